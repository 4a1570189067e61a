// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/joint_map.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/input_file.h"
#include "reprise/retarget/joint_guess.h"
#include "reprise/retarget/joint_tables.h"

namespace reprise {
namespace {

using retargeting::JointTable;

std::string with_side(std::string_view pattern, std::string_view side) {
  std::string name(pattern);
  const std::size_t star = name.find('*');
  return star == std::string::npos ? name : name.replace(star, 1, side);
}

// What counts of a name: programs write one joint "mixamorig:LeftArm", "LeftArm", "left_arm" or
// "DEF-left.arm".
std::string essence(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  for (const std::string_view prefix : {"DEF-", "ORG-"}) {
    if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  }
  std::string result;
  for (const char c : name) {
    if (c != '_' && c != '.' && c != '-' && c != ' ') {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

std::vector<std::string> names_of(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(joint.name);
  return names;
}

std::map<std::string, std::string> match(const JointTable& table, const Skeleton& skeleton) {
  std::map<std::string, std::string> joints;
  std::map<std::string, std::string> name_of_essence;
  for (const Joint& joint : skeleton.joints) name_of_essence.try_emplace(essence(joint.name), joint.name);
  for (const auto& [own, theirs] : table.rows) {
    const std::size_t sides = own.starts_with('*') ? 2 : 1;
    for (std::size_t side = 0; side < sides; ++side) {
      const auto found = name_of_essence.find(essence(with_side(theirs, table.sides[side])));
      if (found == name_of_essence.end()) continue;
      joints.try_emplace(with_side(own, side == 0 ? "left_" : "right_"), found->second);
    }
  }
  return joints;
}

// What retargeting needs and the map does not have; the trunk's end is the head or the chest.
std::vector<std::string> needed(const std::map<std::string, std::string>& joints) {
  std::vector<std::string> lacking;
  for (const std::string& joint : required_body_joints()) {
    if (!joints.contains(joint)) lacking.push_back(joint);
  }
  if (!joints.contains("head") && !joints.contains("chest")) lacking.emplace_back("head or chest");
  return lacking;
}

void describe_rest(JointMap& map, const Skeleton& skeleton) {
  map.missing.clear();
  map.unused.clear();
  for (const std::string& joint : body_joints()) {
    if (!map.joints.contains(joint)) map.missing.push_back(joint);
  }
  std::set<std::string> used;
  for (const auto& [body, theirs] : map.joints) used.insert(theirs);
  for (const Joint& joint : skeleton.joints) {
    // End Sites and ends of chains are no joints that anything could turn.
    if (!used.contains(joint.name) && !joint.name.ends_with("_end")) map.unused.push_back(joint.name);
  }
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw FileError(path, "joint map", what);
}

}  // namespace

const std::vector<std::string>& body_joints() {
  static const std::vector<std::string> joints = [] {
    std::vector<std::string> result = {"pelvis", "spine", "chest", "neck", "head"};
    for (const char* side : {"left_", "right_"}) {
      for (const char* joint : {"collar", "upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toe"}) {
        result.push_back(std::string(side) + joint);
      }
    }
    return result;
  }();
  return joints;
}

const std::vector<std::string>& required_body_joints() {
  static const std::vector<std::string> joints = {
      "pelvis",      "left_upper_arm", "right_upper_arm", "left_forearm", "right_forearm", "left_thigh",
      "right_thigh", "left_shin",      "right_shin",      "left_foot",    "right_foot"};
  return joints;
}

JointMap find_joints(const Skeleton& skeleton, const std::string& what) {
  JointMap best;
  bool is_complete = false;
  for (const JointTable& table : retargeting::joint_tables()) {
    std::map<std::string, std::string> joints = match(table, skeleton);
    const bool complete = needed(joints).empty();
    if (complete < is_complete) continue;
    if (complete == is_complete && joints.size() <= best.joints.size()) continue;
    is_complete = complete;
    best.name = table.name;
    best.joints = std::move(joints);
  }
  if (!is_complete) {
    std::map<std::string, std::string> guessed = retargeting::guess_joints(skeleton);
    is_complete = needed(guessed).empty();
    if (is_complete || guessed.size() > best.joints.size()) {
      best.name = "guessed from the names";
      best.joints = std::move(guessed);
    }
  }
  if (!is_complete) {
    std::vector<std::string> known;
    for (const JointTable& table : retargeting::joint_tables()) known.emplace_back(table.name);
    throw InvalidArgument(
        fmt::format("{}: no joint map fits ({}, a guess from the names): {} also lacks {}; the skeleton's "
                    "joints are: {}. "
                    "Name them in a joint map of your own",
                    what, fmt::join(known, ", "),
                    best.joints.empty() ? std::string("each") : fmt::format("the nearest ({})", best.name),
                    fmt::join(needed(best.joints), ", "), fmt::join(names_of(skeleton), ", ")));
  }
  describe_rest(best, skeleton);
  return best;
}

JointMap parse_joint_map(std::string_view text, const std::filesystem::path& path) {
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw FileError(path, fmt::format("byte {}", error.byte), "is not JSON");
  } catch (const nlohmann::json::exception& error) {  // a number that is too large
    throw FileError(path, fmt::format("is not JSON: {}", error.what()));
  }
  if (!json.is_object() || !json.contains("joints") || !json["joints"].is_object()) {
    fail(path, R"(expected {"joints": {"left_thigh": "NAME", ...}})");
  }
  for (const auto& [key, value] : json.items()) {
    if (key != "joints" && key != "name") {
      fail(path, fmt::format("'{}' is not known: expected 'joints' and perhaps 'name'", key));
    }
  }
  JointMap map;
  map.name = path.filename().string();
  if (json.contains("name")) {
    if (!json["name"].is_string()) fail(path, "'name': expected a text");
    map.name = json["name"].get<std::string>();
  }
  for (const auto& [body, theirs] : json["joints"].items()) {
    if (std::ranges::find(body_joints(), body) == body_joints().end()) {
      const std::string nearest = nearest_word(body.substr(0, 100), body_joints());
      fail(path, fmt::format("'{}' is no body joint{}; they are: {}", body,
                             nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                             fmt::join(body_joints(), ", ")));
    }
    if (!theirs.is_string() || theirs.get<std::string>().empty()) {
      fail(path, fmt::format("'{}': expected the name of a joint", body));
    }
    map.joints[body] = theirs.get<std::string>();
  }
  return map;
}

JointMap read_joint_map(const std::filesystem::path& path) {
  const FileBytes bytes = InputFile(path).read_all();
  return parse_joint_map(bytes.view(), path);
}

JointMap checked(JointMap map, const Skeleton& skeleton, const std::string& what) {
  const std::string which = map.name.empty() ? "the joint map" : fmt::format("the joint map '{}'", map.name);
  std::map<std::string, std::string> body_of;
  for (const auto& [body, theirs] : map.joints) {
    if (std::ranges::find(body_joints(), body) == body_joints().end()) {
      throw InvalidArgument(fmt::format("{} names '{}', which is no body joint; they are: {}", which, body,
                                        fmt::join(body_joints(), ", ")));
    }
    if (!skeleton.find(theirs)) {
      const std::vector<std::string> names = names_of(skeleton);
      const std::string nearest = nearest_word(theirs.substr(0, 100), names);
      throw InvalidArgument(fmt::format(
          "{} gives '{}' for '{}', but {} has no such joint{}; its joints are: {}", which, theirs, body, what,
          nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest), fmt::join(names, ", ")));
    }
    const auto [same, is_new] = body_of.try_emplace(theirs, body);
    if (!is_new) {
      throw InvalidArgument(
          fmt::format("{} gives '{}' for both '{}' and '{}'", which, theirs, same->second, body));
    }
  }
  if (const std::vector<std::string> lacking = needed(map.joints); !lacking.empty()) {
    throw InvalidArgument(fmt::format("{} has no entry for {}; it needs {} and head or chest", which,
                                      fmt::join(lacking, ", "), fmt::join(required_body_joints(), ", ")));
  }
  describe_rest(map, skeleton);
  return map;
}

std::string to_string(const JointMap& map) {
  std::string text =
      fmt::format("{} of {} body joints, {}", map.joints.size(), body_joints().size(), map.name);
  if (!map.missing.empty()) text += fmt::format("; missing: {}", fmt::join(map.missing, ", "));
  if (!map.unused.empty()) text += fmt::format("; not used: {}", fmt::join(map.unused, ", "));
  return text;
}

}  // namespace reprise
