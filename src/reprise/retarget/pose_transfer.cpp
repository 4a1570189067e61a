// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/pose_transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/retarget/bone_angles.h"

namespace reprise::retargeting {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr std::array<const char*, 5> trunk_joints = {"pelvis", "spine", "chest", "neck", "head"};
constexpr std::array<const char*, 2> side_names = {"left_", "right_"};

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

// The least rotation after `rotation` that takes `from` to the direction of `to`.
Quaterniond turned_to(const Quaterniond& rotation, const Vector3d& from, const Vector3d& to) {
  constexpr double shortest = 1e-6;  // metres: such a bone has no direction
  if (from.norm() < shortest || to.norm() < shortest) return rotation;
  return (Quaterniond::FromTwoVectors(rotation * from, to) * rotation).normalized();
}

// The joint of the trunk that is farthest up.
std::size_t top_joint(const std::vector<int>& source_of, const Skeleton& performer) {
  const int head = source_of[index(performer.joint_idx("head"))];
  return index(head >= 0 ? head : source_of[index(performer.joint_idx("chest"))]);
}

}  // namespace

std::vector<int> source_joints(const Skeleton& performer, const JointMap& map, const Skeleton& source) {
  std::vector<int> result(performer.joints.size(), -1);
  for (const auto& [own, theirs] : map.joints) {
    result[index(performer.joint_idx(own))] = source.joint_idx(theirs);
  }
  return result;
}

SkeletalMotion upright(const SkeletalMotion& motion, const std::vector<int>& source_of,
                       const Skeleton& performer) {
  const auto source = [&](const char* name) { return index(source_of[index(performer.joint_idx(name))]); };
  const std::size_t head = top_joint(source_of, performer), left = source("left_thigh"),
                    right = source("right_thigh");
  Vector3d up = Vector3d::Zero();
  for (const SkeletonPose& pose : motion.frames) {
    up += (pose.position[head] - 0.5 * (pose.position[left] + pose.position[right])).normalized();
  }
  up /= static_cast<double>(motion.frames.size());
  Eigen::Index axis = 1;
  up.cwiseAbs().maxCoeff(&axis);
  // A body that lies down in a Y-up file is left lying: another axis must be clearly up.
  if (axis == 1 || std::abs(up[axis]) < 0.8) return motion;
  const Quaterniond turn =
      Quaterniond::FromTwoVectors(std::copysign(1.0, up[axis]) * Vector3d::Unit(axis), Vector3d::UnitY());
  SkeletalMotion result = motion;
  for (Joint& joint : result.skeleton.joints) joint.rest_position = turn * joint.rest_position;
  for (SkeletonPose& pose : result.frames) {
    for (Vector3d& position : pose.position) position = turn * position;
    for (Quaterniond& rotation : pose.rotation) rotation = turn * rotation * turn.conjugate();
  }
  return result;
}

std::size_t frames_before_motion(const SkeletalMotion& motion, const std::vector<int>& source_of,
                                 const Skeleton& performer) {
  constexpr double fastest = 2000.0 * radians_per_degree;  // a second, of both arms at once
  constexpr double longest = 0.25;                         // seconds
  const auto limit = static_cast<std::size_t>(longest * motion.frames_per_second) + 1;
  const auto arm_speed = [&](std::size_t frame, const std::string& side) {
    double greatest = 0.0;
    for (const char* bone : {"upper_arm", "forearm"}) {
      const std::size_t joint = index(source_of[index(performer.joint_idx(side + bone))]);
      const int parent = motion.skeleton.joints[joint].parent;
      const auto local = [&](const SkeletonPose& pose) {
        return parent < 0 ? pose.rotation[joint]
                          : Quaterniond(pose.rotation[index(parent)].conjugate() * pose.rotation[joint]);
      };
      greatest =
          std::max(greatest, local(motion.frames[frame]).angularDistance(local(motion.frames[frame + 1])));
    }
    return greatest * motion.frames_per_second;
  };
  std::size_t first = 0;
  for (std::size_t f = 0; f < limit && f + 1 < motion.frames.size(); ++f) {
    if (arm_speed(f, "left_") > fastest && arm_speed(f, "right_") > fastest) first = f + 1;
  }
  // A motion as fast as that all along is the motion.
  return first >= limit ? 0 : first;
}

std::vector<SkeletonPose> sample(const SkeletalMotion& motion, double frames_per_second) {
  constexpr double deviation = 0.01;  // seconds: leaves what a body does, takes what markers jitter
  if (motion.frames_per_second < 1.5 * frames_per_second) return resample(motion, frames_per_second).frames;
  const double ratio = motion.frames_per_second / frames_per_second;
  const double last = static_cast<double>(motion.frames.size() - 1);
  const auto count = static_cast<std::size_t>(std::floor(last / ratio + 1e-6)) + 1;
  const double reach = 3.0 * deviation * motion.frames_per_second;
  const std::size_t joints = motion.skeleton.joints.size();
  std::vector<SkeletonPose> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double at = std::min(static_cast<double>(k) * ratio, last);
    // Near the ends the window shrinks, so that it stays symmetric and does not lag.
    const double near = std::min({reach, at, last - at});
    std::vector<Eigen::Vector4d> rotation(joints, Eigen::Vector4d::Zero());
    std::vector<Vector3d> position(joints, Vector3d::Zero());
    const SkeletonPose& middle = motion.frames[static_cast<std::size_t>(std::lround(at))];
    double weights = 0.0;
    const auto begin = static_cast<std::size_t>(std::max(0.0, std::ceil(at - near - 0.5)));
    const auto end = static_cast<std::size_t>(std::min(last, std::floor(at + near + 0.5)));
    for (std::size_t f = begin; f <= end; ++f) {
      const double away = (static_cast<double>(f) - at) / (deviation * motion.frames_per_second);
      const double weight = std::exp(-0.5 * away * away);
      weights += weight;
      for (std::size_t j = 0; j < joints; ++j) {
        const Quaterniond& q = motion.frames[f].rotation[j];
        rotation[j] += (q.dot(middle.rotation[j]) < 0.0 ? -weight : weight) * q.coeffs();
        position[j] += weight * motion.frames[f].position[j];
      }
    }
    for (std::size_t j = 0; j < joints; ++j) {
      result[k].rotation.push_back(Quaterniond(Eigen::Vector4d(rotation[j])).normalized());
      result[k].position.emplace_back(position[j] / weights);
    }
  }
  return result;
}

PoseTransfer::PoseTransfer(const Skeleton& performer, const Skeleton& source, std::vector<int> source_of)
    : performer_(performer), source_(source), source_of_(std::move(source_of)) {
  const Vector3d hips = 0.5 * (own_rest(own("left_thigh")) + own_rest(own("right_thigh")));
  hips_from_pelvis_ = hips - own_rest(own("pelvis"));
  double own_leg = 0.0, source_leg = 0.0;
  for (const std::string side : side_names) {
    const int thigh = own(side + "thigh"), shin = own(side + "shin"), foot = own(side + "foot");
    own_leg += (own_rest(shin) - own_rest(thigh)).norm() + (own_rest(foot) - own_rest(shin)).norm();
    source_leg +=
        (source_rest(shin) - source_rest(thigh)).norm() + (source_rest(foot) - source_rest(shin)).norm();
  }
  constexpr double shortest = 1e-3;
  if (!(own_leg > shortest) || !(source_leg > shortest)) {
    throw InvalidArgument(fmt::format("legs of {:.4g} m cannot become legs of {:.4g} m: check the joint map",
                                      0.5 * source_leg, 0.5 * own_leg));
  }
  scale_ = own_leg / source_leg;
  align();
}

const Vector3d& PoseTransfer::source_rest(int own_idx) const {
  return source_.joints[index(source_of_[index(own_idx)])].rest_position;
}

void PoseTransfer::align() {
  // Trunk and head: both rest poses stand and look ahead, so only the directions of "ahead" and "up" are
  // matched. Matching bones would tilt the head by the difference of where the two place its joint.
  const auto frame = [&](const Vector3d& across, const Vector3d& along) {
    Eigen::Matrix3d M;
    M.col(1) = along.normalized();
    M.col(0) = (across - across.dot(M.col(1)) * M.col(1)).normalized();
    M.col(2) = M.col(0).cross(M.col(1));
    return M;
  };
  const int left = own("left_thigh"), right = own("right_thigh");
  const Vector3d up = source_.joints[top_joint(source_of_, performer_)].rest_position -
                      0.5 * (source_rest(left) + source_rest(right));
  const Vector3d across = source_rest(left) - source_rest(right);
  Quaterniond ahead = Quaterniond::Identity();
  constexpr double upright_cosine = 0.9;
  if (up.normalized().y() > upright_cosine) {
    // Hips of real bodies are not quite level or square: a quarter turn is meant unless it is far off.
    const double yaw = heading(across.cross(Vector3d::UnitY()));
    const double quarter = 0.5 * std::numbers::pi * std::round(yaw / (0.5 * std::numbers::pi));
    ahead = turn_about_up(std::abs(yaw - quarter) < 15.0 * radians_per_degree ? quarter : yaw);
  } else if (up.norm() > 1e-6 && across.cross(up).norm() > 1e-9) {
    ahead = Quaterniond(frame(across, up));
  }
  source_rest_from_own_.assign(performer_.joints.size(), ahead.normalized());
  for (const std::string side : side_names) {
    align_limb(side + "upper_arm", side + "forearm", side + "hand");
    align_limb(side + "thigh", side + "shin", side + "foot");
  }
  for (const int side : {0, 1}) align_foot(side);
}

void PoseTransfer::align_limb(const std::string& upper, const std::string& middle, const std::string& end) {
  const int u = own(upper), m = own(middle), e = own(end);
  Quaterniond& upper_turn = source_rest_from_own_[index(u)];
  Quaterniond& middle_turn = source_rest_from_own_[index(m)];
  // The least turn from bone to bone keeps elbows and knees bending the same way.
  upper_turn = turned_to(upper_turn, own_rest(m) - own_rest(u), source_rest(m) - source_rest(u));
  middle_turn = upper_turn;
  if (is_mapped(e)) {
    middle_turn = turned_to(upper_turn, own_rest(e) - own_rest(m), source_rest(e) - source_rest(m));
  }
  source_rest_from_own_[index(e)] = middle_turn;
}

// Feet stand flat in both rest poses, so that at most their headings differ.
void PoseTransfer::align_foot(int side) {
  const std::string name = side_names[index(side)];
  const int foot = own(name + "foot"), toe = own(name + "toe");
  const Quaterniond ahead = source_rest_from_own_[index(own("pelvis"))];
  Quaterniond turn = ahead;
  if (is_mapped(toe)) {
    const Vector3d own_direction = ahead * (own_rest(toe) - own_rest(foot));
    const Vector3d source_direction = source_rest(toe) - source_rest(foot);
    const double difference =
        std::remainder(heading(source_direction) - heading(own_direction), 2.0 * std::numbers::pi);
    // Skeletons mark different points of the foot as the toes' joint, which tells nothing of its heading.
    if (std::abs(difference) > 25.0 * radians_per_degree) turn = turn_about_up(difference) * ahead;
  }
  source_rest_from_own_[index(foot)] = turn;
  source_rest_from_own_[index(toe)] = turn;
}

// What the motion does not have of the trunk, between two joints that it has, lies between them; what it does
// not have above the last goes with that.
void PoseTransfer::fill_trunk(std::vector<Quaterniond>& rotations) const {
  std::size_t below = 0;
  for (std::size_t k = 1; k < trunk_joints.size(); ++k) {
    const int j = own(trunk_joints[k]);
    if (is_mapped(j)) {
      below = k;
      continue;
    }
    std::size_t above = k + 1;
    while (above < trunk_joints.size() && !is_mapped(own(trunk_joints[above]))) ++above;
    const Quaterniond& from = rotations[index(own(trunk_joints[below]))];
    rotations[index(j)] = from;
    if (above == trunk_joints.size()) continue;
    const double share = static_cast<double>(k - below) / static_cast<double>(above - below);
    rotations[index(j)] = from.slerp(share, rotations[index(own(trunk_joints[above]))]).normalized();
  }
}

std::vector<Quaterniond> PoseTransfer::rotations(const SkeletonPose& pose) const {
  std::vector<Quaterniond> result(performer_.joints.size(), Quaterniond::Identity());
  for (std::size_t j = 0; j < result.size(); ++j) {
    if (!is_mapped(static_cast<int>(j))) continue;
    result[j] = (pose.rotation[index(source_of_[j])] * source_rest_from_own_[j]).normalized();
  }
  fill_trunk(result);
  for (std::size_t j = trunk_joints.size(); j < result.size(); ++j) {
    if (!is_mapped(static_cast<int>(j))) result[j] = result[index(performer_.joints[j].parent)];
  }
  return result;
}

Vector3d PoseTransfer::hips(const SkeletonPose& pose) const {
  return 0.5 * (pose.position[index(source_of_[index(own("left_thigh"))])] +
                pose.position[index(source_of_[index(own("right_thigh"))])]);
}

Vector3d PoseTransfer::ankle(const SkeletonPose& pose, int side) const {
  const int foot = own(std::string(side_names[index(side)]) + "foot");
  return pose.position[index(source_of_[index(foot)])];
}

Vector3d PoseTransfer::toe(const SkeletonPose& pose, int side) const {
  const std::string name = side_names[index(side)];
  const int foot = own(name + "foot"), toe = own(name + "toe");
  if (is_mapped(toe)) return pose.position[index(source_of_[index(toe)])];
  const Quaterniond rotation =
      pose.rotation[index(source_of_[index(foot)])] * source_rest_from_own_[index(foot)];
  return ankle(pose, side) + rotation * ((own_rest(toe) - own_rest(foot)) / scale_);
}

}  // namespace reprise::retargeting
