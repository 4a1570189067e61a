// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/surface_loop.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise::skeleton {
namespace {

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint64_t>(high);
}

// Triangle across each side (k, k + 1), or -1 at a border and where more than two meet.
std::vector<std::array<std::int32_t, 3>> triangles_across(const Topology& topology) {
  struct Side {
    std::uint64_t edge;
    std::int32_t triangle;
    int k;
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const Triangle& corners = topology.triangles[t];
    for (int k = 0; k < 3; ++k) {
      sides.push_back(
          {edge_key(corners[static_cast<std::size_t>(k)], corners[static_cast<std::size_t>((k + 1) % 3)]),
           static_cast<std::int32_t>(t), k});
    }
  }
  std::ranges::sort(sides, {}, [](const Side& side) { return std::pair(side.edge, side.triangle); });
  std::vector<std::array<std::int32_t, 3>> across(topology.triangles.size(), {-1, -1, -1});
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    if (end == i + 2) {
      const Side& a = sides[i];
      const Side& b = sides[i + 1];
      across[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.k)] = b.triangle;
      across[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.k)] = a.triangle;
    }
    i = end;
  }
  return across;
}

std::int32_t triangle_at(const Topology& topology, std::int32_t vertex) {
  const auto found = std::ranges::find_if(topology.triangles, [&](const Triangle& triangle) {
    return std::ranges::find(triangle, vertex) != triangle.end();
  });
  return found == topology.triangles.end() ? -1
                                           : static_cast<std::int32_t>(found - topology.triangles.begin());
}

}  // namespace

LoopFinder::LoopFinder(const Topology& topology, const PositionsView& positions, std::int32_t base,
                       std::span<const std::int32_t> terminals)
    : positions_(positions), graph_(topology, positions) {
  if (terminals.size() > 32) {
    throw InvalidArgument(fmt::format("{} terminals; expected at most 32", terminals.size()));
  }
  // Breadth first over triangles from the base; the way back from each terminal is its path.
  const auto across = triangles_across(topology);
  const std::int32_t first = triangle_at(topology, base);
  std::vector<std::int32_t> before(topology.triangles.size(), -1);
  std::vector<std::int32_t> queue;
  if (first >= 0) {
    queue.push_back(first);
    before[static_cast<std::size_t>(first)] = first;
  }
  for (std::size_t i = 0; i < queue.size(); ++i) {
    for (const std::int32_t next : across[static_cast<std::size_t>(queue[i])]) {
      if (next < 0 || before[static_cast<std::size_t>(next)] >= 0) continue;
      before[static_cast<std::size_t>(next)] = queue[i];
      queue.push_back(next);
    }
  }
  for (std::size_t i = 0; i < terminals.size(); ++i) {
    std::int32_t triangle = triangle_at(topology, terminals[i]);
    if (triangle < 0 || before[static_cast<std::size_t>(triangle)] < 0) {
      throw InvalidArgument(
          fmt::format("terminal {} (vertex {}) is not joined with vertex {}", i, terminals[i], base));
    }
    while (triangle != first) {
      const std::int32_t next = before[static_cast<std::size_t>(triangle)];
      const auto& sides = across[static_cast<std::size_t>(triangle)];
      const auto k = static_cast<std::size_t>(std::ranges::find(sides, next) - sides.begin());
      const Triangle& corners = topology.triangles[static_cast<std::size_t>(triangle)];
      crossings_.push_back({edge_key(corners[k], corners[(k + 1) % 3]), std::uint32_t{1} << i});
      triangle = next;
    }
  }
  std::ranges::sort(crossings_, {}, &Crossing::edge);
  std::vector<Crossing> merged;
  for (const Crossing& crossing : crossings_) {
    if (!merged.empty() && merged.back().edge == crossing.edge) {
      merged.back().terminals ^= crossing.terminals;
    } else {
      merged.push_back(crossing);
    }
  }
  crossings_ = std::move(merged);
}

std::uint32_t LoopFinder::crossed(std::int32_t a, std::int32_t b) const {
  const std::uint64_t key = edge_key(a, b);
  const auto found = std::ranges::lower_bound(crossings_, key, {}, &Crossing::edge);
  return found != crossings_.end() && found->edge == key ? found->terminals : 0;
}

std::vector<std::int32_t> LoopFinder::loop(std::int32_t through, std::uint32_t separated,
                                           std::int32_t tip) const {
  const std::vector<float> from_tip = graph_.distances(std::array{tip});
  const float nearest = 0.5F * from_tip[static_cast<std::size_t>(through)];
  const auto is_near_tip = [&](std::int32_t v) { return from_tip[static_cast<std::size_t>(v)] < nearest; };
  const std::vector<float> distance =
      graph_.distances(std::array{through}, EdgeGraph::unreached, [&](std::int32_t a, std::int32_t b) {
        return is_near_tip(a) || is_near_tip(b) ? std::numeric_limits<double>::infinity() : 1.0;
      });
  const std::size_t n = graph_.vertex_count();
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {},
                    [&](std::int32_t v) { return std::pair(distance[static_cast<std::size_t>(v)], v); });

  // The tree of shortest paths from `through`, and which paths of triangles lie across each vertex's path to
  // it.
  std::vector<std::int32_t> before(n, -1);
  std::vector<std::uint32_t> across(n, 0);
  for (const std::int32_t v : order) {
    const auto at = static_cast<std::size_t>(v);
    if (v == through || distance[at] == EdgeGraph::unreached) continue;
    float best = EdgeGraph::unreached;
    for (const auto& [u, length] : graph_.neighbours(v)) {
      const float reached = distance[static_cast<std::size_t>(u)];
      const bool is_settled = reached < distance[at] || (reached == distance[at] && u < v);
      if (is_settled && reached + length < best) {
        best = reached + length;
        before[at] = u;
      }
    }
    if (before[at] >= 0) across[at] = across[static_cast<std::size_t>(before[at])] ^ crossed(v, before[at]);
  }

  // Every edge outside of the tree closes a loop.
  float shortest = EdgeGraph::unreached;
  std::pair<std::int32_t, std::int32_t> closing{-1, -1};
  for (std::int32_t u = 0; u < static_cast<std::int32_t>(n); ++u) {
    for (const auto& [v, length] : graph_.neighbours(u)) {
      if (v < u || before[static_cast<std::size_t>(u)] == v || before[static_cast<std::size_t>(v)] == u)
        continue;
      const float total =
          distance[static_cast<std::size_t>(u)] + distance[static_cast<std::size_t>(v)] + length;
      const std::uint32_t bits =
          across[static_cast<std::size_t>(u)] ^ across[static_cast<std::size_t>(v)] ^ crossed(u, v);
      if (total < shortest && bits == separated) {
        shortest = total;
        closing = {u, v};
      }
    }
  }
  if (closing.first < 0) return {};
  const auto path = [&](std::int32_t from) {
    std::vector<std::int32_t> vertices;
    for (std::int32_t v = from; v >= 0; v = before[static_cast<std::size_t>(v)]) vertices.push_back(v);
    return vertices;  // ends with `through`
  };
  std::vector<std::int32_t> one = path(closing.first);
  std::vector<std::int32_t> other = path(closing.second);
  // Both may start with a common way from `through`, which is not part of the loop; a long one means that the
  // loop is elsewhere.
  while (one.size() > 1 && other.size() > 1 && one[one.size() - 2] == other[other.size() - 2]) {
    one.pop_back();
    other.pop_back();
  }
  constexpr float longest_way = 0.1F;  // of the loop
  const float way = distance[static_cast<std::size_t>(one.back())];
  if (way > longest_way * (shortest - 2.0F * way)) return {};
  if (one.back() == other.back()) other.pop_back();
  one.insert(one.end(), other.rbegin(), other.rend());
  return one;
}

std::vector<bool> LoopFinder::beyond(const std::vector<std::int32_t>& loop, std::int32_t start) const {
  std::vector<bool> reached(graph_.vertex_count(), false);
  for (const std::int32_t v : loop) reached[static_cast<std::size_t>(v)] = true;
  std::vector<std::int32_t> queue;
  if (!reached[static_cast<std::size_t>(start)]) queue.push_back(start);
  reached[static_cast<std::size_t>(start)] = true;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    for (const auto& [v, length] : graph_.neighbours(queue[i])) {
      if (reached[static_cast<std::size_t>(v)]) continue;
      reached[static_cast<std::size_t>(v)] = true;
      queue.push_back(v);
    }
  }
  return reached;
}

Eigen::Vector3d LoopFinder::centroid(const std::vector<std::int32_t>& loop) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double length = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector3d a = positions_.row(loop[i]).transpose().cast<double>();
    const Eigen::Vector3d b = positions_.row(loop[(i + 1) % loop.size()]).transpose().cast<double>();
    sum += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  return sum / length;
}

}  // namespace reprise::skeleton
