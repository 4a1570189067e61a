// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stagger, hit, tense: footsteps and key poses. Times in seconds.

#include <cmath>
#include <numbers>

#include "reprise/synthetic/motion/clip_scores.h"

namespace reprise::motion {

namespace {

constexpr double forever = Step::forever;
constexpr double stance_width = 0.088;  // of one foot from the middle, as in `stand`
constexpr double stance_yaw = 8.0;

constexpr Channel right(Channel left) {
  return sided(left, 1);
}

// A step backwards: the ball lands first and the heel comes down.
Step backwards(Step step) {
  step.strike_pitch = -20.0;
  step.roll_duration = 0.12;
  step.lift_pitch = -22.0;
  step.rise_duration = 0.18;
  step.clearance = 0.06;
  return step;
}

}  // namespace

// Pushed at the left shoulder from the front: falls back over three catching steps and straightens up again.
ClipScore stagger_score() {
  std::array<std::vector<Step>, 2> steps = {
      {{foot_at(0, stance_width, 0.0, stance_yaw, -forever, 0.80), foot_at(0, 0.13, -0.58, 14.0, 1.04, 1.58),
        foot_at(0, stance_width, -0.83, stance_yaw, 1.88, forever)},
       {foot_at(1, stance_width, 0.0, stance_yaw, -forever, 0.40), foot_at(1, 0.15, -0.40, 22.0, 0.66, 1.14),
        foot_at(1, stance_width, -0.83, stance_yaw, 1.38, forever)}}};
  for (std::vector<Step>& foot : steps)
    for (Step& step : foot) step = backwards(step);
  steps[0].back().strike_pitch = 0.0;
  steps[0].back().clearance = 0.04;

  const Controls stand = standing_pose();
  const Controls pushed = changed(stand, {{chest_yaw, 24.0},
                                          {chest_tilt, -13.0},
                                          {chest_list, -5.0},
                                          {pelvis_yaw, 9.0},
                                          {pelvis_tilt, -6.0},
                                          {head_yaw, 6.0},
                                          {head_tilt, 9.0},
                                          {knee, 22.0},
                                          {right(knee), 18.0},
                                          {collar_up, 5.0},
                                          {right(collar_up), 4.0},
                                          {arm_forward, 22.0},
                                          {right(arm_forward), 8.0},
                                          {arm_out, 26.0},
                                          {right(arm_out), 20.0},
                                          {elbow, 42.0},
                                          {right(elbow), 34.0},
                                          {left_weight, 0.7}});
  const Controls flung = changed(pushed, {{chest_yaw, 14.0},
                                          {chest_tilt, -3.0},
                                          {chest_list, -7.0},
                                          {pelvis_yaw, -8.0},
                                          {pelvis_tilt, 3.0},
                                          {head_yaw, 2.0},
                                          {head_tilt, -9.0},
                                          {knee, 30.0},
                                          {right(knee), 30.0},
                                          {arm_forward, 4.0},
                                          {right(arm_forward), 46.0},
                                          {arm_out, 66.0},
                                          {right(arm_out), 40.0},
                                          {elbow, 38.0},
                                          {right(elbow), 44.0},
                                          {left_weight, 0.4}});
  const Controls flail = changed(flung, {{chest_yaw, -8.0},
                                         {chest_tilt, 14.0},
                                         {chest_list, 6.0},
                                         {pelvis_yaw, 8.0},
                                         {pelvis_tilt, 8.0},
                                         {head_yaw, 0.0},
                                         {head_tilt, 6.0},
                                         {knee, 34.0},
                                         {right(knee), 34.0},
                                         {arm_forward, 36.0},
                                         {right(arm_forward), 12.0},
                                         {arm_out, 46.0},
                                         {right(arm_out), 70.0},
                                         {elbow, 46.0},
                                         {right(elbow), 26.0}});
  const Controls caught = changed(flail, {{chest_yaw, -6.0},
                                          {chest_tilt, 26.0},
                                          {chest_list, -3.0},
                                          {pelvis_yaw, -8.0},
                                          {pelvis_tilt, 15.0},
                                          {head_tilt, 13.0},
                                          {knee, 46.0},
                                          {right(knee), 46.0},
                                          {arm_forward, 44.0},
                                          {right(arm_forward), 30.0},
                                          {arm_out, 42.0},
                                          {right(arm_out), 46.0},
                                          {elbow, 52.0},
                                          {right(elbow), 44.0},
                                          {left_weight, 0.42},
                                          {shift_z, -0.02}});
  const Controls rising = changed(stand, {{chest_tilt, 12.0},
                                          {pelvis_tilt, 6.0},
                                          {head_tilt, 8.0},
                                          {knee, 24.0},
                                          {right(knee), 22.0},
                                          {arm_forward, 14.0},
                                          {right(arm_forward), 8.0},
                                          {arm_out, 24.0},
                                          {right(arm_out), 22.0},
                                          {elbow, 38.0},
                                          {right(elbow), 36.0},
                                          {left_weight, 0.3}});
  return action_score("stagger", 54, steps,
                      {{0.14, stand},
                       {0.38, pushed},
                       {0.66, flung},
                       {1.04, flail},
                       {1.42, caught},
                       {1.78, rising},
                       {2.04, stand}},
                      0.04, 4);
}

// A straight punch with the right fist: wind-up over the right leg, a step forward with the left, hips, chest
// and arm turning one after the other; the blow lands at 1.8 s (frame 45).
ClipScore hit_score() {
  constexpr double ahead = 0.44;
  Step left_lands = foot_at(0, 0.10, ahead, 6.0, 1.38, forever);
  left_lands.strike_pitch = 10.0;
  left_lands.clearance = 0.07;
  Step left_stands = foot_at(0, stance_width, 0.0, stance_yaw, -forever, 1.02);
  left_stands.lift_pitch = -26.0;
  // The rear foot turns on its ball with the hips.
  Step right_stands = foot_at(1, stance_width, 0.0, stance_yaw, -forever, 2.06);
  right_stands.pivot = Curve({{1.36, 0.0}, {1.74, 30.0}}, 0.05);
  right_stands.heel_lift = Curve({{1.30, 0.0}, {1.72, 26.0}, {1.95, 28.0}}, 0.05);
  right_stands.lift_pitch = -24.0;
  right_stands.rise_duration = 0.2;
  Step right_lands = foot_at(1, stance_width, ahead, stance_yaw, 2.40, forever);
  right_lands.strike_pitch = 4.0;
  right_lands.clearance = 0.03;

  const Controls stand = standing_pose();
  const Controls wind_up = changed(stand, {{pelvis_yaw, -26.0},
                                           {pelvis_tilt, 5.0},
                                           {chest_yaw, -50.0},
                                           {chest_tilt, 5.0},
                                           {chest_list, 5.0},
                                           {head_yaw, -4.0},
                                           {head_tilt, 4.0},
                                           {left_weight, 0.12},
                                           {knee, 30.0},
                                           {right(knee), 32.0},
                                           {arm_forward, 56.0},
                                           {arm_out, 24.0},
                                           {arm_in_twist, 24.0},
                                           {elbow, 82.0},
                                           {right(arm_forward), -34.0},
                                           {right(arm_out), 30.0},
                                           {right(arm_in_twist), 4.0},
                                           {right(elbow), 118.0},
                                           {right(collar_up), 5.0},
                                           {right(collar_forward), -10.0}});
  const Controls stepping = changed(wind_up, {{pelvis_yaw, -20.0},
                                              {chest_yaw, -54.0},
                                              {chest_tilt, 8.0},
                                              {head_yaw, 0.0},
                                              {knee, 32.0},
                                              {right(knee), 30.0},
                                              {right(arm_forward), -40.0},
                                              {right(elbow), 124.0},
                                              {left_weight, 0.5}});
  const Controls driving = changed(stepping, {{pelvis_yaw, 22.0},
                                              {chest_yaw, 2.0},
                                              {chest_list, 0.0},
                                              {chest_tilt, 12.0},
                                              {head_tilt, 6.0},
                                              {left_weight, 0.75},
                                              {knee, 40.0},
                                              {arm_forward, 30.0},
                                              {elbow, 100.0},
                                              {right(arm_forward), 30.0},
                                              {right(arm_out), 30.0},
                                              {right(arm_in_twist), 20.0},
                                              {right(elbow), 100.0},
                                              {right(collar_forward), 4.0}});
  const Controls contact = changed(driving, {{pelvis_yaw, 34.0},
                                             {chest_yaw, 46.0},
                                             {chest_list, -4.0},
                                             {chest_tilt, 15.0},
                                             {left_weight, 0.86},
                                             {knee, 44.0},
                                             {right(knee), 30.0},
                                             {arm_forward, -14.0},
                                             {arm_out, 24.0},
                                             {elbow, 104.0},
                                             {right(arm_forward), 86.0},
                                             {right(arm_out), 42.0},
                                             {right(arm_in_twist), 50.0},
                                             {right(elbow), 10.0},
                                             {right(palm_in_twist), 30.0},
                                             {right(collar_forward), 18.0},
                                             {right(collar_up), 2.0}});
  const Controls through = changed(contact, {{pelvis_yaw, 38.0},
                                             {chest_yaw, 56.0},
                                             {chest_tilt, 17.0},
                                             {right(arm_forward), 80.0},
                                             {right(arm_out), 36.0},
                                             {right(elbow), 22.0}});
  const Controls recoil = changed(stand, {{pelvis_yaw, 14.0},
                                          {chest_yaw, 24.0},
                                          {chest_tilt, 8.0},
                                          {head_tilt, 4.0},
                                          {left_weight, 0.75},
                                          {knee, 24.0},
                                          {right(knee), 22.0},
                                          {arm_forward, 4.0},
                                          {arm_out, 17.0},
                                          {elbow, 64.0},
                                          {right(arm_forward), 36.0},
                                          {right(arm_out), 24.0},
                                          {right(arm_in_twist), 26.0},
                                          {right(elbow), 78.0},
                                          {right(palm_in_twist), 10.0}});
  return action_score("hit", 66, {{{left_stands, left_lands}, {right_stands, right_lands}}},
                      {{0.16, stand},
                       {0.92, wind_up},
                       {1.36, stepping},
                       {1.62, driving},
                       {1.79, contact},
                       {1.90, through},
                       {2.20, recoil},
                       {2.60, stand}},
                      0.03, 5);
}

// Ready to fight: crouched, fists up, bouncing from foot to foot.
ClipScore tense_score() {
  constexpr int frames = 42;
  constexpr double duration = frames / score_rate;
  const Step left_foot = foot_at(0, 0.10, 0.20, 2.0, -forever, forever);
  Step right_foot = foot_at(1, 0.13, -0.21, 42.0, -forever, forever);
  right_foot.heel_lift = Curve({{0.0, 14.0}}, 0.01);

  const Controls guard = changed(standing_pose(), {{pelvis_yaw, -28.0},
                                                   {pelvis_tilt, 8.0},
                                                   {pelvis_list, 0.0},
                                                   {chest_yaw, -32.0},
                                                   {chest_tilt, 15.0},
                                                   {chest_list, 0.0},
                                                   {head_yaw, -3.0},
                                                   {head_tilt, 7.0},
                                                   {left_weight, 0.52},
                                                   {knee, 44.0},
                                                   {right(knee), 46.0},
                                                   {collar_up, 7.0},
                                                   {right(collar_up), 7.0},
                                                   {collar_forward, 9.0},
                                                   {right(collar_forward), 6.0},
                                                   {arm_forward, 50.0},
                                                   {arm_out, 14.0},
                                                   {arm_in_twist, 12.0},
                                                   {elbow, 108.0},
                                                   {right(arm_forward), 30.0},
                                                   {right(arm_out), 16.0},
                                                   {right(arm_in_twist), 26.0},
                                                   {right(elbow), 128.0}});
  ClipScore score = action_score("tense", frames, {{{left_foot}, {right_foot}}}, {{0.0, guard}}, 0.05, 6);
  score.controls = [guarded = score.controls](double time) {
    Controls c = guarded(time);
    // Two bounces, one shift of weight from the front foot to the rear one and back.
    const double shift = 2.0 * std::numbers::pi * time / duration;
    const double bounce = std::sin(2.0 * shift);
    const double late = std::sin(2.0 * shift - 0.7);
    c[left_weight] += 0.20 * std::sin(shift + 0.4);
    for (int side = 0; side < 2; ++side) {
      c[sided(knee, side)] += 6.0 * bounce;
      c[sided(elbow, side)] += 5.0 * late + 3.0 * std::sin(shift + 2.0 * side);
      c[sided(arm_forward, side)] += 3.0 * late + 3.0 * std::sin(shift + 0.8 + 1.5 * side);
      c[sided(collar_up, side)] += 1.5 * late;
    }
    c[chest_tilt] += 1.6 * late;
    c[chest_yaw] += 4.0 * std::sin(shift - 0.5);
    c[pelvis_yaw] += 2.5 * std::sin(shift);
    c[chest_list] += 1.5 * std::sin(shift - 0.3);
    c[head_tilt] += 0.8 * late;
    return c;
  };
  return score;
}

}  // namespace reprise::motion
