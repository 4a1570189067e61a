// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How near a driven character's motion is to the query's (HSSMG 6.2, Figures 13 and 14).

#pragma once

#include <vector>

#include "reprise/retarget/retarget.h"

namespace reprise {

// Length of the difference of joint velocity vectors, metres/frame, over joints and frames: its mean, and the
// standard deviation of the frames' means over joints.
struct VelocityError {
  double mean = 0.0;
  double deviation = 0.0;
  std::vector<double> per_joint;  // means over frames, one a joint compared
};

enum class VelocityScale {
  legs,  // the query enlarged by the ratio of leg lengths
  none,  // the query in its own size
};

// `result`: poses of the character at the frames of `target.motion`. Velocities are compared in the
// performer's heading: each frame's are turned by the yaw that brings its pose nearest to the target's, so
// that a path that bends away from the query's does not count as another gait. Joints compared:
// `target.source_joints`. Throws `InvalidArgument` if counts differ. A motion of fewer than two frames has no
// velocities: zero.
VelocityError velocity_error(const std::vector<SkeletonPose>& result, const RetargetedMotion& target,
                             VelocityScale scale);

}  // namespace reprise
