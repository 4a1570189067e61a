// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the figure does: clips as functions of time, and the pose at any time of a clip.

#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "reprise/math/ground_transform.h"
#include "reprise/synthetic/figure/figure_skeleton.h"

namespace reprise::figure {

// A clip as its author writes it. All functions take seconds from the first frame and are called from two
// seconds before it to two seconds after the last.
struct ClipPlan {
  using Curve = std::function<double(double)>;
  static double nothing(double) { return 0.0; }

  std::string name;
  double duration = 0.0;       // seconds
  double first_phase = 0.0;    // gait phase at time 0; the left foot strikes at n, the right one at n + 1/2
  Curve speed = nothing;       // of the path, m/s
  Curve phase_rate = nothing;  // gait cycles per second
  Curve turn_rate = nothing;   // of the path, rad/s, positive from +Z towards +X
  Curve jog = nothing;         // 0 walking, 1 jogging
  Curve wave = nothing;        // 0 arm down, 1 right arm waving
};

// "stand", "walk", "walk_curve", "jog", "walk_jog", "jog_walk", "start", "stop", "wave".
std::vector<ClipPlan> clip_plans();

class Motion {
 public:
  explicit Motion(ClipPlan plan);

  const ClipPlan& plan() const { return plan_; }
  // Poses and velocities between two seconds before the first frame and two after the last.
  Pose pose(double time) const;
  // Ground frame of the path: its position and heading.
  GroundTransform path(double time) const;
  Eigen::Vector3d path_velocity(double time) const;
  // The whole sole lies still on the ground.
  bool flat_footed(int side, double time) const;

 private:
  // A stay of one foot on the ground. Times may be infinite: standing before or after the clip.
  struct Step {
    double begin = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // of the ankle's projection on the ground
    double yaw = 0.0;
    double roll_duration = 0.0;  // heel to flat
    double rise_duration = 0.0;  // flat to toe-off
    double strike_pitch = 0.0;   // toes up, radians
    double lift_pitch = 0.0;     // heel up, radians
  };
  struct FootState {
    Eigen::Vector3d ankle;
    double yaw = 0.0;
    double pitch = 0.0;  // toes up
    double toe_bend = 0.0;
  };

  double phase(double time) const;
  double table(const std::vector<double>& values, double time) const;
  double time_of_phase(double phase) const;
  double stride_weight(double time) const;
  std::vector<Step> steps_of(int side) const;
  FootState standing(const Step& step, int side, double time) const;
  FootState foot_state(int side, double time) const;
  void pose_trunk(Pose& pose, double time) const;
  void pose_arm(Pose& pose, int side, double time) const;
  void pose_leg(Pose& pose, int side, double time) const;

  ClipPlan plan_;
  double first_time_ = 0.0;
  std::vector<double> phase_, heading_, x_, z_;  // sampled at table_rate
  std::array<std::vector<Step>, 2> steps_;
};

}  // namespace reprise::figure
