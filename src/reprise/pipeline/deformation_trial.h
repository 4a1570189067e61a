// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// One trial of an editor for `evaluate_deformation`: where constraints sit, which frame is edited, how far
// the result is from the truth.

#pragma once

#include <optional>
#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/deform/surface_editor.h"

namespace reprise {

// `count` vertices spread over the surface: the highest first, each next one the farthest from those before
// (straight through space; of equals the first). Any first few are a choice of that size. Throws
// `InvalidArgument` unless 1 <= count <= N.
std::vector<std::int32_t> spread_vertices(const Positions& reference, std::size_t count);

// The vertices where they are in `frame`, at weight 1, ascending.
std::vector<PositionConstraint> constraints_at(std::vector<std::int32_t> vertices,
                                               const PositionsView& frame);

// The frame whose constrained vertices lie nearest to their targets (least root mean square) after the rigid
// motion that fits best; of equals the first. Knows nothing of the target but the constraints. The database
// has a frame.
FrameId nearest_frame(const PerformanceDatabase& database, std::span<const PositionConstraint> constraints);

// The captured frame under the rigid motion that meets the constraints best: what every model should beat.
class RigidEditor final : public SurfaceEditor {
 public:
  explicit RigidEditor(std::int32_t vertex_count) : vertex_count_(vertex_count) {}

  void set_frame(const PositionsView& frame, const SkeletonPose* pose = nullptr) override;
  DeformReport deform(std::span<const PositionConstraint> constraints) override;
  const Coordinates& positions() const override { return positions_; }

 private:
  std::int32_t vertex_count_;
  Coordinates frame_;
  Coordinates positions_;
};

// Metres, and the factor (1 or more) by which edges are longer or shorter than in any frame that was learnt
// from: what nobody has seen the surface do.
struct TrialFigures {
  double mean_error = 0.0;  // over vertices
  double max_error = 0.0;
  double inside_stretch_p99 = 1.0;
  double inside_stretch_max = 1.0;
  double frontier_stretch_p99 = 1.0;  // 1 if there is no such edge
  double frontier_stretch_max = 1.0;
};

// What a result is measured by. Immutable.
class TrialMeter {
 public:
  // `seen`: the frames that were learnt from. An edge lies on a frontier if one of its ends is shared by
  // several parts of `hierarchy` (may be null: no edge does). A quarter of the mean edge of `reference` is
  // short enough for any edge and never too long: factors of what is tiny say nothing of what is seen.
  TrialMeter(const PerformanceDatabase& seen, const Positions& reference, const PartHierarchy* hierarchy);

  bool has_frontier() const { return !frontier_.empty(); }
  TrialFigures operator()(const Coordinates& positions, const PositionsView& truth) const;

 private:
  struct Edge {
    std::int32_t a = 0, b = 0;
    float shortest = 0.0F, longest = 0.0F;  // metres, that pass
  };
  struct Stretch {
    double p99 = 1.0;
    double max = 1.0;
  };
  static Stretch stretch_of(const std::vector<Edge>& edges, const Coordinates& positions);

  std::vector<Edge> inside_, frontier_;
};

}  // namespace reprise
