// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The pose whose skinned surface meets positional constraints: inverse kinematics through skinning.

#pragma once

#include <span>

#include "reprise/deform/position_constraint.h"
#include "reprise/deform/skinning.h"

namespace reprise {

struct PoseFitOptions {
  Skinning skinning = Skinning::linear;
  double pull = 0.02;  // what turning a joint by 1 radian costs: a distance (metres) at weight 1
  int most_iterations = 200;
  double tolerance = 1e-8;  // a step is shorter than this (radians, metres): done
};

struct PoseFit {
  SkeletonPose pose;
  double residual = 0.0;  // root mean square distance of the constrained vertices from their targets, metres
  int iterations = 0;
  bool converged = false;  // false: stopped by `most_iterations`; the pose is the best found
};

// Minimises over the rotations of all joints against their parents, and rotation and position of the roots,
//   sum_i weight_i^2 |x_i(pose) - target_i|^2 + pull^2 sum_j |log(q_j,source^-1 q_j)|^2
// where x(pose) is the source frame skinned from its pose, q_j the rotation of joint j against its parent (no
// term for roots), and bones keep the lengths they have in the source pose. Levenberg and Marquardt with the
// analytic Jacobian of either skinning, started from the source moved rigidly to where it fits best, with a
// pull that is strong at first.
//
//   - Joints that no constraint speaks of keep their rotation against the parent; what one constraint alone
//     asks for, moving as a whole gives: fix other vertices to hold a body.
//   - No constraints, or all met already: exactly the source pose.
//   - Targets moved rigidly move the result rigidly (to convergence), if three or more are not on a line.
//   - Targets out of reach: limbs stretch straight towards them. Joints have no limits: a knee may bend
//     either way.
// Throws `InvalidArgument` for shapes that do not fit, invalid constraints or options.
PoseFit fit_pose(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
                 const SkeletonPose& source_pose, std::span<const PositionConstraint> constraints,
                 const PoseFitOptions& options = {});

}  // namespace reprise
