// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/transition_smoothness.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/mesh/closest_point.h"

namespace reprise {
namespace {

std::vector<std::int32_t> surface_vertices(const Topology& topology, std::size_t vertex_count) {
  std::vector<bool> used(vertex_count);
  for (const Triangle& triangle : topology.triangles) {
    for (const std::int32_t v : triangle) used.at(static_cast<std::size_t>(v)) = true;
  }
  std::vector<std::int32_t> vertices;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.push_back(static_cast<std::int32_t>(v));
  }
  return vertices;
}

// The greater of `largest` and the distance of any of `vertices` of `points` from the surface of `tree`. The
// same vertex lies on that surface, so that no distance is greater than that from it: vertices come in
// descending order of that bound, and most are never looked at.
double farthest(const std::vector<Eigen::Vector3d>& points, const std::vector<std::int32_t>& vertices,
                const std::vector<double>& bounds, const ClosestPointTree& tree, double largest) {
  for (const std::int32_t v : vertices) {
    const auto i = static_cast<std::size_t>(v);
    if (bounds[i] <= largest) break;
    const auto found = tree.closest(points[i], bounds[i]);
    largest = std::max(largest, found ? found->distance : bounds[i]);
  }
  return largest;
}

}  // namespace

double hausdorff_distance(const PositionsView& source, const PositionsView& target,
                          const GroundTransform& source_from_target, const Topology& topology) {
  if (source.rows() != target.rows()) {
    throw InvalidArgument(
        fmt::format("Hausdorff distance: expected as many vertices in both, found {} and {}", source.rows(),
                    target.rows()));
  }
  if (topology.triangles.empty())
    throw InvalidArgument("Hausdorff distance: expected a surface, found no triangles");
  const auto count = static_cast<std::size_t>(source.rows());
  const Eigen::Matrix3d rotation = source_from_target.rotation();
  const Eigen::Vector3d translation = source_from_target.translation3();
  std::vector<Eigen::Vector3d> a(count);
  std::vector<Eigen::Vector3d> b(count);
  std::vector<double> bounds(count);
  for (std::size_t v = 0; v < count; ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    a[v] = source.row(row).transpose().cast<double>();
    b[v] = rotation * target.row(row).transpose().cast<double>() + translation;
    bounds[v] = (a[v] - b[v]).norm();
  }
  std::vector<std::int32_t> vertices = surface_vertices(topology, count);
  std::ranges::sort(vertices, [&](std::int32_t v, std::int32_t w) {
    const double bound_v = bounds[static_cast<std::size_t>(v)], bound_w = bounds[static_cast<std::size_t>(w)];
    return bound_v > bound_w || (bound_v == bound_w && v < w);
  });
  const ClosestPointTree source_tree(a, topology.triangles);
  const ClosestPointTree target_tree(b, topology.triangles);
  return farthest(b, vertices, bounds, source_tree, farthest(a, vertices, bounds, target_tree, 0.0));
}

TransitionSmoothness transition_smoothness(const PerformanceDatabase& database,
                                           const Transition& transition) {
  const MeshSequence& source = database.clip(transition.source_clip);
  const MeshSequence& target = database.clip(transition.target_clip);
  const int half_window = transition.half_window;
  const auto fits = [&](int center, const MeshSequence& clip) {
    return center - half_window >= 0 && center + half_window < static_cast<int>(clip.frame_count());
  };
  if (half_window < 1 || !fits(transition.m, source) || !fits(transition.n, target)) {
    throw InvalidArgument(
        fmt::format("transition {}:{}->{}:{}: its window of {} frames either side leaves "
                    "clips of {} and {} frames",
                    source.name(), transition.m, target.name(), transition.n, half_window,
                    source.frame_count(), target.frame_count()));
  }
  double sum = 0.0;
  double weights = 0.0;
  for (int k = 1 - half_window; k < half_window; ++k) {  // at both ends alpha' is zero
    throw_if_interrupted();
    const double alpha = blend_weight(BlendProfile::linear, k, half_window);
    const double weight = std::min(1.0 - alpha, alpha);
    sum += weight * hausdorff_distance(source.frame(static_cast<std::size_t>(transition.m + k)),
                                       target.frame(static_cast<std::size_t>(transition.n + k)),
                                       transition.source_from_target, *database.topology());
    weights += weight;
  }
  return {.weighted = sum / (2.0 * half_window + 1.0), .normalized = sum / weights};
}

}  // namespace reprise
