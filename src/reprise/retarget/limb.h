// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Limbs of two bones and a hinge: arms and legs.

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise::retargeting {

// Lengths and resting directions of a limb's bones and its hinge at rest, about which positive angles bend
// it.
class Limb {
 public:
  // Root, middle and end at rest; `hinge`: roughly, made perpendicular to each bone.
  Limb(const Eigen::Vector3d& root, const Eigen::Vector3d& middle, const Eigen::Vector3d& end,
       const Eigen::Vector3d& hinge);

  double upper() const { return upper_; }
  double lower() const { return lower_; }
  double reach() const { return upper_ + lower_; }
  // Distance from root to end at a flexion, radians; 0 is straight.
  double distance(double flexion) const;

  struct Rotations {
    Eigen::Quaterniond upper, lower;  // from rest to the world
  };
  // From the direction of the upper bone, the hinge and the flexion.
  Rotations posed(const Eigen::Vector3d& upper_direction, const Eigen::Vector3d& hinge, double flexion) const;
  // With root and end given, the middle bends towards `pole`. From the share `soft` of its length on, the
  // limb stretches ever less, up to `longest`: a knee that snaps straight pops.
  static constexpr double longest = 0.9992;
  Rotations reaching(const Eigen::Vector3d& root, const Eigen::Vector3d& end, const Eigen::Vector3d& pole,
                     double soft) const;

 private:
  double upper_, lower_;
  Eigen::Matrix3d upper_frame_, lower_frame_;  // columns: hinge, direction, their cross product; at rest
};

}  // namespace reprise::retargeting
