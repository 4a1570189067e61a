// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where the feet are: steps that stay where they are put, and swings between them.

#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "reprise/retarget/foot_shape.h"
#include "reprise/synthetic/motion/motion_curve.h"

namespace reprise::motion {

constexpr double side_sign(int side) {
  return side == 0 ? 1.0 : -1.0;
}

using retargeting::foot_shape;
using retargeting::FootShape;

// Pitch is positive with the toes up. A foot with positive pitch stands on its heel, with negative pitch on
// its ball, the toes staying flat.
struct Step {
  static constexpr double forever = std::numeric_limits<double>::infinity();

  double begin = -forever;  // seconds
  double end = forever;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // x, z of the ankle over the flat foot, metres
  double yaw = 0.0;                                 // degrees
  double strike_pitch = 0.0;                        // degrees, at `begin`
  double roll_duration = 0.1;                       // from `begin` to flat
  double lift_pitch = -30.0;                        // degrees, at `end`
  double rise_duration = 0.25;                      // from flat to `end`
  // While the foot stands: turning about the ball, degrees beside `yaw`; heel raised, degrees. May be empty.
  Curve pivot, heel_lift;
  // Of the swing that leads here: height of the ankle beside the straight way, early and late in the swing,
  // and its outward arc, metres; extra lowering of the toes, degrees.
  double clearance = 0.03;
  double late_lift = 0.0;
  double outward = 0.0;
  double swing_drop = 0.0;
  // Share of its length to which the leg may stretch while it stands; a swinging one holds back beyond.
  double reach = 0.9945;
};

struct FootState {
  Eigen::Vector3d ankle;
  double yaw = 0.0;        // radians
  double pitch = 0.0;      // radians
  double toe_pitch = 0.0;  // of the toes in the world
  double swing = 0.0;      // 0 standing, 1 in the middle of a swing
  double reach = 1.0;      // see `Step`
  bool heel_down = false;
  bool ball_down = false;

  Eigen::Quaterniond foot_rotation() const;
  Eigen::Quaterniond toe_rotation() const;
  bool contact() const { return heel_down || ball_down; }
};

// The steps of one foot, in order of time.
class FootPlan {
 public:
  FootPlan(FootShape shape, int side, std::vector<Step> steps);

  const FootShape& shape() const { return shape_; }
  const std::vector<Step>& steps() const { return steps_; }
  FootState at(double time) const;
  // The step that stands at a time, or none.
  const Step* standing_step(double time) const;
  // Where the foot presses on the ground at a time in a step: from heel to ball as it rolls; x, z.
  Eigen::Vector2d pressure(const Step& step, double time) const;

 private:
  FootState standing(const Step& step, double time) const;

  FootShape shape_;
  int side_;
  std::vector<Step> steps_;
};

}  // namespace reprise::motion
