// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The solid that a triangle mesh encloses, cut into voxels; works on surfaces with holes and folds.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/topology.h"

namespace reprise {

// Which voxels of a grid belong to a solid. Voxel (i, j, k) covers anchor + voxel_size * [i, i + 1] x
// [j, j + 1] x [k, k + 1].
//
// A voxel is inside if the surface winds around its centre by more than 1/2 on average over the six rays
// along the axes: each ray counts +1 where it leaves through the outside of a triangle and -1 where it
// enters. On a closed surface every ray gives the winding number, also where the surface passes through
// itself; at a hole the rays that miss it outvote the few that leave through it. A voxel is touched if a
// triangle of the surface has a point in it, so that what is thinner than a voxel counts as well.
class VoxelSolid {
 public:
  // Most cells of the box around the surface, and most along one axis.
  static constexpr std::int64_t max_cells = std::int64_t{1} << 26;
  static constexpr std::int64_t max_cells_along_axis = std::int64_t{1} << 14;

  // `points`: finite; `triangles`: valid indices into it. Only points that triangles use count. Throws
  // `InvalidArgument`, before memory is taken, if the box needs more cells than allowed (says how many), or
  // if `voxel_size` is not positive. Without triangles, no voxel counts.
  VoxelSolid(std::span<const Eigen::Vector3d> points, std::span<const Triangle> triangles,
             const Eigen::Vector3d& anchor, double voxel_size);

  double voxel_size() const { return voxel_size_; }
  // Voxels of the box around the surface: index (k * size_y + j) * size_x + i, counted from its first voxel.
  const std::array<std::int32_t, 3>& size() const { return size_; }
  std::size_t cell_count() const { return flags_.size(); }
  bool is_inside(std::size_t cell) const { return (flags_[cell] & inside_flag) != 0; }
  bool is_touched(std::size_t cell) const { return (flags_[cell] & touched_flag) != 0; }
  // Inside or touched.
  bool counts(std::size_t cell) const { return flags_[cell] != 0; }
  // Voxels that count, ascending.
  const std::vector<std::int32_t>& voxels() const { return voxels_; }
  Eigen::Vector3d center(std::size_t cell) const;

  // Voxels that the surface winds around by more than 1/2 the right way, and the wrong way: the latter is
  // large for a surface that is inside out.
  std::int64_t inside_count() const { return inside_count_; }
  std::int64_t reversed_count() const { return reversed_count_; }

 private:
  static constexpr std::uint8_t inside_flag = 1;
  static constexpr std::uint8_t touched_flag = 2;

  std::array<std::int32_t, 3> position(std::size_t cell) const;
  void find_inside(std::span<const Eigen::Vector3d> in_voxels, std::span<const Triangle> triangles);
  void find_touched(std::span<const Eigen::Vector3d> in_voxels, std::span<const Triangle> triangles);

  double voxel_size_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // corner of the first voxel
  std::array<std::int32_t, 3> size_{};
  std::vector<std::uint8_t> flags_;
  std::vector<std::int32_t> voxels_;
  std::int64_t inside_count_ = 0;
  std::int64_t reversed_count_ = 0;
};

}  // namespace reprise
