// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/clip_scores.h"

namespace reprise::motion {

namespace {

// Times in seconds.
constexpr double always = 1.0;

std::function<double(double)> from_to(double begin, double end) {
  return [begin, end](double time) { return ramp(begin, end, time); };
}
std::function<double(double)> constant(double value) {
  return [value](double) { return value; };
}

// Both feet stand; the left one lifts next.
constexpr double resting_phase = -0.46;

std::vector<ClipScore> gaits() {
  const auto standing = [](double) { return standing_pose(); };
  std::vector<ClipScore> scores;

  GaitCourse walk;  // two cycles
  scores.push_back(gait_score("walk", 52, walk, constant(always), standing, 2));

  GaitCourse jog{.jog = constant(1.0)};  // two cycles
  scores.push_back(gait_score("jog", 36, jog, constant(always), standing, 3));

  const GaitCourse start{
      .pace = from_to(0.2, 0.95), .cadence = from_to(0.1, 0.4), .first_phase = resting_phase};
  scores.push_back(gait_score("stand_walk", 38, start, from_to(0.12, 0.9), standing, 7));

  // The left foot strikes at 0.16 s, the right one for good at 0.68 s, and the left one beside it at 1.2 s.
  const GaitCourse stop{.pace = [](double t) { return ramp(1.15, 0.5, t); },
                        .cadence = [](double t) { return ramp(1.35, 1.15, t); },
                        .first_phase = -0.15};
  scores.push_back(gait_score(
      "walk_stand", 42, stop, [](double t) { return ramp(1.3, 0.6, t); }, standing, 8));

  const GaitCourse faster{.jog = from_to(0.25, 1.0), .first_phase = 0.25};
  scores.push_back(gait_score("walk_jog", 36, faster, constant(always), standing, 9));
  const GaitCourse slower{.jog = [](double t) { return ramp(0.78, 0.12, t); }, .first_phase = 0.1};
  scores.push_back(gait_score("jog_walk", 36, slower, constant(always), standing, 10));
  return scores;
}

ClipScore stand() {
  const GaitCourse::Stance stance;
  std::array<std::vector<Step>, 2> steps;
  for (int side = 0; side < 2; ++side) {
    const auto s = static_cast<std::size_t>(side);
    steps[s] = {foot_at(side, stance.place[s].x(), stance.place[s].y(), stance.yaw[s], -Step::forever,
                        Step::forever)};
  }
  return action_score("stand", 40, steps, {{0.0, standing_pose()}}, 0.05, 1);
}

}  // namespace

std::vector<ClipScore> character_scores() {
  std::vector<ClipScore> scores = gaits();
  scores.insert(scores.begin(), stand());
  scores.insert(scores.begin() + 3, {stagger_score(), hit_score(), tense_score()});
  return scores;
}

}  // namespace reprise::motion
