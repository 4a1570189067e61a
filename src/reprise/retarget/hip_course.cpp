// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/hip_course.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace reprise::retargeting {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void HipCourse::add_leg(const Limb& limb, const std::vector<Vector3d>& ways,
                        const std::vector<Vector3d>& moved, double frames_per_second) {
  constexpr double greatest_gain = 6.0;  // of a straight leg it is infinite
  const double place = knee_place * squared_frame(frames_per_second);
  Vector3d v_before = Vector3d::Zero();
  double k_before = 0.0;
  for (std::size_t f = 0; f < ways.size(); ++f) {
    const double share = std::min(ways[f].norm() / limb.reach(), 1.0);
    // The knee's way for a change of the distance from hip to ankle, of a leg of two like bones.
    const double gain = std::min(0.5 * share / std::sqrt(std::max(1.0 - share * share, 1e-6)), greatest_gain);
    const Vector3d v = -gain * ways[f].normalized();
    const double k = -v.dot(moved[f]);
    D_[f] += place * v * v.transpose();
    b_[f] -= place * k * v;
    if (f > 0) {
      D_[f] += v * v.transpose();
      D_[f - 1] += v_before * v_before.transpose();
      O_[f - 1] -= v_before * v.transpose();
      b_[f] -= (k - k_before) * v;
      b_[f - 1] += (k - k_before) * v_before;
    }
    v_before = v;
    k_before = k;
  }
}

std::vector<Vector3d> HipCourse::shifts(double frames_per_second) {
  constexpr double joints = 8.0;  // that hips count as: more, and knees jerk
  const std::size_t n = D_.size();
  for (std::size_t f = 0; f < n; ++f) {
    D_[f] += hip_place * joints * squared_frame(frames_per_second) * Matrix3d::Identity();
    if (f == 0) continue;
    D_[f] += joints * Matrix3d::Identity();
    D_[f - 1] += joints * Matrix3d::Identity();
    O_[f - 1] -= joints * Matrix3d::Identity();
  }
  for (std::size_t f = 1; f < n; ++f) {
    const Matrix3d eliminated = D_[f - 1].ldlt().solve(O_[f - 1]).transpose();
    D_[f] -= eliminated * O_[f - 1];
    b_[f] -= eliminated * b_[f - 1];
  }
  std::vector<Vector3d> shifts(n);
  for (std::size_t f = n; f-- > 0;) {
    const Vector3d rest = f + 1 < n ? Vector3d(b_[f] - O_[f] * shifts[f + 1]) : b_[f];
    shifts[f] = D_[f].ldlt().solve(rest);
  }
  return shifts;
}

}  // namespace reprise::retargeting
