// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/foot_shape.h"

#include <string>

namespace reprise::retargeting {

FootShape foot_shape(const Skeleton& skeleton, int side) {
  const std::string prefix = side == 0 ? "left_" : "right_";
  FootShape shape;
  shape.ankle = skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx(prefix + "foot"))].rest_position;
  shape.ball = skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx(prefix + "toe"))].rest_position;
  // The heel lies behind the ankle by a good third, the toes end before the ball by half of the way from
  // ankle to ball.
  const double length = shape.ball.z() - shape.ankle.z();
  shape.heel = {shape.ankle.x(), 0.0, shape.ankle.z() - 0.42 * length};
  shape.toe_tip = {shape.ball.x(), 0.0, shape.ball.z() + 0.5 * length};
  return shape;
}

}  // namespace reprise::retargeting
