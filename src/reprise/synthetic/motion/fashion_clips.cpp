// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Clips of the fashion sets. Times in seconds.

#include "reprise/synthetic/motion/fashion_script.h"

namespace reprise::motion {

namespace {

constexpr double forever = Step::forever;

Step stance_foot(const FashionScript& script, int side, double begin, double end) {
  const auto s = static_cast<std::size_t>(side);
  return foot_at(side, script.stance.place[s].x(), script.stance.place[s].y(), script.stance.yaw[s], begin,
                 end);
}

// Holds the first pose, moves over to the second one and back.
ClipScore pose(const FashionScript& script, int frames) {
  const double end = frames / score_rate;
  std::array<std::vector<Step>, 2> steps;
  for (int side = 0; side < 2; ++side) {
    Step step = stance_foot(script, side, -forever, forever);
    const bool free = side == script.free_side;
    const double in_a = free ? script.free_heel_a : 0.0;
    const double in_b = free ? 0.0 : script.other_heel_b;
    step.heel_lift =
        Curve({{0.30 * end, in_a}, {0.45 * end, in_b}, {0.76 * end, in_b}, {0.92 * end, in_a}}, 0.05);
    steps[static_cast<std::size_t>(side)] = {step};
  }
  return action_score("pose", frames, steps,
                      {{-0.05 * end, script.pose_a},
                       {0.22 * end, script.pose_a_end},
                       {0.50 * end, script.pose_b},
                       {0.72 * end, script.pose_b_end},
                       {0.97 * end, script.pose_a}},
                      0.10, script.seed);
}

ClipScore walk(const FashionScript& script, int frames) {
  return gait_score(
      "walk", frames, {.walk = script.walk}, [](double) { return 1.0; }, [](double) { return Controls(); },
      script.seed + 1);
}

// The free foot takes the first step.
ClipScore pose_walk(const FashionScript& script, int frames) {
  const double hold = 0.55;
  const double resting = script.free_side == 0 ? -0.46 : 0.04;
  const GaitCourse course{
      .pace = [hold](double t) { return ramp(hold + 0.15, hold + 0.9, t); },
      .cadence = [hold](double t) { return ramp(hold + 0.05, hold + 0.4, t); },
      .first_phase = resting,
      .walk = script.walk,
      .before = script.stance,
  };
  ClipScore score = gait_score(
      "pose_walk", frames, course, [hold](double t) { return ramp(hold, hold + 0.85, t); },
      [keyed = KeyedControls({{0.05, script.pose_a}, {hold, script.pose_a_end}}, 0.1)](double t) {
        return keyed(t);
      },
      script.seed + 2);
  score.steps[static_cast<std::size_t>(script.free_side)].front().heel_lift =
      Curve({{0.0, script.free_heel_a}}, 0.01);
  return score;
}

// The other foot stops behind, the free one before it, and the weight settles back into the pose.
ClipScore walk_pose(const FashionScript& script, int frames) {
  const double last_phase = script.free_side == 0 ? 1.0 : 0.5;  // of the free foot's last strike
  const double strikes = 1.26;                                  // about when
  const GaitCourse course{
      .pace = [strikes](double t) { return ramp(strikes + 0.02, strikes - 0.75, t); },
      .cadence = [strikes](double t) { return ramp(strikes + 0.22, strikes - 0.10, t); },
      .first_phase = last_phase - (strikes - 0.01) / script.walk.cycle,
      .walk = script.walk,
      .after = script.stance,
  };
  const double settled = strikes + 0.62;
  ClipScore score = gait_score(
      "walk_pose", frames, course, [strikes](double t) { return ramp(strikes + 0.40, strikes - 0.35, t); },
      [keyed = KeyedControls({{strikes - 0.1, lerp(script.ready, script.pose_a, 0.25)},
                              {settled, script.pose_a},
                              {settled + 1.0, lerp(script.pose_a, script.pose_a_end, 0.4)}},
                             0.09)](double t) { return keyed(t); },
      script.seed + 3);
  score.steps[static_cast<std::size_t>(script.free_side)].back().heel_lift =
      Curve({{strikes + 0.22, 0.0}, {settled, script.free_heel_a}}, 0.05);
  return score;
}

// At ease, a look to the side, wind-up, twirl, and at ease again.
ClipScore twirl_clip(const FashionScript& script, int frames) {
  const Twirl turn = twirl(script, 0.0, 0.0);
  const double start = script.twirl_start;
  std::vector<KeyPose> poses = {{0.1, script.ready},
                                {0.38 * start, changed(script.ready, {{left_weight, 0.62},
                                                                      {pelvis_list, 2.0},
                                                                      {chest_yaw, 7.0},
                                                                      {head_yaw, 16.0},
                                                                      {head_tilt, -4.0},
                                                                      {arm_out, 24.0},
                                                                      {elbow, 30.0}})}};
  poses.insert(poses.end(), turn.poses.begin(), turn.poses.end());
  return action_score("twirl", frames, turn.steps, poses, 0.045, script.seed + 4);
}

// The free foot steps from the pose to the stance before the twirl; the clip ends in the middle of the turn.
ClipScore pose_twirl(const FashionScript& script, int frames) {
  const double end = frames / score_rate;
  // The turn is as far as in "twirl" when the first swing is nearly over.
  const double earlier = script.twirl_start + 0.30 + 0.75 * script.half_turn - end;
  const int other = 1 - script.free_side;
  const double s = side_sign(other);
  const double origin = s * (script.stance.place[static_cast<std::size_t>(other)].x() - 0.10);
  Twirl turn = twirl(script, earlier, origin);
  const auto f = static_cast<std::size_t>(script.free_side);
  Step from_pose = stance_foot(script, script.free_side, -forever, 0.52);
  from_pose.heel_lift = Curve({{0.0, script.free_heel_a}}, 0.01);
  from_pose.lift_pitch = -16.0;
  Step& ready = turn.steps[f].front();
  ready.begin = 0.88;
  ready.strike_pitch = -10.0;
  ready.clearance = 0.05;
  turn.steps[f].insert(turn.steps[f].begin(), from_pose);
  std::vector<KeyPose> poses = {{0.05, script.pose_a}, {0.35, lerp(script.pose_a, script.pose_a_end, 0.5)}};
  poses.insert(poses.end(), turn.poses.begin(), turn.poses.end());
  return action_score("pose_twirl", frames, turn.steps, poses, 0.045, script.seed + 5);
}

}  // namespace

std::vector<ClipScore> fashion_scores(FashionStyle style) {
  const FashionScript script = fashion_script(style);
  if (style == FashionStyle::calm) {
    return {pose(script, 100),     walk(script, 81),      twirl_clip(script, 116),
            pose_walk(script, 60), walk_pose(script, 66), pose_twirl(script, 68)};
  }
  return {pose(script, 76),      walk(script, 78),      twirl_clip(script, 118),
          pose_walk(script, 52), walk_pose(script, 56), pose_twirl(script, 55)};
}

}  // namespace reprise::motion
