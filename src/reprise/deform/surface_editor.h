// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What every way of deforming a captured frame by constraints has in common: learnt parts, the whole body,
// plain Laplacian editing, skinning.

#pragma once

#include <span>
#include <vector>

#include "reprise/deform/part_hierarchy.h"
#include "reprise/deform/position_constraint.h"
#include "reprise/sequence/skeleton.h"

namespace reprise {

struct DeformReport {
  int iterations = 0;             // of the slowest part
  int solved_parts = 0;           // that had to move; the others keep the captured surface
  double largest_residual = 0.0;  // metres: constraint least well met
};

// One frame and what is asked of it. Keeps factorisations as long as the constrained vertices and their
// weights stay the same, so that a drag (only targets change) costs milliseconds. Not thread-safe: one editor
// a thread; what is costly and immutable is shared between editors.
class SurfaceEditor {
 public:
  virtual ~SurfaceEditor() = default;

  // The captured frame to deform, N x 3, metres; result positions become the frame's own. `pose`: the frame's
  // skeleton pose, needed by skinned models and ignored by others. Throws `InvalidArgument` if shapes do not
  // fit, a coordinate is not finite or a pose is missing.
  virtual void set_frame(const PositionsView& frame, const SkeletonPose* pose = nullptr) = 0;

  // Deforms the frame, from its captured state, to meet the constraints in the least-squares sense. The same
  // constraints give the same result, whatever was asked before. Targets at the frame's own places give back
  // the frame; targets moved rigidly move what they hold rigidly; a result is finite however far targets lie.
  // Throws `InvalidArgument` for what `validate` refuses, for no constraint at all, or before a frame was
  // set.
  virtual DeformReport deform(std::span<const PositionConstraint> constraints) = 0;

  // N x 3, metres: the last result, or the frame itself.
  virtual const Coordinates& positions() const = 0;
};

// For editors. Throw `InvalidArgument`: a frame that does not fit or is not finite; constraints that
// `validate` refuses, none at all, or no frame yet (no rows).
void check_frame(const PositionsView& frame, std::int32_t vertex_count);
void check_constraints(std::span<const PositionConstraint> constraints, std::int32_t vertex_count,
                       const Coordinates& frame);
// Metres.
double largest_residual(std::span<const PositionConstraint> constraints, const Coordinates& positions);

}  // namespace reprise
