// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Rigid motion on the ground plane: a turn about the vertical axis and a horizontal translation.

#pragma once

#include <Eigen/Core>

namespace reprise {

// Maps p to R_y(yaw) p + (x, 0, z). Named like every transform here: `b_from_a` maps coordinates of a to
// those of b. A positive yaw (radians, right-handed about +Y) turns +Z towards +X.
struct GroundTransform {
  double yaw = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  // (x, z), metres

  Eigen::Matrix3d rotation() const;
  Eigen::Vector3d translation3() const { return {translation.x(), 0.0, translation.y()}; }

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const;
  // Of a point on the ground, (x, z).
  Eigen::Vector2d operator*(const Eigen::Vector2d& ground_point) const;

  GroundTransform inverse() const;
};

// c_from_a = c_from_b * b_from_a. The yaw of the product lies in (-pi, pi].
GroundTransform operator*(const GroundTransform& c_from_b, const GroundTransform& b_from_a);

// The angle plus a multiple of 2 pi that lies in (-pi, pi].
double wrap_angle(double radians);

}  // namespace reprise
