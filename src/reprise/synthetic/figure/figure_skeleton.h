// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Skeleton of the figure: joints in the rest pose, an A-pose facing +Z with its left side towards +X.

#pragma once

#include <array>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise::figure {

// Joints of the trunk, then of the two sides. A parent stands before its children.
enum Joint {
  pelvis,
  spine,
  chest,
  neck,
  head,
  upper_arm,  // of the left side; the right side's joints follow at `+ side_joints`
  forearm,
  hand,
  thigh,
  shin,
  foot,
  toe,
  side_joints = 7,
  joint_count = 5 + 2 * side_joints,
};

// Sides: 0 is left (+X), 1 is right.
constexpr int sided(Joint left_joint, int side) {
  return left_joint + side * side_joints;
}
constexpr double side_sign(int side) {
  return side == 0 ? 1.0 : -1.0;
}

// All lengths of the figure are given for this height, in metres, and scaled at the end.
constexpr double design_height = 1.75;

// "pelvis", "left_upper_arm" and so on; and the joint it hangs on, -1 for the pelvis.
std::string joint_name(int joint);
int parent_of(int joint);

// Rest position of a joint, metres.
Eigen::Vector3d rest_position(int joint);

// Direction of the resting arm from shoulder to hand, unit length.
Eigen::Vector3d rest_arm_direction(int side);

// Rear edge of the sole, about which the foot rolls when it strikes.
Eigen::Vector3d rest_heel(int side);

// 0 below `low`, 1 above `high`, smooth between.
double smooth_ramp(double low, double high, double value);

// World rotations and positions of all joints. A point x of the rest pose that is fixed to joint j goes to
// rotation[j] (x - rest_position(j)) + position[j].
struct Pose {
  std::array<Eigen::Quaterniond, joint_count> rotation;
  std::array<Eigen::Vector3d, joint_count> position;
};

}  // namespace reprise::figure
