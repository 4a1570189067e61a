// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/performance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reprise::motion {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double gravity = 9.81;

enum TrunkJoint { pelvis, spine, chest, neck, head };
enum SideJoint { collar, upper_arm, forearm, hand, thigh, shin, foot, toe };

Quaterniond turn(double degrees, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(degrees * degree, axis));
}

// Yaw, then tilt, then list, as a body is turned.
Quaterniond orientation(double yaw, double tilt, double list) {
  return turn(yaw, Vector3d::UnitY()) * turn(tilt, Vector3d::UnitX()) * turn(list, Vector3d::UnitZ());
}

}  // namespace

Performance::Performance(const Skeleton& skeleton, ClipScore score)
    : skeleton_(skeleton), score_(std::move(score)) {
  trunk_idx_ = {skeleton.joint_idx("pelvis"), skeleton.joint_idx("spine"), skeleton.joint_idx("chest"),
                skeleton.joint_idx("neck"), skeleton.joint_idx("head")};
  const std::array<const char*, 8> names = {"collar", "upper_arm", "forearm", "hand",
                                            "thigh",  "shin",      "foot",    "toe"};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < names.size(); ++k)
      side_idx_[side][k] = skeleton.joint_idx(std::string(side == 0 ? "left_" : "right_") + names[k]);
  }
  rest_hips_ = 0.5 * (rest(side_idx_[0][thigh]) + rest(side_idx_[1][thigh]));
  scale_ = rest_hips_.y() / design_leg;

  for (std::size_t side = 0; side < 2; ++side) {
    const auto& idx = side_idx_[side];
    for (Step& step : score_.steps[side]) {
      step.place *= scale_;
      step.clearance *= scale_;
      step.late_lift *= scale_;
      step.outward *= scale_;
    }
    feet_.emplace_back(foot_shape(skeleton, static_cast<int>(side)), static_cast<int>(side),
                       score_.steps[side]);
    legs_.emplace_back(rest(idx[thigh]), rest(idx[shin]), rest(idx[foot]), Vector3d::UnitX());
    // The resting arm is bent: its plane is known. (An arm that rests straight bends forwards.)
    const Vector3d upper = rest(idx[forearm]) - rest(idx[upper_arm]);
    const Vector3d lower = rest(idx[hand]) - rest(idx[forearm]);
    Vector3d hinge = upper.normalized().cross(lower.normalized());
    if (hinge.norm() < 0.05) hinge = upper.cross(Vector3d::UnitZ());
    arms_.emplace_back(rest(idx[upper_arm]), rest(idx[forearm]), rest(idx[hand]), hinge);
  }

  first_time_ = -score_margin;
  const auto count =
      static_cast<std::size_t>((score_.duration + 2.0 * score_margin) * SampledCurve::rate) + 1;
  std::vector<Controls> controls;
  controls.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    controls.push_back(score_.controls(first_time_ + static_cast<double>(k) / SampledCurve::rate));
  for (std::size_t side = 0; side < 2; ++side) load_[side].resize(count);
  x_.resize(count);
  z_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    // Loads: taken up and given back while the other foot stands too.
    const double time = first_time_ + static_cast<double>(k) / SampledCurve::rate;
    const std::array<double, 2> share = {controls[k][left_weight], 1.0 - controls[k][left_weight]};
    for (std::size_t side = 0; side < 2; ++side) {
      const Step* step = feet_[side].standing_step(time);
      if (step == nullptr) continue;
      constexpr double longest = 0.45;
      double load = share[side];
      const auto overlap = [&](double at) {
        // For how long the other foot stands after a landing or stood before a lift at `at`.
        const Step* other = feet_[1 - side].standing_step(at);
        if (other == nullptr) return 0.02;
        const double length = at == step->begin ? other->end - at : at - other->begin;
        return std::clamp(length, 0.02, longest);
      };
      if (std::isfinite(step->begin)) load *= smooth_step((time - step->begin) / overlap(step->begin));
      if (std::isfinite(step->end)) load *= smooth_step((step->end - time) / overlap(step->end));
      load_[side][k] = load + 1e-6;
    }
  }
  balance();
  // Hips stand before the feet's pressure by what the author says.
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d shift = turn(controls[k][heading], Vector3d::UnitY()) *
                           Vector3d(controls[k][shift_x], 0.0, controls[k][shift_z]) * scale_;
    x_[k] += shift.x();
    z_[k] += shift.z();
  }
  raise_hips(controls);

  // The clip begins over the origin.
  const auto start = static_cast<std::size_t>(score_margin * SampledCurve::rate);
  const Vector2d origin(x_[start], z_[start]);
  for (std::size_t side = 0; side < 2; ++side) {
    std::vector<Step> steps = feet_[side].steps();
    for (Step& step : steps) step.place -= origin;
    feet_[side] = FootPlan(feet_[side].shape(), static_cast<int>(side), std::move(steps));
  }
  for (double& x : x_) x -= origin.x();
  for (double& z : z_) z -= origin.y();
  hips_x_ = SampledCurve(first_time_, x_);
  hips_z_ = SampledCurve(first_time_, z_);
}

// The body as an inverted pendulum of constant height h over the centre of pressure p (Kajita 2001):
// c'' = g / h (c - p). Its one solution that does not fall is p filtered with exp(-|t| / tau) / (2 tau),
// tau = sqrt(h / g): the weight moves to a foot before the other one leaves the ground, and speeds up and
// slows down as weight must.
void Performance::balance() {
  const std::size_t count = x_.size();
  double before_x = 0.0, before_z = 0.0;
  std::vector<bool> known(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    const double time = first_time_ + static_cast<double>(k) / SampledCurve::rate;
    Vector2d sum = Vector2d::Zero();
    double weight = 0.0;
    for (std::size_t side = 0; side < 2; ++side) {
      const Step* step = feet_[side].standing_step(time);
      if (step == nullptr) continue;
      sum += load_[side][k] * feet_[side].pressure(*step, time);
      weight += load_[side][k];
    }
    known[k] = weight > 0.0;
    if (!known[k]) continue;
    x_[k] = sum.x() / weight;
    z_[k] = sum.y() / weight;
  }
  // In flight from one foot's last place to the other's first.
  for (std::size_t k = 0; k < count; ++k) {
    if (known[k]) {
      before_x = x_[k];
      before_z = z_[k];
      continue;
    }
    std::size_t after = k;
    while (after + 1 < count && !known[after]) ++after;
    const double share = 1.0 / static_cast<double>(after - k + 1);
    x_[k] = before_x = lerp(before_x, known[after] ? x_[after] : before_x, share);
    z_[k] = before_z = lerp(before_z, known[after] ? z_[after] : before_z, share);
  }
  // tau belongs to the height of the centre of mass, a little above the hips.
  const double tau = std::sqrt(1.1 * rest_hips_.y() / gravity);
  const double keep = std::exp(-1.0 / (tau * SampledCurve::rate));
  for (std::vector<double>* values : {&x_, &z_}) {
    for (std::size_t k = 1; k < count; ++k) (*values)[k] = lerp((*values)[k], (*values)[k - 1], keep);
    for (std::size_t k = count - 1; k-- > 0;) (*values)[k] = lerp((*values)[k], (*values)[k + 1], keep);
    *values = smoothed(*values, 0.03);
  }
}

// The hips are as high as the legs that carry them are long, given how far their knees are bent; in flight
// they fall freely. No standing foot may come out of reach.
void Performance::raise_hips(const std::vector<Controls>& controls) {
  const std::size_t count = x_.size();
  std::vector<double> height(count), limit(count);
  std::vector<bool> known(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    const double time = first_time_ + static_cast<double>(k) / SampledCurve::rate;
    const Quaterniond rotation = trunk(controls[k]).pelvis;
    double sum = 0.0, weight = 0.0;
    limit[k] = 10.0 * rest_hips_.y();
    for (int side = 0; side < 2; ++side) {
      const auto s = static_cast<std::size_t>(side);
      const FootState state = feet_[s].at(time);
      const Vector3d hip = rotation * (rest(side_idx_[s][thigh]) - rest_hips_);
      const double dx = x_[k] + hip.x() - state.ankle.x();
      const double dz = z_[k] + hip.z() - state.ankle.z();
      const double level = dx * dx + dz * dz;
      const auto height_at = [&](double length) {
        return state.ankle.y() + std::sqrt(std::max(length * length - level, 0.01)) - hip.y();
      };
      // A foot about to land must be within reach as well, or the knee snaps on landing.
      const double share = lerp(state.reach, 1.05, state.swing);
      limit[k] = std::min(limit[k], height_at(share * legs_[s].reach()));
      const double load = load_[s][k];
      if (load <= 0.0) continue;
      sum += load * height_at(legs_[s].distance(controls[k][sided(knee, side)] * degree));
      weight += load;
    }
    known[k] = weight > 0.0;
    if (known[k]) height[k] = sum / weight;
  }
  for (std::size_t k = 1; k < count; ++k) {
    if (known[k]) continue;
    std::size_t after = k;
    while (after + 1 < count && !known[after]) ++after;
    const double a = height[k - 1];
    const double b = known[after] ? height[after] : a;
    const double duration = static_cast<double>(after - k + 1) / SampledCurve::rate;
    for (std::size_t i = k; i < after; ++i) {
      const double t = static_cast<double>(i - k + 1) / SampledCurve::rate;
      height[i] = lerp(a, b, t / duration) + 0.5 * gravity * t * (duration - t);
      known[i] = true;
    }
  }
  height = smoothed(height, score_.height_smoothing);
  // What is too high is taken off, spread over the time around it so that no jerk is seen.
  const int spread = static_cast<int>(0.08 * SampledCurve::rate);
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> excess(count), wide(count);
    for (std::size_t k = 0; k < count; ++k) excess[k] = std::max(0.0, height[k] - limit[k]);
    for (int k = 0; k < static_cast<int>(count); ++k) {
      for (int i = std::max(0, k - spread); i <= std::min(static_cast<int>(count) - 1, k + spread); ++i)
        wide[static_cast<std::size_t>(k)] =
            std::max(wide[static_cast<std::size_t>(k)], excess[static_cast<std::size_t>(i)]);
    }
    wide = smoothed(wide, 0.04);
    for (std::size_t k = 0; k < count; ++k) height[k] -= wide[k];
  }
  hips_y_ = SampledCurve(first_time_, std::move(height));
}

Vector3d Performance::hips(double time) const {
  return {hips_x_(time), hips_y_(time), hips_z_(time)};
}

Performance::Trunk Performance::trunk(const Controls& controls) const {
  const Quaterniond ahead = turn(controls[heading], Vector3d::UnitY());
  Trunk trunk;
  trunk.pelvis = ahead * orientation(controls[pelvis_yaw], controls[pelvis_tilt], controls[pelvis_list]);
  trunk.chest = ahead * orientation(controls[chest_yaw], controls[chest_tilt], controls[chest_list]);
  trunk.head = ahead * orientation(controls[head_yaw], controls[head_tilt], controls[head_list]);
  trunk.spine = trunk.pelvis.slerp(0.5, trunk.chest);
  trunk.neck = trunk.chest.slerp(0.45, trunk.head);
  return trunk;
}

void Performance::attach(SkeletonPose& pose, int joint_idx, const Quaterniond& rotation) const {
  const auto j = static_cast<std::size_t>(joint_idx);
  const auto parent = static_cast<std::size_t>(skeleton_.joints[j].parent);
  pose.rotation[j] = rotation.normalized();
  pose.position[j] =
      pose.position[parent] + pose.rotation[parent] * (rest(joint_idx) - rest(skeleton_.joints[j].parent));
}

void Performance::pose_arm(SkeletonPose& pose, int side, const Controls& controls) const {
  const auto& idx = side_idx_[static_cast<std::size_t>(side)];
  const Limb& limb = arms_[static_cast<std::size_t>(side)];
  const double s = side_sign(side);
  const auto control = [&](Channel channel) { return controls[sided(channel, side)]; };
  const Quaterniond chest_rotation = pose.rotation[static_cast<std::size_t>(trunk_idx_[chest])];

  // A raised arm takes the shoulder along; the resting one is raised already.
  const Vector3d rest_arm = rest(idx[forearm]) - rest(idx[upper_arm]);
  const auto raised = [](double degrees) {
    const double over = (degrees - 60.0) / 12.0;
    return 0.24 * degrees + 0.12 * 12.0 * (over > 30.0 ? over : std::log1p(std::exp(over)));
  };
  const Vector3d posed_arm = turn(-control(arm_forward), Vector3d::UnitX()) *
                             turn(s * control(arm_out), Vector3d::UnitZ()) * Vector3d(0.0, -1.0, 0.0);
  const auto elevation = [](const Vector3d& arm) {
    return std::acos(std::clamp(-arm.normalized().y(), -1.0, 1.0)) / degree;
  };
  // Near hanging, elevation has a corner; its square root form has none.
  const double height = std::hypot(elevation(posed_arm), 10.0);
  const double up = raised(height) - raised(elevation(rest_arm)) + control(collar_up);
  attach(pose, idx[collar],
         chest_rotation * turn(-s * control(collar_forward), Vector3d::UnitY()) *
             turn(s * up, Vector3d::UnitZ()));
  const auto c = static_cast<std::size_t>(idx[collar]);
  const Vector3d shoulder = pose.position[c] + pose.rotation[c] * (rest(idx[upper_arm]) - rest(idx[collar]));

  const Quaterniond arm = chest_rotation * turn(-control(arm_forward), Vector3d::UnitX()) *
                          turn(s * control(arm_out), Vector3d::UnitZ());
  const Vector3d direction = arm * Vector3d(0.0, -1.0, 0.0);
  // Bent about -X, the hanging forearm comes forwards; twisted in, towards the other side.
  const Vector3d hinge = arm * turn(-s * control(arm_in_twist), Vector3d::UnitY()) * Vector3d(-1.0, 0.0, 0.0);
  Limb::Rotations rotations = limb.posed(direction, hinge, control(elbow) * degree);
  if (control(pin) > 1e-6) {
    const auto p = static_cast<std::size_t>(trunk_idx_[pelvis]);
    const Quaterniond& hips_rotation = pose.rotation[p];
    const Vector3d middle = pose.position[p] + hips_rotation * (rest_hips_ - rest(trunk_idx_[pelvis]));
    const Vector3d place = middle + hips_rotation * (scale_ * Vector3d(s * control(pin_out), control(pin_up),
                                                                       control(pin_forward)));
    const double back = control(pin_elbow_back) * degree;
    const Vector3d pole = chest_rotation * Vector3d(s * std::cos(back), 0.0, -std::sin(back));
    const Limb::Rotations held = limb.reaching(shoulder, place, pole, 0.97);
    const double share = std::clamp(control(pin), 0.0, 1.0);
    rotations.upper = rotations.upper.slerp(share, held.upper);
    rotations.lower = rotations.lower.slerp(share, held.lower);
  }
  attach(pose, idx[upper_arm], rotations.upper);
  attach(pose, idx[forearm], rotations.lower);
  const Vector3d along = rotations.lower * (rest(idx[hand]) - rest(idx[forearm])).normalized();
  const Vector3d axis =
      rotations.lower *
      (rest(idx[forearm]) - rest(idx[upper_arm])).cross(rest(idx[hand]) - rest(idx[forearm])).normalized();
  attach(pose, idx[hand],
         turn(control(wrist), axis) * turn(s * control(palm_in_twist), along) * rotations.lower);
}

void Performance::pose_leg(SkeletonPose& pose, int side, const Controls& controls, double time) const {
  const auto& idx = side_idx_[static_cast<std::size_t>(side)];
  const FootState state = feet_[static_cast<std::size_t>(side)].at(time);
  const auto p = static_cast<std::size_t>(trunk_idx_[pelvis]);
  const Quaterniond& pelvis_rotation = pose.rotation[p];
  const Vector3d hip = pose.position[p] + pelvis_rotation * (rest(idx[thigh]) - rest(trunk_idx_[pelvis]));
  // The knee looks where foot and hips look, more where the foot does.
  const double hips_yaw = (controls[heading] + controls[pelvis_yaw]) * degree;
  const double yaw =
      lerp(hips_yaw, state.yaw, 0.65) + side_sign(side) * controls[sided(knee_out, side)] * degree;
  const Vector3d pole(std::sin(yaw), 0.0, std::cos(yaw));
  const Limb::Rotations rotations =
      legs_[static_cast<std::size_t>(side)].reaching(hip, state.ankle, pole, state.reach);
  attach(pose, idx[thigh], rotations.upper);
  attach(pose, idx[shin], rotations.lower);
  attach(pose, idx[foot], state.foot_rotation());
  attach(pose, idx[toe], state.toe_rotation());
}

SkeletonPose Performance::pose(double time) const {
  const Controls controls = score_.controls(time);
  const Trunk rotations = trunk(controls);
  SkeletonPose pose = rest_pose(skeleton_);
  const auto root = static_cast<std::size_t>(trunk_idx_[pelvis]);
  pose.rotation[root] = rotations.pelvis;
  pose.position[root] = hips(time) + rotations.pelvis * (rest(trunk_idx_[pelvis]) - rest_hips_);
  attach(pose, trunk_idx_[spine], rotations.spine);
  attach(pose, trunk_idx_[chest], rotations.chest);
  attach(pose, trunk_idx_[neck], rotations.neck);
  attach(pose, trunk_idx_[head], rotations.head);
  for (int side = 0; side < 2; ++side) {
    pose_arm(pose, side, controls);
    pose_leg(pose, side, controls, time);
  }
  return pose;
}

FootContacts Performance::contacts(double time) const {
  return {foot_state(0, time).contact(), foot_state(1, time).contact()};
}

}  // namespace reprise::motion
