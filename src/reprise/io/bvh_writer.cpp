// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/bvh.h"

namespace reprise {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
// A site that turns less than this against its joint (radians) is fixed to it.
constexpr double fixed_angle = 1e-6;

// Angles around Z, X, Y in degrees: R = Rz Rx Ry.
using Angles = std::array<double, 3>;

Angles zxy_angles(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d R = rotation.toRotationMatrix();
  const double x = std::asin(std::clamp(R(2, 1), -1.0, 1.0));
  // Where X is a quarter turn, Z and Y turn about one axis: all of it is given to Z.
  constexpr double locked = 1.0 - 1e-12;
  const bool is_locked = std::abs(R(2, 1)) > locked;
  const double z = is_locked ? std::atan2(R(1, 0), R(0, 0)) : std::atan2(-R(0, 1), R(1, 1));
  const double y = is_locked ? 0.0 : std::atan2(-R(2, 0), R(2, 2));
  return {z * degrees_per_radian, x * degrees_per_radian, y * degrees_per_radian};
}

double nearest_turn(double angle, double previous) {
  return angle + 360.0 * std::round((previous - angle) / 360.0);
}

// Of all angles that mean the same rotation those nearest to the last frame's: programs interpolate angles.
Angles continued(const Angles& angles, const Angles& previous) {
  Angles best{};
  double best_distance = std::numeric_limits<double>::infinity();
  for (const Angles& same : {angles, Angles{angles[0] + 180.0, 180.0 - angles[1], angles[2] + 180.0}}) {
    Angles turned{};
    double distance = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      turned[i] = nearest_turn(same[i], previous[i]);
      distance += std::abs(turned[i] - previous[i]);
    }
    if (distance < best_distance) {
      best = turned;
      best_distance = distance;
    }
  }
  return best;
}

// Minus zero and digits below the last one would make equal poses differ in text.
double rounded(double value) {
  const double result = std::round(value * 1e6) / 1e6;
  return result == 0.0 ? 0.0 : result;
}

class BvhFormatter {
 public:
  BvhFormatter(const SkeletalMotion& motion, double metres_per_unit);
  std::string format();

 private:
  const Joint& joint(int idx) const { return motion_.skeleton.joints[static_cast<std::size_t>(idx)]; }
  Eigen::Quaterniond local_rotation(const SkeletonPose& pose, int idx) const;
  bool is_end_site(int idx) const;
  void add_joints(int root);
  void add_line(int depth, const std::string& text);
  void add_offset(int depth, const Eigen::Vector3d& metres);

  const SkeletalMotion& motion_;
  double units_per_metre_;
  std::vector<std::string> names_;
  std::vector<std::vector<int>> children_;
  std::vector<int> order_;  // joints with channels, as they stand in the file
  std::string out_;
};

BvhFormatter::BvhFormatter(const SkeletalMotion& motion, double metres_per_unit)
    : motion_(motion), units_per_metre_(1.0 / metres_per_unit), children_(motion.skeleton.joints.size()) {
  validate(motion.skeleton);
  if (motion.skeleton.joints.empty()) {
    throw InvalidArgument(fmt::format("motion '{}' has no joints", motion.name));
  }
  if (motion.frames.empty()) throw InvalidArgument(fmt::format("motion '{}' has no frames", motion.name));
  if (!(motion.frames_per_second > 0.0) || !std::isfinite(motion.frames_per_second)) {
    throw InvalidArgument(fmt::format("motion '{}': {} frames per second; expected a positive, finite rate",
                                      motion.name, motion.frames_per_second));
  }
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    const SkeletonPose& pose = motion.frames[f];
    bool good = pose.rotation.size() == children_.size() && pose.position.size() == children_.size();
    for (std::size_t j = 0; good && j < children_.size(); ++j) {
      good = pose.position[j].allFinite() && std::abs(pose.rotation[j].squaredNorm() - 1.0) < 1e-6;
    }
    if (!good) {
      throw InvalidArgument(
          fmt::format("motion '{}' frame {}: expected a finite pose of {} joints with unit "
                      "rotations",
                      motion.name, f, children_.size()));
    }
  }
  std::set<std::string> taken;
  for (int j = 0; j < motion.skeleton.size(); ++j) {
    if (joint(j).parent >= 0) children_[static_cast<std::size_t>(joint(j).parent)].push_back(j);
    std::string name = joint(j).name;
    std::ranges::replace_if(
        name, [](unsigned char c) { return c <= ' ' || c == '{' || c == '}' || c == 0x7F; }, '_');
    if (!taken.insert(name).second) {
      throw InvalidArgument(fmt::format("two joints would be called '{}' in a BVH file", name));
    }
    names_.push_back(std::move(name));
  }
}

Eigen::Quaterniond BvhFormatter::local_rotation(const SkeletonPose& pose, int idx) const {
  const int parent = joint(idx).parent;
  const Eigen::Quaterniond& own = pose.rotation[static_cast<std::size_t>(idx)];
  return parent < 0 ? own : pose.rotation[static_cast<std::size_t>(parent)].conjugate() * own;
}

bool BvhFormatter::is_end_site(int idx) const {
  const int parent = joint(idx).parent;
  if (parent < 0 || !children_[static_cast<std::size_t>(idx)].empty() ||
      joint(idx).name != joint(parent).name + "_end") {
    return false;
  }
  return std::ranges::all_of(motion_.frames, [&](const SkeletonPose& pose) {
    return local_rotation(pose, idx).angularDistance(Eigen::Quaterniond::Identity()) < fixed_angle;
  });
}

void BvhFormatter::add_line(int depth, const std::string& text) {
  out_.append(static_cast<std::size_t>(depth), '\t');
  out_ += text;
  out_ += '\n';
}

void BvhFormatter::add_offset(int depth, const Eigen::Vector3d& metres) {
  const Eigen::Vector3d units = units_per_metre_ * metres;
  add_line(depth, fmt::format("OFFSET {:.6f} {:.6f} {:.6f}", rounded(units.x()), rounded(units.y()),
                              rounded(units.z())));
}

// Without recursion: chains may be of any length.
void BvhFormatter::add_joints(int root) {
  struct Open {
    int joint;
    std::size_t next_child;
  };
  std::vector<Open> open;
  const auto begin = [&](int idx) {
    const int depth = static_cast<int>(open.size());
    const bool is_root = joint(idx).parent < 0;
    add_line(depth, (is_root ? "ROOT " : "JOINT ") + names_[static_cast<std::size_t>(idx)]);
    add_line(depth, "{");
    add_offset(depth + 1,
               is_root ? joint(idx).rest_position
                       : Eigen::Vector3d(joint(idx).rest_position - joint(joint(idx).parent).rest_position));
    add_line(depth + 1, is_root ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
                                : "CHANNELS 3 Zrotation Xrotation Yrotation");
    order_.push_back(idx);
    open.push_back({idx, 0});
  };
  const auto add_site = [&](const Eigen::Vector3d& offset) {
    const int depth = static_cast<int>(open.size());
    add_line(depth, "End Site");
    add_line(depth, "{");
    add_offset(depth + 1, offset);
    add_line(depth, "}");
  };
  begin(root);
  while (!open.empty()) {
    const int idx = open.back().joint;
    const std::vector<int>& children = children_[static_cast<std::size_t>(idx)];
    if (open.back().next_child < children.size()) {
      const int child = children[open.back().next_child++];
      if (is_end_site(child)) {
        add_site(joint(child).rest_position - joint(idx).rest_position);
      } else {
        begin(child);
      }
      continue;
    }
    if (children.empty()) {
      constexpr double site_length = 0.05;  // metres: long enough to see and pick
      Eigen::Vector3d along = Eigen::Vector3d::UnitY();
      if (joint(idx).parent >= 0) {
        const Eigen::Vector3d bone = joint(idx).rest_position - joint(joint(idx).parent).rest_position;
        if (bone.norm() > 1e-9) along = bone.normalized();
      }
      add_site(site_length * along);
    }
    open.pop_back();
    add_line(static_cast<int>(open.size()), "}");
  }
}

std::string BvhFormatter::format() {
  out_ = "HIERARCHY\n";
  for (int j = 0; j < motion_.skeleton.size(); ++j) {
    if (joint(j).parent < 0) add_joints(j);
  }
  out_ += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.10f}\n", motion_.frames.size(),
                      1.0 / motion_.frames_per_second);
  std::vector<Angles> previous(motion_.skeleton.joints.size(), Angles{});
  for (const SkeletonPose& pose : motion_.frames) {
    const char* separator = "";
    const auto add = [&](double value) {
      fmt::format_to(std::back_inserter(out_), "{}{:.6f}", separator, rounded(value));
      separator = " ";
    };
    for (const int idx : order_) {
      const auto j = static_cast<std::size_t>(idx);
      if (joint(idx).parent < 0) {
        for (int axis = 0; axis < 3; ++axis) add(units_per_metre_ * pose.position[j][axis]);
      }
      const Angles angles = continued(zxy_angles(local_rotation(pose, idx)), previous[j]);
      for (const double angle : angles) add(angle);
      previous[j] = angles;
    }
    out_ += '\n';
  }
  return std::move(out_);
}

}  // namespace

std::string format_bvh(const SkeletalMotion& motion, const BvhReadOptions& options) {
  if (!(options.metres_per_unit > 0.0) || !std::isfinite(options.metres_per_unit)) {
    throw InvalidArgument(
        fmt::format("{} metres per unit; expected a positive, finite number", options.metres_per_unit));
  }
  return BvhFormatter(motion, options.metres_per_unit).format();
}

void write_bvh(const SkeletalMotion& motion, const std::filesystem::path& path,
               const BvhReadOptions& options) {
  write_text_file(path, format_bvh(motion, options));
}

}  // namespace reprise
