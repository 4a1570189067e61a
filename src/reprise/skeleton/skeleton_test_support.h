// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A leg of loose pieces, one a bone, that move rigidly: what is extracted from it can be told exactly.

#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise::test {

inline Skeleton leg_skeleton() {
  return {.joints = {{.name = "pelvis", .parent = -1, .rest_position = {0.0, 0.95, 0.0}},
                     {.name = "left_thigh", .parent = 0, .rest_position = {0.1, 0.92, 0.0}},
                     {.name = "left_shin", .parent = 1, .rest_position = {0.11, 0.5, 0.03}},
                     {.name = "left_foot", .parent = 2, .rest_position = {0.11, 0.08, -0.01}},
                     {.name = "left_toe", .parent = 3, .rest_position = {0.11, 0.02, 0.11}}}};
}

constexpr int piece_size = 27;  // vertices of a piece: a grid of 3 x 3 x 3 about the middle of the bone

inline Markup leg_markup() {
  Markup markup{.skeleton = leg_skeleton()};
  const int bones = markup.skeleton.size();
  markup.reference.resize(bones * piece_size, 3);
  for (int j = 0; j < bones; ++j) {
    const auto& joints = markup.skeleton.joints;
    const Eigen::Vector3d begin = joints[static_cast<std::size_t>(j)].rest_position;
    const Eigen::Vector3d end = j + 1 < bones ? joints[static_cast<std::size_t>(j) + 1].rest_position
                                              : Eigen::Vector3d(0.11, 0.01, 0.17);
    for (int i = 0; i < piece_size; ++i) {
      const Eigen::Vector3d offset(0.04 * (i % 3 - 1), 0.05 * (i / 3 % 3 - 1), 0.03 * (i / 9 - 1));
      markup.reference.row(j * piece_size + i) = (0.5 * (begin + end) + offset).transpose().cast<float>();
      markup.joint_of_vertex.push_back(j);
    }
  }
  return markup;
}

inline TopologyPtr leg_topology() {
  Topology topology{.vertex_count = leg_skeleton().size() * piece_size};
  // Every vertex has some surface: pieces are closed strips over all of their vertices.
  for (int j = 0; j < leg_skeleton().size(); ++j) {
    for (int i = 0; i < piece_size; ++i) {
      const auto at = [&](int k) { return j * piece_size + (i + k) % piece_size; };
      topology.triangles.push_back({at(0), at(1), at(5)});
    }
  }
  return std::make_shared<const Topology>(std::move(topology));
}

// The leg steps and kicks: every bone turns about every axis, the knee forwards only.
inline std::vector<SkeletonPose> leg_poses(int frame_count) {
  std::vector<SkeletonPose> poses;
  for (int f = 0; f < frame_count; ++f) {
    const double t = 0.25 * f;
    const auto turn = [](double x, double y, double z) {
      return Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) *
             Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ());
    };
    const Eigen::Quaterniond pelvis = Eigen::Quaterniond(turn(0.1 * std::sin(t), 0.3 * t, 0.1 * std::cos(t)));
    const Eigen::Quaterniond thigh = pelvis * turn(-0.6 * std::sin(t), 0.1, 0.1 * std::sin(0.5 * t));
    const Eigen::Quaterniond shin = thigh * turn(0.6 + 0.5 * std::cos(t), 0.05, 0.0);
    const Eigen::Quaterniond foot = shin * turn(-0.3 * std::sin(1.3 * t), 0.1 * std::sin(t), 0.0);
    const Eigen::Quaterniond toe = foot * turn(-0.3 * (1.0 + std::sin(t)), 0.0, 0.0);
    poses.push_back(pose_from_rotations(leg_skeleton(), {pelvis, thigh, shin, foot, toe},
                                        {0.1 * t, 0.95 + 0.03 * std::sin(2.0 * t), 0.2 * t}));
  }
  return poses;
}

inline MeshSequence leg_clip(const std::vector<SkeletonPose>& poses) {
  const Markup markup = leg_markup();
  MeshSequence clip("leg", leg_topology(), poses.size(), 25.0);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    PositionsRef frame = clip.frame(f);
    for (Eigen::Index v = 0; v < frame.rows(); ++v) {
      const int j = markup.joint_of_vertex[static_cast<std::size_t>(v)];
      const Eigen::Vector3d rest = markup.reference.row(v).transpose().cast<double>();
      frame.row(v) = (poses[f].world_from_rest(markup.skeleton, j) * rest).transpose().cast<float>();
    }
  }
  return clip;
}

}  // namespace reprise::test
