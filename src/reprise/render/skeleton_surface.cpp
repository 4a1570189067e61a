// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/skeleton_surface.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// Vertices of an octahedron: two tips and the ring between them.
constexpr int corners = 6;
constexpr double ring_place = 0.18;  // of the bone's length from its joint

struct Piece {
  int joint = 0;
  int child = -1;  // -1: the ball at the end of a chain
};

std::vector<Piece> pieces_of(const Skeleton& skeleton) {
  std::vector<Piece> pieces;
  for (int j = 0; j < skeleton.size(); ++j) {
    const std::vector<int> children = skeleton.children(j);
    for (const int child : children) pieces.push_back({j, child});
    if (children.empty()) pieces.push_back({j, -1});
  }
  return pieces;
}

// "left_arm", "LeftArm", "lfemur", "L_Arm"; a 'l' alone begins many names ("lowerback", "legs").
Color color_of(const std::string& name, const SkeletonSurfaceOptions& options) {
  std::string word;
  for (const char c : name.substr(name.rfind(':') + 1)) {
    word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (word.find("left") != std::string::npos || word.starts_with("l_")) return options.left;
  if (word.find("right") != std::string::npos || word.starts_with("r_")) return options.right;
  static constexpr std::array acclaim = {"hipjoint", "femur",   "tibia", "foot",    "toes",    "clavicle",
                                         "humerus",  "radius",  "wrist", "hand",    "fingers", "thumb",
                                         "shldr",    "forearm", "thigh", "shin",    "collar",  "buttock",
                                         "upleg",    "leg",     "arm",   "shoulder"};
  for (const char* bone : acclaim) {
    if (word.size() < 2 || !std::string_view(word).substr(1).starts_with(bone)) continue;
    if (word[0] == 'l') return options.left;
    if (word[0] == 'r') return options.right;
  }
  return options.middle;
}

TopologyPtr make_topology(std::size_t pieces) {
  auto topology = std::make_shared<Topology>();
  topology->vertex_count = static_cast<std::int32_t>(corners * pieces);
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(pieces); ++p) {
    const std::int32_t base = corners * p;
    for (std::int32_t k = 0; k < 4; ++k) {
      const std::int32_t here = base + 2 + k;
      const std::int32_t next = base + 2 + (k + 1) % 4;
      topology->triangles.push_back({base, next, here});
      topology->triangles.push_back({base + 1, here, next});
    }
  }
  return topology;
}

// Tips and two axes of the ring, which turns with the bone.
void place(PositionsRef frame, Eigen::Index first, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
           const Eigen::Vector3d& ring, const Eigen::Vector3d& side, const Eigen::Vector3d& up) {
  const std::array<Eigen::Vector3d, corners> points = {from,      to,          ring + side,
                                                       ring + up, ring - side, ring - up};
  for (int c = 0; c < corners; ++c) {
    frame.row(first + c) = points[static_cast<std::size_t>(c)].transpose().cast<float>();
  }
}

}  // namespace

MeshSequence skeleton_surface(const SkeletalMotion& motion, const SkeletonSurfaceOptions& options) {
  if (motion.frames.empty() || motion.skeleton.joints.empty()) {
    throw InvalidArgument(fmt::format("'{}': expected joints and frames to draw, found {} and {}",
                                      motion.name, motion.skeleton.joints.size(), motion.frames.size()));
  }
  const std::vector<Piece> pieces = pieces_of(motion.skeleton);
  MeshSequence surface(motion.name, make_topology(pieces.size()), motion.frames.size(),
                       motion.frames_per_second);
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    const SkeletonPose& pose = motion.frames[f];
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      const auto j = static_cast<std::size_t>(pieces[p].joint);
      const auto first = static_cast<Eigen::Index>(corners * p);
      const Eigen::Vector3d from = pose.position[j];
      const Eigen::Vector3d to =
          pieces[p].child >= 0 ? pose.position[static_cast<std::size_t>(pieces[p].child)] : from;
      const double length = (to - from).norm();
      if (pieces[p].child < 0 || length < 1e-6) {
        const Eigen::Vector3d half = options.ball * Eigen::Vector3d::UnitY();
        place(surface.frame(f), first, from - half, from + half, from,
              options.ball * Eigen::Vector3d::UnitX(), options.ball * -Eigen::Vector3d::UnitZ());
        continue;
      }
      const Eigen::Vector3d along = (to - from) / length;
      // An axis of the joint that is not the bone's own.
      const Eigen::Matrix3d turn = pose.rotation[j].toRotationMatrix();
      Eigen::Index least = 0;
      (turn.transpose() * along).cwiseAbs().minCoeff(&least);
      const double radius = std::clamp(options.thickness * length, options.thinnest, options.thickest);
      const Eigen::Vector3d side = radius * turn.col(least).cross(along).normalized();
      place(surface.frame(f), first, from, to, from + ring_place * length * along, side, along.cross(side));
    }
  }
  std::vector<Color> colors;
  for (const Piece& piece : pieces) {
    const int named = piece.child >= 0 ? piece.child : piece.joint;
    const Color color = color_of(motion.skeleton.joints[static_cast<std::size_t>(named)].name, options);
    colors.insert(colors.end(), corners, color);
  }
  surface.set_colors(std::move(colors));
  return surface;
}

}  // namespace reprise
