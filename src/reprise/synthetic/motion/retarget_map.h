// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which joint of a motion drives which joint of the performer.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "reprise/sequence/skeleton.h"

namespace reprise::retargeting {

// For each joint of the performer the motion's joint, or -1: it follows its neighbours. Pelvis, chest, head,
// upper arms, forearms, thighs, shins and feet have one. `joint_map`: performer's joint -> motion's joint;
// empty: the built-in map with the most joints of those that fit. Built-in names are compared without case
// and without a prefix that ends in ':'. Throws `InvalidArgument`, see `retarget()`.
std::vector<int> map_joints(const Skeleton& performer, const SkeletalMotion& motion,
                            const std::map<std::string, std::string>& joint_map);

}  // namespace reprise::retargeting
