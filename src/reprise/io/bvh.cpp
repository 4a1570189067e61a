// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/io/input_file.h"
#include "reprise/io/text_lines.h"

namespace reprise {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
// Poses are held for every joint, also for one that nothing moves: without a limit a small file could ask for
// any amount of memory. Real skeletons have at most one joint for each channel.
constexpr std::size_t greatest_joints_per_channel = 8;

constexpr std::array<std::string_view, 6> channel_names = {"Xposition", "Yposition", "Zposition",
                                                           "Xrotation", "Yrotation", "Zrotation"};

struct BvhJoint {
  std::string name;  // empty: an End Site
  std::size_t line = 0;
  int parent = -1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  bool has_offset = false;
  bool has_channels = false;
  std::vector<int> channels;  // indices into `channel_names`, in the order of the file
};

class BvhParser {
 public:
  BvhParser(std::string_view text, const std::filesystem::path& path, const BvhReadOptions& options)
      : lines_(text, path),
        metres_per_unit_(options.metres_per_unit),
        frames_per_second_(options.frames_per_second) {}

  SkeletalMotion parse();

 private:
  const std::string_view& word() const { return lines_.words()[at_]; }
  bool at_line_end() const { return at_ == lines_.words().size(); }
  // The next word, on this line or a later one.
  std::string_view take(std::string_view what);
  void expect(std::string_view keyword);
  double take_number(std::string_view what);

  void parse_hierarchy();
  void begin_joint(int parent);
  void begin_end_site(int parent);
  void parse_channels(BvhJoint& joint);
  void name_end_sites();
  double parse_motion_head();
  SkeletonPose parse_frame();

  TextLines lines_;
  std::size_t at_ = 0;  // the next word of the line
  double metres_per_unit_;
  double frames_per_second_;     // 0: the file's
  bool is_first_frame_ = false;  // the line at hand, which is no frame time
  std::vector<BvhJoint> joints_;
  std::map<std::string, std::size_t> line_of_name_;
  std::size_t channel_count_ = 0;
  std::size_t frame_count_ = 0;
};

std::string_view BvhParser::take(std::string_view what) {
  if (at_line_end()) {
    lines_.require_next(what);
    at_ = 0;
  }
  return lines_.words()[at_++];
}

void BvhParser::expect(std::string_view keyword) {
  const std::string_view found = take(fmt::format("'{}'", keyword));
  if (!same_word(found, keyword)) {
    lines_.fail(fmt::format("expected '{}', found {}", keyword, in_quotes(found)));
  }
}

double BvhParser::take_number(std::string_view what) {
  return lines_.number(take(what), what);
}

// The name is the rest of the line: 3ds Max writes "ROOT Bip01 L Thigh".
void BvhParser::begin_joint(int parent) {
  BvhJoint joint;
  joint.line = lines_.line();
  joint.parent = parent;
  for (; !at_line_end() && word() != "{"; ++at_) {
    if (!joint.name.empty()) joint.name += ' ';
    joint.name += word();
  }
  if (joint.name.empty()) lines_.fail("expected the name of a joint, found none");
  const auto [same, is_new] = line_of_name_.try_emplace(joint.name, joint.line);
  if (!is_new) {
    lines_.fail(fmt::format("two joints are called {}: the first is in line {}", in_quotes(joint.name),
                            same->second));
  }
  expect("{");
  joints_.push_back(std::move(joint));
}

void BvhParser::begin_end_site(int parent) {
  expect("Site");
  while (!at_line_end() && word() != "{") ++at_;  // some programs name the site
  expect("{");
  BvhJoint site;
  site.line = lines_.line();
  site.parent = parent;
  site.has_channels = true;
  joints_.push_back(std::move(site));
}

void BvhParser::parse_channels(BvhJoint& joint) {
  if (joint.has_channels) {
    lines_.fail(joint.name.empty() ? "an End Site has no channels" : "the joint has channels already");
  }
  const int count = lines_.count(take("the number of channels"), "the number of channels");
  for (int i = 0; i < count; ++i) {
    const std::string_view name = at_line_end() ? std::string_view("the end of the line") : word();
    const auto found =
        std::ranges::find_if(channel_names, [&](auto known) { return same_word(known, name); });
    if (found == channel_names.end()) {
      lines_.fail(fmt::format("expected {} channels out of {}, found {} and then {}", count,
                              fmt::join(channel_names, ", "), i, in_quotes(name)));
    }
    const int channel = static_cast<int>(found - channel_names.begin());
    if (channel < 3 && std::ranges::find(joint.channels, channel) != joint.channels.end()) {
      lines_.fail(fmt::format("the channel {} stands twice", *found));
    }
    joint.channels.push_back(channel);
    ++at_;
  }
  if (!at_line_end()) {
    lines_.fail(fmt::format("expected {} channels, found more: {}", count, in_quotes(word())));
  }
  joint.has_channels = true;
  channel_count_ += joint.channels.size();
}

void BvhParser::parse_hierarchy() {
  expect("HIERARCHY");
  std::vector<int> open;  // joints whose braces are open
  for (;;) {
    const std::string_view found = take(open.empty() ? "ROOT or MOTION" : "'}'");
    const int parent = open.empty() ? -1 : open.back();
    const bool in_site = parent >= 0 && joints_[static_cast<std::size_t>(parent)].name.empty();
    if (open.empty()) {
      if (same_word(found, "MOTION") && !joints_.empty()) break;
      if (!same_word(found, "ROOT")) {
        lines_.fail(
            fmt::format("expected ROOT{}, found {}", joints_.empty() ? "" : " or MOTION", in_quotes(found)));
      }
      begin_joint(-1);
      open.push_back(static_cast<int>(joints_.size()) - 1);
    } else if (same_word(found, "JOINT") && !in_site) {
      begin_joint(parent);
      open.push_back(static_cast<int>(joints_.size()) - 1);
    } else if (same_word(found, "End") && !in_site) {
      begin_end_site(parent);
      open.push_back(static_cast<int>(joints_.size()) - 1);
    } else if (same_word(found, "OFFSET")) {
      BvhJoint& joint = joints_[static_cast<std::size_t>(parent)];
      if (joint.has_offset) lines_.fail("the joint has an OFFSET already");
      joint.has_offset = true;
      for (int axis = 0; axis < 3; ++axis) joint.offset[axis] = take_number("three numbers after OFFSET");
    } else if (same_word(found, "CHANNELS")) {
      parse_channels(joints_[static_cast<std::size_t>(parent)]);
    } else if (found == "}") {
      const BvhJoint& joint = joints_[static_cast<std::size_t>(parent)];
      if (!joint.has_offset) lines_.fail_at(joint.line, "the joint has no OFFSET");
      if (!joint.has_channels) lines_.fail_at(joint.line, "the joint has no CHANNELS");
      open.pop_back();
    } else {
      lines_.fail(fmt::format("expected {}, found {}",
                              in_site ? "OFFSET or '}'" : "OFFSET, CHANNELS, JOINT, End Site or '}'",
                              in_quotes(found)));
    }
  }
  if (!at_line_end())
    lines_.fail(fmt::format("expected a new line after MOTION, found {}", in_quotes(word())));
  if (joints_.size() > greatest_joints_per_channel * channel_count_) {
    lines_.fail(fmt::format("{} channels cannot move {} joints: expected at least one for every {}",
                            channel_count_, joints_.size(), greatest_joints_per_channel));
  }
  name_end_sites();
}

// After all joints, whose names come first.
void BvhParser::name_end_sites() {
  std::map<std::string, int> next_number;  // of the sites of one joint
  for (BvhJoint& joint : joints_) {
    if (!joint.name.empty()) continue;
    const std::string base = joints_[static_cast<std::size_t>(joint.parent)].name + "_end";
    int& number = next_number.try_emplace(base, 1).first->second;
    do {
      joint.name = number == 1 ? base : fmt::format("{}_{}", base, number);
      ++number;
    } while (!line_of_name_.try_emplace(joint.name, joint.line).second);
  }
}

// The rate of a written frame time. Times are written with few digits: if one frame in n is within the last
// digit's rounding, n is meant.
double rate_of(double frame_time, std::string_view written) {
  const double rate = 1.0 / frame_time;
  const double whole = std::round(rate);
  const std::size_t point = written.find('.');
  const bool plain = written.find_first_of("eE") == std::string_view::npos;
  if (point != std::string_view::npos && plain && whole >= 1.0) {
    const double last_digit = std::pow(10.0, -static_cast<double>(written.size() - point - 1));
    if (std::abs(1.0 / whole - frame_time) <= 0.5000001 * last_digit) return whole;
  }
  return rate;
}

// Returns the frames per second.
double BvhParser::parse_motion_head() {
  lines_.require_next("Frames:");
  // "Frames: 2", or without the space.
  std::string_view first = lines_.words()[0], count;
  constexpr std::string_view keyword = "Frames:";
  if (same_word(first.substr(0, keyword.size()), keyword)) {
    if (first.size() > keyword.size() && lines_.words().size() == 1) count = first.substr(keyword.size());
    if (first.size() == keyword.size() && lines_.words().size() == 2) count = lines_.words()[1];
  }
  if (count.empty()) lines_.fail(fmt::format("expected 'Frames: N', found {}", in_quotes(first)));
  frame_count_ = static_cast<std::size_t>(lines_.count(count, "the number of frames"));
  if (frame_count_ == 0) lines_.fail("expected at least one frame, found 0");
  lines_.require_next("Frame Time:");
  if (frames_per_second_ > 0.0) {
    is_first_frame_ = !same_word(lines_.words()[0], "Frame");
    return frames_per_second_;
  }
  const std::vector<std::string_view>& words = lines_.words();
  std::string_view written;
  constexpr std::string_view time = "Time:";
  if (words.size() >= 2 && same_word(words[0], "Frame") && same_word(words[1].substr(0, time.size()), time)) {
    if (words.size() == 3 && words[1].size() == time.size()) written = words[2];
    if (words.size() == 2) written = words[1].substr(time.size());
  }
  if (written.empty()) {
    lines_.fail(fmt::format("expected 'Frame Time: SECONDS', found {}", in_quotes(words[0])));
  }
  const double frame_time = lines_.number(written, "the time between frames in seconds");
  if (!(frame_time > 0.0) || !std::isfinite(1.0 / frame_time)) {
    lines_.fail(fmt::format("expected a time between frames above 0, found {}", in_quotes(written)));
  }
  return rate_of(frame_time, written);
}

SkeletonPose BvhParser::parse_frame() {
  const std::vector<std::string_view>& words = lines_.words();
  if (words.size() != channel_count_) {
    lines_.fail(fmt::format("expected {} values, one a channel, found {}", channel_count_, words.size()));
  }
  SkeletonPose pose;
  pose.rotation.reserve(joints_.size());
  pose.position.reserve(joints_.size());
  std::size_t next = 0;
  for (const BvhJoint& joint : joints_) {
    Eigen::Vector3d offset = joint.offset;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    for (const int channel : joint.channels) {
      const double value = lines_.number(words[next++], "a number");
      if (channel < 3) {
        offset[channel] = value;
      } else {
        // The first rotation written is the outermost.
        rotation =
            rotation * Eigen::AngleAxisd(value * radians_per_degree, Eigen::Vector3d::Unit(channel - 3));
      }
    }
    offset *= metres_per_unit_;
    if (joint.parent < 0) {
      pose.position.push_back(offset);
      pose.rotation.push_back(rotation.normalized());
    } else {
      const auto p = static_cast<std::size_t>(joint.parent);
      pose.position.emplace_back(pose.position[p] + pose.rotation[p] * offset);
      pose.rotation.push_back((pose.rotation[p] * rotation).normalized());
    }
  }
  return pose;
}

SkeletalMotion BvhParser::parse() {
  parse_hierarchy();
  SkeletalMotion motion;
  for (const BvhJoint& joint : joints_) {
    Eigen::Vector3d position = joint.offset * metres_per_unit_;
    if (joint.parent >= 0) {
      position += motion.skeleton.joints[static_cast<std::size_t>(joint.parent)].rest_position;
    }
    motion.skeleton.joints.push_back({joint.name, joint.parent, position});
  }
  motion.frames_per_second = parse_motion_head();
  const std::size_t head_line = lines_.line();
  while (is_first_frame_ || lines_.next()) {
    is_first_frame_ = false;
    if (motion.frames.size() == frame_count_) {
      lines_.fail(
          fmt::format("expected the end of the file after {} frames, found another line", frame_count_));
    }
    motion.frames.push_back(parse_frame());
  }
  if (motion.frames.size() < frame_count_) {
    lines_.fail(fmt::format("is truncated: expected {} frames after line {}, found {}", frame_count_,
                            head_line, motion.frames.size()));
  }
  return motion;
}

}  // namespace

SkeletalMotion parse_bvh(std::string_view text, const std::filesystem::path& path,
                         const BvhReadOptions& options) {
  if (!(options.metres_per_unit > 0.0) || !std::isfinite(options.metres_per_unit)) {
    throw InvalidArgument(
        fmt::format("{} metres per unit; expected a positive, finite number", options.metres_per_unit));
  }
  if (!(options.frames_per_second >= 0.0) || !std::isfinite(options.frames_per_second)) {
    throw InvalidArgument(
        fmt::format("{} frames per second; expected a positive, finite number", options.frames_per_second));
  }
  SkeletalMotion motion = BvhParser(text, path, options).parse();
  motion.name = path.stem().string();
  return motion;
}

SkeletalMotion read_bvh(const std::filesystem::path& path, const BvhReadOptions& options) {
  const FileBytes bytes = InputFile(path).read_all();
  return parse_bvh(bytes.view(), path, options);
}

}  // namespace reprise
