// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/standing_figure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/retarget/standing_rotations.h"

namespace reprise {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

std::string parent_of(const std::string& body_joint) {
  static const std::map<std::string, std::string> parents = {
      {"spine", "pelvis"}, {"chest", "spine"},       {"neck", "chest"},         {"head", "neck"},
      {"collar", "chest"}, {"upper_arm", "*collar"}, {"forearm", "*upper_arm"}, {"hand", "*forearm"},
      {"thigh", "pelvis"}, {"shin", "*thigh"},       {"foot", "*shin"},         {"toe", "*foot"}};
  if (body_joint == "pelvis") return {};
  const bool left = body_joint.starts_with("left_"), right = body_joint.starts_with("right_");
  const std::string side = left ? "left_" : (right ? "right_" : "");
  const std::string& parent = parents.at(body_joint.substr(side.size()));
  return parent.starts_with('*') ? side + parent.substr(1) : parent;
}

Skeleton body_skeleton() {
  Skeleton skeleton;
  for (const std::string& name : body_joints()) {
    const std::string parent = parent_of(name);
    skeleton.joints.push_back({name, parent.empty() ? -1 : skeleton.joint_idx(parent), Vector3d::Zero()});
  }
  return skeleton;
}

// Where joints stand that a character lacks: fractions of the way between the ones that it has, or, at the
// ends, of the length of its legs.
void place_missing(Skeleton& standing, const std::vector<int>& body) {
  const auto has = [&](const std::string& name) { return body[index(standing.joint_idx(name))] >= 0; };
  const auto rest = [&](const std::string& name) -> Vector3d& {
    return standing.joints[index(standing.joint_idx(name))].rest_position;
  };
  const double leg =
      (rest("left_shin") - rest("left_thigh")).norm() + (rest("left_foot") - rest("left_shin")).norm();
  const Vector3d hips = 0.5 * (rest("left_thigh") + rest("right_thigh"));
  const Vector3d shoulders = 0.5 * (rest("left_upper_arm") + rest("right_upper_arm"));
  const auto between = [&](const Vector3d& a, const Vector3d& b, double share) -> Vector3d {
    return a + share * (b - a);
  };
  if (!has("chest")) rest("chest") = between(hips, shoulders, 0.5);
  if (!has("spine")) rest("spine") = between(rest("pelvis"), rest("chest"), 0.35);
  if (!has("neck")) rest("neck") = between(rest("chest"), shoulders, 1.2);
  if (!has("head")) rest("head") = rest("neck") + 0.14 * leg * Vector3d::UnitY();
  for (const std::string side : {"left_", "right_"}) {
    if (!has(side + "collar")) {
      rest(side + "collar") = between(between(rest("chest"), shoulders, 0.9), rest(side + "upper_arm"), 0.15);
    }
    if (!has(side + "hand")) {
      const Vector3d along = (rest(side + "forearm") - rest(side + "upper_arm")).normalized();
      rest(side + "hand") = rest(side + "forearm") + 0.28 * leg * along;
    }
    // The ball of a foot: before the ankle, at two fifths of its height.
    if (!has(side + "toe")) {
      const Vector3d& ankle = rest(side + "foot");
      rest(side + "toe") = {ankle.x(), 0.4 * ankle.y(), ankle.z() + 0.165 * leg};
    }
  }
}

}  // namespace

StandingFigure::StandingFigure(const Skeleton& skeleton, std::span<const SkeletalMotion> seen,
                               const std::string& what, const std::optional<std::array<double, 2>>& soles)
    : own_(skeleton) {
  validate(skeleton);
  map_ = find_joints(skeleton, what);
  const std::vector<int> body = retargeting::body_joint_indices(skeleton, map_);
  for (const SkeletalMotion& motion : seen) {
    for (std::size_t f = 0; f < motion.frames.size(); ++f) {
      if (motion.frames[f].position.size() != skeleton.joints.size() ||
          motion.frames[f].rotation.size() != skeleton.joints.size()) {
        throw InvalidArgument(fmt::format("{}: motion '{}' frame {} is no pose of its skeleton of {} joints",
                                          what, motion.name, f, skeleton.joints.size()));
      }
    }
  }
  rest_pose_stands_ = retargeting::stands_at_rest(skeleton, body);
  const retargeting::StandingRotations found =
      rest_pose_stands_ ? retargeting::standing_from_rest(skeleton, body, seen, soles)
                        : retargeting::standing_from_motions(skeleton, body, seen, what);
  drive(body, found.standing_from_own);
  place_joints(body, found);
}

// What drives each of the character's joints.
void StandingFigure::drive(const std::vector<int>& body, const std::vector<Quaterniond>& standing_from_own) {
  body_joint_of_own_.assign(own_.joints.size(), -1);
  for (std::size_t b = 0; b < body.size(); ++b) {
    if (body[b] >= 0) body_joint_of_own_[index(body[b])] = static_cast<int>(b);
  }
  standing_from_own_.resize(own_.joints.size());
  for (std::size_t j = 0; j < own_.joints.size(); ++j) {
    int& driver = body_joint_of_own_[j];
    // What stands for no body joint goes with its parent; before the pelvis, with the pelvis.
    if (driver < 0) {
      const int parent = own_.joints[j].parent;
      driver = parent < 0 ? 0 : body_joint_of_own_[index(parent)];
    }
    standing_from_own_[j] = standing_from_own[index(driver)];
  }
}

void StandingFigure::place_joints(const std::vector<int>& body, const retargeting::StandingRotations& found) {
  standing_ = body_skeleton();
  if (!found.moved) {
    for (std::size_t b = 0; b < body.size(); ++b) {
      if (body[b] >= 0) standing_.joints[b].rest_position = own_.joints[index(body[b])].rest_position;
    }
    place_missing(standing_, body);
    return;
  }
  // The pelvis over the origin, at a height that is yet to be found.
  const auto place = [&] {
    const SkeletonPose pose = pose_from_rotations(own_, standing_from_own_, Vector3d::Zero());
    for (std::size_t b = 0; b < body.size(); ++b) {
      if (body[b] < 0) continue;
      standing_.joints[b].rest_position = pose.position[index(body[b])] - pose.position[index(body[0])];
    }
  };
  place();
  const auto rest = [&](const std::string& name) -> const Vector3d& {
    return standing_.joints[index(standing_.joint_idx(name))].rest_position;
  };
  // Both ankles are as high over the ground as they are when the feet stand flat: legs are turned outwards or
  // inwards a little.
  constexpr std::array<const char*, 2> sides = {"left_", "right_"};
  double height = 0.0, highest = 1e9;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string name = sides[side];
    const Vector3d leg = rest(name + "foot") - rest(name + "thigh");
    height += 0.5 * (found.ankle_height[side] - rest(name + "foot").y());
    highest =
        std::min(highest, found.ankle_height[side] + std::hypot(leg.x(), leg.y()) - rest(name + "thigh").y());
  }
  height = std::min(height, highest);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string name = sides[side];
    const double outward = side == 0 ? 1.0 : -1.0;
    const Vector3d leg = rest(name + "foot") - rest(name + "thigh");
    const double depth = height + rest(name + "thigh").y() - found.ankle_height[side];
    const double angle = std::acos(std::clamp(depth / std::hypot(leg.x(), leg.y()), 0.0, 1.0));
    const double now = std::atan2(outward * leg.x(), -leg.y());
    // The nearer of the two angles that reach so deep.
    const double turn = (now < 0.0 ? -angle : angle) - now;
    const Quaterniond turned(Eigen::AngleAxisd(outward * turn, Vector3d::UnitZ()));
    for (const char* bone : {"thigh", "shin"}) {
      const int joint = standing_.joint_idx(name + bone);
      for (std::size_t j = 0; j < own_.joints.size(); ++j) {
        if (body_joint_of_own_[j] != joint) continue;
        standing_from_own_[j] = (turned * standing_from_own_[j]).normalized();
      }
    }
  }
  place();
  for (Joint& joint : standing_.joints) joint.rest_position.y() += height;
  place_missing(standing_, body);
}

SkeletonPose StandingFigure::own_pose(const SkeletonPose& standing_pose) const {
  std::vector<Quaterniond> rotations;
  rotations.reserve(own_.joints.size());
  for (std::size_t j = 0; j < own_.joints.size(); ++j) {
    rotations.push_back(standing_pose.rotation.at(index(body_joint_of_own_[j])) * standing_from_own_[j]);
  }
  const int pelvis = own_.joint_idx(map_.joints.at("pelvis"));
  if (pelvis == 0) return pose_from_rotations(own_, rotations, standing_pose.position.at(0));
  const SkeletonPose pose = pose_from_rotations(own_, rotations, Vector3d::Zero());
  return pose_from_rotations(own_, rotations, standing_pose.position.at(0) - pose.position[index(pelvis)]);
}

SkeletonPose StandingFigure::standing_pose(const SkeletonPose& own_pose) const {
  const std::vector<int> body = retargeting::body_joint_indices(own_, map_);
  std::vector<Quaterniond> rotations(standing_.joints.size(), Quaterniond::Identity());
  for (std::size_t b = 0; b < body.size(); ++b) {
    if (body[b] >= 0) {
      const auto j = index(body[b]);
      rotations[b] = (own_pose.rotation.at(j) * standing_from_own_[j].conjugate()).normalized();
    } else {
      rotations[b] = rotations[index(standing_.joints[b].parent)];
    }
  }
  SkeletonPose pose = pose_from_rotations(standing_, rotations, own_pose.position.at(index(body[0])));
  return pose;
}

}  // namespace reprise
