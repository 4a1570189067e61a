// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/acclaim_skeleton.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/text_lines.h"

namespace reprise {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

// "XYZ": turned around X first, so Z stands outermost.
Eigen::Quaterniond from_euler(const Eigen::Vector3d& angles, const std::array<int, 3>& order) {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (const int axis : order) {
    rotation = Eigen::AngleAxisd(angles[axis], Eigen::Vector3d::Unit(axis)) * rotation;
  }
  return rotation.normalized();
}

// A bone as it is written, before the hierarchy gives it a parent.
struct WrittenBone {
  std::size_t line = 0;
  std::string name;
  std::optional<Eigen::Vector3d> direction;
  std::optional<double> length;
  Eigen::Vector3d axis_angles = Eigen::Vector3d::Zero();
  std::array<int, 3> axis_order = {0, 1, 2};
  std::vector<int> freedoms;
  int parent = -1;  // index among the written bones; 0 is the root
  std::vector<int> children;
};

class AsfParser {
 public:
  AsfParser(std::string_view text, const std::filesystem::path& path) : lines_(text, path, '#') {
    bones_.resize(1);
    bones_[0].name = "root";
    bones_[0].freedoms = {3, 4, 5, 0, 1, 2};
    idx_of_name_["root"] = 0;
  }

  AcclaimSkeleton parse();

 private:
  // Reads lines until one that starts with ':'; false at the end of the file.
  bool next_line();
  std::string_view word(std::size_t i) const { return lines_.words()[i]; }
  std::size_t word_count() const { return lines_.words().size(); }
  void expect_words(std::size_t count, std::string_view what) const;
  Eigen::Vector3d vector(std::string_view what) const;
  std::array<int, 3> axis_order(std::string_view written) const;
  void parse_units();
  void parse_root();
  void parse_freedoms(WrittenBone& bone, bool is_root) const;
  void parse_bones();
  WrittenBone parse_bone();
  void parse_hierarchy();
  int bone_idx(std::string_view name) const;
  AcclaimSkeleton in_order() const;

  TextLines lines_;
  bool more_ = true;
  double radians_per_unit_ = radians_per_degree;
  Eigen::Vector3d root_position_ = Eigen::Vector3d::Zero();
  std::vector<WrittenBone> bones_;
  std::map<std::string, int, std::less<>> idx_of_name_;
  bool has_bones_ = false;
  bool has_hierarchy_ = false;
};

bool AsfParser::next_line() {
  more_ = lines_.next();
  return more_ && !word(0).starts_with(':');
}

void AsfParser::expect_words(std::size_t count, std::string_view what) const {
  if (word_count() != count) {
    lines_.fail(fmt::format("expected {}, found {} {} after '{}'", what, word_count() - 1,
                            word_count() == 2 ? "word" : "words", word(0)));
  }
}

Eigen::Vector3d AsfParser::vector(std::string_view what) const {
  if (word_count() < 4) {
    lines_.fail(fmt::format("expected {}, found {} {} after '{}'", what, word_count() - 1,
                            word_count() == 2 ? "word" : "words", word(0)));
  }
  return {lines_.number(word(1), what), lines_.number(word(2), what), lines_.number(word(3), what)};
}

std::array<int, 3> AsfParser::axis_order(std::string_view written) const {
  std::array<int, 3> order{};
  unsigned seen = 0;
  for (std::size_t i = 0; i < written.size() && i < 3; ++i) {
    const char letter = written[i];
    order[i] = letter >= 'x' ? letter - 'x' : letter - 'X';
    if (order[i] >= 0 && order[i] < 3) seen |= 1U << static_cast<unsigned>(order[i]);
  }
  if (written.size() != 3 || seen != 7U) {
    lines_.fail(fmt::format("expected an order of axes such as XYZ, found {}", in_quotes(written)));
  }
  return order;
}

void AsfParser::parse_units() {
  while (next_line()) {
    if (!same_word(word(0), "angle")) continue;
    expect_words(2, "'angle deg' or 'angle rad'");
    if (same_word(word(1), "deg")) {
      radians_per_unit_ = radians_per_degree;
    } else if (same_word(word(1), "rad")) {
      radians_per_unit_ = 1.0;
    } else {
      lines_.fail(fmt::format("expected 'angle deg' or 'angle rad', found {}", in_quotes(word(1))));
    }
  }
}

void AsfParser::parse_freedoms(WrittenBone& bone, bool is_root) const {
  constexpr std::array<std::string_view, 6> names = {"rx", "ry", "rz", "tx", "ty", "tz"};
  bone.freedoms.clear();
  for (std::size_t i = 1; i < word_count(); ++i) {
    const auto found = std::ranges::find_if(names, [&](auto name) { return same_word(name, word(i)); });
    const int freedom = static_cast<int>(found - names.begin());
    if (found == names.end() || (freedom >= 3 && !is_root)) {
      lines_.fail(fmt::format("expected degrees of freedom out of {}, found {}",
                              is_root ? "TX TY TZ RX RY RZ" : "rx ry rz (bones neither move nor stretch)",
                              in_quotes(word(i))));
    }
    if (std::ranges::find(bone.freedoms, freedom) != bone.freedoms.end()) {
      lines_.fail(fmt::format("the degree of freedom {} stands twice", *found));
    }
    bone.freedoms.push_back(freedom);
  }
}

void AsfParser::parse_root() {
  WrittenBone& root = bones_[0];
  while (next_line()) {
    if (same_word(word(0), "order")) {
      parse_freedoms(root, true);
    } else if (same_word(word(0), "axis")) {
      expect_words(2, "an order of axes such as XYZ");
      root.axis_order = axis_order(word(1));
    } else if (same_word(word(0), "position")) {
      root_position_ = vector("three numbers");
    } else if (same_word(word(0), "orientation")) {
      root.axis_angles = vector("three angles");
    }
  }
}

WrittenBone AsfParser::parse_bone() {
  WrittenBone bone;
  bone.line = lines_.line();
  for (;;) {
    lines_.require_next("'end' of the bone");
    const std::string_view keyword = word(0);
    if (keyword.starts_with(':') || same_word(keyword, "begin")) {
      lines_.fail(
          fmt::format("expected 'end' of the bone of line {}, found {}", bone.line, in_quotes(keyword)));
    } else if (same_word(keyword, "end")) {
      break;
    } else if (same_word(keyword, "name")) {
      expect_words(2, "the name of a bone");
      bone.name = word(1);
    } else if (same_word(keyword, "direction")) {
      bone.direction = vector("three numbers");
    } else if (same_word(keyword, "length")) {
      expect_words(2, "a length");
      bone.length = lines_.number(word(1), "a length");
    } else if (same_word(keyword, "axis")) {
      bone.axis_angles = vector("three angles and an order of axes");
      expect_words(5, "three angles and an order of axes");
      bone.axis_order = axis_order(word(4));
    } else if (same_word(keyword, "dof")) {
      parse_freedoms(bone, false);
    }
    // Left over: id, bodymass, cofmass and limits, of which the second and later lines are bare pairs.
  }
  if (bone.name.empty()) lines_.fail_at(bone.line, "the bone has no name");
  if (!bone.direction) lines_.fail_at(bone.line, fmt::format("bone '{}' has no direction", bone.name));
  if (!bone.length) lines_.fail_at(bone.line, fmt::format("bone '{}' has no length", bone.name));
  return bone;
}

void AsfParser::parse_bones() {
  has_bones_ = true;
  while (next_line()) {
    if (!same_word(word(0), "begin")) {
      lines_.fail(fmt::format("expected 'begin' of a bone, found {}", in_quotes(word(0))));
    }
    WrittenBone bone = parse_bone();
    const auto [same, is_new] = idx_of_name_.try_emplace(bone.name, static_cast<int>(bones_.size()));
    if (!is_new) {
      lines_.fail_at(bone.line,
                     same->second == 0
                         ? std::string("a bone cannot be called 'root'")
                         : fmt::format("two bones are called '{}': the first is in "
                                       "line {}",
                                       bone.name, bones_[static_cast<std::size_t>(same->second)].line));
    }
    bones_.push_back(std::move(bone));
  }
}

int AsfParser::bone_idx(std::string_view name) const {
  const auto found = idx_of_name_.find(name);
  if (found != idx_of_name_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, idx] : idx_of_name_) names.push_back(known);
  const std::string nearest = nearest_word(name.substr(0, 100), names);
  lines_.fail(fmt::format("there is no bone {}{}", in_quotes(name),
                          nearest.empty() ? "" : fmt::format(": did you mean '{}'?", nearest)));
}

void AsfParser::parse_hierarchy() {
  if (!has_bones_) lines_.fail("':hierarchy' before any ':bonedata'");
  has_hierarchy_ = true;
  bool is_open = false;
  while (next_line()) {
    if (same_word(word(0), "begin")) {
      is_open = true;
    } else if (same_word(word(0), "end")) {
      is_open = false;
    } else {
      const int parent = bone_idx(word(0));
      for (std::size_t i = 1; i < word_count(); ++i) {
        const int child = bone_idx(word(i));
        WrittenBone& bone = bones_[static_cast<std::size_t>(child)];
        if (child == 0) lines_.fail("the root cannot have a parent");
        if (bone.parent >= 0) lines_.fail(fmt::format("bone '{}' has a parent already", bone.name));
        bone.parent = parent;
        bones_[static_cast<std::size_t>(parent)].children.push_back(child);
      }
    }
  }
  if (is_open) lines_.fail("is truncated: expected 'end' of the hierarchy");
}

// Depth first from the root, children in the order of the hierarchy.
AcclaimSkeleton AsfParser::in_order() const {
  AcclaimSkeleton skeleton;
  skeleton.root_position = root_position_;
  struct Next {
    int bone;
    int parent;
  };
  std::vector<Next> open = {{0, -1}};
  std::vector<bool> reached(bones_.size());
  while (!open.empty()) {
    const Next next = open.back();
    open.pop_back();
    const WrittenBone& bone = bones_[static_cast<std::size_t>(next.bone)];
    reached[static_cast<std::size_t>(next.bone)] = true;
    const int idx = static_cast<int>(skeleton.bones.size());
    AcclaimBone& made = skeleton.bones.emplace_back();
    made.name = bone.name;
    made.parent = next.parent;
    if (bone.direction) {
      // Directions are unit vectors up to their rounding. A zero one is that of a bone without length.
      const double norm = bone.direction->norm();
      made.offset = norm > 0.0 ? Eigen::Vector3d(*bone.direction * (*bone.length / norm)) : made.offset;
    }
    made.axis = from_euler(radians_per_unit_ * bone.axis_angles, bone.axis_order);
    made.freedoms = bone.freedoms;
    for (auto child = bone.children.rbegin(); child != bone.children.rend(); ++child) {
      open.push_back({*child, idx});
    }
  }
  for (std::size_t i = 0; i < bones_.size(); ++i) {
    if (!reached[i]) {
      lines_.fail_at(bones_[i].line,
                     fmt::format("bone '{}' does not hang on the root in ':hierarchy'", bones_[i].name));
    }
  }
  return skeleton;
}

AcclaimSkeleton AsfParser::parse() {
  while (next_line()) {
    lines_.fail(
        fmt::format("is not an ASF file: expected a section such as ':units', found {}", in_quotes(word(0))));
  }
  while (more_) {
    const std::string section(word(0));
    if (same_word(section, ":units")) {
      parse_units();
    } else if (same_word(section, ":root")) {
      parse_root();
    } else if (same_word(section, ":bonedata")) {
      parse_bones();
    } else if (same_word(section, ":hierarchy")) {
      parse_hierarchy();
    } else {
      while (next_line()) {
      }
    }
  }
  if (!has_bones_) throw FileError(lines_.path(), "is not an ASF file, or truncated: it has no ':bonedata'");
  if (!has_hierarchy_) throw FileError(lines_.path(), "is truncated: it has no ':hierarchy'");
  return in_order();
}

}  // namespace

AcclaimSkeleton parse_asf(std::string_view text, const std::filesystem::path& path) {
  return AsfParser(text, path).parse();
}

}  // namespace reprise
