// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/gait.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace reprise::motion {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// Curves over a cycle that begins with the heel strike of the leg in question, every 5 %. The angles are
// what the textbooks agree on for adults; written from their tables and figures, rounded.

// Flexion of the knee in walking (Winter 2009, appendix A; Perry and Burnfield 2010): yields to 18 degrees
// when the weight comes on, straightens, gives way before toe-off, swings through with 62 degrees.
constexpr std::array<double, 20> walking_knee = {4,  12, 17.5, 18, 15.5, 12, 9,  6.5, 5,  6.5,
                                                 12, 22, 38,   54, 62,   60, 50, 33,  14, 3};
// In slow running (Novacheck 1998): strikes bent, yields to 42 degrees, leaves bent, folds to 90 degrees.
constexpr std::array<double, 20> running_knee = {18, 29, 38, 42, 40, 34, 27, 21, 22, 33,
                                                 52, 72, 86, 91, 88, 76, 58, 37, 21, 14};

// Trunk, as parts of their amplitude; the second half of the cycle mirrors the first. Obliquity of the
// pelvis, up on the side that carries: peaks when the other foot leaves the ground (Kadaba et al. 1990).
constexpr std::array<double, 20> pelvis_obliquity = {.1,  .62,  .97,  1,  .85,  .66,  .52,  .42,  .30,  .12,
                                                     -.1, -.62, -.97, -1, -.85, -.66, -.52, -.42, -.30, -.12};
// Rotation: forward with the striking leg (ibid.).
constexpr std::array<double, 20> pelvis_rotation = {1,  .99,  .92,  .78,  .58,  .33,  .05,  -.24, -.52, -.77,
                                                    -1, -.99, -.92, -.78, -.58, -.33, -.05, .24,  .52,  .77};
// Shoulder flexion over the cycle of the leg on the same side: hindmost just after its strike, foremost with
// the other's (Murray et al. 1967).
constexpr std::array<double, 20> shoulder = {-.98, -1, -.94, -.82, -.64, -.42, -.17, .1,   .38, .66,
                                             .87,  1,  .98,  .88,  .72,  .5,   .24,  -.06, -.4, -.76};

struct Tables {
  PhaseCurve walking_knee{motion::walking_knee, 6};
  PhaseCurve running_knee{motion::running_knee, 6};
  PhaseCurve obliquity{pelvis_obliquity, 5};
  PhaseCurve rotation{pelvis_rotation, 3};
  PhaseCurve shoulder{motion::shoulder, 4};
};
const Tables& tables() {
  static const Tables tables;
  return tables;
}

// Joints of a straight leg do not lie on one line at rest; textbook angles count from a straight leg.
constexpr double straight_knee = 5.0;

}  // namespace

GaitStyle walk_style() {
  return {};
}

GaitStyle jog_style() {
  return {.speed = 2.6,
          .cycle = 0.72,
          .duty = 0.37,
          .half_width = 0.035,
          .toe_out = 5.0,
          .strike_pitch = 8.0,
          .roll = 0.06,
          .lift_pitch = -46.0,
          .rise = 0.19,
          .clearance = 0.11,
          .reach = 0.976,
          .late_lift = 0.05,
          .outward = 0.0,
          .swing_drop = 18.0,
          .hip_yaw = 6.0,
          .hip_list = 3.5,
          .tilt = 8.0,
          .lean = 8.0,
          .chest_yaw = 11.0,
          .chest_list = 1.0,
          .sway = 0.0,
          .hips_ahead = 0.06,
          .arm_swing = 27.0,
          .arm_mean = -14.0,
          .arm_out = 15.0,
          .arm_in_twist = 24.0,
          .elbow = 94.0,
          .elbow_swing = 11.0,
          .running = 1.0};
}

Controls gait_controls(const GaitStyle& style, double phase) {
  const Tables& t = tables();
  const double cycle = two_pi * phase;
  Controls c;
  c[left_weight] = 0.5;
  c[pelvis_yaw] = -style.hip_yaw * t.rotation(phase);
  c[pelvis_list] = style.hip_list * t.obliquity(phase);
  // Twice a cycle the trunk nods: forwards as a foot strikes.
  c[pelvis_tilt] = style.tilt + 0.9 * std::cos(2.0 * (cycle - two_pi * 0.03));
  c[chest_tilt] = style.lean + 0.9 * std::cos(2.0 * (cycle - two_pi * 0.06));
  c[chest_yaw] = style.chest_yaw * t.rotation(phase - 0.03);
  c[chest_list] = -style.chest_list * t.obliquity(phase - 0.02);
  // The head keeps level and looks where it goes (Pozzo et al. 1990): against the rise and fall of the body.
  c[head_yaw] = 0.08 * c[chest_yaw];
  c[head_list] = 0.15 * c[chest_list];
  c[head_tilt] = 1.0 - 0.8 * std::cos(2.0 * (cycle - two_pi * 0.06));
  c[shift_x] = style.sway * t.obliquity(phase - 0.04);
  // Leaning forwards takes the hips back.
  c[shift_z] = style.hips_ahead - 0.003 * style.lean;
  for (int side = 0; side < 2; ++side) {
    const double own = phase - (side == 0 ? 0.0 : 0.5);
    c[sided(knee, side)] = straight_knee + lerp(t.walking_knee(own), t.running_knee(own), style.running);
    const double swing = t.shoulder(own);
    const double late = t.shoulder(own - 0.05);
    // The right arm swings a little less than the left.
    const double amount = side == 0 ? 1.03 : 0.95;
    c[sided(arm_forward, side)] = style.arm_mean + amount * style.arm_swing * swing;
    c[sided(arm_out, side)] = style.arm_out + 1.5 * std::abs(std::sin(cycle)) * std::abs(std::sin(cycle));
    c[sided(arm_in_twist, side)] = style.arm_in_twist + 0.25 * style.arm_swing * late;
    c[sided(elbow, side)] = style.elbow + amount * style.elbow_swing * late;
    c[sided(collar_forward, side)] = 0.12 * style.arm_swing * swing;
    c[sided(palm_in_twist, side)] = -20.0;
    c[sided(wrist, side)] = 4.0 + 3.0 * t.shoulder(own - 0.1);
  }
  return c;
}

Gait::Gait(GaitCourse course, double duration, double margin)
    : course_(std::move(course)), first_time_(-margin), last_time_(duration + margin) {
  // By the trapezium rule outwards from time 0, on a grid that time 0 lies on.
  constexpr double rate = 2.0 * SampledCurve::rate;
  const int before = static_cast<int>(std::lround(margin * rate));
  const int after = static_cast<int>(std::ceil(last_time_ * rate));
  first_time_ = -before / rate;
  const auto count = static_cast<std::size_t>(before + after + 1);
  phase_.assign(count, course_.first_phase);
  distance_.assign(count, 0.0);
  const auto phase_rate = [&](double t) {
    return course_.cadence(t) * lerp(1.0 / course_.walk.cycle, 1.0 / course_.jogging.cycle, course_.jog(t));
  };
  const auto speed = [&](double t) {
    return course_.pace(t) * lerp(course_.walk.speed, course_.jogging.speed, course_.jog(t));
  };
  const auto advance = [&](int i, int step) {
    const double from = i / rate, to = (i + step) / rate;
    const auto a = static_cast<std::size_t>(i + before), b = static_cast<std::size_t>(i + step + before);
    phase_[b] = phase_[a] + 0.5 * (to - from) * (phase_rate(from) + phase_rate(to));
    distance_[b] = distance_[a] + 0.5 * (to - from) * (speed(from) + speed(to));
  };
  for (int i = 0; i < after; ++i) advance(i, 1);
  for (int i = 0; i > -before; --i) advance(i, -1);
}

namespace {

double read(const std::vector<double>& table, double first_time, double time) {
  const double where =
      std::clamp((time - first_time) * 2.0 * SampledCurve::rate, 0.0, static_cast<double>(table.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(where), table.size() - 2);
  return lerp(table[i], table[i + 1], where - static_cast<double>(i));
}

}  // namespace

double Gait::phase(double time) const {
  return read(phase_, first_time_, time);
}

double Gait::distance(double time) const {
  return read(distance_, first_time_, time);
}

// The first time at which the phase is reached; -+infinity if that is not within the known time.
double Gait::time_of_phase(double phase) const {
  if (phase <= phase_.front()) return -std::numeric_limits<double>::infinity();
  const auto above = std::lower_bound(phase_.begin(), phase_.end(), phase);
  if (above == phase_.end()) return std::numeric_limits<double>::infinity();
  const double share = (phase - *(above - 1)) / (*above - *(above - 1));
  return first_time_ +
         (static_cast<double>(above - phase_.begin()) - 1.0 + share) / (2.0 * SampledCurve::rate);
}

// A stance must be short enough for the speed at which it ends, or the body runs away from its foot and sinks
// to keep it within reach. The faster the style, the sooner the stance ends: the style that is the one at its
// own end lies where the two meet.
double Gait::style_of_stance(double begin, const std::function<double(double)>& end_of) const {
  const auto style_at_end = [&](double style) {
    return course_.jog(std::clamp(end_of(style), first_time_, last_time_));
  };
  double slow = course_.jog(begin);
  if (style_at_end(slow) <= slow) return slow;
  double fast = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (slow + fast);
    (style_at_end(middle) > middle ? slow : fast) = middle;
  }
  return fast;
}

std::vector<Step> Gait::steps(int side) const {
  std::vector<Step> steps;
  const double offset = side == 0 ? 0.0 : 0.5;
  const GaitStyle& walk = course_.walk;
  const GaitStyle& run = course_.jogging;
  const int first = static_cast<int>(std::floor(phase_.front())) - 2;
  const int last = static_cast<int>(std::ceil(phase_.back())) + 1;
  for (int n = first; n <= last; ++n) {
    Step step;
    step.begin = time_of_phase(n + offset);
    if (step.begin == Step::forever) break;
    const auto end_of = [&](double style) {
      return time_of_phase(n + offset + lerp(walk.duty, run.duty, style));
    };
    const double jog = style_of_stance(std::isfinite(step.begin) ? step.begin : first_time_, end_of);
    step.end = end_of(jog);
    if (step.end == -Step::forever) continue;

    const bool strides = std::isfinite(step.begin) && std::isfinite(step.end);
    const auto s = static_cast<std::size_t>(side);
    double half_width = lerp(walk.half_width, run.half_width, jog);
    double along = 0.0;
    double yaw = lerp(walk.toe_out, run.toe_out, jog);
    if (strides) {
      // The body passes over the foot a little before the middle of the stance.
      along = distance(lerp(step.begin, step.end, 0.45));
    } else {
      const bool starts = std::isfinite(step.end);
      const GaitCourse::Stance& stance = starts ? course_.before : course_.after;
      along = distance(starts ? first_time_ : last_time_) + stance.place[s].y();
      half_width = stance.place[s].x();
      yaw = stance.yaw[s];
    }
    step.place = {side_sign(side) * half_width, along};
    step.yaw = side_sign(side) * yaw;
    // Short and slow steps roll less.
    const double pace_in = std::isfinite(step.begin) ? std::min(1.0, course_.pace(step.begin)) : 0.0;
    const double pace_out = std::isfinite(step.end) ? std::min(1.0, course_.pace(step.end)) : 0.0;
    step.strike_pitch = lerp(walk.strike_pitch, run.strike_pitch, jog) * lerp(0.25, 1.0, pace_in);
    step.roll_duration = lerp(walk.roll, run.roll, jog);
    step.lift_pitch = lerp(walk.lift_pitch, run.lift_pitch, jog) * lerp(0.5, 1.0, pace_out);
    step.rise_duration = lerp(walk.rise, run.rise, jog);
    if (strides)
      step.rise_duration = std::min(step.rise_duration, step.end - step.begin - step.roll_duration);
    step.clearance = lerp(walk.clearance, run.clearance, jog) + 0.03 * (1.0 - std::min(pace_in, 1.0));
    step.reach = lerp(walk.reach, run.reach, jog);
    step.late_lift = lerp(walk.late_lift, run.late_lift, jog);
    step.outward = lerp(walk.outward, run.outward, jog);
    step.swing_drop = lerp(walk.swing_drop, run.swing_drop, jog);
    steps.push_back(step);
  }
  return steps;
}

Controls Gait::controls(double time) const {
  const double at_phase = phase(time);
  return lerp(gait_controls(course_.walk, at_phase), gait_controls(course_.jogging, at_phase),
              course_.jog(time));
}

}  // namespace reprise::motion
