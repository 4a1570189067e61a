// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How a character's bones are turned when it stands straight.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "reprise/retarget/joint_map.h"

namespace reprise::retargeting {

// Index in the skeleton of each body joint, in the order of `body_joints`; -1: it has none.
std::vector<int> body_joint_indices(const Skeleton& skeleton, const JointMap& map);

// Whether a body stands at rest: trunk upright, legs straight below it, feet level.
bool stands_at_rest(const Skeleton& skeleton, const std::vector<int>& body);

struct StandingRotations {
  // At rest; one a body joint that the skeleton has (the others are identity).
  std::vector<Eigen::Quaterniond> standing_from_own;
  std::array<double, 2> ankle_height = {};  // over the ground, of a flat foot; metres
  bool moved = true;                        // false: the rest pose is the standing one as it is
};

// Of a skeleton that stands at rest: turned to face +Z. `soles`: heights of its soles there, left and right;
// if they are not known, on the ground at y = 0 or where the feet are seen to stand.
StandingRotations standing_from_rest(const Skeleton& skeleton, const std::vector<int>& body,
                                     std::span<const SkeletalMotion> seen,
                                     const std::optional<std::array<double, 2>>& soles);

// Of any other, from what was seen of it, on the ground at y = 0. Throws `InvalidArgument` if nothing that
// stands was seen; `what` names the skeleton.
StandingRotations standing_from_motions(const Skeleton& skeleton, const std::vector<int>& body,
                                        std::span<const SkeletalMotion> seen, const std::string& what);

}  // namespace reprise::retargeting
