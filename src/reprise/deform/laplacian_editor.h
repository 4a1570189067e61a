// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Plain Laplacian editing of a frame, without anything learnt (LPBM III, Eq. 4).

#pragma once

#include <memory>

#include "reprise/deform/surface_editor.h"

namespace reprise {

struct LaplacianEditorOptions {
  double constraint_weight = 5.0;  // as in `PartEditorOptions`
  int most_iterations = 25;
  double tolerance = 1e-4;  // metres: stop when no vertex has moved farther in an iteration
};

// x minimises |L x - delta|^2 + |W_c (x - x_c)|^2. Laplacian coordinates do not turn with the surface, so
// they are turned: rebuild, take every triangle's rotation against the captured frame (the mean of those
// around it, lest the surface crumples), turn its gradient, and repeat until nothing moves any more. The
// first iteration turns the surface as a whole, by the rotation that leaves least to be minimised: rigid
// drags end there. Pieces that do not hang together with the largest one go along with its nearest vertex.
class LaplacianEditor final : public SurfaceEditor {
 public:
  // `reference`: N x 3, any frame of the performer; the operator is defined on it. Throws `InvalidArgument`
  // as `SurfaceLaplacian` does, and for options out of range.
  LaplacianEditor(TopologyPtr topology, const PositionsView& reference,
                  const LaplacianEditorOptions& options = {});
  ~LaplacianEditor() override;

  void set_frame(const PositionsView& frame, const SkeletonPose* pose = nullptr) override;
  DeformReport deform(std::span<const PositionConstraint> constraints) override;
  const Coordinates& positions() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
