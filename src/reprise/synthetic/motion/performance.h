// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// From footsteps and controls to poses: the hips go where balance and the legs put them, the legs reach for
// the feet.

#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/retarget/limb.h"
#include "reprise/sequence/skeleton.h"
#include "reprise/synthetic/motion/body_controls.h"
#include "reprise/synthetic/motion/foot_plan.h"

namespace reprise::motion {

using retargeting::Limb;

// Lengths in scores are those of a performer with legs this long (hip joint over the ground), metres; they
// are scaled to the skeleton's.
constexpr double design_leg = 0.822;

// A clip as its author writes it. Everything must be defined from `score_margin` seconds before the clip to
// as long after it.
constexpr double score_margin = 4.0;
struct ClipScore {
  std::string name;
  double duration = 0.0;  // seconds
  std::array<std::vector<Step>, 2> steps{};
  std::function<Controls(double time)> controls{};
  double height_smoothing = 0.05;  // seconds, of the hips' height: less for quick motion
};

class Performance {
 public:
  Performance(const Skeleton& skeleton, ClipScore score);

  const ClipScore& score() const { return score_; }
  // Within `score_margin` before and after, less two seconds.
  SkeletonPose pose(double time) const;
  FootState foot_state(int side, double time) const { return feet_[static_cast<std::size_t>(side)].at(time); }
  FootContacts contacts(double time) const;

 private:
  struct Trunk {
    Eigen::Quaterniond pelvis, spine, chest, neck, head;
  };
  Trunk trunk(const Controls& controls) const;
  void balance();
  void raise_hips(const std::vector<Controls>& controls);
  Eigen::Vector3d hips(double time) const;
  void pose_arm(SkeletonPose& pose, int side, const Controls& controls) const;
  void pose_leg(SkeletonPose& pose, int side, const Controls& controls, double time) const;
  void attach(SkeletonPose& pose, int joint_idx, const Eigen::Quaterniond& rotation) const;
  const Eigen::Vector3d& rest(int joint_idx) const {
    return skeleton_.joints[static_cast<std::size_t>(joint_idx)].rest_position;
  }

  Skeleton skeleton_;
  ClipScore score_;
  double scale_ = 1.0;
  std::array<int, 5> trunk_idx_{};                // pelvis, spine, chest, neck, head
  std::array<std::array<int, 8>, 2> side_idx_{};  // collar, upper_arm, forearm, hand, thigh, shin, foot, toe
  std::vector<FootPlan> feet_;
  std::vector<Limb> arms_, legs_;
  Eigen::Vector3d rest_hips_;  // middle between the hip joints
  double first_time_ = 0.0;
  std::array<std::vector<double>, 2> load_;
  std::vector<double> x_, z_;
  SampledCurve hips_x_, hips_y_, hips_z_;
};

}  // namespace reprise::motion
