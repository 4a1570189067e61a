// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/acclaim.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/acclaim_skeleton.h"
#include "reprise/io/input_file.h"
#include "reprise/io/text_lines.h"

namespace reprise {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
// As in a BVH file: poses are held for bones that nothing moves, too.
constexpr std::size_t greatest_bones_per_freedom = 8;

class AmcParser {
 public:
  AmcParser(std::string_view text, const std::filesystem::path& path, const AcclaimSkeleton& skeleton,
            const AcclaimReadOptions& options);

  SkeletalMotion parse();

 private:
  void make_joints();
  bool parse_head();
  void parse_bone();
  void end_frame(int frame, std::size_t line, bool is_last);
  SkeletonPose pose() const;

  TextLines lines_;
  const AcclaimSkeleton& skeleton_;
  double metres_per_unit_;
  double radians_per_unit_ = 1.0;
  std::map<std::string, std::size_t, std::less<>> idx_of_name_;
  std::vector<int> joint_parents_;  // of the NAME_end joints, which follow the bones'
  SkeletalMotion motion_;
  std::int64_t next_frame_ = 0;
  // Of the frame being read.
  std::vector<Eigen::Quaterniond> turn_;  // of each bone against its parent, in world axes at rest
  std::vector<bool> is_given_;
  Eigen::Vector3d root_translation_ = Eigen::Vector3d::Zero();
};

AmcParser::AmcParser(std::string_view text, const std::filesystem::path& path,
                     const AcclaimSkeleton& skeleton, const AcclaimReadOptions& options)
    : lines_(text, path, '#'), skeleton_(skeleton), metres_per_unit_(options.metres_per_unit) {
  std::size_t freedoms = 0;
  for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
    idx_of_name_[skeleton.bones[b].name] = b;
    freedoms += skeleton.bones[b].freedoms.size();
  }
  if (skeleton.bones.size() > greatest_bones_per_freedom * freedoms) {
    throw FileError(path, fmt::format("{} degrees of freedom cannot move {} bones: expected at least one for "
                                      "every {}",
                                      freedoms, skeleton.bones.size(), greatest_bones_per_freedom));
  }
  motion_.name = path.stem().string();
  motion_.frames_per_second = options.frames_per_second;
  turn_.assign(skeleton.bones.size(), Eigen::Quaterniond::Identity());
  is_given_.assign(skeleton.bones.size(), false);
  make_joints();
}

// A joint where each bone begins, and one where a chain ends.
void AmcParser::make_joints() {
  std::vector<Joint>& joints = motion_.skeleton.joints;
  std::vector<bool> is_leaf(skeleton_.bones.size(), true);
  for (const AcclaimBone& bone : skeleton_.bones) {
    if (bone.parent < 0) {
      joints.push_back({bone.name, -1, metres_per_unit_ * skeleton_.root_position});
    } else {
      const auto p = static_cast<std::size_t>(bone.parent);
      is_leaf[p] = false;
      joints.push_back(
          {bone.name, bone.parent, joints[p].rest_position + metres_per_unit_ * skeleton_.bones[p].offset});
    }
  }
  for (std::size_t b = 1; b < skeleton_.bones.size(); ++b) {
    if (!is_leaf[b]) continue;
    std::string name = skeleton_.bones[b].name + "_end";
    while (idx_of_name_.contains(name)) name += "_2";  // a bone may have this name
    joints.push_back(
        {name, static_cast<int>(b), joints[b].rest_position + metres_per_unit_ * skeleton_.bones[b].offset});
    joint_parents_.push_back(static_cast<int>(b));
  }
}

// Up to the first frame number. False at the end of the file.
bool AmcParser::parse_head() {
  bool has_unit = false;
  while (lines_.next()) {
    const std::string_view word = lines_.words()[0];
    if (!word.starts_with(':')) {
      if (!has_unit) lines_.fail(fmt::format("expected ':DEGREES' or ':RADIANS' before {}", in_quotes(word)));
      return true;
    }
    if (same_word(word, ":DEGREES") || same_word(word, ":RADIANS")) {
      radians_per_unit_ = same_word(word, ":DEGREES") ? radians_per_degree : 1.0;
      has_unit = true;
    }
  }
  return false;
}

void AmcParser::parse_bone() {
  const std::vector<std::string_view>& words = lines_.words();
  const auto found = idx_of_name_.find(words[0]);
  if (found == idx_of_name_.end()) {
    std::vector<std::string> names;
    for (const auto& [known, idx] : idx_of_name_) names.push_back(known);
    const std::string nearest = nearest_word(words[0].substr(0, 100), names);
    lines_.fail(fmt::format("the skeleton has no bone {}{}", in_quotes(words[0]),
                            nearest.empty() ? "" : fmt::format(": did you mean '{}'?", nearest)));
  }
  const std::size_t b = found->second;
  const AcclaimBone& bone = skeleton_.bones[b];
  if (words.size() - 1 != bone.freedoms.size()) {
    lines_.fail(fmt::format("expected {} values of bone '{}', found {}", bone.freedoms.size(), bone.name,
                            words.size() - 1));
  }
  if (is_given_[b]) lines_.fail(fmt::format("bone '{}' stands twice in the frame", bone.name));
  is_given_[b] = true;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < bone.freedoms.size(); ++i) {
    const double value = lines_.number(words[i + 1], "a number");
    if (bone.freedoms[i] >= 3) {
      root_translation_[bone.freedoms[i] - 3] = value;
    } else {
      // The first angle turns first, so it stands innermost.
      turn = Eigen::AngleAxisd(value * radians_per_unit_, Eigen::Vector3d::Unit(bone.freedoms[i])) * turn;
    }
  }
  turn_[b] = (bone.axis * turn * bone.axis.conjugate()).normalized();
}

SkeletonPose AmcParser::pose() const {
  SkeletonPose pose;
  pose.rotation.reserve(motion_.skeleton.joints.size());
  pose.position.reserve(motion_.skeleton.joints.size());
  for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
    const int parent = skeleton_.bones[b].parent;
    if (parent < 0) {
      pose.rotation.push_back(turn_[b]);
      pose.position.emplace_back(metres_per_unit_ * (skeleton_.root_position + root_translation_));
    } else {
      const auto p = static_cast<std::size_t>(parent);
      pose.rotation.push_back((pose.rotation[p] * turn_[b]).normalized());
      pose.position.emplace_back(pose.position[p] +
                                 pose.rotation[p] * (metres_per_unit_ * skeleton_.bones[p].offset));
    }
  }
  for (const int parent : joint_parents_) {
    const auto p = static_cast<std::size_t>(parent);
    pose.rotation.push_back(pose.rotation[p]);
    pose.position.emplace_back(pose.position[p] +
                               pose.rotation[p] * (metres_per_unit_ * skeleton_.bones[p].offset));
  }
  return pose;
}

void AmcParser::end_frame(int frame, std::size_t line, bool is_last) {
  for (std::size_t b = 0; b < is_given_.size(); ++b) {
    if (!is_given_[b] && !skeleton_.bones[b].freedoms.empty()) {
      lines_.fail_at(line,
                     fmt::format("frame {} has no values of bone '{}'{}", frame, skeleton_.bones[b].name,
                                 is_last ? "; the file ends there: it is truncated" : ""));
    }
  }
  motion_.frames.push_back(pose());
  is_given_.assign(is_given_.size(), false);
}

SkeletalMotion AmcParser::parse() {
  if (!parse_head())
    throw FileError(lines_.path(), "is truncated: expected a frame, found the end of the file");
  for (bool more = true; more;) {
    if (lines_.words().size() != 1) {
      lines_.fail(fmt::format("expected the number of a frame, found {}", in_quotes(lines_.words()[0])));
    }
    const int frame = lines_.count(lines_.words()[0], "the number of a frame");
    const std::size_t line = lines_.line();
    if (!motion_.frames.empty() && frame != next_frame_) {
      lines_.fail(fmt::format("expected frame {}, found {}", next_frame_, frame));
    }
    next_frame_ = std::int64_t{frame} + 1;
    const auto is_number = [](std::string_view word) { return word[0] >= '0' && word[0] <= '9'; };
    while ((more = lines_.next()) && !is_number(lines_.words()[0])) parse_bone();
    end_frame(frame, line, !more);
  }
  return std::move(motion_);
}

}  // namespace

SkeletalMotion parse_amc(std::string_view text, const std::filesystem::path& path,
                         const AcclaimSkeleton& skeleton, const AcclaimReadOptions& options) {
  const auto check = [](double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw InvalidArgument(fmt::format("{} {}; expected a positive, finite number", value, what));
    }
  };
  check(options.frames_per_second, "frames per second");
  check(options.metres_per_unit, "metres per unit");
  return AmcParser(text, path, skeleton, options).parse();
}

SkeletalMotion read_acclaim(const std::filesystem::path& skeleton_asf,
                            const std::filesystem::path& motion_amc, const AcclaimReadOptions& options) {
  const FileBytes skeleton = InputFile(skeleton_asf).read_all();
  const FileBytes motion = InputFile(motion_amc).read_all();
  return parse_amc(motion.view(), motion_amc, parse_asf(skeleton.view(), skeleton_asf), options);
}

}  // namespace reprise
