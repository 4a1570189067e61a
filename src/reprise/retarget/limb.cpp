// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/limb.h"

#include <algorithm>
#include <cmath>

#include "reprise/retarget/bone_angles.h"

namespace reprise::retargeting {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Limb::Limb(const Vector3d& root, const Vector3d& middle, const Vector3d& end, const Vector3d& hinge)
    : upper_((middle - root).norm()),
      lower_((end - middle).norm()),
      upper_frame_(hinge_frame(middle - root, hinge)),
      lower_frame_(hinge_frame(end - middle, hinge)) {}

double Limb::distance(double flexion) const {
  return std::sqrt(upper_ * upper_ + lower_ * lower_ + 2.0 * upper_ * lower_ * std::cos(flexion));
}

Limb::Rotations Limb::posed(const Vector3d& upper_direction, const Vector3d& hinge, double flexion) const {
  const Matrix3d M = hinge_frame(upper_direction, hinge);
  const Vector3d lower_direction = Eigen::AngleAxisd(flexion, M.col(0)) * M.col(1);
  return {
      .upper = Quaterniond(M * upper_frame_.transpose()).normalized(),
      .lower = Quaterniond(hinge_frame(lower_direction, M.col(0)) * lower_frame_.transpose()).normalized()};
}

Limb::Rotations Limb::reaching(const Vector3d& root, const Vector3d& end, const Vector3d& pole,
                               double soft) const {
  double share = (end - root).norm() / reach();
  if (share > soft) share = soft + (longest - soft) * std::tanh((share - soft) / (longest - soft));
  const double distance = std::max(share * reach(), std::abs(upper_ - lower_) + 1e-3 * reach());
  const Vector3d toward = (end - root).normalized();
  const double cosine = std::clamp(
      (upper_ * upper_ + distance * distance - lower_ * lower_) / (2.0 * upper_ * distance), -1.0, 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const Vector3d aside = (pole - pole.dot(toward) * toward).normalized();
  const Vector3d upper_direction = cosine * toward + sine * aside;
  const double bend = (upper_ * upper_ + lower_ * lower_ - distance * distance) / (2.0 * upper_ * lower_);
  // Bending about the hinge turns the upper bone's direction away from the pole.
  const Vector3d hinge = aside.cross(toward);
  return posed(upper_direction, hinge, std::acos(std::clamp(-bend, -1.0, 1.0)));
}

}  // namespace reprise::retargeting
