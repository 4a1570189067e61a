// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Colours of a textured surface, averaged over patches of a given size.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/topology.h"

namespace reprise {

// The texture of a topology averaged over patches: every triangle is split evenly, so that patches have about
// the area of a square of the patch size, or is one patch. A lookup then neither misses fine patterns nor
// depends on where exactly it falls on them. Averages are of sRGB values as stored.
class PatchColors {
 public:
  // `points`: some frame, for the lengths of edges. Texture coordinates repeat outside [0, 1]. Throws
  // `InvalidArgument` if the topology has no texture, names a texture coordinate that is not finite, or needs
  // more patches than memory should hold.
  PatchColors(const Topology& topology, std::span<const Eigen::Vector3d> points, double patch_size);

  // R, G, B from 0 to 1 at corners * weights of a triangle; weights not negative, sum 1.
  const std::array<float, 3>& color(std::int32_t triangle, const Eigen::Vector3f& weights) const;

  // Means of the colours around vertices: over the triangles that meet there, falling off linearly to their
  // other corners. One row a vertex; black where there is no triangle of positive area.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> vertex_means() const;

  std::size_t patch_count() const { return colors_.size(); }

 private:
  struct Split {
    std::size_t first = 0;   // patch
    std::int32_t parts = 1;  // of each edge: parts^2 patches
  };
  std::int32_t vertex_count_;
  std::vector<Triangle> triangles_;
  std::vector<double> areas_;  // of triangles
  std::vector<Split> splits_;  // one a triangle
  std::vector<std::array<float, 3>> colors_;
};

}  // namespace reprise
