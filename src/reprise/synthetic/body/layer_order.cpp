// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/layer_order.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "reprise/core/parallel.h"
#include "reprise/mesh/closest_point.h"

namespace reprise::body {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> points_of(const BodyLayer& layer) {
  std::vector<Vector3d> points;
  points.reserve(static_cast<std::size_t>(layer.points.rows()));
  for (Eigen::Index v = 0; v < layer.points.rows(); ++v) points.emplace_back(layer.points.row(v).transpose());
  return points;
}

std::vector<std::vector<std::int32_t>> neighbours_of(const BodyLayer& layer) {
  std::vector<std::vector<std::int32_t>> neighbours(static_cast<std::size_t>(layer.points.rows()));
  for (const Triangle& t : layer.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      neighbours[static_cast<std::size_t>(t[k])].push_back(t[(k + 1) % 3]);
      neighbours[static_cast<std::size_t>(t[k])].push_back(t[(k + 2) % 3]);
    }
  }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

// Points every few millimetres along the edges that only one triangle has.
std::vector<Vector3d> border_points(const BodyLayer& layer) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const Triangle& t : layer.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++uses[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
    }
  }
  std::vector<Vector3d> points;
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    const Vector3d a = layer.points.row(edge.first), b = layer.points.row(edge.second);
    points.push_back(a);
    points.emplace_back(0.5 * (a + b));
  }
  return points;
}

}  // namespace

void keep_outside(FittedLayer& outer, const FittedLayer& inner, double gap, const std::vector<bool>& under) {
  constexpr double deepest = 0.04;  // metres; what is farther inside lies on another side of the body
  constexpr int rounds = 3;
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < inner.layer.triangles.size(); ++t) {
    if (under.empty() || under[t]) triangles.push_back(inner.layer.triangles[t]);
  }
  if (triangles.empty()) return;
  const ClosestPointTree tree(points_of(inner.layer), triangles);
  Points& points = outer.layer.points;
  const auto neighbours = neighbours_of(outer.layer);
  for (int round = 0; round < rounds; ++round) {
    const Points normals = vertex_normals(points, outer.layer.triangles);
    std::vector<Vector3d> shift(static_cast<std::size_t>(points.rows()), Vector3d::Zero());
    parallel_for(
        0, shift.size(),
        [&](std::size_t v) {
          const Vector3d p = points.row(static_cast<Eigen::Index>(v)).transpose();
          const Vector3d facing = normals.row(static_cast<Eigen::Index>(v)).transpose();
          const auto nearest = tree.closest(p, deepest, &facing);
          if (!nearest) return;
          const Vector3d normal = tree.normal(nearest->triangle);
          const double height = (p - nearest->point).dot(normal);
          if (height < gap) shift[v] = (gap - height) * normal;
        },
        64);
    // Neighbours come along a part of the way: no vertex is pulled out alone.
    for (std::size_t v = 0; v < shift.size(); ++v) {
      Vector3d mean = Vector3d::Zero();
      for (const std::int32_t n : neighbours[v]) mean += shift[static_cast<std::size_t>(n)];
      if (!neighbours[v].empty()) mean /= static_cast<double>(neighbours[v].size());
      const Vector3d& own = shift[v];
      const Vector3d& moved = own.squaredNorm() >= 0.25 * mean.squaredNorm() ? own : Vector3d(0.5 * mean);
      points.row(static_cast<Eigen::Index>(v)) += moved.transpose();
    }
  }
}

std::vector<bool> hidden_under(const FittedLayer& inner, const FittedLayer& outer) {
  constexpr double deepest = 0.05;   // metres under the outer layer
  constexpr double highest = 0.012;  // over it
  constexpr double touching = 0.004;
  constexpr double straight = 0.75;  // cosine
  constexpr double from_border = 0.018;
  constexpr double free = 0.25;
  const BodyLayer& cloth = outer.layer;
  const ClosestPointTree tree(points_of(cloth), cloth.triangles);
  const std::vector<Vector3d> border = border_points(cloth);
  const auto near_border = [&](const Vector3d& p) {
    return std::any_of(border.begin(), border.end(),
                       [&](const Vector3d& b) { return (b - p).squaredNorm() < from_border * from_border; });
  };

  const Points normals = vertex_normals(inner.layer.points, inner.layer.triangles);
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(inner.layer.points.rows()), 0);
  parallel_for(
      0, covered.size(),
      [&](std::size_t v) {
        const Vector3d p = inner.layer.points.row(static_cast<Eigen::Index>(v)).transpose();
        const Vector3d facing = normals.row(static_cast<Eigen::Index>(v)).transpose();
        const auto nearest = tree.closest(p, deepest, &facing);
        if (!nearest) return;
        const Vector3d to_cloth = nearest->point - p;
        if (-to_cloth.dot(tree.normal(nearest->triangle)) > highest) return;
        // Beside a rim, rather than under it, the nearest place is far along the skin.
        if (to_cloth.norm() > touching && std::abs(to_cloth.dot(facing)) < straight * to_cloth.norm()) return;
        const Triangle& corners = cloth.triangles[static_cast<std::size_t>(nearest->triangle)];
        for (const std::int32_t corner : corners) {
          if (!cloth.freedom.empty() && cloth.freedom[static_cast<std::size_t>(corner)] > free) return;
        }
        // Beyond a border the nearest place lies on it.
        if (near_border(nearest->point)) return;
        covered[v] = 1;
      },
      64);
  std::vector<bool> hidden;
  hidden.reserve(inner.layer.triangles.size());
  for (const Triangle& t : inner.layer.triangles) {
    hidden.push_back(std::all_of(t.begin(), t.end(),
                                 [&](std::int32_t v) { return covered[static_cast<std::size_t>(v)] != 0; }));
  }
  return hidden;
}

}  // namespace reprise::body
