// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/retarget_map.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/io/text_lines.h"

namespace reprise::retargeting {
namespace {

constexpr std::array<std::string_view, 13> required_joints = {
    "pelvis",       "chest",         "head",       "left_upper_arm", "right_upper_arm",
    "left_forearm", "right_forearm", "left_thigh", "right_thigh",    "left_shin",
    "right_shin",   "left_foot",     "right_foot"};

// '*' stands for the side: "left_" and "right_" on the performer's side of a row, `sides` on the motion's.
// A joint may stand in several rows: the first name that the motion has counts.
struct BuiltInMap {
  std::string_view name;
  std::array<std::string_view, 2> sides;
  std::vector<std::array<std::string_view, 2>> rows;
};

const std::vector<BuiltInMap>& built_in_maps() {
  static const std::vector<BuiltInMap> maps = {{"CMU (ASF/AMC)",
                                                {"l", "r"},
                                                {{"pelvis", "root"},
                                                 {"spine", "upperback"},
                                                 {"chest", "thorax"},
                                                 {"neck", "lowerneck"},
                                                 {"head", "head"},
                                                 {"*collar", "*clavicle"},
                                                 {"*upper_arm", "*humerus"},
                                                 {"*forearm", "*radius"},
                                                 {"*hand", "*hand"},
                                                 {"*thigh", "*femur"},
                                                 {"*shin", "*tibia"},
                                                 {"*foot", "*foot"},
                                                 {"*toe", "*toes"}}},
                                               {"CMU (BVH)",
                                                {"Left", "Right"},
                                                {{"pelvis", "Hips"},
                                                 {"spine", "Spine"},
                                                 {"chest", "Spine1"},
                                                 {"neck", "Neck"},
                                                 {"head", "Head"},
                                                 {"*collar", "*Shoulder"},
                                                 {"*upper_arm", "*Arm"},
                                                 {"*forearm", "*ForeArm"},
                                                 {"*hand", "*FingerBase"},
                                                 {"*thigh", "*UpLeg"},
                                                 {"*shin", "*Leg"},
                                                 {"*foot", "*Foot"},
                                                 {"*toe", "*ToeBase"}}},
                                               {"Mixamo and MotionBuilder",
                                                {"Left", "Right"},
                                                {{"pelvis", "Hips"},
                                                 {"spine", "Spine"},
                                                 {"chest", "Spine2"},
                                                 {"chest", "Spine1"},
                                                 {"neck", "Neck"},
                                                 {"head", "Head"},
                                                 {"*collar", "*Shoulder"},
                                                 {"*upper_arm", "*Arm"},
                                                 {"*forearm", "*ForeArm"},
                                                 {"*hand", "*Hand"},
                                                 {"*thigh", "*UpLeg"},
                                                 {"*shin", "*Leg"},
                                                 {"*foot", "*Foot"},
                                                 {"*toe", "*ToeBase"},
                                                 {"*toe", "*Toe"},
                                                 {"*toe", "*Foot_end"}}},
                                               {"Daz (cgspeed BVH)",
                                                {"l", "r"},
                                                {{"pelvis", "hip"},
                                                 {"spine", "abdomen"},
                                                 {"chest", "chest"},
                                                 {"neck", "neck"},
                                                 {"head", "head"},
                                                 {"*collar", "*Collar"},
                                                 {"*upper_arm", "*Shldr"},
                                                 {"*forearm", "*ForeArm"},
                                                 {"*hand", "*Hand"},
                                                 {"*thigh", "*Thigh"},
                                                 {"*shin", "*Shin"},
                                                 {"*foot", "*Foot"},
                                                 {"*toe", "*Toe"},
                                                 {"*toe", "*Foot_end"}}},
                                               {"the performer's own names",
                                                {"left_", "right_"},
                                                {{"pelvis", "pelvis"},
                                                 {"spine", "spine"},
                                                 {"chest", "chest"},
                                                 {"neck", "neck"},
                                                 {"head", "head"},
                                                 {"*collar", "*collar"},
                                                 {"*upper_arm", "*upper_arm"},
                                                 {"*forearm", "*forearm"},
                                                 {"*hand", "*hand"},
                                                 {"*thigh", "*thigh"},
                                                 {"*shin", "*shin"},
                                                 {"*foot", "*foot"},
                                                 {"*toe", "*toe"}}}};
  return maps;
}

std::string with_side(std::string_view pattern, std::string_view side) {
  std::string name(pattern);
  const std::size_t star = name.find('*');
  return star == std::string::npos ? name : name.replace(star, 1, side);
}

std::string_view without_prefix(std::string_view name) {
  return name.substr(name.rfind(':') + 1);  // npos + 1 = 0
}

struct Match {
  std::vector<int> joints;
  int count = 0;
  std::vector<std::string> missing;  // required names of the motion
};

Match match(const BuiltInMap& map, const Skeleton& performer, const Skeleton& source) {
  const auto find = [&](const std::string& wanted) {
    const auto found = std::ranges::find_if(
        source.joints, [&](const Joint& joint) { return same_word(without_prefix(joint.name), wanted); });
    return found == source.joints.end() ? -1 : static_cast<int>(found - source.joints.begin());
  };
  Match result;
  result.joints.assign(performer.joints.size(), -1);
  std::map<std::string, std::string> missing;
  for (const auto& [own, theirs] : map.rows) {
    constexpr std::array<std::string_view, 2> own_sides = {"left_", "right_"};
    const std::size_t sides = own.starts_with('*') ? 2 : 1;
    for (std::size_t side = 0; side < sides; ++side) {
      const std::string name = with_side(own, own_sides[side]);
      const std::optional<int> idx = performer.find(name);
      if (!idx) continue;
      int& joint = result.joints[static_cast<std::size_t>(*idx)];
      if (joint >= 0) continue;
      const std::string wanted = with_side(theirs, map.sides[side]);
      joint = find(wanted);
      if (joint >= 0) {
        ++result.count;
        missing.erase(name);
      } else if (std::ranges::find(required_joints, name) != required_joints.end()) {
        missing.try_emplace(name, wanted);
      }
    }
  }
  for (const auto& [own, theirs] : missing) result.missing.push_back(theirs);
  return result;
}

std::vector<int> built_in(const Skeleton& performer, const SkeletalMotion& motion) {
  std::optional<Match> best;
  std::optional<Match> nearest;
  const BuiltInMap* nearest_map = nullptr;
  for (const BuiltInMap& map : built_in_maps()) {
    Match found = match(map, performer, motion.skeleton);
    if (!nearest || found.count > nearest->count) {
      nearest = found;
      nearest_map = &map;
    }
    if (found.missing.empty() && (!best || found.count > best->count)) best = std::move(found);
  }
  if (best) return best->joints;
  std::vector<std::string> known, there;
  for (const BuiltInMap& map : built_in_maps()) known.emplace_back(map.name);
  for (const Joint& joint : motion.skeleton.joints) there.push_back(joint.name);
  throw InvalidArgument(
      fmt::format("no built-in joint map ({}) fits motion '{}': the nearest, {}, also needs {}; the motion's "
                  "joints are: {}",
                  fmt::join(known, ", "), motion.name, nearest_map->name, fmt::join(nearest->missing, ", "),
                  fmt::join(there, ", ")));
}

}  // namespace

std::vector<int> map_joints(const Skeleton& performer, const SkeletalMotion& motion,
                            const std::map<std::string, std::string>& joint_map) {
  if (joint_map.empty()) return built_in(performer, motion);
  std::vector<int> joints(performer.joints.size(), -1);
  for (const auto& [own, theirs] : joint_map) {
    const int idx = performer.joint_idx(own);
    if (!motion.skeleton.find(theirs)) {
      std::vector<std::string> there;
      for (const Joint& joint : motion.skeleton.joints) there.push_back(joint.name);
      throw InvalidArgument(
          fmt::format("the joint map gives '{}' for '{}', but motion '{}' has no such joint; "
                      "its joints are: {}",
                      theirs, own, motion.name, fmt::join(there, ", ")));
    }
    joints[static_cast<std::size_t>(idx)] = motion.skeleton.joint_idx(theirs);
  }
  for (const std::string_view name : required_joints) {
    if (joints[static_cast<std::size_t>(performer.joint_idx(std::string(name)))] < 0) {
      throw InvalidArgument(fmt::format("the joint map has no entry for '{}'; it needs {}", name,
                                        fmt::join(required_joints, ", ")));
    }
  }
  return joints;
}

}  // namespace reprise::retargeting
