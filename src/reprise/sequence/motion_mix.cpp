// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/motion_mix.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// For every joint of the body its joint in the other skeleton, or -1: keeps its own rotation.
std::vector<int> taken_joints(const Skeleton& body, const Skeleton& other,
                              const std::vector<std::string>& limbs) {
  if (limbs.empty()) throw InvalidArgument("expected at least one limb to take from the other motion");
  std::vector<int> taken(body.joints.size(), -1);
  for (const std::string& limb : limbs) {
    const auto j = static_cast<std::size_t>(body.joint_idx(limb));
    if (body.joints[j].parent < 0)
      throw InvalidArgument(fmt::format("'{}' is the root of the skeleton, not a limb", limb));
    taken[j] = other.joint_idx(limb);
  }
  for (std::size_t j = 0; j < taken.size(); ++j) {
    const int parent = body.joints[j].parent;
    if (parent >= 0 && taken[static_cast<std::size_t>(parent)] >= 0)
      taken[j] = other.joint_idx(body.joints[j].name);
  }
  return taken;
}

Eigen::Quaterniond local_rotation(const Skeleton& skeleton, const SkeletonPose& pose, int joint_idx) {
  const auto j = static_cast<std::size_t>(joint_idx);
  const int parent = skeleton.joints[j].parent;
  if (parent < 0) return pose.rotation[j];
  return pose.rotation[static_cast<std::size_t>(parent)].conjugate() * pose.rotation[j];
}

}  // namespace

SkeletalMotion mix_motions(const SkeletalMotion& body, const SkeletalMotion& limbs_of,
                           const MotionMixOptions& options) {
  const std::vector<int> taken = taken_joints(body.skeleton, limbs_of.skeleton, options.limbs);
  if (body.frames.empty()) throw InvalidArgument("the motion of the body has no frames");
  const SkeletalMotion other = resample(limbs_of, body.frames_per_second);
  const double first = std::round(options.start * body.frames_per_second);
  if (!(first >= 0.0) || first >= static_cast<double>(other.frames.size())) {
    throw InvalidArgument(
        fmt::format("the limbs start at {} s; expected 0 to less than {:.2f} s, their length", options.start,
                    other.duration()));
  }
  const auto offset = static_cast<std::size_t>(first);
  SkeletalMotion mixed{.name = body.name,
                       .skeleton = body.skeleton,
                       .frames_per_second = body.frames_per_second,
                       .frames = {}};
  for (std::size_t f = 0; f < std::min(body.frames.size(), other.frames.size() - offset); ++f) {
    const SkeletonPose& pose = body.frames[f];
    std::vector<Eigen::Quaterniond> rotations = pose.rotation;
    for (int j = 0; j < body.skeleton.size(); ++j) {
      const auto i = static_cast<std::size_t>(j);
      const int parent = body.skeleton.joints[i].parent;
      if (parent < 0 || taken[i] < 0) continue;
      // Above a limb nothing turns, so the body's own rotations stand.
      rotations[i] = rotations[static_cast<std::size_t>(parent)] *
                     local_rotation(other.skeleton, other.frames[f + offset], taken[i]);
    }
    mixed.frames.push_back(pose_from_rotations(body.skeleton, rotations, pose.position[0]));
  }
  return mixed;
}

}  // namespace reprise
