// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <numbers>

#include "reprise/synthetic/motion/fashion_script.h"

namespace reprise::motion {

namespace {

// Of a foot with the given yaw, degrees; metres of the design figure.
Eigen::Vector2d from_ankle_to_ball(double yaw) {
  const double angle = yaw * std::numbers::pi / 180.0;
  return 0.125 * Eigen::Vector2d(std::sin(angle), std::cos(angle));
}

}  // namespace

Twirl twirl(const FashionScript& script, double earlier, double origin) {
  constexpr double forever = Step::forever;
  constexpr double half_width = 0.10;  // of the stance before and after
  constexpr double spacing = 0.20;     // the turn travels to the left by this much every half turn
  constexpr double raised = 14.0;      // degrees of the heel of a turning foot
  const double start = script.twirl_start - earlier;
  const double h = script.half_turn;
  const int half_turns = 2 * script.turns;
  const double left_yaw = script.stance.yaw[0];
  const double right_yaw = script.stance.yaw[1];
  const double full = 360.0 * script.turns;
  // Swing j = 1, 2, ... begins and ends.
  const auto lift = [&](int j) { return start + 0.30 + (j - 1) * h; };
  const auto land = [&](int j) { return lift(j) + 0.8 * h; };

  Twirl result;
  Step left_before = foot_at(0, half_width + origin, 0.0, left_yaw, -forever, start);
  left_before.lift_pitch = -24.0;
  Step right_before = foot_at(1, half_width - origin, 0.0, right_yaw, -forever, lift(1));
  right_before.lift_pitch = -40.0;
  result.steps = {{{left_before}, {right_before}}};

  // Standing foot j (0: the left one, opened to the left) turns while swing j + 1 goes on.
  for (int j = 0; j <= half_turns; ++j) {
    const int side = j % 2;
    const double turned = 180.0 * j;
    Step step;
    step.begin = j == 0 ? start + 0.22 : land(j);
    step.place = {origin + half_width + spacing * j, j == 0 ? 0.02 : 0.0};
    step.clearance = j == 0 ? 0.03 : 0.05;
    // Round the standing foot, not through it.
    step.outward = j == 0 ? 0.0 : 0.17;
    step.strike_pitch = j == half_turns ? 4.0 : -raised;
    step.roll_duration = 0.10;
    step.rise_duration = 0.15;
    step.lift_pitch = -26.0;
    if (j == half_turns) {
      step.yaw = full + left_yaw;
    } else {
      const bool last = j == half_turns - 1;
      const double yaw_end = last ? full - right_yaw : turned + 165.0;
      step.yaw = j == 0 ? 55.0 : turned + (side == 0 ? 20.0 : 12.0);
      // The ball stays while the ankle goes round it: the last foot ends at the place it was meant for, the
      // others pass it in the middle of their turn.
      const double at_place = last ? yaw_end : 0.5 * (step.yaw + yaw_end);
      step.place += from_ankle_to_ball(at_place) - from_ankle_to_ball(step.yaw);
      step.end = last ? forever : lift(j + 2);
      step.pivot = Curve({{lift(j + 1) - 0.08, 0.0}, {land(j + 1) + 0.02, yaw_end - step.yaw}}, 0.04);
      std::vector<Key> heel = {{step.begin, 0.0}, {step.begin + 0.10, raised}};
      if (last) {
        heel.push_back({land(j + 1) + 0.06, raised});
        heel.push_back({land(j + 1) + 0.34, 0.0});
      }
      step.heel_lift = Curve(heel, 0.03);
    }
    result.steps[static_cast<std::size_t>(side)].push_back(step);
  }

  // The chest leads, the head stays with the audience as long as it can and then overtakes the body.
  Controls open = changed(lerp(script.wound_up, script.spinning, 0.5),
                          {{heading, 18.0}, {chest_yaw, 16.0}, {head_yaw, -22.0}, {left_weight, 0.8}});
  result.poses = {{start - 0.75, script.ready},
                  {start - 0.05, changed(script.wound_up, {{heading, -14.0}})},
                  {start + 0.28, open}};
  for (int j = 1; j <= half_turns; ++j) {
    const double turned = 180.0 * j;
    const bool facing = j % 2 == 0;
    if (!facing) {
      result.poses.push_back(
          {lerp(lift(j), land(j), 0.45),
           changed(script.spinning, {{heading, turned - 95.0}, {chest_yaw, 14.0}, {head_yaw, -62.0}})});
    }
    const bool last = j == half_turns;
    result.poses.push_back({land(j) - (last ? 0.02 : 0.0),
                            changed(last ? lerp(script.spinning, script.ready, 0.25) : script.spinning,
                                    {{heading, turned - (last ? 6.0 : 12.0)},
                                     {chest_yaw, facing ? 6.0 : 10.0},
                                     {head_yaw, facing ? 5.0 : 52.0}})});
  }
  const double done = land(half_turns);
  const double follow = full + 5.0;
  result.poses.push_back({done + 0.26, changed(lerp(script.spinning, script.ready, 0.6),
                                               {{heading, follow}, {chest_yaw, 10.0}, {head_yaw, -4.0}})});
  result.poses.push_back({done + 0.85, changed(script.ready, {{heading, full}})});
  return result;
}

}  // namespace reprise::motion
