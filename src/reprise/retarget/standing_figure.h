// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A captured character as retargeting sees it: a body that stands straight on flat feet.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reprise/retarget/joint_map.h"

namespace reprise {

namespace retargeting {
struct StandingRotations;
}

// Captures are marked on any frame, a stride or a crane's stand; retargeting needs to know what straight,
// flat and ahead mean for every bone. If the rest pose stands (both feet flat and level, trunk upright), it
// says so; else the poses of the captured clips do: trunk and head as they are on average against the
// heading, feet as they are while they stand still, limbs by their bones.
class StandingFigure {
 public:
  // `seen`: motions of `skeleton` (extracted from the clips); may be empty if the rest pose stands. Throws
  // `InvalidArgument` if required body joints are not found, or the rest pose does not stand and nothing was
  // seen that does. `soles`: the lowest points of both feet (left, right) at rest over the ground, metres,
  // where a surface tells them: captures are rarely marked on level ground.
  StandingFigure(const Skeleton& skeleton, std::span<const SkeletalMotion> seen,
                 const std::string& what = "the character",
                 const std::optional<std::array<double, 2>>& soles = std::nullopt);

  const Skeleton& own() const { return own_; }
  // All body joints, in the order of `body_joints`, at rest: standing, soles at y = 0, facing +Z. Joints that
  // the character lacks stand where they would be.
  const Skeleton& standing() const { return standing_; }
  const JointMap& map() const { return map_; }
  bool rest_pose_stands() const { return rest_pose_stands_; }

  // The pose of the character's own skeleton in which its bones are turned as in a pose of `standing()`.
  // Joints of the character that stand for no body joint go with their parents.
  SkeletonPose own_pose(const SkeletonPose& standing_pose) const;
  // The other way round: of a pose of the character's skeleton, body joints that it lacks filled in.
  SkeletonPose standing_pose(const SkeletonPose& own_pose) const;

 private:
  void drive(const std::vector<int>& body, const std::vector<Eigen::Quaterniond>& standing_from_own);
  void place_joints(const std::vector<int>& body, const retargeting::StandingRotations& found);

  Skeleton own_;
  Skeleton standing_;
  JointMap map_;
  bool rest_pose_stands_ = true;
  std::vector<int> body_joint_of_own_;                 // which drives it, one a joint of the character
  std::vector<Eigen::Quaterniond> standing_from_own_;  // at rest, one a joint of the character
};

}  // namespace reprise
