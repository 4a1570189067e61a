// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The surface point nearest to each voxel of a solid.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/voxel_solid.h"

namespace reprise {

// A place on a triangle: its corners times the weights.
struct TrianglePoint {
  std::int32_t triangle = -1;
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  // not negative, sum 1
};

// Finds nearest surface points for the frames of one topology. Groups triangles once into a tree of boxes;
// each frame only takes new measures of the boxes, for what is near on a body in one frame mostly is in all.
// Eight voxels go down the tree together.
class NearestSurface {
 public:
  // `triangles`: valid indices into `points`, which are those of any frame; is referred to afterwards.
  NearestSurface(std::span<const Triangle> triangles, std::span<const Eigen::Vector3d> points);

  // For every voxel of `solid.voxels()`, the surface point nearest to its centre, exact but for float32
  // rounding of distances. `points` and the triangles are those the solid was made of. Const and thread-safe.
  std::vector<TrianglePoint> find(const VoxelSolid& solid, std::span<const Eigen::Vector3d> points) const;

 private:
  struct Node {
    std::int32_t begin = 0;  // of `order_`
    std::int32_t end = 0;
    std::int32_t second = 0;  // the first child follows its parent; 0: a leaf
  };
  class Frame;

  void build(std::span<const Eigen::Vector3d> centers, std::int32_t begin, std::int32_t end);

  std::span<const Triangle> triangles_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace reprise
