// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Directions of bones as angles and turns. Internal.

#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise::retargeting {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

// About +Y from +Z, of a direction over the ground.
inline double heading(const Eigen::Vector3d& direction) {
  return std::atan2(direction.x(), direction.z());
}

inline Eigen::Quaterniond turn_about_up(double yaw) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()));
}

// Columns: the hinge, made perpendicular to the direction; the direction; their cross product.
inline Eigen::Matrix3d hinge_frame(const Eigen::Vector3d& direction, const Eigen::Vector3d& hinge) {
  const Eigen::Vector3d along = direction.normalized();
  const Eigen::Vector3d axis = (hinge - hinge.dot(along) * along).normalized();
  Eigen::Matrix3d M;
  M << axis, along, axis.cross(along);
  return M;
}

}  // namespace reprise::retargeting
