// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Hips that go along with feet that are moved.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reprise/retarget/limb.h"

namespace reprise::retargeting {

// The course of the hips, which go along with what planting moves at the feet: of hips that stay, knees would
// have to make up for it, and a knee that is nearly straight jumps by several times the change.
class HipCourse {
 public:
  explicit HipCourse(std::size_t frames)
      : D_(frames, Eigen::Matrix3d::Zero()),
        O_(frames, Eigen::Matrix3d::Zero()),
        b_(frames, Eigen::Vector3d::Zero()) {}

  // A leg from its hip joint to the ankle in every frame, and what its ankle is moved by.
  void add_leg(const Limb& limb, const std::vector<Eigen::Vector3d>& ways,
               const std::vector<Eigen::Vector3d>& moved, double frames_per_second);
  // Shifts of the hips, metres, that minimise velocities that are changed: of the hips, with all that hangs
  // on them, and of the knees.
  std::vector<Eigen::Vector3d> shifts(double frames_per_second);

 private:
  // Changes that last count little beside changes of velocity: squared, in units of those of a frame of 1/25
  // s.
  static constexpr double knee_place = 0.05, hip_place = 0.02;
  static double squared_frame(double frames_per_second) {
    return 625.0 / (frames_per_second * frames_per_second);
  }

  // Block tridiagonal normal equations.
  std::vector<Eigen::Matrix3d> D_, O_;
  std::vector<Eigen::Vector3d> b_;
};

}  // namespace reprise::retargeting
