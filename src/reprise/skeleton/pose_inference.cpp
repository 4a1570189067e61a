// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/pose_inference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reprise::skeleton {
namespace {

std::size_t at(int joint) {
  return static_cast<std::size_t>(joint);
}

// The smallest turn that brings `from` into the direction of `to`.
Eigen::Quaterniond swing(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& unit_line) {
  return vector - vector.dot(unit_line) * unit_line;
}

}  // namespace

PoseInference::PoseInference(const Skeleton& skeleton, std::vector<bool> is_known)
    : skeleton_(skeleton), is_known_(std::move(is_known)) {
  const int n = skeleton.size();
  constexpr int never = std::numeric_limits<int>::max();
  // For each joint the nearest known bone at or below it, and over which child it lies.
  std::vector<int> steps(at(n), never);
  std::vector<int> nearest(at(n), -1);
  std::vector<int> towards(at(n), -1);
  for (int j = n - 1; j >= 0; --j) {
    if (is_known_[at(j)]) {
      steps[at(j)] = 0;
      nearest[at(j)] = j;
    }
    const int parent = skeleton.joints[at(j)].parent;
    // `<=`: among equals the first child stands, which is met last.
    if (parent >= 0 && steps[at(j)] != never && steps[at(j)] + 1 <= steps[at(parent)]) {
      steps[at(parent)] = steps[at(j)] + 1;
      nearest[at(parent)] = nearest[at(j)];
      towards[at(parent)] = j;
    }
  }
  const auto first_known = static_cast<int>(std::ranges::find(is_known_, true) - is_known_.begin());
  std::vector<bool> is_placed = is_known_;
  for (int j = 0; j < n; ++j) {
    if (is_placed[at(j)]) continue;
    const int parent = skeleton.joints[at(j)].parent;
    if (parent < 0) {
      roots_.emplace_back(j, nearest[at(j)] >= 0 ? nearest[at(j)] : first_known);
      is_placed[at(j)] = true;
      continue;
    }
    Chain chain{.above = parent, .below = nearest[at(j)]};
    for (int bone = j; bone != chain.below && bone >= 0; bone = towards[at(bone)]) {
      chain.bones.push_back(bone);
      is_placed[at(bone)] = true;
    }
    chains_.push_back(std::move(chain));
  }
}

SkeletonPose PoseInference::infer(const std::vector<std::optional<KnownBone>>& known) const {
  SkeletonPose pose = rest_pose(skeleton_);
  for (std::size_t j = 0; j < known.size(); ++j) {
    if (!is_known_[j]) continue;
    pose.rotation[j] = known[j]->rotation;
    pose.position[j] = known[j]->position;
  }
  const auto carry = [&](int joint, int by) {
    pose.rotation[at(joint)] = pose.rotation[at(by)];
    pose.position[at(joint)] = pose.position[at(by)] + pose.rotation[at(by)] * (rest(joint) - rest(by));
  };
  for (const auto& [root, by] : roots_) carry(root, by);
  for (const Chain& chain : chains_) {
    if (chain.below >= 0) {
      place_chain(chain, pose);
    } else {
      for (const int bone : chain.bones) carry(bone, skeleton_.joints[at(bone)].parent);
    }
  }
  return pose;
}

void PoseInference::aim(int bone, const Eigen::Vector3d& rest_goal, const Eigen::Vector3d& goal,
                        SkeletonPose& pose) const {
  const Eigen::Vector3d points = pose.rotation[at(bone)] * (rest_goal - rest(bone));
  const Eigen::Vector3d wanted = goal - pose.position[at(bone)];
  if (points.norm() < 1e-9 || wanted.norm() < 1e-9) return;
  pose.rotation[at(bone)] = (swing(points, wanted) * pose.rotation[at(bone)]).normalized();
}

void PoseInference::place_chain(const Chain& chain, SkeletonPose& pose) const {
  const int first = chain.bones.front();
  const Eigen::Quaterniond& above = pose.rotation[at(chain.above)];
  pose.position[at(first)] = pose.position[at(chain.above)] + above * (rest(first) - rest(chain.above));
  // Turned evenly from the bone above to the bone below.
  for (std::size_t i = 0; i < chain.bones.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(chain.bones.size() + 1);
    pose.rotation[at(chain.bones[i])] = above.slerp(share, pose.rotation[at(chain.below)]);
  }
  if (chain.bones.size() == 1) {
    aim(first, rest(chain.below), pose.position[at(chain.below)], pose);
  } else if (chain.bones.size() == 2) {
    place_pair(chain, pose);
  } else {
    place_string(chain, pose);
  }
}

void PoseInference::place_pair(const Chain& chain, SkeletonPose& pose) const {
  const int upper = chain.bones[0];
  const int lower = chain.bones[1];
  const Eigen::Vector3d start = pose.position[at(upper)];
  const Eigen::Vector3d goal = pose.position[at(chain.below)];
  const Eigen::Vector3d rest_line = rest(chain.below) - rest(upper);
  const double upper_length = (rest(lower) - rest(upper)).norm();
  const double lower_length = (rest(chain.below) - rest(lower)).norm();
  const double reach = upper_length + lower_length;
  if (rest_line.norm() < 1e-9 || (goal - start).norm() < 1e-9 || reach < 1e-9)
    return place_string(chain, pose);
  const Eigen::Vector3d rest_direction = rest_line.normalized();
  const Eigen::Vector3d direction = (goal - start).normalized();

  // Where the middle joint bends to at rest; a straight limb bends to where the bone below it points (toes).
  constexpr double straight = 0.01;  // of the limb's length
  Eigen::Vector3d rest_bend = across(rest(lower) - rest(upper), rest_direction);
  if (rest_bend.norm() < straight * reach) {
    for (const int child : skeleton_.children(chain.below)) {
      const Eigen::Vector3d pointing = across(rest(child) - rest(chain.below), rest_direction);
      if (pointing.norm() > rest_bend.norm()) rest_bend = pointing;
    }
  }
  if (rest_bend.norm() < 1e-9) rest_bend = rest_direction.unitOrthogonal();

  // Both ends say where that is now. Swung onto the limb's line they differ by a twist about it only, so that
  // a raised heel or a leaning pelvis does not bend the knee sideways.
  const auto onto_line = [&](const Eigen::Quaterniond& rotation) {
    return swing(rotation * rest_direction, direction) * rotation;
  };
  const Eigen::Quaterniond middle =
      onto_line(pose.rotation[at(chain.above)]).slerp(0.5, onto_line(pose.rotation[at(chain.below)]));
  const Eigen::Vector3d bend = across(middle * rest_bend, direction).normalized();

  // Law of cosines; out of reach, the limb is straight and the middle joint divides it as at rest.
  const double distance = (goal - start).norm();
  const double along =
      distance >= reach ? distance * upper_length / reach
                        : (distance * distance + upper_length * upper_length - lower_length * lower_length) /
                              (2.0 * distance);
  const double beside =
      distance >= reach ? 0.0 : std::sqrt(std::max(0.0, upper_length * upper_length - along * along));
  pose.rotation[at(upper)] = middle;
  pose.rotation[at(lower)] = middle;
  pose.position[at(lower)] = start + along * direction + beside * bend;
  aim(upper, rest(lower), pose.position[at(lower)], pose);
  aim(lower, rest(chain.below), goal, pose);
}

// Forward and backward reaching (Aristidou and Lasenby 2011) from an even turning.
void PoseInference::place_string(const Chain& chain, SkeletonPose& pose) const {
  std::vector<int> joints = chain.bones;
  joints.push_back(chain.below);
  const Eigen::Vector3d start = pose.position[at(joints.front())];
  const Eigen::Vector3d goal = pose.position[at(chain.below)];
  std::vector<Eigen::Vector3d> points = {start};
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    const Eigen::Vector3d bone = rest(joints[i + 1]) - rest(joints[i]);
    lengths.push_back(bone.norm());
    points.push_back(points.back() + pose.rotation[at(joints[i])] * bone);
  }
  const auto pull = [](Eigen::Vector3d& point, const Eigen::Vector3d& fixed, double length) {
    const Eigen::Vector3d d = point - fixed;
    point = fixed + (d.norm() > 1e-12 ? Eigen::Vector3d(d.normalized() * length) : Eigen::Vector3d::Zero());
  };
  constexpr int iterations = 30;
  for (int k = 0; k < iterations; ++k) {
    points.back() = goal;
    for (std::size_t i = points.size() - 1; i-- > 1;) pull(points[i], points[i + 1], lengths[i]);
    for (std::size_t i = 1; i < points.size(); ++i) pull(points[i], points[i - 1], lengths[i - 1]);
  }
  for (std::size_t i = 1; i + 1 < joints.size(); ++i) pose.position[at(joints[i])] = points[i];
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    aim(joints[i], rest(joints[i + 1]), i + 2 < joints.size() ? points[i + 1] : goal, pose);
  }
}

}  // namespace reprise::skeleton
