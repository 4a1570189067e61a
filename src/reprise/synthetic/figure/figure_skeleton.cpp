// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure_skeleton.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reprise::figure {

namespace {

constexpr double arm_angle = 45.0 * std::numbers::pi / 180.0;  // of the resting arm from the vertical
constexpr double upper_arm_length = 0.275;
constexpr double forearm_length = 0.245;

Eigen::Vector3d left_position(int joint) {
  Eigen::Vector3d shoulder(0.172, 1.392, -0.005);
  const Eigen::Vector3d along(std::sin(arm_angle), -std::cos(arm_angle), 0.0);
  switch (joint) {
    case pelvis:
      return {0.0, 0.97, 0.0};
    case spine:
      return {0.0, 1.07, -0.01};
    case chest:
      return {0.0, 1.21, -0.01};
    case neck:
      return {0.0, 1.455, -0.005};
    case head:
      return {0.0, 1.515, 0.0};
    case upper_arm:
      return shoulder;
    case forearm:
      return shoulder + upper_arm_length * along;
    case hand:
      return shoulder + (upper_arm_length + forearm_length) * along;
    case thigh:
      return {0.095, 0.93, 0.0};
    case shin:
      return {0.1, 0.505, 0.012};
    case foot:
      return {0.1, 0.085, -0.02};
    default:
      return {0.1, 0.01, 0.095};  // the ball: near the sole, so that a bending sole does not slide
  }
}

}  // namespace

std::string joint_name(int joint) {
  static constexpr std::array<const char*, upper_arm + side_joints> names = {
      "pelvis",  "spine", "chest", "neck", "head", "upper_arm",
      "forearm", "hand",  "thigh", "shin", "foot", "toe"};
  if (joint < upper_arm) return names[static_cast<std::size_t>(joint)];
  const bool is_left = joint < sided(upper_arm, 1);
  return std::string(is_left ? "left_" : "right_") +
         names[static_cast<std::size_t>(is_left ? joint : joint - side_joints)];
}

int parent_of(int joint) {
  if (joint <= head) return joint - 1;
  const int first = joint < sided(upper_arm, 1) ? upper_arm : sided(upper_arm, 1);
  const int left = joint - first + upper_arm;
  return left == upper_arm ? int{chest} : left == thigh ? int{pelvis} : joint - 1;
}

Eigen::Vector3d rest_position(int joint) {
  if (joint < sided(upper_arm, 1)) return left_position(joint);
  const Eigen::Vector3d left = left_position(joint - side_joints);
  return {-left.x(), left.y(), left.z()};
}

Eigen::Vector3d rest_arm_direction(int side) {
  return {side_sign(side) * std::sin(arm_angle), -std::cos(arm_angle), 0.0};
}

Eigen::Vector3d rest_heel(int side) {
  return {side_sign(side) * 0.1, 0.0, -0.08};
}

double smooth_ramp(double low, double high, double value) {
  const double u = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

}  // namespace reprise::figure
