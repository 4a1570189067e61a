// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/voxel_solid.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// Rays are cast in whole numbers, of which this many make a voxel: whether a ray passes left or right of an
// edge is then exact, so that of the triangles around an edge or a vertex no crossing is lost or counted
// twice. A voxel of 2 cm moves its surface by less than a micrometre.
constexpr std::int64_t subdivisions = 1 << 16;

struct Corner {
  std::int64_t u = 0;
  std::int64_t v = 0;
  double depth = 0.0;  // voxels
};

// Twice the signed area of a, b, p.
std::int64_t orientation(const Corner& a, const Corner& b, std::int64_t u, std::int64_t v) {
  return (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
}

// Of the two directions of an edge exactly one owns the points that lie on it.
bool owns_its_points(const Corner& a, const Corner& b) {
  return b.v > a.v || (b.v == a.v && b.u < a.u);
}

// First and last voxel whose centre lies in [low, high] of whole numbers.
std::int32_t first_center(std::int64_t low, std::int32_t count) {
  const std::int64_t doubled = 2 * low - subdivisions;  // centre i lies at (2 i + 1) subdivisions / 2
  const std::int64_t first = doubled <= 0 ? 0 : (doubled + 2 * subdivisions - 1) / (2 * subdivisions);
  return static_cast<std::int32_t>(std::min<std::int64_t>(first, count));
}
std::int32_t last_center(std::int64_t high, std::int32_t count) {
  const std::int64_t doubled = 2 * high - subdivisions;
  if (doubled < 0) return -1;
  return static_cast<std::int32_t>(std::min<std::int64_t>(doubled / (2 * subdivisions), count - 1));
}

// Calls cross(u, v, k, sign) for every crossing of the triangle with a line through voxel centres along
// `axis`: it lies between the centres k - 1 and k of the line, and the outside of the triangle looks along
// sign * axis.
template <typename Cross>
void for_crossings(std::array<Corner, 3> corner, const std::array<std::int32_t, 2>& count,
                   std::int32_t depth_count, const Cross& cross) {
  std::int64_t area = orientation(corner[0], corner[1], corner[2].u, corner[2].v);
  if (area == 0) return;  // seen edge-on
  const int sign = area > 0 ? 1 : -1;
  if (sign < 0) {
    std::swap(corner[1], corner[2]);
    area = -area;
  }
  const auto [u_low, u_high] = std::minmax({corner[0].u, corner[1].u, corner[2].u});
  const auto [v_low, v_high] = std::minmax({corner[0].v, corner[1].v, corner[2].v});
  std::array<std::int64_t, 3> least{};  // an edge includes its points or not
  for (std::size_t e = 0; e < 3; ++e) {
    least[e] = owns_its_points(corner[(e + 1) % 3], corner[(e + 2) % 3]) ? 0 : 1;
  }
  const double inverse = 1.0 / static_cast<double>(area);
  const std::int32_t u_end = last_center(u_high, count[0]);
  const std::int32_t v_end = last_center(v_high, count[1]);
  for (std::int32_t j = first_center(v_low, count[1]); j <= v_end; ++j) {
    const std::int64_t v = j * subdivisions + subdivisions / 2;
    for (std::int32_t i = first_center(u_low, count[0]); i <= u_end; ++i) {
      const std::int64_t u = i * subdivisions + subdivisions / 2;
      const std::int64_t w0 = orientation(corner[1], corner[2], u, v);
      const std::int64_t w1 = orientation(corner[2], corner[0], u, v);
      const std::int64_t w2 = orientation(corner[0], corner[1], u, v);
      if (w0 < least[0] || w1 < least[1] || w2 < least[2]) continue;
      const double depth =
          (static_cast<double>(w0) * corner[0].depth + static_cast<double>(w1) * corner[1].depth +
           static_cast<double>(w2) * corner[2].depth) *
          inverse;
      const auto k = static_cast<std::int32_t>(std::floor(depth + 0.5));
      cross(i, j, std::clamp(k, 0, depth_count), sign);
    }
  }
}

// Whether a triangle meets boxes of one voxel: by the separating axes of Akenine-Moeller in the form of
// Schwarz and Seidel (2010), whose constants depend on the triangle alone.
class BoxOverlap {
 public:
  explicit BoxOverlap(const std::array<Eigen::Vector3d, 3>& corner) {
    const std::array<Eigen::Vector3d, 3> edge = {corner[1] - corner[0], corner[2] - corner[1],
                                                 corner[0] - corner[2]};
    normal_ = edge[0].cross(edge[1]);
    const double middle = normal_.dot(corner[0]);
    const double positive = normal_.cwiseMax(0.0).sum();
    const double negative = normal_.cwiseMin(0.0).sum();
    low_ = middle - positive;
    high_ = middle - negative;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      const double side = normal_[axis] < 0.0 ? -1.0 : 1.0;
      for (std::size_t e = 0; e < 3; ++e) {
        // Inner normal of the projected edge, and the corner of the box that lies farthest along it.
        const double nu = -side * edge[e][v];
        const double nv = side * edge[e][u];
        Side& s = sides_[static_cast<std::size_t>(axis)][e];
        s = {nu, nv, -(nu * corner[e][u] + nv * corner[e][v]) + std::max(0.0, nu) + std::max(0.0, nv)};
      }
    }
  }

  // `box`: the corner with the smallest coordinates. The boxes of both must overlap.
  bool meets(const Eigen::Vector3d& box) const {
    const double at = normal_.dot(box);
    if (at < low_ || at > high_) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double u = box[static_cast<Eigen::Index>((axis + 1) % 3)];
      const double v = box[static_cast<Eigen::Index>((axis + 2) % 3)];
      for (const Side& s : sides_[axis]) {
        if (s.nu * u + s.nv * v + s.offset < 0.0) return false;
      }
    }
    return true;
  }

 private:
  struct Side {
    double nu = 0.0;
    double nv = 0.0;
    double offset = 0.0;
  };
  Eigen::Vector3d normal_;
  double low_ = 0.0;
  double high_ = 0.0;
  std::array<std::array<Side, 3>, 3> sides_;
};

}  // namespace

VoxelSolid::VoxelSolid(std::span<const Eigen::Vector3d> points, std::span<const Triangle> triangles,
                       const Eigen::Vector3d& anchor, double voxel_size)
    : voxel_size_(voxel_size) {
  if (!(voxel_size > 0.0) || !std::isfinite(voxel_size)) {
    throw InvalidArgument(
        fmt::format("voxel size: expected a positive number of metres, found {}", voxel_size));
  }
  if (triangles.empty()) return;
  std::vector<Eigen::Vector3d> in_voxels(points.size());
  for (std::size_t v = 0; v < points.size(); ++v) in_voxels[v] = (points[v] - anchor) / voxel_size;
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles) {
    for (const std::int32_t v : triangle) {
      const Eigen::Vector3d& point = in_voxels[static_cast<std::size_t>(v)];
      if (!point.allFinite()) throw InvalidArgument(fmt::format("point {}: expected finite coordinates", v));
      box.extend(point);
    }
  }
  const Eigen::Vector3d first = box.min().array().floor();
  // Of the difference, for it may round up to the next voxel.
  const Eigen::Vector3d size = (box.max() - first).array().floor() + 1.0;
  if (!(size.prod() <= static_cast<double>(max_cells)) ||
      size.maxCoeff() > static_cast<double>(max_cells_along_axis)) {
    throw InvalidArgument(
        fmt::format("a surface of {:.3g} x {:.3g} x {:.3g} m needs {:.0f} x {:.0f} x {:.0f} voxels of {} m: "
                    "expected at most "
                    "{} in all and {} along each axis",
                    box.sizes().x() * voxel_size, box.sizes().y() * voxel_size, box.sizes().z() * voxel_size,
                    size.x(), size.y(), size.z(), voxel_size, max_cells, max_cells_along_axis));
  }
  for (int axis = 0; axis < 3; ++axis) {
    size_[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(size[axis]);
  }
  origin_ = anchor + voxel_size * first;
  for (Eigen::Vector3d& point : in_voxels) point -= first;
  flags_.assign(static_cast<std::size_t>(size.prod()), 0);
  find_inside(in_voxels, triangles);
  find_touched(in_voxels, triangles);
  for (std::size_t cell = 0; cell < flags_.size(); ++cell) {
    if (flags_[cell] != 0) voxels_.push_back(static_cast<std::int32_t>(cell));
  }
}

std::array<std::int32_t, 3> VoxelSolid::position(std::size_t cell) const {
  const auto index = static_cast<std::int32_t>(cell);
  const std::int32_t row = index / size_[0];
  return {index - row * size_[0], row % size_[1], row / size_[1]};
}

Eigen::Vector3d VoxelSolid::center(std::size_t cell) const {
  const std::array<std::int32_t, 3> p = position(cell);
  return origin_ + voxel_size_ * Eigen::Vector3d(p[0] + 0.5, p[1] + 0.5, p[2] + 0.5);
}

// With T = sum of all signs on a line and P(k) = sum of those before centre k, the ray forwards counts T - P
// and the ray backwards -P.
void VoxelSolid::find_inside(std::span<const Eigen::Vector3d> in_voxels,
                             std::span<const Triangle> triangles) {
  std::vector<std::array<std::int64_t, 3>> whole(in_voxels.size());
  for (std::size_t v = 0; v < in_voxels.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      whole[v][static_cast<std::size_t>(axis)] =
          std::llround(in_voxels[v][axis] * static_cast<double>(subdivisions));
    }
  }
  const std::array<std::size_t, 3> stride = {
      1, static_cast<std::size_t>(size_[0]),
      static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1])};
  std::vector<std::int32_t> winding(flags_.size(), 0);  // sum over the six rays
  std::vector<std::int32_t> change(flags_.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u_axis = (axis + 1) % 3;
    const std::size_t v_axis = (axis + 2) % 3;
    std::fill(change.begin(), change.end(), 0);
    // What a line starts with, T, and how much both rays together lose at each centre are kept in one table:
    // T - 2 P(k) is the running sum of `change`.
    for (const Triangle& triangle : triangles) {
      std::array<Corner, 3> corner;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto v = static_cast<std::size_t>(triangle[c]);
        corner[c] = {whole[v][u_axis], whole[v][v_axis], in_voxels[v][static_cast<Eigen::Index>(axis)]};
      }
      for_crossings(corner, {size_[u_axis], size_[v_axis]}, size_[axis],
                    [&](std::int32_t u, std::int32_t v, std::int32_t k, int sign) {
                      const std::size_t line = static_cast<std::size_t>(u) * stride[u_axis] +
                                               static_cast<std::size_t>(v) * stride[v_axis];
                      change[line] += sign;
                      if (k < size_[axis])
                        change[line + static_cast<std::size_t>(k) * stride[axis]] -= 2 * sign;
                    });
    }
    if (axis == 0) {
      for (std::size_t row = 0; row < change.size(); row += static_cast<std::size_t>(size_[0])) {
        std::int32_t sum = 0;
        for (std::size_t i = row; i < row + static_cast<std::size_t>(size_[0]); ++i) {
          sum += change[i];
          winding[i] += sum;
        }
      }
      continue;
    }
    // Whole rows (along y) or slices (along z) at once: they lie in memory one after the other.
    const std::size_t step = stride[axis];
    const std::size_t block = axis == 1 ? stride[2] : change.size();
    for (std::size_t begin = 0; begin < change.size(); begin += block) {
      for (std::size_t i = begin; i < begin + step; ++i) winding[i] += change[i];
      for (std::size_t i = begin + step; i < begin + block; ++i) {
        change[i] += change[i - step];
        winding[i] += change[i];
      }
    }
  }
  for (std::size_t cell = 0; cell < flags_.size(); ++cell) {
    if (winding[cell] > 3) {
      flags_[cell] = inside_flag;
      ++inside_count_;
    } else if (winding[cell] < -3) {
      ++reversed_count_;
    }
  }
}

void VoxelSolid::find_touched(std::span<const Eigen::Vector3d> in_voxels,
                              std::span<const Triangle> triangles) {
  for (const Triangle& triangle : triangles) {
    const std::array<Eigen::Vector3d, 3> corner = {in_voxels[static_cast<std::size_t>(triangle[0])],
                                                   in_voxels[static_cast<std::size_t>(triangle[1])],
                                                   in_voxels[static_cast<std::size_t>(triangle[2])]};
    const Eigen::Array3i low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]).array().floor().cast<int>();
    const Eigen::Array3i high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]).array().floor().cast<int>();
    const bool one_box = (low == high).all();
    const BoxOverlap overlap(corner);
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        const std::size_t row =
            (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
            static_cast<std::size_t>(size_[0]);
        for (int i = low[0]; i <= high[0]; ++i) {
          if (one_box || overlap.meets(Eigen::Vector3d(i, j, k))) {
            flags_[row + static_cast<std::size_t>(i)] |= touched_flag;
          }
        }
      }
    }
  }
}

}  // namespace reprise
