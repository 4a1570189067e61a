// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Skeletons and skeletal motion: joints of a rest pose, and where they are in every frame.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise {

struct Joint {
  std::string name;
  int parent = -1;                // index of a joint before this one; -1: a root
  Eigen::Vector3d rest_position;  // metres, world, in the rest pose
};

// A joint is where its bone begins: "left_shin" is the knee and moves with the lower leg.
struct Skeleton {
  std::vector<Joint> joints;  // parents before children

  int size() const { return static_cast<int>(joints.size()); }
  std::optional<int> find(const std::string& name) const;
  // Throws `InvalidArgument` that offers the nearest name and lists what is there.
  int joint_idx(const std::string& name) const;
  std::vector<int> children(int joint_idx) const;
};

// Throws `InvalidArgument` naming the joint: an empty or taken name, a parent that does not stand before it,
// a position that is not finite.
void validate(const Skeleton& skeleton);

// World pose of every joint. `rotation` takes directions of the rest pose to the frame (identity = at rest),
// so that a point x of the rest pose fixed to bone j is at rotation[j] * (x - rest_position[j]) +
// position[j].
struct SkeletonPose {
  std::vector<Eigen::Quaterniond> rotation;  // unit
  std::vector<Eigen::Vector3d> position;     // metres

  Eigen::Isometry3d world_from_rest(const Skeleton& skeleton, int joint_idx) const;
};

SkeletonPose rest_pose(const Skeleton& skeleton);

// Forward kinematics: positions of all joints from the world rotations and the root's position, with the bone
// lengths of the rest pose. A second root keeps its rest offset from the first.
SkeletonPose pose_from_rotations(const Skeleton& skeleton,
                                 const std::vector<Eigen::Quaterniond>& world_rotations,
                                 const Eigen::Vector3d& root_position);

// `alpha` in [0, 1]: joint rotations along the shortest arc relative to the parent, root position linearly.
SkeletonPose interpolate(const Skeleton& skeleton, const SkeletonPose& a, const SkeletonPose& b,
                         double alpha);

struct SkeletalMotion {
  std::string name;
  Skeleton skeleton;
  double frames_per_second = 25.0;
  std::vector<SkeletonPose> frames;

  double duration() const { return static_cast<double>(frames.size()) / frames_per_second; }
};

// The same motion at another rate, by interpolation: frame k is at k / rate seconds; floor((F - 1) *
// rate_ratio) + 1 frames. Throws `InvalidArgument` for a rate that is not positive and finite, or a motion
// without frames.
SkeletalMotion resample(const SkeletalMotion& motion, double frames_per_second);

}  // namespace reprise
