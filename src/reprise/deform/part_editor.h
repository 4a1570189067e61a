// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Editing within what the parts were seen to do (LPBM IV.B, HSSMG Eq. 32).

#pragma once

#include <memory>

#include "reprise/database/learnt_model.h"
#include "reprise/deform/surface_editor.h"

namespace reprise {

class LearntPartSolver;

struct PartEditorOptions {
  // Weight of a constraint of weight 1 against the surface's bending: multiples of 1 / (mean edge length).
  double constraint_weight = 5.0;
  // Weight of an anchor that a child takes from its parent, in the same unit: of a parent that constraints
  // ask, whose place near its end is itself only an estimate, and of one that is not asked and stays.
  double frontier_weight = 0.5;
  double resting_frontier_weight = 2.0;
  // Pull of coefficients towards those of the edited frame, in units of what PCA left out of the examples
  // (probabilistic PCA); 0: none, as in the papers.
  double prior = 1.0;
  // How far coefficients may leave the range of the examples, as a share of that range; negative: no limit,
  // as in the papers. A frame outside of the range keeps its place.
  double beyond_range = 0.5;
  // Radians. Where the surface has turned farther than this from what the learnt shape says, its Laplacian
  // coordinates turn along by what is beyond: poses that no combination of examples shows. pi: never.
  double free_turn = 0.35;
};

// The immutable half of an editor, shared by all editors of a model: parts, operators, learnt spaces.
class PartModel {
 public:
  // Throws `InvalidArgument` for what `validate` or `PartHierarchy` refuses.
  PartModel(TopologyPtr topology, const LearntModel& learnt, const PartEditorOptions& options = {});
  ~PartModel();

  const PartHierarchy& hierarchy() const { return hierarchy_; }
  const PartEditorOptions& options() const { return options_; }

 private:
  friend class PartEditor;
  PartHierarchy hierarchy_;
  PartEditorOptions options_;
  std::vector<std::unique_ptr<LearntPartSolver>> solvers_;  // one a part
  double edge_length_ = 1.0;                                // metres, mean of the reference
};

// Each part is deformed as delta_s + E r under one rotation Q of the whole part, delta_s the frame's own
// Laplacian coordinates: r, Q and x minimise
//   |L x - (delta_s + E r) Q^T|^2 + |W_c (x - x_c)|^2 + prior,
// x by a Schur complement that is kept with the factorisation, (Q, r) exactly in l + 3 unknowns. A constraint
// asks the part with the greatest share in its vertex, and counts by their shares in all asked parts that
// hold it. Parents first: where a child overlaps its parent, the parent's new surface anchors the child, and
// both are recombined (`PartHierarchy`). A part that is not asked, or asked to stay, and whose parent stays
// keeps the captured surface to the last bit.
class PartEditor final : public SurfaceEditor {
 public:
  explicit PartEditor(std::shared_ptr<const PartModel> model);
  ~PartEditor() override;

  void set_frame(const PositionsView& frame, const SkeletonPose* pose = nullptr) override;
  DeformReport deform(std::span<const PositionConstraint> constraints) override;
  const Coordinates& positions() const override { return positions_; }

  const PartModel& model() const { return *model_; }
  // Change r of the coefficients against the frame in the last result: one vector a part.
  const std::vector<Eigen::VectorXd>& coefficient_changes() const { return changes_; }
  // The prior draws r towards these instead of 0 from the next `deform` on: one vector a part, or none.
  // Throws `InvalidArgument` if sizes do not fit.
  void prefer(std::vector<Eigen::VectorXd> changes);

 private:
  struct PartState;
  std::shared_ptr<const PartModel> model_;
  std::vector<PartState> states_;
  Coordinates frame_;
  Coordinates positions_;
  std::vector<Coordinates> part_positions_;
  std::vector<Eigen::VectorXd> changes_;
  std::vector<Eigen::VectorXd> preferred_;
};

}  // namespace reprise
