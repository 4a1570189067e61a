// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/clip_scores.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace reprise::motion {

namespace {

struct Sway {
  Channel channel;
  double amount;
};
// Standard deviations.
constexpr std::array<Sway, 14> sways = {{{head_yaw, 1.6},
                                         {head_tilt, 0.7},
                                         {head_list, 0.5},
                                         {chest_yaw, 0.6},
                                         {chest_list, 0.35},
                                         {pelvis_yaw, 0.4},
                                         {left_weight, 0.035},
                                         {arm_forward, 0.7},
                                         {sided(arm_forward, 1), 0.7},
                                         {arm_out, 0.4},
                                         {sided(arm_out, 1), 0.4},
                                         {elbow, 1.0},
                                         {sided(elbow, 1), 1.0},
                                         {shift_z, 0.003}}};

}  // namespace

Life::Life(std::uint64_t seed, double period)
    : breath_period_(period / std::max(1.0, std::round(period / 3.4))) {
  for (std::size_t k = 0; k < sways.size(); ++k) noise_.emplace_back(97 * seed + k, period);
}

Controls Life::add_to(Controls controls, double time, double amount) const {
  for (std::size_t k = 0; k < sways.size(); ++k)
    controls[sways[k].channel] += amount * sways[k].amount * noise_[k](time);
  // The chest rises, the shoulders a little later, and the head stays level.
  const double cycle = 2.0 * std::numbers::pi * time / breath_period_;
  controls[chest_tilt] -= 0.9 * amount * std::sin(cycle);
  for (int side = 0; side < 2; ++side) {
    controls[sided(collar_up, side)] += 0.9 * amount * std::sin(cycle - 0.3);
    controls[sided(arm_out, side)] += 0.4 * amount * std::sin(cycle - 0.5);
  }
  return controls;
}

Controls standing_pose() {
  Controls pose;
  for (int side = 0; side < 2; ++side) {
    pose[sided(knee, side)] = 10.0;
    pose[sided(arm_forward, side)] = -3.0;
    pose[sided(arm_out, side)] = 10.0;
    pose[sided(arm_in_twist, side)] = 10.0;
    pose[sided(elbow, side)] = 17.0;
    pose[sided(wrist, side)] = 4.0;
    pose[sided(palm_in_twist, side)] = -20.0;
  }
  // Nobody stands quite evenly.
  return changed(pose, {{left_weight, 0.54},
                        {pelvis_list, 0.6},
                        {chest_list, -0.5},
                        {chest_yaw, 0.8},
                        {head_yaw, -1.0},
                        {head_tilt, 1.0},
                        {sided(elbow, 1), 19.0},
                        {sided(arm_forward, 1), -1.5}});
}

Step foot_at(int side, double out, double ahead, double yaw_out, double begin, double end) {
  const double s = side_sign(side);
  Step step;
  step.begin = begin;
  step.end = end;
  step.place = {s * out, ahead};
  step.yaw = s * yaw_out;
  return step;
}

ClipScore action_score(const std::string& name, int frames, std::array<std::vector<Step>, 2> steps,
                       const std::vector<KeyPose>& poses, double smoothing, std::uint64_t seed) {
  ClipScore score{.name = name, .duration = frames / score_rate, .steps = std::move(steps)};
  score.controls = [keyed = KeyedControls(poses, smoothing), life = Life(seed, score.duration)](double time) {
    return life.add_to(keyed(time), time);
  };
  return score;
}

ClipScore gait_score(const std::string& name, int frames, const GaitCourse& course,
                     const std::function<double(double)>& striding,
                     const std::function<Controls(double)>& standing, std::uint64_t seed) {
  ClipScore score{.name = name, .duration = frames / score_rate};
  const auto gait = std::make_shared<const Gait>(course, score.duration, score_margin);
  score.steps = {gait->steps(0), gait->steps(1)};
  score.controls = [gait, striding, standing, life = Life(seed, score.duration)](double time) {
    return life.add_to(lerp(standing(time), gait->controls(time), striding(time)), time,
                       lerp(1.0, 0.6, striding(time)));
  };
  score.height_smoothing = 0.04;
  return score;
}

}  // namespace reprise::motion
