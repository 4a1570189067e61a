// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Rigid motions as dual quaternions, and their weighted mean (Kavan et al. 2007): a rigid motion again, so
// that what follows it keeps its volume.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise {

// The motion x -> R x + t: the unit quaternion q of R and (0, t) q / 2, each as (w, x, y, z).
using DualQuaternion = Eigen::Matrix<double, 8, 1>;

inline DualQuaternion dual_quaternion(const Eigen::Quaterniond& rotation,
                                      const Eigen::Vector3d& translation) {
  const Eigen::Vector3d& t = translation;
  const Eigen::Quaterniond d = Eigen::Quaterniond(0.0, t.x(), t.y(), t.z()) * rotation;
  DualQuaternion result;
  result << rotation.w(), rotation.vec(), 0.5 * d.w(), 0.5 * d.vec();
  return result;
}

// Weighted sum of motions. The same rotation has two quaternions: each motion enters with the one nearer to
// that of the first, which should be the one of the largest weight. The sum is never zero.
class DualQuaternionSum {
 public:
  // `weight` > 0.
  DualQuaternionSum(double weight, const DualQuaternion& first) : first_(first), sum_(weight * first) {}

  // The sign with which a motion enters.
  double sign(const DualQuaternion& other) const {
    return first_.head<4>().dot(other.head<4>()) < 0.0 ? -1.0 : 1.0;
  }
  // `weight` >= 0.
  void add(double weight, const DualQuaternion& other) { sum_ += (sign(other) * weight) * other; }
  const DualQuaternion& sum() const { return sum_; }

 private:
  DualQuaternion first_;
  DualQuaternion sum_;
};

// Where the motion nearest to a sum of motions, sum / |q|, takes a point.
inline Eigen::Vector3d carry(const DualQuaternion& sum, const Eigen::Vector3d& x) {
  const DualQuaternion unit = sum / sum.head<4>().norm();
  const double w0 = unit[0], we = unit[4];
  const Eigen::Vector3d v0 = unit.segment<3>(1), ve = unit.tail<3>();
  const Eigen::Vector3d rotated = x + 2.0 * v0.cross(v0.cross(x) + w0 * x);
  return rotated + 2.0 * (w0 * ve - we * v0 + v0.cross(ve));
}

}  // namespace reprise
