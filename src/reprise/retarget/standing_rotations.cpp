// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/standing_rotations.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/retarget/bone_angles.h"

namespace reprise::retargeting {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Places in the order of `body_joints`.
constexpr int pelvis = 0, chest = 2, neck = 3, head = 4;
constexpr int left_side = 5, right_side = 13;  // first joint of the side
constexpr int collar = 0, upper_arm = 1, forearm = 2, hand = 3, thigh = 4, shin = 5, foot = 6, toe = 7;

int at(int side, int joint) {
  return (side == 0 ? left_side : right_side) + joint;
}

// Positions and rotations of the body joints in one pose.
class Body {
 public:
  Body(const std::vector<int>& body, const SkeletonPose& pose) : body_(body), pose_(pose) {}

  bool has(int joint) const { return body_[index(joint)] >= 0; }
  const Vector3d& position(int joint) const { return pose_.position[index(body_[index(joint)])]; }
  const Quaterniond& rotation(int joint) const { return pose_.rotation[index(body_[index(joint)])]; }

  Vector3d hips() const { return 0.5 * (position(at(0, thigh)) + position(at(1, thigh))); }
  // From the hips to the end of the trunk: the neck tells more of it than the head, which nods.
  Vector3d trunk() const {
    const int top = has(neck) ? neck : (has(chest) ? chest : head);
    return position(top) - hips();
  }
  // Where hips and shoulders face, together: they turn against each other in a stride.
  Vector3d ahead() const {
    Vector3d across = Vector3d::Zero();
    for (const int joint : {thigh, upper_arm}) {
      Vector3d way = position(at(0, joint)) - position(at(1, joint));
      way.y() = 0.0;
      if (way.norm() > 1e-6) across += way.normalized();
    }
    return across.cross(Vector3d::UnitY());
  }

 private:
  const std::vector<int>& body_;
  const SkeletonPose& pose_;
};

// Weighted mean of rotations that outliers hardly move: each counts less the farther it is from the mean.
class RotationMean {
 public:
  void add(const Quaterniond& rotation, double weight = 1.0) {
    rotations_.push_back(rotation);
    weights_.push_back(weight);
  }
  bool empty() const { return rotations_.empty(); }
  Quaterniond value() const {
    constexpr int rounds = 10;
    constexpr double near = 3.0 * radians_per_degree;
    Quaterniond mean = Quaterniond::Identity();
    for (int round = 0; round < rounds; ++round) {
      Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
      for (std::size_t i = 0; i < rotations_.size(); ++i) {
        const double away = round == 0 ? 1.0 : rotations_[i].angularDistance(mean) + near;
        sum += weights_[i] / away * rotations_[i].coeffs() * rotations_[i].coeffs().transpose();
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
      mean = Quaterniond(Eigen::Vector4d(solver.eigenvectors().col(3)));
    }
    return mean.normalized();
  }

 private:
  std::vector<Quaterniond> rotations_;
  std::vector<double> weights_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A foot that stands flat and still, as it is turned when its toes point along +Z.
struct FlatFoot {
  RotationMean foot, toe;
  std::vector<double> ankle_heights;
};

struct StillFrame {
  std::size_t motion, frame;
  double height;  // of the ankle
};

// Frames in which neither ankle nor ball of a foot moves.
std::vector<StillFrame> still_frames(const std::vector<int>& body, std::span<const SkeletalMotion> seen,
                                     int side) {
  constexpr double fastest = 0.2;  // m/s
  std::vector<StillFrame> result;
  for (std::size_t m = 0; m < seen.size(); ++m) {
    const std::vector<SkeletonPose>& frames = seen[m].frames;
    for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
      const Body before(body, frames[f - 1]), after(body, frames[f + 1]);
      const auto is_still = [&](int joint) {
        const Vector3d way = after.position(joint) - before.position(joint);
        return 0.5 * way.norm() * seen[m].frames_per_second < fastest;
      };
      const int ankle = at(side, foot), ball = at(side, toe);
      if (!is_still(ankle) || (after.has(ball) && !is_still(ball))) continue;
      result.push_back({m, f, Body(body, frames[f]).position(ankle).y()});
    }
  }
  return result;
}

FlatFoot flat_foot(const Skeleton& skeleton, const std::vector<int>& body,
                   std::span<const SkeletalMotion> seen, int side) {
  constexpr double low = 0.03;  // metres over the lowest tenth: a foot may also be still in the air
  FlatFoot flat;
  const std::vector<StillFrame> still = still_frames(body, seen, side);
  if (still.empty()) return flat;
  std::vector<double> heights;
  for (const StillFrame& frame : still) heights.push_back(frame.height);
  const auto tenth = heights.begin() + static_cast<std::ptrdiff_t>((heights.size() - 1) / 10);
  std::nth_element(heights.begin(), tenth, heights.end());
  const double highest = *tenth + low;
  const SkeletonPose rest = rest_pose(skeleton);
  const Body at_rest(body, rest);
  const int ankle = at(side, foot), ball = at(side, toe);
  for (const StillFrame& frame : still) {
    if (frame.height > highest) continue;
    const Body now(body, seen[frame.motion].frames[frame.frame]);
    const Vector3d ahead = now.has(ball)
                               ? now.rotation(ankle) * (at_rest.position(ball) - at_rest.position(ankle))
                               : now.ahead();
    const Quaterniond turn = turn_about_up(-heading(ahead));
    flat.foot.add(turn * now.rotation(ankle));
    if (now.has(ball)) flat.toe.add(turn * now.rotation(ball));
    flat.ankle_heights.push_back(frame.height);
  }
  return flat;
}

// The axis about which the middle joint of a limb bends, in the rest frames of the bones above and below it.
struct Hinge {
  Vector3d upper = Vector3d::Zero(), lower = Vector3d::Zero();
  bool is_known = false;
};

// `upper`, `middle`, `end`: body joints.
Hinge hinge_of(const Skeleton& skeleton, const std::vector<int>& body, std::span<const SkeletalMotion> seen,
               int upper, int middle, int end) {
  constexpr double least_bend = 15.0 * radians_per_degree;
  Hinge hinge;
  const auto add = [&](const Body& now) {
    const Vector3d above = (now.position(middle) - now.position(upper)).normalized();
    const Vector3d below = (now.position(end) - now.position(middle)).normalized();
    // As long as the sine of the bend, so that the more it bends the more it says.
    const Vector3d axis = above.cross(below);
    if (axis.norm() < std::sin(least_bend)) return;
    hinge.upper += now.rotation(upper).conjugate() * axis;
    hinge.lower += now.rotation(middle).conjugate() * axis;
  };
  for (const SkeletalMotion& motion : seen) {
    for (const SkeletonPose& pose : motion.frames) add(Body(body, pose));
  }
  const SkeletonPose rest = rest_pose(skeleton);
  if (hinge.upper.isZero()) add(Body(body, rest));
  hinge.is_known = hinge.upper.norm() > 1e-6 && hinge.lower.norm() > 1e-6;
  return hinge;
}

// Turns the two bones of a limb to the direction, with the hinge along `standing_hinge`.
void straighten_limb(std::vector<Quaterniond>& standing_from_own, const Skeleton& skeleton,
                     const std::vector<int>& body, const Hinge& hinge, const std::array<int, 3>& joints,
                     const Vector3d& direction, const Vector3d& standing_hinge,
                     const Quaterniond& otherwise) {
  const SkeletonPose rest = rest_pose(skeleton);
  const Body at_rest(body, rest);
  const auto [upper, middle, end] = joints;
  const Matrix3d target = hinge_frame(direction, standing_hinge);
  const auto turn = [&](int from, int to, const Vector3d& axis) -> Quaterniond {
    const Vector3d bone = at_rest.position(to) - at_rest.position(from);
    // A hinge along its bone says nothing; then the bone is turned as little as may be.
    if (hinge.is_known && angle_between(axis, bone) > 0.3 &&
        angle_between(axis, bone) < std::numbers::pi - 0.3) {
      return Quaterniond(target * hinge_frame(bone, axis).transpose()).normalized();
    }
    return (Quaterniond::FromTwoVectors(otherwise * bone, direction) * otherwise).normalized();
  };
  standing_from_own[index(upper)] = turn(upper, middle, hinge.upper);
  standing_from_own[index(middle)] =
      at_rest.has(end) ? turn(middle, end, hinge.lower) : standing_from_own[index(upper)];
}

}  // namespace

std::vector<int> body_joint_indices(const Skeleton& skeleton, const JointMap& map) {
  std::vector<int> result;
  for (const std::string& joint : body_joints()) {
    const auto found = map.joints.find(joint);
    result.push_back(found == map.joints.end() ? -1 : skeleton.joint_idx(found->second));
  }
  return result;
}

bool stands_at_rest(const Skeleton& skeleton, const std::vector<int>& body) {
  constexpr double greatest_tilt = 15.0 * radians_per_degree;    // of the trunk and of each leg, forwards
  constexpr double greatest_spread = 30.0 * radians_per_degree;  // of the legs, sideways
  constexpr double greatest_bend = 25.0 * radians_per_degree;    // of the knees
  const SkeletonPose rest = rest_pose(skeleton);
  const Body figure(body, rest);
  const Vector3d up = Vector3d::UnitY();
  if (!(angle_between(figure.trunk(), up) < greatest_tilt)) return false;
  const Vector3d ahead = figure.ahead();
  if (ahead.norm() < 1e-6) return false;
  const Vector3d forward = ahead.normalized();
  double leg_length = 0.0;
  for (const int side : {0, 1}) {
    const Vector3d upper = figure.position(at(side, shin)) - figure.position(at(side, thigh));
    const Vector3d lower = figure.position(at(side, foot)) - figure.position(at(side, shin));
    leg_length += 0.5 * (upper.norm() + lower.norm());
    const Vector3d leg = upper + lower;
    if (!(leg.y() < 0.0) || std::abs(std::atan2(leg.dot(forward), -leg.y())) > greatest_tilt) return false;
    if (angle_between(leg, -up) > greatest_spread || angle_between(upper, lower) > greatest_bend)
      return false;
  }
  const double step = figure.position(at(0, foot)).y() - figure.position(at(1, foot)).y();
  return std::abs(step) < 0.04 * leg_length;
}

StandingRotations standing_from_rest(const Skeleton& skeleton, const std::vector<int>& body,
                                     std::span<const SkeletalMotion> seen,
                                     const std::optional<std::array<double, 2>>& soles) {
  constexpr double square = 4.0 * radians_per_degree;
  constexpr double splayed = 10.0 * radians_per_degree;
  constexpr double level = 0.02;  // metres
  StandingRotations result;
  const SkeletonPose rest = rest_pose(skeleton);
  const Body figure(body, rest);
  // Hips and shoulders of real bodies are not quite square: a quarter turn is meant where one is near.
  double yaw = heading(figure.ahead());
  const double quarter = 0.5 * std::numbers::pi * std::round(yaw / (0.5 * std::numbers::pi));
  if (std::abs(yaw - quarter) < square) yaw = quarter;
  result.moved = yaw != 0.0;
  for (const int side : {0, 1}) {
    double& height = result.ankle_height[index(side)];
    height = figure.position(at(side, foot)).y();
    if (soles) {
      const double sole = (*soles)[index(side)];
      height -= sole;
      result.moved = result.moved || std::abs(sole) > level;
      continue;
    }
    const double leg = (figure.position(at(side, foot)) - figure.position(at(side, thigh))).norm();
    if (!(height > 0.02 * leg && height < 0.3 * leg)) {
      // The rest pose of a motion file hangs in the air or begins at the hips.
      const int ball = at(side, toe);
      height = 0.1 * leg;
      if (figure.has(ball)) {
        const double drop = figure.position(at(side, foot)).y() - figure.position(ball).y();
        height = std::clamp(drop, 0.0, 0.15 * leg) + 0.035 * leg;
      }
      result.moved = true;
    }
    // The surface that was marked need not be where the captures put the ground.
    const FlatFoot flat = flat_foot(skeleton, body, seen, side);
    if (flat.ankle_heights.empty()) continue;
    const double seen_height = median(flat.ankle_heights);
    if (std::abs(seen_height - height) < level) continue;
    height = seen_height;
    result.moved = true;
  }
  const Quaterniond turn = result.moved ? turn_about_up(-yaw) : Quaterniond::Identity();
  result.standing_from_own.assign(body.size(), turn);
  if (!result.moved) return result;
  // Feet that stand splayed are still feet that point ahead, turned.
  for (const int side : {0, 1}) {
    const int ankle = at(side, foot), ball = at(side, toe);
    if (!figure.has(ball)) continue;
    const double out = heading(turn * (figure.position(ball) - figure.position(ankle)));
    if (std::abs(out) < splayed) continue;
    for (const int joint : {ankle, ball}) result.standing_from_own[index(joint)] = turn_about_up(-out) * turn;
  }
  return result;
}

StandingRotations standing_from_motions(const Skeleton& skeleton, const std::vector<int>& body,
                                        std::span<const SkeletalMotion> seen, const std::string& what) {
  constexpr double upright = 40.0 * radians_per_degree;
  std::array<RotationMean, 21> means;
  Vector3d trunk = Vector3d::Zero();
  for (const SkeletalMotion& motion : seen) {
    for (const SkeletonPose& pose : motion.frames) {
      const Body now(body, pose);
      const Vector3d ahead = now.ahead();
      if (!(angle_between(now.trunk(), Vector3d::UnitY()) < upright) || !(ahead.norm() > 0.5)) continue;
      const Quaterniond turn = turn_about_up(-heading(ahead));
      trunk += (turn * now.trunk()).normalized();
      for (int joint = 0; joint < static_cast<int>(body.size()); ++joint) {
        if (now.has(joint)) means[index(joint)].add(turn * now.rotation(joint));
      }
    }
  }
  if (means[pelvis].empty()) {
    throw InvalidArgument(fmt::format(
        "{}: the rest pose does not stand on both feet, and {}: give motions in which the figure stands or "
        "walks, or mark it on a frame in which it stands",
        what, seen.empty() ? "no motion of it is given" : "no frame of its motions is upright"));
  }
  StandingRotations result;
  result.standing_from_own.assign(body.size(), Quaterniond::Identity());
  std::vector<Quaterniond>& standing = result.standing_from_own;
  // On the way a body leans a little; standing, its neck is over its hips.
  const Quaterniond straight = Quaterniond::FromTwoVectors(trunk, Vector3d::UnitY());
  const auto has = [&](int joint) { return body[index(joint)] >= 0; };
  for (int joint = pelvis; joint <= head; ++joint) {
    if (!has(joint)) continue;
    const Quaterniond mean = means[index(joint)].value();
    standing[index(joint)] = joint == head ? mean : (straight * mean).normalized();
  }
  const Quaterniond shoulders = standing[index(has(chest) ? chest : pelvis)];
  for (const int side : {0, 1}) {
    if (has(at(side, collar))) {
      standing[index(at(side, collar))] = (straight * means[index(at(side, collar))].value()).normalized();
    }
    // Arms half down, elbows bending forward; legs down, knees bending backward.
    const Vector3d arm = Vector3d(side == 0 ? 1.0 : -1.0, -1.0, 0.0).normalized();
    const std::array<int, 3> arm_joints = {at(side, upper_arm), at(side, forearm), at(side, hand)};
    const Hinge elbow = has(at(side, hand))
                            ? hinge_of(skeleton, body, seen, arm_joints[0], arm_joints[1], arm_joints[2])
                            : Hinge{};
    straighten_limb(standing, skeleton, body, elbow, arm_joints, arm, arm.cross(Vector3d::UnitZ()),
                    shoulders);
    if (has(at(side, hand))) {
      RotationMean wrist;
      for (const SkeletalMotion& motion : seen) {
        for (const SkeletonPose& pose : motion.frames) {
          const Body now(body, pose);
          wrist.add(now.rotation(arm_joints[1]).conjugate() * now.rotation(arm_joints[2]));
        }
      }
      standing[index(arm_joints[2])] = (standing[index(arm_joints[1])] * wrist.value()).normalized();
    }
    const std::array<int, 3> leg_joints = {at(side, thigh), at(side, shin), at(side, foot)};
    const Hinge knee = hinge_of(skeleton, body, seen, leg_joints[0], leg_joints[1], leg_joints[2]);
    straighten_limb(standing, skeleton, body, knee, leg_joints, -Vector3d::UnitY(), Vector3d::UnitX(),
                    standing[pelvis]);
    const FlatFoot flat = flat_foot(skeleton, body, seen, side);
    if (flat.foot.empty()) {
      throw InvalidArgument(
          fmt::format("{}: the {} foot never stands still on the ground in its motions, so "
                      "what is flat for it is not known",
                      what, side == 0 ? "left" : "right"));
    }
    standing[index(at(side, foot))] = flat.foot.value();
    if (has(at(side, toe))) standing[index(at(side, toe))] = flat.toe.value();
    result.ankle_height[index(side)] = median(flat.ankle_heights);
  }
  return result;
}

}  // namespace reprise::retargeting
