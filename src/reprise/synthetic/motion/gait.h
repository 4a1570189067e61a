// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Walking and jogging: curves over the gait cycle and the footsteps that go with them.

#pragma once

#include <array>
#include <functional>
#include <vector>

#include "reprise/synthetic/motion/body_controls.h"
#include "reprise/synthetic/motion/foot_plan.h"

namespace reprise::motion {

// One way of walking or running. Metres and seconds for the design figure, degrees.
struct GaitStyle {
  double speed = 1.3;
  double cycle = 1.04;  // seconds for two steps
  double duty = 0.60;   // share of the cycle a foot is on the ground; below one half: flight
  // Feet.
  double half_width = 0.045;  // of the track
  double toe_out = 6.0;
  double strike_pitch = 18.0;
  double roll = 0.12;  // seconds from strike to flat
  double lift_pitch = -56.0;
  double rise = 0.30;  // seconds from flat to toe-off
  double clearance = 0.03;
  double reach = 0.9945;  // of the standing leg, see `Step`
  double late_lift = 0.0;
  double outward = 0.012;
  double swing_drop = -14.0;
  // Trunk.
  double hip_yaw = 5.0;
  double hip_list = 4.5;
  double tilt = 2.0;        // of the pelvis
  double lean = 2.0;        // of the chest
  double chest_yaw = 5.0;   // against the hips
  double chest_list = 1.2;  // against the hips
  double sway = 0.0;        // of the hips beside what balance asks for, metres
  double hips_ahead = 0.04;
  // Arms.
  double arm_swing = 17.0;
  double arm_mean = -4.0;
  double arm_out = 11.5;
  double arm_in_twist = 6.0;
  double elbow = 24.0;
  double elbow_swing = 8.0;
  double running = 0.0;  // 0: the walking knee, 1: the running knee
};

GaitStyle walk_style();
GaitStyle jog_style();

// The left foot strikes at phase n, the right one at n + 1/2.
Controls gait_controls(const GaitStyle& style, double phase);

// A walk through time: where it starts, speeds up and stops.
struct GaitCourse {
  std::function<double(double time)> jog = [](double) { return 0.0; };   // 0: `walk`, 1: `jog`
  std::function<double(double time)> pace = [](double) { return 1.0; };  // share of the speed
  // Share of the rate of steps; 0 stands.
  std::function<double(double time)> cadence = [](double) { return 1.0; };
  double first_phase = 0.0;  // at time 0
  GaitStyle walk = walk_style();
  GaitStyle jogging = jog_style();
  // Where the feet stand before the first and after the last step, from the path: x outwards, z; degrees.
  struct Stance {
    std::array<Eigen::Vector2d, 2> place = {Eigen::Vector2d(0.088, 0.0), Eigen::Vector2d(0.088, 0.0)};
    std::array<double, 2> yaw = {8.0, 8.0};  // outwards
  };
  Stance before{}, after{};
};

// Phase and footsteps of a course along +Z.
class Gait {
 public:
  // Known from `margin` seconds before the clip to as long after `duration`.
  Gait(GaitCourse course, double duration, double margin);

  double phase(double time) const;
  // Distance travelled since time 0, metres.
  double distance(double time) const;
  std::vector<Step> steps(int side) const;
  // Of the style at that time. Fades to nothing while standing.
  Controls controls(double time) const;

 private:
  double time_of_phase(double phase) const;
  // 0 walks, 1 jogs. `end_of`: when a stance of a style ends.
  double style_of_stance(double begin, const std::function<double(double style)>& end_of) const;

  GaitCourse course_;
  double first_time_;
  double last_time_;
  std::vector<double> phase_, distance_;
};

}  // namespace reprise::motion
