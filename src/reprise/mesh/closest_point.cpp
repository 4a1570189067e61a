// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr std::int32_t leaf_triangles = 4;
constexpr int stack_size = 64;  // the tree is balanced: far deeper than any mesh that fits in memory

double box_squared_distance(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& query) {
  return (box.min() - query).cwiseMax(query - box.max()).cwiseMax(0.0).squaredNorm();
}

}  // namespace

// The regions of a triangle (corner, edge, inside) are told apart by the signs of a few products; see
// Ericson, Real-Time Collision Detection, 5.1.5.
Eigen::Vector3d closest_weights(const Eigen::Vector3d& query, const Eigen::Vector3d& a,
                                const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = query - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const Eigen::Vector3d bp = query - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double w = d1 / (d1 - d3);
    return {1.0 - w, w, 0.0};
  }
  const Eigen::Vector3d cp = query - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return {1.0 - w, 0.0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - w, w};
  }
  const double sum = va + vb + vc;
  return {1.0 - vb / sum - vc / sum, vb / sum, vc / sum};
}

ClosestPointTree::ClosestPointTree(std::vector<Eigen::Vector3d> points, std::vector<Triangle> triangles)
    : points_(std::move(points)), triangles_(std::move(triangles)) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!points_[i].allFinite())
      throw InvalidArgument(fmt::format("point {}: expected finite coordinates", i));
  }
  const auto count = static_cast<std::int32_t>(triangles_.size());
  normals_.reserve(triangles_.size());
  centers_.reserve(triangles_.size());
  for (std::int32_t i = 0; i < count; ++i) {
    for (const std::int32_t v : triangles_[i]) {
      if (v < 0 || static_cast<std::size_t>(v) >= points_.size()) {
        throw InvalidArgument(
            fmt::format("triangle {}: expected indices below {}, found {}", i, points_.size(), v));
      }
    }
    const Eigen::Vector3d& a = points_[triangles_[i][0]];
    const Eigen::Vector3d& b = points_[triangles_[i][1]];
    const Eigen::Vector3d& c = points_[triangles_[i][2]];
    normals_.push_back((b - a).cross(c - a).stableNormalized());
    centers_.push_back((a + b + c) / 3.0);
  }
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(triangles_.size());
  if (count > 0) build(0, count);
  centers_ = {};
}

void ClosestPointTree::build(std::int32_t begin, std::int32_t end) {
  const auto node_idx = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box, center_box;
  for (std::int32_t i = begin; i < end; ++i) {
    for (const std::int32_t v : triangles_[order_[i]]) box.extend(points_[v]);
    center_box.extend(centers_[order_[i]]);
  }
  nodes_[node_idx] = {.box = box, .begin = begin, .end = end, .second = 0};
  if (end - begin <= leaf_triangles) return;
  Eigen::Index axis = 0;
  center_box.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     return std::pair(centers_[a][axis], a) < std::pair(centers_[b][axis], b);
                   });
  build(begin, middle);
  nodes_[node_idx].second = static_cast<std::int32_t>(nodes_.size());
  build(middle, end);
}

std::optional<SurfacePoint> ClosestPointTree::closest(const Eigen::Vector3d& query, double max_distance,
                                                      const Eigen::Vector3d* facing) const {
  if (nodes_.empty()) return std::nullopt;
  SurfacePoint best;
  double best_squared = max_distance * max_distance;
  std::array<std::pair<std::int32_t, double>, stack_size> stack;
  int top = 0;
  stack[top++] = {0, box_squared_distance(nodes_[0].box, query)};
  while (top > 0) {
    const auto [node_idx, bound] = stack[--top];
    if (bound > best_squared) continue;
    const Node& node = nodes_[node_idx];
    if (node.second == 0) {
      for (std::int32_t i = node.begin; i < node.end; ++i) {
        const std::int32_t t = order_[i];
        if (facing != nullptr && normals_[t].dot(*facing) <= 0.0) continue;
        const Eigen::Vector3d& a = points_[triangles_[t][0]];
        const Eigen::Vector3d& b = points_[triangles_[t][1]];
        const Eigen::Vector3d& c = points_[triangles_[t][2]];
        const Eigen::Vector3d weights = closest_weights(query, a, b, c);
        const Eigen::Vector3d point = weights[0] * a + weights[1] * b + weights[2] * c;
        const double squared = (point - query).squaredNorm();
        if (squared < best_squared || (squared == best_squared && best.triangle >= 0 && t < best.triangle)) {
          best_squared = squared;
          best = {.triangle = t, .weights = weights, .point = point, .distance = std::sqrt(squared)};
        }
      }
      continue;
    }
    std::pair<std::int32_t, double> near{node_idx + 1, box_squared_distance(nodes_[node_idx + 1].box, query)};
    std::pair<std::int32_t, double> far{node.second, box_squared_distance(nodes_[node.second].box, query)};
    if (far.second < near.second) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
  if (best.triangle < 0) return std::nullopt;
  return best;
}

void ClosestPointTree::hits(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_t,
                            std::vector<RayHit>& hits) const {
  hits.clear();
  if (nodes_.empty()) return;
  const Eigen::Vector3d inverse = direction.cwiseInverse();  // infinite where parallel: the slab test holds
  const auto meets = [&](const Eigen::AlignedBox3d& box) {
    double enter = 0.0, leave = max_t;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0.0) {
        if (origin[k] < box.min()[k] || origin[k] > box.max()[k]) return false;
        continue;
      }
      const double a = (box.min()[k] - origin[k]) * inverse[k];
      const double b = (box.max()[k] - origin[k]) * inverse[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    // Rounding must not lose a triangle that lies in a side of its box.
    return enter <= leave + 1e-12;
  };
  std::array<std::int32_t, stack_size> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::int32_t node_idx = stack[--top];
    const Node& node = nodes_[node_idx];
    if (!meets(node.box)) continue;
    if (node.second != 0) {
      stack[top++] = node.second;
      stack[top++] = node_idx + 1;
      continue;
    }
    for (std::int32_t i = node.begin; i < node.end; ++i) {
      const std::int32_t t = order_[i];
      const Eigen::Vector3d& a = points_[triangles_[t][0]];
      const Eigen::Vector3d ab = points_[triangles_[t][1]] - a;
      const Eigen::Vector3d ac = points_[triangles_[t][2]] - a;
      // Moeller and Trumbore.
      const Eigen::Vector3d p = direction.cross(ac);
      const double determinant = ab.dot(p);
      if (determinant == 0.0) continue;
      const Eigen::Vector3d s = origin - a;
      const double u = s.dot(p) / determinant;
      if (u < 0.0 || u > 1.0) continue;
      const Eigen::Vector3d q = s.cross(ab);
      const double v = direction.dot(q) / determinant;
      if (v < 0.0 || u + v > 1.0) continue;
      const double along = ac.dot(q) / determinant;
      if (along < 0.0 || along > max_t) continue;
      hits.push_back({.triangle = t, .t = along, .weights = {1.0 - u - v, u, v}, .front = determinant > 0.0});
    }
  }
  std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) {
    return std::pair(a.t, a.triangle) < std::pair(b.t, b.triangle);
  });
}

}  // namespace reprise
