// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/voxel_nearest.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "reprise/mesh/closest_point.h"

namespace reprise {
namespace {

constexpr std::int32_t leaf_triangles = 4;
constexpr int stack_size = 64;  // the tree is balanced: far deeper than any mesh that fits in memory

// Eight voxels, 2 x 2 x 2.
using Lanes = Eigen::Array<float, 8, 1>;

struct Points8 {
  Lanes x, y, z;
};

// A box in four lanes: x, y, z and one that is always 0.
struct Box {
  Eigen::Array4f low = {std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
                        std::numeric_limits<float>::max(), 0.0F};
  Eigen::Array4f high = -low;

  void extend(const Box& other) {
    low = low.min(other.low);
    high = high.max(other.high);
  }
  void extend(const Eigen::Vector3f& point) {
    const Eigen::Array4f p(point.x(), point.y(), point.z(), 0.0F);
    extend(Box{p, p});
  }
  float squared_distance(const Box& other) const {
    return (low - other.high).max(other.low - high).max(0.0F).square().sum();
  }
};

// What the distances of one triangle to many points share. Lengths are in voxels.
struct TriangleForm {
  std::array<Eigen::Vector3f, 3> corner;
  std::array<Eigen::Vector3f, 3> edge;    // from corner e to corner e + 1
  std::array<float, 3> inverse_square;    // of the edge's length; 0: the edge is a point
  std::array<Eigen::Vector3f, 3> inward;  // in the plane of the triangle, across edge e
  std::array<float, 3> inward_offset;
  Eigen::Vector3f normal;
  float normal_offset = 0.0F;

  explicit TriangleForm(const std::array<Eigen::Vector3d, 3>& c) {
    const Eigen::Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]).stableNormalized();
    normal = n.cast<float>();
    // Without area it has no plane: infinitely far from it, it is as near as its edges.
    normal_offset = n.isZero() ? 1e15F : static_cast<float>(n.dot(c[0]));
    for (std::size_t e = 0; e < 3; ++e) {
      const Eigen::Vector3d along = c[(e + 1) % 3] - c[e];
      const Eigen::Vector3d across = n.cross(along);
      const double square = along.squaredNorm();
      corner[e] = c[e].cast<float>();
      edge[e] = along.cast<float>();
      inverse_square[e] = square > 0.0 ? static_cast<float>(std::min(1.0 / square, 1e30)) : 0.0F;
      inward[e] = across.cast<float>();
      inward_offset[e] = static_cast<float>(across.dot(c[e]));
    }
  }

  // The nearest of the edges, or of the plane for points above the triangle. Without branches: the plane is
  // made infinitely far for points beyond an edge.
  Lanes squared_distance(const Points8& p) const {
    Lanes least = Lanes::Constant(std::numeric_limits<float>::max());
    Lanes inside = least;
    for (std::size_t e = 0; e < 3; ++e) {
      const Lanes x = p.x - corner[e].x();
      const Lanes y = p.y - corner[e].y();
      const Lanes z = p.z - corner[e].z();
      const Lanes t =
          ((x * edge[e].x() + y * edge[e].y() + z * edge[e].z()) * inverse_square[e]).max(0.0F).min(1.0F);
      least = least.min((x - t * edge[e].x()).square() + (y - t * edge[e].y()).square() +
                        (z - t * edge[e].z()).square());
      inside = inside.min(p.x * inward[e].x() + p.y * inward[e].y() + p.z * inward[e].z() - inward_offset[e]);
    }
    const Lanes height = p.x * normal.x() + p.y * normal.y() + p.z * normal.z() - normal_offset;
    constexpr float far = 1e20F;
    return least.min(height.square() + far * (-inside).max(0.0F));
  }
};

}  // namespace

// The tree measured on one frame.
class NearestSurface::Frame {
 public:
  Frame(const NearestSurface& tree, const VoxelSolid& solid, std::span<const Eigen::Vector3d> points)
      : tree_(tree), boxes_(tree.nodes_.size()) {
    const Eigen::Vector3d origin = solid.center(0) - Eigen::Vector3d::Constant(0.5 * solid.voxel_size());
    points_.reserve(points.size());
    for (const Eigen::Vector3d& point : points) points_.push_back((point - origin) / solid.voxel_size());
    forms_.reserve(tree.order_.size());
    for (const std::int32_t triangle : tree.order_) forms_.emplace_back(corners(triangle));
    for (std::size_t n = boxes_.size(); n-- > 0;) {
      const Node& node = tree.nodes_[n];
      if (node.second != 0) {
        boxes_[n] = boxes_[n + 1];
        boxes_[n].extend(boxes_[static_cast<std::size_t>(node.second)]);
        continue;
      }
      for (std::int32_t i = node.begin; i < node.end; ++i) {
        for (const Eigen::Vector3f& corner : forms_[static_cast<std::size_t>(i)].corner)
          boxes_[n].extend(corner);
      }
    }
  }

  std::array<Eigen::Vector3d, 3> corners(std::int32_t triangle) const {
    const Triangle& t = tree_.triangles_[static_cast<std::size_t>(triangle)];
    return {points_[static_cast<std::size_t>(t[0])], points_[static_cast<std::size_t>(t[1])],
            points_[static_cast<std::size_t>(t[2])]};
  }

  // Nearest triangles of those of eight points whose `best` is not negative on entry. `hint`: the place of a
  // triangle in the tree to begin with, and one of those found.
  void search(const Points8& p, Lanes& best, std::array<std::int32_t, 8>& nearest, std::size_t& hint) const {
    const Box around{{p.x[0], p.y[0], p.z[0], 0.0F}, {p.x[7], p.y[7], p.z[7], 0.0F}};
    float bound = std::numeric_limits<float>::max();
    const auto test = [&](std::size_t i) {
      const Lanes squared = forms_[i].squared_distance(p);
      if (!((best - squared).maxCoeff() > 0.0F)) return;
      for (Eigen::Index lane = 0; lane < 8; ++lane) {
        if (!(squared[lane] < best[lane])) continue;
        best[lane] = squared[lane];
        nearest[static_cast<std::size_t>(lane)] = tree_.order_[i];
        hint = i;
      }
      bound = best.maxCoeff();
    };
    test(hint);
    std::array<std::pair<std::size_t, float>, stack_size> stack;
    std::size_t top = 0;
    stack[top++] = {0, 0.0F};
    while (top > 0) {
      const auto [n, least] = stack[--top];
      if (least >= bound) continue;
      const Node& node = tree_.nodes_[n];
      if (node.second == 0) {
        for (std::int32_t i = node.begin; i < node.end; ++i) test(static_cast<std::size_t>(i));
        continue;
      }
      const auto second = static_cast<std::size_t>(node.second);
      std::pair<std::size_t, float> near{n + 1, around.squared_distance(boxes_[n + 1])};
      std::pair<std::size_t, float> far{second, around.squared_distance(boxes_[second])};
      if (far.second < near.second) std::swap(near, far);
      stack[top++] = far;
      stack[top++] = near;
    }
  }

 private:
  const NearestSurface& tree_;
  std::vector<Eigen::Vector3d> points_;  // in voxels from the first corner of the solid
  std::vector<TriangleForm> forms_;      // in the order of the tree
  std::vector<Box> boxes_;
};

NearestSurface::NearestSurface(std::span<const Triangle> triangles, std::span<const Eigen::Vector3d> points)
    : triangles_(triangles), order_(triangles.size()) {
  std::vector<Eigen::Vector3d> centers;
  centers.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    centers.emplace_back((points[static_cast<std::size_t>(t[0])] + points[static_cast<std::size_t>(t[1])] +
                          points[static_cast<std::size_t>(t[2])]) /
                         3.0);
  }
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(centers, 0, static_cast<std::int32_t>(order_.size()));
}

void NearestSurface::build(std::span<const Eigen::Vector3d> centers, std::int32_t begin, std::int32_t end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({.begin = begin, .end = end});
  if (end - begin <= leaf_triangles) return;
  Eigen::AlignedBox3d box;
  for (std::int32_t i = begin; i < end; ++i) {
    box.extend(centers[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])]);
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     return std::pair(centers[static_cast<std::size_t>(a)][axis], a) <
                            std::pair(centers[static_cast<std::size_t>(b)][axis], b);
                   });
  build(centers, begin, middle);
  nodes_[node].second = static_cast<std::int32_t>(nodes_.size());
  build(centers, middle, end);
}

std::vector<TrianglePoint> NearestSurface::find(const VoxelSolid& solid,
                                                std::span<const Eigen::Vector3d> points) const {
  std::vector<TrianglePoint> result(solid.voxels().size());
  if (result.empty()) return result;
  const Frame frame(*this, solid, points);
  const std::array<std::int32_t, 3>& size = solid.size();
  const auto cell_of = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  };
  std::vector<std::int32_t> place(solid.cell_count());  // among the voxels that count
  for (std::size_t i = 0; i < result.size(); ++i) {
    place[static_cast<std::size_t>(solid.voxels()[i])] = static_cast<std::int32_t>(i);
  }
  std::size_t hint = 0;
  for (std::int32_t k = 0; k < size[2]; k += 2) {
    for (std::int32_t j = 0; j < size[1]; j += 2) {
      for (std::int32_t i = 0; i < size[0]; i += 2) {
        Points8 centers;
        Lanes best = Lanes::Constant(-1.0F);
        std::array<std::size_t, 8> cells{};
        for (std::int32_t lane = 0; lane < 8; ++lane) {
          const std::int32_t x = i + (lane & 1);
          const std::int32_t y = j + (lane >> 1 & 1);
          const std::int32_t z = k + (lane >> 2);
          centers.x[lane] = static_cast<float>(x) + 0.5F;
          centers.y[lane] = static_cast<float>(y) + 0.5F;
          centers.z[lane] = static_cast<float>(z) + 0.5F;
          if (x >= size[0] || y >= size[1] || z >= size[2]) continue;
          cells[static_cast<std::size_t>(lane)] = cell_of(x, y, z);
          if (solid.counts(cells[static_cast<std::size_t>(lane)]))
            best[lane] = std::numeric_limits<float>::max();
        }
        if (best.maxCoeff() < 0.0F) continue;
        const Lanes wanted = best;
        std::array<std::int32_t, 8> nearest{};
        frame.search(centers, best, nearest, hint);
        for (std::size_t lane = 0; lane < 8; ++lane) {
          const auto l = static_cast<Eigen::Index>(lane);
          if (wanted[l] < 0.0F) continue;
          const std::array<Eigen::Vector3d, 3> c = frame.corners(nearest[lane]);
          const Eigen::Vector3d center(centers.x[l], centers.y[l], centers.z[l]);
          result[static_cast<std::size_t>(place[cells[lane]])] = {
              .triangle = nearest[lane], .weights = closest_weights(center, c[0], c[1], c[2]).cast<float>()};
        }
      }
    }
  }
  return result;
}

}  // namespace reprise
