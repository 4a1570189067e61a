// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which joints of a skeleton are those of a person's body.

#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "reprise/sequence/skeleton.h"

namespace reprise {

// The joints of a body, parents before children: pelvis, spine, chest, neck, head and for left_ and right_
// collar, upper_arm, forearm, hand, thigh, shin, foot, toe.
const std::vector<std::string>& body_joints();

// What retargeting cannot do without: pelvis, upper arms, forearms, thighs, shins, feet. Of head and chest it
// needs one, too.
const std::vector<std::string>& required_body_joints();

struct JointMap {
  std::string name;  // "CMU (ASF/AMC)", "Mixamo", ..., "guessed from the names", or a file
  std::map<std::string, std::string> joints;  // body joint -> joint of the skeleton
  std::vector<std::string> missing;           // body joints that the skeleton does not have
  std::vector<std::string> unused;  // joints of the skeleton that stand for none (End Sites left out)
};

// The built-in map that fits with the most joints (CMU's ASF/AMC and BVH, cgspeed and Daz, Mixamo,
// MotionBuilder, Blender's, Unity's, Unreal's, Biped's, Biovision's, SMPL's, the performer's own); if none
// has what is required, a guess from the words in the names and from sides and order in the tree. Prefixes up
// to
// ':', case, and '_', '.', '-' and spaces do not count. Throws `InvalidArgument` if too few joints are found
// (says which, and lists what is there). `what`: names the skeleton in messages.
JointMap find_joints(const Skeleton& skeleton, const std::string& what);

// A user's map: {"joints": {"left_thigh": "LThigh", ...}}. Throws `FileError` for what is not such JSON and
// for names that are no body joints (offers the nearest).
JointMap read_joint_map(const std::filesystem::path& path);
// The same of a text; `path` is named in errors and, without a "name" in the text, names the map.
JointMap parse_joint_map(std::string_view text, const std::filesystem::path& path);
// Throws `InvalidArgument` if the map names joints the skeleton does not have (lists what is there) or lacks
// what is required. Returns it with `missing` and `unused`.
JointMap checked(JointMap map, const Skeleton& skeleton, const std::string& what);

// "21 of 21 body joints, CMU (ASF/AMC); not used: lhipjoint, ...": what a report says.
std::string to_string(const JointMap& map);

}  // namespace reprise
