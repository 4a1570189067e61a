// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reprise::figure {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;

constexpr double walk_speed = 1.35;  // m/s
constexpr double walk_cycle = 0.96;  // seconds for two steps
constexpr double walk_duty = 0.58;   // share of the cycle a foot is on the ground
constexpr double jog_speed = 2.6;
constexpr double jog_cycle = 0.72;
constexpr double jog_duty = 0.36;        // below one half: flight
constexpr double resting_phase = -0.46;  // both feet on the ground
constexpr double idle_period = 2.0;      // seconds

constexpr double margin = 2.2;        // seconds of motion known before and after a clip
constexpr double table_rate = 500.0;  // samples per second: a multiple of the usual frame rates

double lerp(double a, double b, double u) {
  return a + u * (b - a);
}

Quaterniond turn(double angle, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}
Quaterniond turn_x(double angle) {
  return turn(angle, Vector3d::UnitX());
}
Quaterniond turn_y(double angle) {
  return turn(angle, Vector3d::UnitY());
}
Quaterniond turn_z(double angle) {
  return turn(angle, Vector3d::UnitZ());
}

// Cubic with given values and slopes at u = 0 and 1.
template <typename Value>
Value hermite(const Value& from, const Value& slope_from, const Value& to, const Value& slope_to, double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * from + (u3 - 2 * u2 + u) * slope_from + (3 * u2 - 2 * u3) * to +
         (u3 - u2) * slope_to;
}

// Rotation that takes the resting bone direction to `to`, keeping the hinge (perpendicular to `to`) where X
// was.
Quaterniond bone_rotation(const Vector3d& rest_direction, const Vector3d& to, const Vector3d& hinge) {
  const auto frame = [](const Vector3d& direction, const Vector3d& axis) {
    Eigen::Matrix3d M;
    const Vector3d h = (axis - axis.dot(direction) * direction).normalized();
    M << h, direction, h.cross(direction);
    return M;
  };
  return Quaterniond(frame(to, hinge) * frame(rest_direction, Vector3d::UnitX()).transpose()).normalized();
}

}  // namespace

std::vector<ClipPlan> clip_plans() {
  const auto constant = [](double value) { return [value](double) { return value; }; };
  const auto ramp = [](double low, double high) {
    return [low, high](double t) { return smooth_ramp(low, high, t); };
  };
  const auto gait = [](const ClipPlan::Curve& jog) {
    return ClipPlan{.speed = [jog](double t) { return lerp(walk_speed, jog_speed, jog(t)); },
                    .phase_rate = [jog](double t) { return lerp(1.0 / walk_cycle, 1.0 / jog_cycle, jog(t)); },
                    .jog = jog};
  };
  std::vector<ClipPlan> plans;

  plans.push_back({.name = "stand", .duration = idle_period, .first_phase = resting_phase});

  ClipPlan walk = gait(ClipPlan::nothing);
  walk.name = "walk";
  walk.duration = 3.0 * walk_cycle;
  plans.push_back(walk);

  walk.name = "walk_curve";
  walk.turn_rate = [](double t) { return 0.6 * smooth_ramp(0.2, 0.8, t) * smooth_ramp(2.7, 2.1, t); };
  plans.push_back(walk);

  ClipPlan jog = gait(constant(1.0));
  jog.name = "jog";
  jog.duration = 3.0 * jog_cycle;
  plans.push_back(jog);

  ClipPlan faster = gait(ramp(0.5, 1.6));
  faster.name = "walk_jog";
  faster.duration = 2.4;
  plans.push_back(faster);

  ClipPlan slower = gait(ramp(1.6, 0.5));
  slower.name = "jog_walk";
  slower.duration = 2.4;
  plans.push_back(slower);

  // The left foot leaves the ground at about 0.58 s and strikes at 0.99 s.
  plans.push_back({.name = "start",
                   .duration = 2.4,
                   .first_phase = resting_phase,
                   .speed = [](double t) { return walk_speed * smooth_ramp(0.5, 1.4, t); },
                   .phase_rate = [](double t) { return smooth_ramp(0.45, 0.65, t) / walk_cycle; }});

  // The left foot strikes at 0.24 s and for good at 1.2 s, the right one at 0.72 s and for good at 1.68 s.
  plans.push_back({.name = "stop",
                   .duration = 2.4,
                   .first_phase = -0.25,
                   .speed = [](double t) { return walk_speed * smooth_ramp(1.78, 0.98, t); },
                   .phase_rate = [](double t) { return smooth_ramp(1.74, 1.68, t) / walk_cycle; }});

  plans.push_back({.name = "wave", .duration = 3.0, .first_phase = resting_phase, .wave = [](double t) {
                     return smooth_ramp(0.3, 0.9, t) * smooth_ramp(2.75, 2.1, t);
                   }});
  return plans;
}

Motion::Motion(ClipPlan plan) : plan_(std::move(plan)) {
  // Tables of the path and of the phase, by the trapezium rule outwards from time 0.
  const int before = static_cast<int>(std::lround(margin * table_rate));
  const int after = static_cast<int>(std::ceil((plan_.duration + margin) * table_rate));
  first_time_ = -before / table_rate;
  const std::size_t count = static_cast<std::size_t>(before + after + 1);
  phase_.assign(count, plan_.first_phase);
  heading_.assign(count, 0.0);
  x_.assign(count, 0.0);
  z_.assign(count, 0.0);
  const auto advance = [&](int i, int step) {
    const double from = i / table_rate;
    const double to = (i + step) / table_rate;
    const double half = 0.5 * (to - from);
    const std::size_t a = static_cast<std::size_t>(i + before);
    const std::size_t b = static_cast<std::size_t>(i + step + before);
    phase_[b] = phase_[a] + half * (plan_.phase_rate(from) + plan_.phase_rate(to));
    heading_[b] = heading_[a] + half * (plan_.turn_rate(from) + plan_.turn_rate(to));
    x_[b] =
        x_[a] + half * (plan_.speed(from) * std::sin(heading_[a]) + plan_.speed(to) * std::sin(heading_[b]));
    z_[b] =
        z_[a] + half * (plan_.speed(from) * std::cos(heading_[a]) + plan_.speed(to) * std::cos(heading_[b]));
  };
  for (int i = 0; i < after; ++i) advance(i, 1);
  for (int i = 0; i > -before; --i) advance(i, -1);
  for (int side = 0; side < 2; ++side) steps_[side] = steps_of(side);
}

double Motion::table(const std::vector<double>& values, double time) const {
  const double at =
      std::clamp((time - first_time_) * table_rate, 0.0, static_cast<double>(values.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(at), values.size() - 2);
  return lerp(values[i], values[i + 1], at - static_cast<double>(i));
}

double Motion::phase(double time) const {
  return table(phase_, time);
}

GroundTransform Motion::path(double time) const {
  return {.yaw = table(heading_, time), .translation = {table(x_, time), table(z_, time)}};
}

Vector3d Motion::path_velocity(double time) const {
  const double heading = table(heading_, time);
  return plan_.speed(time) * Vector3d(std::sin(heading), 0.0, std::cos(heading));
}

// 0 standing, 1 at walking speed or above.
double Motion::stride_weight(double time) const {
  return std::min(plan_.speed(time) / walk_speed, 1.0);
}

double Motion::time_of_phase(double phase) const {
  if (phase <= phase_.front()) return -std::numeric_limits<double>::infinity();
  const auto above = std::lower_bound(phase_.begin(), phase_.end(), phase);
  if (above == phase_.end()) return std::numeric_limits<double>::infinity();
  const double share = (phase - *(above - 1)) / (*above - *(above - 1));
  return first_time_ + (static_cast<double>(above - phase_.begin()) - 1.0 + share) / table_rate;
}

std::vector<Motion::Step> Motion::steps_of(int side) const {
  std::vector<Step> steps;
  const double offset = side == 0 ? 0.0 : 0.5;
  const int first = static_cast<int>(std::floor(phase_.front())) - 2;
  const int last = static_cast<int>(std::ceil(phase_.back())) + 1;
  for (int n = first; n <= last; ++n) {
    Step step;
    step.begin = time_of_phase(n + offset);
    const double begin_known = std::isfinite(step.begin) ? step.begin : first_time_;
    // The stance must be short enough for the speed at its begin and later on.
    const double jog = std::max(plan_.jog(begin_known), plan_.jog(begin_known + 0.15));
    step.end = time_of_phase(n + offset + lerp(walk_duty, jog_duty, jog));
    if (step.end == -std::numeric_limits<double>::infinity()) continue;
    if (step.begin == std::numeric_limits<double>::infinity()) break;

    // A striding foot stands where the body is nearly half-way through the stance; a resting one beside the
    // body.
    const bool strides = std::isfinite(step.begin) && std::isfinite(step.end);
    const double time = strides ? lerp(step.begin, step.end, lerp(0.43, 0.42, jog))
                                : (std::isfinite(step.end) ? first_time_ : first_time_ + 1e6);
    const GroundTransform under = path(time);
    const double half_width = strides ? lerp(0.078, 0.06, jog) : 0.098;
    step.yaw = under.yaw + side_sign(side) * 7.0 * degree;
    step.place = under * Vector3d(side_sign(side) * half_width, 0.0, 0.0);
    if (std::isfinite(step.begin)) {
      step.strike_pitch = stride_weight(step.begin) * lerp(20.0, 8.0, jog) * degree;
      step.roll_duration = lerp(0.12, 0.05, jog);
    }
    if (std::isfinite(step.end)) {
      step.lift_pitch = lerp(20.0, 50.0, stride_weight(step.end)) * degree;
      step.rise_duration = lerp(0.26, 0.12, jog);
    }
    steps.push_back(step);
  }
  return steps;
}

Motion::FootState Motion::standing(const Step& step, int side, double time) const {
  FootState state{.ankle = {}, .yaw = step.yaw};
  const double rolled = step.roll_duration > 0.0 ? (time - step.begin) / step.roll_duration : 1.0;
  const double risen = step.rise_duration > 0.0 ? 1.0 + (time - step.end) / step.rise_duration : 0.0;
  if (rolled < 1.0) state.pitch = step.strike_pitch * (1.0 - std::sin(0.5 * pi * std::max(rolled, 0.0)));
  if (risen > 0.0) state.pitch = -step.lift_pitch * risen * risen * (2.0 - risen);
  if (risen > 0.0) state.toe_bend = state.pitch;

  const Vector3d ankle = rest_position(sided(foot, side));
  const Vector3d pivot = state.pitch > 0.0 ? rest_heel(side) : rest_position(sided(toe, side));
  const Vector3d rolled_ankle = pivot + turn_x(-state.pitch) * (ankle - pivot);
  state.ankle = step.place + turn_y(step.yaw) * (rolled_ankle - Vector3d(ankle.x(), 0.0, ankle.z()));
  return state;
}

Motion::FootState Motion::foot_state(int side, double time) const {
  const std::vector<Step>& steps = steps_[side];
  std::size_t i = 0;
  while (i + 1 < steps.size() && steps[i + 1].begin <= time) ++i;
  if (time <= steps[i].end || i + 1 == steps.size()) return standing(steps[i], side, time);

  // Swing: leave and arrive with the velocities of the rolling foot, lifted in between.
  const Step& from = steps[i];
  const Step& to = steps[i + 1];
  const double duration = to.begin - from.end;
  const double u = (time - from.end) / duration;
  constexpr double tick = 1e-4;
  const FootState a = standing(from, side, from.end);
  const FootState a_before = standing(from, side, from.end - tick);
  const FootState b = standing(to, side, to.begin);
  const FootState b_after = standing(to, side, to.begin + tick);
  const double per_swing = duration / tick;
  const double jog = plan_.jog(time);
  const double pace = std::max(stride_weight(from.end), stride_weight(to.begin));

  FootState state;
  state.ankle = hermite<Vector3d>(a.ankle, per_swing * (a.ankle - a_before.ankle), b.ankle,
                                  per_swing * (b_after.ankle - b.ankle), u);
  const double bump = 16.0 * u * u * (1.0 - u) * (1.0 - u);
  const double early = 1.0 + 0.8 * (0.5 - u);
  state.ankle.y() += early * bump * lerp(lerp(0.03, 0.035, pace), 0.20, jog);
  state.pitch = hermite(a.pitch, per_swing * (a.pitch - a_before.pitch), b.pitch,
                        per_swing * (b_after.pitch - b.pitch), u) -
                early * bump * lerp(4.0, 22.0, jog) * degree;
  // The toes let go at once; their own momentum would bend them too far.
  state.toe_bend = hermite(a.toe_bend, 0.0, 0.0, 0.0, std::min(1.3 * u, 1.0));
  state.yaw = from.yaw + smooth_ramp(0.0, 1.0, u) * (to.yaw - from.yaw);
  return state;
}

bool Motion::flat_footed(int side, double time) const {
  for (const Step& step : steps_[side]) {
    if (time >= step.begin + step.roll_duration && time <= step.end - step.rise_duration) return true;
  }
  return false;
}

void Motion::pose_trunk(Pose& pose, double time) const {
  const double stride = stride_weight(time);
  const double jog = plan_.jog(time);
  const double cycle = 2.0 * pi * phase(time);
  const double idle = (1.0 - stride) * std::sin(2.0 * pi * time / idle_period);
  const double breath = (1.0 - stride) * std::sin(2.0 * pi * time / idle_period + 1.0);
  const double wave = plan_.wave(time);
  const GroundTransform ground = path(time);

  // The pelvis is lowest just after a strike when walking and in the middle of the stance when jogging.
  const double walk_height = -0.034 + 0.014 * std::cos(2.0 * (cycle - 2.0 * pi * 0.30));
  const double jog_height = -0.074 + 0.032 * std::cos(2.0 * (cycle - 2.0 * pi * (0.5 * jog_duty + 0.25)));
  const double height = lerp(lerp(-0.006, walk_height, stride), jog_height, jog);
  const double sway = stride * lerp(0.022, 0.012, jog) * std::cos(cycle - 2.0 * pi * 0.27) + 0.012 * idle;
  const double list =
      stride * lerp(4.0, 3.0, jog) * degree * std::cos(cycle - 2.0 * pi * 0.22) + 0.8 * degree * idle;
  const double hip_yaw = -stride * lerp(6.0, 7.0, jog) * degree * std::cos(cycle);
  const double chest_yaw = stride * lerp(6.0, 9.0, jog) * degree * std::cos(cycle) - 4.0 * degree * wave;
  const double lean = lerp(stride * 2.5, 9.0, jog) * degree;
  const double chest_roll = -2.5 * degree * wave;

  pose.rotation[pelvis] = turn_y(ground.yaw) * turn_y(hip_yaw) * turn_x(0.4 * lean) * turn_z(list);
  pose.position[pelvis] = ground * Vector3d(rest_position(pelvis) + Vector3d(sway, height, 0.0));
  const auto attach = [&](Joint joint, Joint parent, const Quaterniond& rotation) {
    pose.rotation[joint] = pose.rotation[parent] * rotation;
    pose.position[joint] =
        pose.position[parent] + pose.rotation[parent] * (rest_position(joint) - rest_position(parent));
  };
  const double untwist = 0.5 * (chest_yaw - hip_yaw);
  attach(spine, pelvis, turn_y(untwist) * turn_x(0.3 * lean + 0.6 * degree * breath) * turn_z(-0.6 * list));
  attach(chest, spine,
         turn_y(untwist) * turn_x(0.3 * lean - 1.6 * degree * breath) * turn_z(-0.5 * list + chest_roll));
  attach(
      neck, chest,
      turn_y(-0.45 * chest_yaw) * turn_x(-0.35 * lean + 0.5 * degree * breath) * turn_z(-0.4 * chest_roll));
  attach(head, neck,
         turn_y(-0.45 * chest_yaw + 3.0 * degree * idle - 6.0 * degree * wave) *
             turn_x(-0.35 * lean + 0.5 * degree * breath) * turn_z(0.1 * list + 4.0 * degree * wave));
}

void Motion::pose_arm(Pose& pose, int side, double time) const {
  const double s = side_sign(side);
  const double stride = stride_weight(time);
  const double jog = plan_.jog(time);
  const double breath = (1.0 - stride) * std::sin(2.0 * pi * time / idle_period + 1.0);
  // The arm swings against the leg of its side, the forearm a little later.
  const double cycle = 2.0 * pi * (phase(time) - (side == 0 ? 0.0 : 0.5));
  const double swing = -std::cos(cycle);
  const double late = -std::cos(cycle - 0.5);
  double forward = (lerp(stride * 23.0, 34.0, jog) * swing + lerp(stride * 1.0, -12.0, jog)) * degree;
  double outward = (lerp(11.0, 15.0, jog) + 0.8 * breath) * degree;
  double twist = lerp(-8.0, -22.0, jog) * degree;
  double elbow = (lerp(14.0, 22.0, stride) + stride * 9.0 * late) * degree;
  elbow = lerp(elbow, (88.0 + 12.0 * late) * degree, jog);
  double wrist = 4.0 * degree;
  if (side == 1) {
    const double wave = plan_.wave(time);
    const double beat = std::sin(2.0 * pi * 1.6 * time);
    forward = lerp(forward, 22.0 * degree, wave);
    outward = lerp(outward, 74.0 * degree, wave);
    twist = lerp(twist, (78.0 + 4.0 * beat) * degree, wave);
    elbow = lerp(elbow, (92.0 + 20.0 * beat) * degree, wave);
    wrist = lerp(wrist, 10.0 * std::sin(2.0 * pi * 1.6 * time - 0.8) * degree, wave);
  }

  const int shoulder = sided(upper_arm, side);
  const int elbow_joint = sided(forearm, side);
  const int wrist_joint = sided(hand, side);
  const Vector3d along = rest_arm_direction(side);
  const Vector3d hinge = along.cross(Vector3d::UnitZ());
  const auto attach = [&](int joint, int parent, const Quaterniond& rotation) {
    pose.rotation[joint] = pose.rotation[parent] * rotation;
    pose.position[joint] =
        pose.position[parent] + pose.rotation[parent] * (rest_position(joint) - rest_position(parent));
  };
  attach(shoulder, chest, turn_x(-forward) * turn_z(s * (outward - 45.0 * degree)) * turn(-s * twist, along));
  attach(elbow_joint, shoulder, turn(elbow, hinge));
  attach(wrist_joint, elbow_joint, turn(wrist, hinge));
}

// Two-bone inverse kinematics: hip and ankle are given, the knee bends forwards.
void Motion::pose_leg(Pose& pose, int side, double time) const {
  const int hip_joint = sided(thigh, side);
  const int knee_joint = sided(shin, side);
  const int ankle_joint = sided(foot, side);
  const int ball_joint = sided(toe, side);
  const FootState state = foot_state(side, time);
  const double heading = path(time).yaw;

  const Vector3d rest_thigh = rest_position(knee_joint) - rest_position(hip_joint);
  const Vector3d rest_shin = rest_position(ankle_joint) - rest_position(knee_joint);
  const Vector3d hip =
      pose.position[pelvis] + pose.rotation[pelvis] * (rest_position(hip_joint) - rest_position(pelvis));
  const double a = rest_thigh.norm();
  const double b = rest_shin.norm();
  const Vector3d reach = state.ankle - hip;
  const double distance = std::clamp(reach.norm(), std::abs(a - b) + 1e-3, 0.9995 * (a + b));
  const Vector3d toward = reach.normalized();
  const Vector3d lateral = turn_y(0.5 * (heading + state.yaw)) * Vector3d::UnitX();
  const Vector3d hinge = (lateral - lateral.dot(toward) * toward).normalized();
  const Vector3d forward = toward.cross(hinge);
  const double cosine = std::clamp((a * a + distance * distance - b * b) / (2.0 * a * distance), -1.0, 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const Vector3d thigh_direction = cosine * toward + sine * forward;
  const Vector3d knee = hip + a * thigh_direction;
  const Vector3d shin_direction = (hip + distance * toward - knee).normalized();

  pose.position[hip_joint] = hip;
  pose.rotation[hip_joint] = bone_rotation(rest_thigh.normalized(), thigh_direction, hinge);
  pose.position[knee_joint] = knee;
  pose.rotation[knee_joint] = bone_rotation(rest_shin.normalized(), shin_direction, hinge);
  pose.position[ankle_joint] = knee + b * shin_direction;
  pose.rotation[ankle_joint] = turn_y(state.yaw) * turn_x(-state.pitch);
  pose.position[ball_joint] =
      pose.position[ankle_joint] +
      pose.rotation[ankle_joint] * (rest_position(ball_joint) - rest_position(ankle_joint));
  pose.rotation[ball_joint] = pose.rotation[ankle_joint] * turn_x(state.toe_bend);
}

Pose Motion::pose(double time) const {
  Pose pose;
  pose_trunk(pose, time);
  for (int side = 0; side < 2; ++side) {
    pose_arm(pose, side, time);
    pose_leg(pose, side, time);
  }
  return pose;
}

}  // namespace reprise::figure
