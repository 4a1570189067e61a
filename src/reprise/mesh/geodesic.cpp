// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/geodesic.h"

#include <algorithm>
#include <queue>
#include <unordered_map>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

namespace {

struct Entry {
  float distance;
  std::int32_t vertex;
  // The order is total, so that equal distances are settled alike everywhere.
  bool operator>(const Entry& other) const {
    return distance != other.distance ? distance > other.distance : vertex > other.vertex;
  }
};
using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

void check_source(std::int32_t source, std::size_t vertex_count) {
  if (source < 0 || static_cast<std::size_t>(source) >= vertex_count) {
    throw InvalidArgument(fmt::format("vertex {} is out of range: there are {}", source, vertex_count));
  }
}

}  // namespace

EdgeGraph::EdgeGraph(const Topology& topology, const PositionsView& positions) {
  if (positions.rows() != topology.vertex_count) {
    throw InvalidArgument(
        fmt::format("{} positions for {} vertices", positions.rows(), topology.vertex_count));
  }
  std::vector<std::array<std::int32_t, 2>> arcs;
  arcs.reserve(topology.triangles.size() * 6);
  for (const Triangle& t : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      arcs.push_back({t[k], t[(k + 1) % 3]});
      arcs.push_back({t[(k + 1) % 3], t[k]});
    }
  }
  std::sort(arcs.begin(), arcs.end());
  arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
  first_.assign(static_cast<std::size_t>(topology.vertex_count) + 1, 0);
  neighbours_.reserve(arcs.size());
  for (const auto& [a, b] : arcs) {
    ++first_[static_cast<std::size_t>(a) + 1];
    neighbours_.push_back({b, (positions.row(a) - positions.row(b)).norm()});
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
}

std::span<const EdgeGraph::Neighbour> EdgeGraph::neighbours(std::int32_t vertex) const {
  check_source(vertex, vertex_count());
  const auto v = static_cast<std::size_t>(vertex);
  return {neighbours_.data() + first_[v], first_[v + 1] - first_[v]};
}

std::vector<float> EdgeGraph::distances(std::span<const std::int32_t> sources, float limit,
                                        const Stretch& stretch) const {
  std::vector<float> distances(vertex_count(), unreached);
  Queue queue;
  for (const std::int32_t source : sources) {
    check_source(source, vertex_count());
    distances[static_cast<std::size_t>(source)] = 0.0F;
    queue.push({0.0F, source});
  }
  while (!queue.empty()) {
    const auto [distance, vertex] = queue.top();
    queue.pop();
    if (distance > distances[static_cast<std::size_t>(vertex)]) continue;
    for (const auto& [next, length] : neighbours(vertex)) {
      const float factor = stretch ? static_cast<float>(stretch(vertex, next)) : 1.0F;
      const float reached = distance + length * factor;
      float& known = distances[static_cast<std::size_t>(next)];
      if (reached < known && reached <= limit) {
        known = reached;
        queue.push({reached, next});
      }
    }
  }
  return distances;
}

std::vector<std::int32_t> EdgeGraph::nearest_source(std::span<const std::int32_t> sources) const {
  std::vector<std::int32_t> nearest(vertex_count(), -1);
  std::vector<float> distances(vertex_count(), unreached);
  Queue queue;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    check_source(sources[i], vertex_count());
    const auto v = static_cast<std::size_t>(sources[i]);
    if (nearest[v] >= 0) continue;
    nearest[v] = static_cast<std::int32_t>(i);
    distances[v] = 0.0F;
    queue.push({0.0F, sources[i]});
  }
  while (!queue.empty()) {
    const auto [distance, vertex] = queue.top();
    queue.pop();
    const auto v = static_cast<std::size_t>(vertex);
    if (distance > distances[v]) continue;
    for (const auto& [next, length] : neighbours(vertex)) {
      const auto n = static_cast<std::size_t>(next);
      const float reached = distance + length;
      if (reached < distances[n] || (reached == distances[n] && nearest[v] < nearest[n])) {
        distances[n] = reached;
        nearest[n] = nearest[v];
        queue.push({reached, next});
      }
    }
  }
  return nearest;
}

std::vector<EdgeGraph::Reached> EdgeGraph::neighbourhood(std::int32_t vertex, float radius) const {
  check_source(vertex, vertex_count());
  std::unordered_map<std::int32_t, float> distances = {{vertex, 0.0F}};
  std::vector<Reached> reached;
  Queue queue;
  queue.push({0.0F, vertex});
  while (!queue.empty()) {
    const auto [distance, at] = queue.top();
    queue.pop();
    if (distance > distances.at(at)) continue;
    reached.push_back({at, distance});
    for (const auto& [next, length] : neighbours(at)) {
      const float further = distance + length;
      if (further > radius) continue;
      const auto [known, is_new] = distances.try_emplace(next, further);
      if (!is_new && further >= known->second) continue;
      known->second = further;
      queue.push({further, next});
    }
  }
  return reached;
}

}  // namespace reprise
