// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/vertex_samples.h"

#include <algorithm>
#include <limits>

namespace reprise {
namespace {

constexpr std::int32_t unreached = std::numeric_limits<std::int32_t>::max();

// Edges of the triangles, compressed by rows: neighbours of v stand at offsets[v] to offsets[v + 1].
struct Neighbors {
  explicit Neighbors(const Topology& topology)
      : offsets(static_cast<std::size_t>(topology.vertex_count) + 1) {
    for (const Triangle& triangle : topology.triangles) {
      for (const std::int32_t v : triangle) offsets[static_cast<std::size_t>(v) + 1] += 2;
    }
    for (std::size_t v = 1; v < offsets.size(); ++v) offsets[v] += offsets[v - 1];
    vertices.resize(offsets.back());
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    for (const auto& [a, b, c] : topology.triangles) {
      for (const auto& [from, to] : {std::pair(a, b), {a, c}, {b, a}, {b, c}, {c, a}, {c, b}}) {
        vertices[next[static_cast<std::size_t>(from)]++] = to;
      }
    }
  }

  std::vector<std::size_t> offsets;
  std::vector<std::int32_t> vertices;
};

// Lowers `steps` to the distance from `seed` wherever that is nearer.
void spread(const Neighbors& neighbors, std::int32_t seed, std::vector<std::int32_t>& steps) {
  std::vector<std::int32_t> front = {seed};
  steps[static_cast<std::size_t>(seed)] = 0;
  for (std::int32_t step = 1; !front.empty(); ++step) {
    std::vector<std::int32_t> next_front;
    for (const std::int32_t v : front) {
      for (std::size_t e = neighbors.offsets[static_cast<std::size_t>(v)];
           e < neighbors.offsets[static_cast<std::size_t>(v) + 1]; ++e) {
        std::int32_t& reached = steps[static_cast<std::size_t>(neighbors.vertices[e])];
        if (reached <= step) continue;
        reached = step;
        next_front.push_back(neighbors.vertices[e]);
      }
    }
    front = std::move(next_front);
  }
}

}  // namespace

std::vector<std::int32_t> sample_vertices(const Topology& topology, int count) {
  const Neighbors neighbors(topology);
  std::vector<std::int32_t> steps(static_cast<std::size_t>(topology.vertex_count),
                                  -1);  // -1: not to be sampled
  std::int32_t used_count = 0;
  for (std::size_t v = 0; v < steps.size(); ++v) {
    if (neighbors.offsets[v] == neighbors.offsets[v + 1]) continue;
    steps[v] = unreached;
    ++used_count;
  }
  std::vector<std::int32_t> samples;
  while (static_cast<std::int32_t>(samples.size()) < std::min(count, used_count)) {
    const auto farthest = static_cast<std::int32_t>(std::ranges::max_element(steps) - steps.begin());
    samples.push_back(farthest);
    spread(neighbors, farthest, steps);
  }
  return samples;
}

}  // namespace reprise
