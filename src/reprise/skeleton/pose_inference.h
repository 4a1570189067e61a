// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Bones that no vertex shows: placed between those that are known.

#pragma once

#include <optional>
#include <vector>

#include "reprise/sequence/skeleton.h"

namespace reprise::skeleton {

// What is known of a bone: how it stands in the frame.
struct KnownBone {
  Eigen::Quaterniond rotation;  // frame from rest
  Eigen::Vector3d position;     // of its joint
};

// Decides once, from which bones are known, how each other bone is found; then works frame by frame.
// Everything turns and moves with the known bones, and varies with them continuously.
//   - an unknown root is carried by the known bones nearest to it in the tree;
//   - unknown bones between two known ones (hip and knee between pelvis and foot) hang on the upper one and
//   reach
//     the joint of the lower one: one bone is aimed at it, two bend in the direction in which they are bent
//     at rest (or, if they are straight, towards which the lower bone points), more are drawn there from an
//     even turning; two and more keep their rest lengths, and stretch straight if the goal is out of reach;
//   - an unknown bone with nothing known below it stays with its parent.
class PoseInference {
 public:
  // `is_known`: one entry a joint, at least one of them true.
  PoseInference(const Skeleton& skeleton, std::vector<bool> is_known);

  SkeletonPose infer(const std::vector<std::optional<KnownBone>>& known) const;

 private:
  struct Chain {
    int above = -1;          // known or inferred before
    std::vector<int> bones;  // unknown, from above down
    int below = -1;          // known; -1: nothing below
  };

  void place_chain(const Chain& chain, SkeletonPose& pose) const;
  void place_pair(const Chain& chain, SkeletonPose& pose) const;
  void place_string(const Chain& chain, SkeletonPose& pose) const;
  void aim(int bone, const Eigen::Vector3d& rest_goal, const Eigen::Vector3d& goal, SkeletonPose& pose) const;
  const Eigen::Vector3d& rest(int joint) const {
    return skeleton_.joints[static_cast<std::size_t>(joint)].rest_position;
  }

  Skeleton skeleton_;
  std::vector<bool> is_known_;
  std::vector<std::pair<int, int>> roots_;  // unknown roots, each with a known bone that carries it
  std::vector<Chain> chains_;               // in the order in which they can be placed
};

}  // namespace reprise::skeleton
