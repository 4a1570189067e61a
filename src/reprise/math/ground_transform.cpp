// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/math/ground_transform.h"

#include <cmath>
#include <numbers>

namespace reprise {

Eigen::Matrix3d GroundTransform::rotation() const {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  Eigen::Matrix3d R;
  R << c, 0, s,  //
      0, 1, 0,   //
      -s, 0, c;
  return R;
}

Eigen::Vector3d GroundTransform::operator*(const Eigen::Vector3d& point) const {
  return rotation() * point + translation3();
}

Eigen::Vector2d GroundTransform::operator*(const Eigen::Vector2d& ground_point) const {
  const Eigen::Vector3d moved = *this * Eigen::Vector3d(ground_point.x(), 0.0, ground_point.y());
  return {moved.x(), moved.z()};
}

GroundTransform GroundTransform::inverse() const {
  GroundTransform result{.yaw = wrap_angle(-yaw)};
  result.translation = -(result * translation);
  return result;
}

GroundTransform operator*(const GroundTransform& c_from_b, const GroundTransform& b_from_a) {
  return {.yaw = wrap_angle(c_from_b.yaw + b_from_a.yaw), .translation = c_from_b * b_from_a.translation};
}

double wrap_angle(double radians) {
  const double wrapped = std::remainder(radians, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

}  // namespace reprise
