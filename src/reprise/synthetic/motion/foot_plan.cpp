// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/foot_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reprise::motion {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double rest_pressure = 0.035;    // metres before the ankle, where a standing foot presses
constexpr double pressure_travel = 0.075;  // from there to the ball, and back to the heel

Quaterniond turn_y(double angle) {
  return Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
}
Quaterniond toes_up(double angle) {
  return Quaterniond(Eigen::AngleAxisd(-angle, Vector3d::UnitX()));
}

}  // namespace

Quaterniond FootState::foot_rotation() const {
  return turn_y(yaw) * toes_up(pitch);
}

Quaterniond FootState::toe_rotation() const {
  return turn_y(yaw) * toes_up(toe_pitch);
}

FootPlan::FootPlan(FootShape shape, int side, std::vector<Step> steps)
    : shape_(std::move(shape)), side_(side), steps_(std::move(steps)) {}

FootState FootPlan::standing(const Step& step, double time) const {
  FootState state;
  state.reach = step.reach;
  const double pivot = step.pivot.empty() ? 0.0 : step.pivot(time) * degree;
  const double rolled =
      std::isfinite(step.begin) ? std::max((time - step.begin) / step.roll_duration, 0.0) : 1.0;
  const double risen = std::isfinite(step.end) ? 1.0 + (time - step.end) / step.rise_duration : 0.0;
  double pitch = 0.0;
  if (rolled < 1.0) {
    // Comes down fast, and to rest without a jerk.
    const double left = 1.0 - rolled;
    pitch += step.strike_pitch * left * left * left * (1.0 + 1.5 * rolled);
  }
  if (risen > 0.0) pitch += step.lift_pitch * risen * risen * risen * (1.8 - 0.8 * risen);
  if (!step.heel_lift.empty()) pitch -= step.heel_lift(time);
  state.pitch = pitch * degree;
  state.yaw = step.yaw * degree + pivot;

  // A foot turns about its ball, and no heel stays where it is meanwhile.
  const auto turned = [&](double at) { return step.pivot.empty() ? 0.0 : step.pivot(at); };
  constexpr double tick = 1e-3;
  const bool turning = std::abs(turned(time + tick) - turned(time - tick)) > 1e-4;
  const bool on_heel = pitch > 0.0;
  constexpr double flat = 0.02;  // degrees: what lies flat within micrometres
  state.toe_pitch = on_heel ? state.pitch : 0.0;
  state.heel_down = pitch > -flat && !turning;
  state.ball_down = pitch < flat;

  const Vector3d under_ankle(shape_.ankle.x(), 0.0, shape_.ankle.z());
  const Vector3d place(step.place.x(), 0.0, step.place.y());
  const Vector3d ball = place + turn_y(step.yaw * degree) * (shape_.ball - under_ankle);
  if (on_heel) {
    const Vector3d heel = ball + turn_y(state.yaw) * (shape_.heel - shape_.ball);
    state.ankle = heel + state.foot_rotation() * (shape_.ankle - shape_.heel);
  } else {
    state.ankle = ball + state.foot_rotation() * (shape_.ankle - shape_.ball);
  }
  return state;
}

const Step* FootPlan::standing_step(double time) const {
  for (const Step& step : steps_)
    if (time >= step.begin && time <= step.end) return &step;
  return nullptr;
}

FootState FootPlan::at(double time) const {
  if (const Step* step = standing_step(time)) return standing(*step, time);
  std::size_t next = 0;
  while (next < steps_.size() && steps_[next].begin <= time) ++next;
  // Before the first and after the last step the foot waits where it will be and was put.
  if (next == 0) return standing(steps_.front(), steps_.front().begin);
  if (next == steps_.size()) return standing(steps_.back(), steps_.back().end);

  // Swing: leaves and arrives with position, velocity and acceleration of the standing foot.
  const Step& from = steps_[next - 1];
  const Step& to = steps_[next];
  const double duration = to.begin - from.end;
  const double u = (time - from.end) / duration;
  constexpr double tick = 1e-3;
  const FootState a0 = standing(from, from.end), a1 = standing(from, from.end - tick),
                  a2 = standing(from, from.end - 2 * tick);
  const FootState b0 = standing(to, to.begin), b1 = standing(to, to.begin + tick),
                  b2 = standing(to, to.begin + 2 * tick);
  const double per_swing = duration / tick;
  const auto across = [&](auto value) {
    const auto p0 = value(a0), p1 = value(a1), p2 = value(a2);
    const auto q0 = value(b0), q1 = value(b1), q2 = value(b2);
    using Value = std::decay_t<decltype(value(a0))>;
    const Value v0 = per_swing * (1.5 * p0 - 2.0 * p1 + 0.5 * p2);
    const Value w0 = 0.5 * per_swing * per_swing * (p0 - 2.0 * p1 + p2);
    const Value v1 = per_swing * (-1.5 * q0 + 2.0 * q1 - 0.5 * q2);
    const Value w1 = 0.5 * per_swing * per_swing * (q0 - 2.0 * q1 + q2);
    return quintic<Value>(p0, v0, w0, q0, v1, w1, u);
  };
  FootState state;
  state.swing = smooth_step(u / 0.15) * smooth_step((1.0 - u) / 0.07);
  state.reach = lerp(from.reach, to.reach, smooth_step(u));
  state.ankle = across([](const FootState& s) -> Vector3d { return s.ankle; });
  state.yaw = across([](const FootState& s) { return s.yaw; });
  state.pitch = across([](const FootState& s) { return s.pitch; });
  // A swinging foot is at its fastest late: the knee unfolds like a whip.
  const double late = bump(std::pow(u, 2.6));
  state.ankle -= 0.09 * late * (b0.ankle - a0.ankle);
  state.ankle.y() += to.late_lift * late;
  // The lift leans towards the begin: a foot is pulled up and then lowered with care.
  const double early = bump(std::pow(u, 0.8));
  state.ankle.y() += to.clearance * early;
  const double out = side_sign(side_) * to.outward * bump(u);
  state.ankle += turn_y(state.yaw) * Vector3d(out, 0.0, 0.0);
  state.pitch -= to.swing_drop * degree * early;
  // The toes straighten after they let go of the ground, and lie flat again when a ball lands first; between,
  // they drag along rather than dip into the floor.
  const double toes = state.pitch + (1.0 - smooth_step(u / 0.5)) * (a0.toe_pitch - a0.pitch) +
                      smooth_step((u - 0.6) / 0.4) * (b0.toe_pitch - b0.pitch);
  const Vector3d ball = state.ankle + state.foot_rotation() * (shape_.ball - shape_.ankle);
  const double height = std::max(ball.y() - shape_.ball.y(), 0.0);
  const double steepest = -0.9 * std::atan2(height, (shape_.toe_tip - shape_.ball).norm());
  const double soft = 0.1 * bump(0.5 * std::min(1.0, 5.0 * std::min(u, 1.0 - u)));
  state.toe_pitch = 0.5 * (toes + steepest + std::hypot(toes - steepest, soft));
  return state;
}

Vector2d FootPlan::pressure(const Step& step, double time) const {
  const double scale = (shape_.ball - shape_.ankle).norm() / 0.134;
  double along = rest_pressure;
  if (std::isfinite(step.begin)) {
    const double sign = step.strike_pitch < 0.0 ? -1.0 : 1.0;
    along -= sign * pressure_travel * (1.0 - smooth_step((time - step.begin) / (2.5 * step.roll_duration)));
  }
  if (std::isfinite(step.end)) {
    const double sign = step.lift_pitch > 0.0 ? -1.0 : 1.0;
    along += sign * pressure_travel * smooth_step(1.0 + (time - step.end) / (1.2 * step.rise_duration));
  }
  const double yaw = step.yaw * degree;
  if (!step.pivot.empty()) {
    const Vector3d ball = turn_y(yaw) * (shape_.ball - shape_.ankle);
    return step.place + Vector2d(ball.x(), ball.z());
  }
  return step.place + scale * along * Vector2d(std::sin(yaw), std::cos(yaw));
}

}  // namespace reprise::motion
