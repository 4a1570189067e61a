// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The performer's 21 joints on the 163 bones of the package's body: bends of spine and neck are spread over
// their vertebrae, twists of arms and legs along the limb.

#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "reprise/sequence/skeleton.h"
#include "reprise/synthetic/body/makehuman.h"

namespace reprise::body {

// x -> rotation x + translation.
struct RigidTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// Takes the fingers and thumbs of the body from the package's straight rest pose to a relaxed curl: one
// transform a node of the body.
std::vector<RigidTransform> relaxed_fingers(const MakehumanBody& body, const MakehumanPoints& points);

class BodyRig {
 public:
  // `points`: all vertices of the body at rest.
  BodyRig(const MakehumanBody& body, const MakehumanPoints& points);

  const Skeleton& skeleton() const { return skeleton_; }
  int bone_count() const { return static_cast<int>(bones_.size()); }
  // The bone that a node of the body follows.
  int bone_of_node(int node_idx) const { return bone_of_node_[static_cast<std::size_t>(node_idx)]; }
  // The joint of the skeleton whose part of the body a bone is.
  int joint_of_bone(int bone_idx) const { return bones_[static_cast<std::size_t>(bone_idx)].joint; }

  // From the rest pose to `pose`, one a bone.
  std::vector<RigidTransform> transforms(const SkeletonPose& pose) const;

 private:
  // Follows `joint`, or is between `parent` and `joint`: `swing` and `twist` say how much of the joint's
  // rotation against the parent it takes, and `child_twist` how much of the twist of the joint's child.
  struct Bone {
    int joint = 0;
    int parent = -1;  // -1: follows `joint` wholly
    int child = -1;
    double swing = 1.0, twist = 1.0, child_twist = 0.0;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  // of twist, at rest

    bool operator==(const Bone&) const = default;
  };
  int add_bone(const Bone& bone);

  Skeleton skeleton_;
  std::vector<Bone> bones_;
  std::vector<int> bone_of_node_;
};

}  // namespace reprise::body
