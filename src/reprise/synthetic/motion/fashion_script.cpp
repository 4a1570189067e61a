// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/fashion_script.h"

namespace reprise::motion {

namespace {

constexpr Channel right(Channel left) {
  return sided(left, 1);
}

// Arms hang clear of a skirt.
Controls easy() {
  Controls pose = standing_pose();
  for (int side = 0; side < 2; ++side) {
    pose[sided(arm_out, side)] = 15.0;
    pose[sided(arm_in_twist, side)] = 8.0;
    pose[sided(elbow, side)] = 20.0;
    pose[sided(arm_forward, side)] = -5.0;
    pose[sided(knee, side)] = 8.0;
    // Held places fade in from the waist.
    pose[sided(pin_out, side)] = 0.195;
    pose[sided(pin_up, side)] = 0.125;
    pose[sided(pin_forward, side)] = -0.03;
    pose[sided(pin_elbow_back, side)] = 30.0;
  }
  return changed(pose, {{chest_tilt, -1.5}, {head_tilt, -1.0}});
}

Controls with_hand_on_hip(const Controls& pose, int side) {
  return changed(pose, {{sided(pin, side), 1.0},
                        {sided(collar_up, side), 2.0},
                        {sided(wrist, side), -38.0},
                        {sided(palm_in_twist, side), -8.0},
                        {sided(arm_out, side), 42.0},
                        {sided(arm_in_twist, side), 40.0},
                        {sided(arm_forward, side), -14.0},
                        {sided(elbow, side), 85.0}});
}

// Weight on the left foot, its hip out to the side, shoulders against it.
Controls on_left(const Controls& pose, double amount) {
  return changed(pose, {{left_weight, 0.5 + 0.38 * amount},
                        {pelvis_list, 6.5 * amount},
                        {chest_list, -5.0 * amount},
                        {pelvis_yaw, 9.0 * amount},
                        {chest_yaw, -4.0 * amount},
                        {shift_x, 0.022 * amount},
                        {knee, 6.0},
                        {right(knee), 6.0 + 14.0 * amount},
                        {right(knee_out), 4.0}});
}

Controls on_right(const Controls& pose, double amount) {
  return mirrored(on_left(mirrored(pose), amount));
}

FashionScript calm() {
  FashionScript s;
  s.walk = {.speed = 1.15,
            .cycle = 1.08,
            .duty = 0.61,
            .half_width = 0.018,
            .toe_out = 3.0,
            .strike_pitch = 13.0,
            .lift_pitch = -54.0,
            .clearance = 0.035,
            .outward = 0.035,
            .hip_yaw = 8.0,
            .hip_list = 6.5,
            .tilt = 1.0,
            .lean = -1.0,
            .chest_yaw = 4.5,
            .chest_list = 2.5,
            .sway = 0.014,
            .arm_swing = 13.0,
            .arm_mean = -6.0,
            .arm_out = 15.0,
            .arm_in_twist = 6.0,
            .elbow = 17.0,
            .elbow_swing = 5.0};
  s.free_side = 1;
  s.stance = {.place = {Eigen::Vector2d(0.055, 0.0), Eigen::Vector2d(0.045, 0.17)}, .yaw = {20.0, 14.0}};
  s.free_heel_a = 16.0;
  s.other_heel_b = 14.0;
  s.pose_a = changed(with_hand_on_hip(on_left(easy(), 1.0), 1),
                     {{head_yaw, -16.0}, {head_list, 3.0}, {head_tilt, -2.0}, {arm_forward, -8.0}});
  s.pose_a_end = changed(s.pose_a, {{head_yaw, -6.0},
                                    {head_list, 4.5},
                                    {chest_yaw, -8.0},
                                    {pelvis_list, 7.5},
                                    {arm_forward, -3.0},
                                    {elbow, 26.0}});
  s.pose_b = changed(on_right(easy(), 0.8), {{head_yaw, 22.0},
                                             {head_list, -3.0},
                                             {head_tilt, -4.0},
                                             {chest_yaw, 9.0},
                                             {arm_forward, 12.0},
                                             {arm_out, 20.0},
                                             {elbow, 42.0},
                                             {arm_in_twist, 14.0},
                                             {right(arm_forward), -12.0},
                                             {right(arm_out), 17.0}});
  s.pose_b_end = changed(s.pose_b, {{head_yaw, 14.0}, {head_tilt, -1.0}, {chest_yaw, 5.0}, {elbow, 36.0}});
  s.ready = changed(easy(), {{left_weight, 0.45}, {arm_out, 18.0}, {right(arm_out), 18.0}});
  s.wound_up = changed(s.ready, {{pelvis_yaw, -14.0},
                                 {chest_yaw, -34.0},
                                 {head_yaw, 8.0},
                                 {left_weight, 0.2},
                                 {knee, 24.0},
                                 {right(knee), 22.0},
                                 {arm_forward, 42.0},
                                 {arm_out, 26.0},
                                 {elbow, 42.0},
                                 {right(arm_forward), -12.0},
                                 {right(arm_out), 56.0},
                                 {right(elbow), 24.0}});
  s.spinning = changed(s.ready, {{left_weight, 0.5},
                                 {knee, 10.0},
                                 {right(knee), 10.0},
                                 {chest_tilt, -3.0},
                                 {arm_forward, 14.0},
                                 {arm_out, 62.0},
                                 {elbow, 22.0},
                                 {arm_in_twist, 0.0},
                                 {right(arm_forward), 8.0},
                                 {right(arm_out), 58.0},
                                 {right(arm_in_twist), 0.0},
                                 {right(elbow), 26.0}});
  s.turns = 1;
  s.half_turn = 0.5;
  s.twirl_start = 2.15;
  s.seed = 20;
  return s;
}

FashionScript lively() {
  FashionScript s = calm();
  s.walk.speed = 1.42;
  s.walk.cycle = 1.04;
  s.walk.half_width = 0.012;
  s.walk.strike_pitch = 17.0;
  s.walk.lift_pitch = -58.0;
  s.walk.hip_yaw = 10.0;
  s.walk.hip_list = 7.5;
  s.walk.chest_yaw = 6.5;
  s.walk.sway = 0.017;
  s.walk.arm_swing = 18.0;
  s.walk.arm_mean = -7.0;
  s.walk.elbow = 22.0;
  s.walk.arm_out = 16.0;
  s.free_side = 0;
  s.stance = {.place = {Eigen::Vector2d(0.15, 0.09), Eigen::Vector2d(0.06, 0.0)}, .yaw = {28.0, 12.0}};
  s.free_heel_a = 0.0;
  s.other_heel_b = 16.0;
  s.pose_a = changed(with_hand_on_hip(on_right(easy(), 1.1), 0), {{head_yaw, 24.0},
                                                                  {head_list, -4.0},
                                                                  {head_tilt, -5.0},
                                                                  {chest_yaw, 10.0},
                                                                  {right(arm_forward), -14.0},
                                                                  {right(elbow), 24.0}});
  s.pose_a_end =
      changed(s.pose_a, {{head_yaw, 8.0}, {head_tilt, -2.0}, {chest_yaw, 4.0}, {right(arm_forward), -6.0}});
  s.pose_b = changed(
      with_hand_on_hip(with_hand_on_hip(on_left(easy(), 0.9), 0), 1),
      {{head_yaw, -26.0}, {head_list, 4.0}, {head_tilt, -7.0}, {chest_yaw, -12.0}, {chest_tilt, -4.0}});
  s.pose_b_end = changed(s.pose_b, {{head_yaw, -16.0}, {head_tilt, -3.0}, {chest_yaw, -7.0}});
  s.spinning =
      changed(s.spinning, {{arm_out, 74.0}, {right(arm_out), 68.0}, {arm_forward, 8.0}, {chest_tilt, -4.0}});
  s.turns = 2;
  s.half_turn = 0.42;
  s.twirl_start = 2.0;
  s.seed = 40;
  return s;
}

}  // namespace

FashionScript fashion_script(FashionStyle style) {
  return style == FashionStyle::calm ? calm() : lively();
}

}  // namespace reprise::motion
