// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/skeleton.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {
namespace {

// Rates such as 120/1.001 and sums of frame times are rounded: a frame that is due within a millionth of the
// last one is there.
constexpr double frame_tolerance = 1e-6;
constexpr double greatest_frame_count = 1e8;

std::vector<std::string> names(const Skeleton& skeleton) {
  std::vector<std::string> result;
  for (const Joint& joint : skeleton.joints) result.push_back(joint.name);
  return result;
}

void check_size(const Skeleton& skeleton, const SkeletonPose& pose) {
  if (pose.rotation.size() != skeleton.joints.size() || pose.position.size() != skeleton.joints.size()) {
    throw InvalidArgument(fmt::format("a pose has {} rotations and {} positions; expected {}, one a joint",
                                      pose.rotation.size(), pose.position.size(), skeleton.joints.size()));
  }
}

// Joint `j` of a pose relative to its parent: rotation, and the joint's place in the parent's rest frame.
struct Local {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d offset;
};

Local local(const SkeletonPose& pose, std::size_t j, int parent) {
  if (parent < 0) return {pose.rotation[j], pose.position[j]};
  const auto p = static_cast<std::size_t>(parent);
  const Eigen::Quaterniond parent_from_world = pose.rotation[p].conjugate();
  return {parent_from_world * pose.rotation[j], parent_from_world * (pose.position[j] - pose.position[p])};
}

}  // namespace

std::optional<int> Skeleton::find(const std::string& name) const {
  const auto found = std::ranges::find(joints, name, &Joint::name);
  if (found == joints.end()) return std::nullopt;
  return static_cast<int>(found - joints.begin());
}

int Skeleton::joint_idx(const std::string& name) const {
  if (const std::optional<int> idx = find(name)) return *idx;
  const std::vector<std::string> all = names(*this);
  const std::string nearest = nearest_word(name, all);
  throw InvalidArgument(fmt::format("the skeleton has no joint '{}'{}; its joints are: {}", name,
                                    nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                                    fmt::join(all, ", ")));
}

std::vector<int> Skeleton::children(int joint_idx) const {
  std::vector<int> result;
  for (int j = 0; j < size(); ++j) {
    if (joints[static_cast<std::size_t>(j)].parent == joint_idx) result.push_back(j);
  }
  return result;
}

void validate(const Skeleton& skeleton) {
  std::set<std::string> taken;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    if (joint.name.empty()) throw InvalidArgument(fmt::format("joint {} has no name", j));
    if (!taken.insert(joint.name).second)
      throw InvalidArgument(fmt::format("two joints are called '{}'", joint.name));
    if (joint.parent < -1 || joint.parent >= static_cast<int>(j)) {
      throw InvalidArgument(fmt::format("joint '{}' ({}) has the parent {}; expected -1 or a joint before it",
                                        joint.name, j, joint.parent));
    }
    if (!joint.rest_position.allFinite()) {
      throw InvalidArgument(fmt::format("joint '{}' has a rest position that is not finite", joint.name));
    }
  }
}

Eigen::Isometry3d SkeletonPose::world_from_rest(const Skeleton& skeleton, int joint_idx) const {
  const auto j = static_cast<std::size_t>(joint_idx);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = rotation.at(j).toRotationMatrix();
  transform.translation() = position.at(j) - transform.linear() * skeleton.joints.at(j).rest_position;
  return transform;
}

SkeletonPose rest_pose(const Skeleton& skeleton) {
  SkeletonPose pose;
  pose.rotation.assign(skeleton.joints.size(), Eigen::Quaterniond::Identity());
  for (const Joint& joint : skeleton.joints) pose.position.push_back(joint.rest_position);
  return pose;
}

SkeletonPose pose_from_rotations(const Skeleton& skeleton,
                                 const std::vector<Eigen::Quaterniond>& world_rotations,
                                 const Eigen::Vector3d& root_position) {
  if (world_rotations.size() != skeleton.joints.size()) {
    throw InvalidArgument(fmt::format("{} rotations for a skeleton of {} joints", world_rotations.size(),
                                      skeleton.joints.size()));
  }
  SkeletonPose pose;
  pose.rotation = world_rotations;
  pose.position.reserve(world_rotations.size());
  for (const Joint& joint : skeleton.joints) {
    if (joint.parent < 0) {
      pose.position.emplace_back(root_position + joint.rest_position - skeleton.joints[0].rest_position);
    } else {
      const auto p = static_cast<std::size_t>(joint.parent);
      pose.position.emplace_back(pose.position[p] +
                                 pose.rotation[p] * (joint.rest_position - skeleton.joints[p].rest_position));
    }
  }
  return pose;
}

SkeletonPose interpolate(const Skeleton& skeleton, const SkeletonPose& a, const SkeletonPose& b,
                         double alpha) {
  check_size(skeleton, a);
  check_size(skeleton, b);
  if (!(alpha >= 0.0 && alpha <= 1.0)) {
    throw InvalidArgument(fmt::format("cannot interpolate poses at {}; expected 0 to 1", alpha));
  }
  if (alpha == 0.0) return a;
  if (alpha == 1.0) return b;
  SkeletonPose pose;
  pose.rotation.reserve(a.rotation.size());
  pose.position.reserve(a.rotation.size());
  for (std::size_t j = 0; j < a.rotation.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Local from = local(a, j, parent);
    const Local to = local(b, j, parent);
    const Eigen::Quaterniond rotation = from.rotation.slerp(alpha, to.rotation).normalized();
    // Between frames of one rigid skeleton the offsets are equal: bones keep their lengths.
    const Eigen::Vector3d offset = from.offset + alpha * (to.offset - from.offset);
    if (parent < 0) {
      pose.rotation.push_back(rotation);
      pose.position.push_back(offset);
    } else {
      const auto p = static_cast<std::size_t>(parent);
      pose.rotation.push_back((pose.rotation[p] * rotation).normalized());
      pose.position.emplace_back(pose.position[p] + pose.rotation[p] * offset);
    }
  }
  return pose;
}

SkeletalMotion resample(const SkeletalMotion& motion, double frames_per_second) {
  if (!(frames_per_second > 0.0) || !std::isfinite(frames_per_second)) {
    throw InvalidArgument(
        fmt::format("cannot resample '{}' to {} frames per second; expected a positive, "
                    "finite rate",
                    motion.name, frames_per_second));
  }
  if (motion.frames.empty()) throw InvalidArgument(fmt::format("motion '{}' has no frames", motion.name));
  const double last = static_cast<double>(motion.frames.size() - 1);
  const double ratio = frames_per_second / motion.frames_per_second;
  const double count = std::floor(last * ratio + frame_tolerance) + 1.0;
  if (!(count <= greatest_frame_count)) {
    throw InvalidArgument(
        fmt::format("motion '{}' would have {} frames at {} frames per second; expected at "
                    "most {}",
                    motion.name, count, frames_per_second, greatest_frame_count));
  }
  SkeletalMotion result{motion.name, motion.skeleton, frames_per_second, {}};
  result.frames.reserve(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    const double at = std::min(static_cast<double>(k) / ratio, last);
    const auto before = static_cast<std::size_t>(at);
    const double alpha = at - static_cast<double>(before);
    const std::size_t after = std::min(before + 1, motion.frames.size() - 1);
    result.frames.push_back(interpolate(motion.skeleton, motion.frames[before], motion.frames[after], alpha));
  }
  return result;
}

}  // namespace reprise
