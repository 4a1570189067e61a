// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A body and motions of it for the tests of retargeting.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "reprise/io/acclaim.h"
#include "reprise/retarget/limb.h"
#include "reprise/sequence/skeleton.h"
#include "support/test_data.h"

namespace reprise::test {

// A woman of 1.6 m in an A-pose, soles at y = 0, facing +Z. All body joints, in their order.
inline Skeleton standing_woman() {
  Skeleton skeleton;
  const auto add = [&](const std::string& name, const std::string& parent, const Eigen::Vector3d& position) {
    skeleton.joints.push_back({name, parent.empty() ? -1 : skeleton.joint_idx(parent), position});
  };
  add("pelvis", "", {0, 0.835, -0.063});
  add("spine", "pelvis", {0, 0.906, -0.022});
  add("chest", "spine", {0, 1.060, 0.012});
  add("neck", "chest", {0, 1.358, -0.001});
  add("head", "neck", {0, 1.470, 0.041});
  for (const double sign : {1.0, -1.0}) {
    const std::string side = sign > 0.0 ? "left_" : "right_";
    const auto limb = [&](const std::string& name, const std::string& parent, Eigen::Vector3d position) {
      position.x() *= sign;
      add(side + name, parent, position);
    };
    limb("collar", "chest", {0.023, 1.290, 0.021});
    limb("upper_arm", side + "collar", {0.155, 1.275, 0.021});
    limb("forearm", side + "upper_arm", {0.313, 1.102, 0.025});
    limb("hand", side + "forearm", {0.424, 0.981, 0.161});
    limb("thigh", "pelvis", {0.0955, 0.822, 0.017});
    limb("shin", side + "thigh", {0.135, 0.450, 0.048});
    limb("foot", side + "shin", {0.166, 0.069, 0.030});
    limb("toe", side + "foot", {0.1435, 0.026, 0.155});
  }
  return skeleton;
}

inline std::size_t joint(const Skeleton& skeleton, const std::string& name) {
  return static_cast<std::size_t>(skeleton.joint_idx(name));
}

inline const std::string& side_name(std::size_t side) {
  static const std::array<std::string, 2> names = {"left_", "right_"};
  return names[side];
}

// She bows and bends her knees to and fro, one more than the other, with feet that stay where they are; her
// arms swing and bend.
inline SkeletalMotion bowing(const Skeleton& skeleton, std::size_t frame_count, double frames_per_second) {
  using Eigen::AngleAxisd;
  using Eigen::Quaterniond;
  using Eigen::Vector3d;
  SkeletalMotion motion{"bowing", skeleton, frames_per_second, {}};
  const auto rest = [&](const std::string& name) {
    return skeleton.joints[joint(skeleton, name)].rest_position;
  };
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double t = static_cast<double>(f) / frames_per_second;
    std::vector<Quaterniond> rotations(skeleton.joints.size(), Quaterniond::Identity());
    const auto turn = [&](const std::string& name) -> Quaterniond& {
      return rotations[joint(skeleton, name)];
    };
    const double sink = 0.03 + 0.03 * std::sin(2.0 * t);
    const Vector3d shift(0.03 * std::sin(1.3 * t), -sink, 0.02 * std::sin(1.7 * t));
    const Quaterniond chest(AngleAxisd(0.25 * std::sin(2.3 * t), Vector3d::UnitX()));
    for (const char* name : {"spine", "chest", "neck", "head", "left_collar", "right_collar"})
      turn(name) = chest;
    turn("head") = chest * AngleAxisd(0.3 * std::sin(3.1 * t), Vector3d::UnitY());
    for (std::size_t side = 0; side < 2; ++side) {
      const std::string name = side_name(side);
      const double phase = 2.5 * static_cast<double>(side);
      turn(name + "upper_arm") = chest * AngleAxisd(0.6 * std::sin(3.0 * t + phase), Vector3d::UnitX());
      const Vector3d arm = rest(name + "forearm") - rest(name + "upper_arm");
      const Vector3d elbow = arm.cross(Vector3d::UnitZ()).normalized();
      turn(name + "forearm") =
          turn(name + "upper_arm") * AngleAxisd(0.3 + 0.3 * std::sin(4.0 * t + phase), elbow);
      turn(name + "hand") = turn(name + "forearm");
      const retargeting::Limb leg(rest(name + "thigh"), rest(name + "shin"), rest(name + "foot"),
                                  Vector3d::UnitX());
      const auto bent =
          leg.reaching(rest(name + "thigh") + shift, rest(name + "foot"), Vector3d::UnitZ(), 0.998);
      turn(name + "thigh") = bent.upper;
      turn(name + "shin") = bent.lower;
    }
    motion.frames.push_back(pose_from_rotations(skeleton, rotations, rest("pelvis") + shift));
  }
  return motion;
}

// The same motion of a skeleton whose rest pose is one of its frames: what a capture is whose markup was made
// on that frame.
inline SkeletalMotion rebased(const SkeletalMotion& motion, std::size_t frame) {
  SkeletalMotion result = motion;
  const SkeletonPose& rest = motion.frames[frame];
  for (std::size_t j = 0; j < motion.skeleton.joints.size(); ++j) {
    result.skeleton.joints[j].rest_position = rest.position[j];
    for (SkeletonPose& pose : result.frames) {
      pose.rotation[j] = (pose.rotation[j] * rest.rotation[j].conjugate()).normalized();
    }
  }
  return result;
}

// The same body and motion seen from elsewhere and on another scale.
inline SkeletalMotion moved(const SkeletalMotion& motion, const Eigen::Quaterniond& turn, double scale,
                            const Eigen::Vector3d& shift) {
  SkeletalMotion result = motion;
  for (Joint& j : result.skeleton.joints) j.rest_position *= scale;
  for (SkeletonPose& pose : result.frames) {
    for (Eigen::Vector3d& position : pose.position) position = turn * (scale * position) + shift;
    for (Eigen::Quaterniond& rotation : pose.rotation) rotation = turn * rotation;
  }
  return result;
}

inline double greatest_distance(const SkeletonPose& a, const SkeletonPose& b) {
  double greatest = 0.0;
  for (std::size_t j = 0; j < a.position.size(); ++j) {
    greatest = std::max(
        {greatest, (a.position[j] - b.position[j]).norm(), a.rotation[j].angularDistance(b.rotation[j])});
  }
  return greatest;
}

inline SkeletalMotion cmu_trial(const std::string& trial) {
  const std::filesystem::path cmu = data_folder() / "cmu";
  return read_acclaim(cmu / "asf" / (trial.substr(0, 2) + ".asf"), cmu / "amc" / (trial + ".amc"));
}

}  // namespace reprise::test
