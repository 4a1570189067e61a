// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_weights.h"

#include <algorithm>

namespace reprise {
namespace {

std::vector<std::int32_t> vertices_where(const VertexMask& mask, std::uint8_t value) {
  std::vector<std::int32_t> vertices;
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (mask[v] == value) vertices.push_back(static_cast<std::int32_t>(v));
  }
  return vertices;
}

std::vector<float> distances_to_outside(const EdgeGraph& graph, const VertexMask& inside) {
  return graph.distances(vertices_where(inside, 0));
}

bool has_neighbour_outside(const EdgeGraph& graph, const VertexMask& mask, std::int32_t vertex) {
  return std::ranges::any_of(graph.neighbours(vertex), [&](const EdgeGraph::Neighbour& next) {
    return mask[static_cast<std::size_t>(next.vertex)] == 0;
  });
}

// The connected components of the vertices in a mask.
std::vector<std::vector<std::int32_t>> components_of(const EdgeGraph& graph, const VertexMask& mask) {
  std::vector<std::vector<std::int32_t>> components;
  VertexMask is_open = mask;
  for (const std::int32_t first : vertices_where(mask, 1)) {
    if (is_open[static_cast<std::size_t>(first)] == 0) continue;
    std::vector<std::int32_t>& component = components.emplace_back(1, first);
    is_open[static_cast<std::size_t>(first)] = 0;
    for (std::size_t i = 0; i < component.size(); ++i) {
      for (const EdgeGraph::Neighbour& next : graph.neighbours(component[i])) {
        std::uint8_t& open = is_open[static_cast<std::size_t>(next.vertex)];
        if (open == 0) continue;
        open = 0;
        component.push_back(next.vertex);
      }
    }
  }
  return components;
}

VertexMask intersection(const VertexMask& a, const VertexMask& b) {
  VertexMask both(a.size());
  for (std::size_t v = 0; v < a.size(); ++v) both[v] = a[v] & b[v];
  return both;
}

void add(VertexMask& mask, const VertexMask& other) {
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] |= other[v];
}

// What of a child's territory the parent holds without ending there: the connected components of their
// overlap none of whose neighbours lies outside of the parent.
VertexMask engulfed(const EdgeGraph& graph, const VertexMask& parent, const VertexMask& child) {
  VertexMask mask(parent.size(), 0);
  for (const std::vector<std::int32_t>& component : components_of(graph, intersection(parent, child))) {
    if (std::ranges::any_of(component,
                            [&](std::int32_t v) { return has_neighbour_outside(graph, parent, v); }))
      continue;
    for (const std::int32_t v : component) mask[static_cast<std::size_t>(v)] = 1;
  }
  return mask;
}

// The interior of a territory, component by component: what lies deeper than `takeover` or than half of the
// deepest, and never the outermost ring, so that some of the territory is left to hand over in.
VertexMask interior(const EdgeGraph& graph, const VertexMask& territory, double takeover) {
  VertexMask mask(territory.size(), 0);
  const std::vector<float> depth = distances_to_outside(graph, territory);
  for (const std::vector<std::int32_t>& component : components_of(graph, territory)) {
    float deepest = 0.0F;
    for (const std::int32_t v : component) deepest = std::max(deepest, depth[static_cast<std::size_t>(v)]);
    const float begin = std::min(static_cast<float>(takeover), 0.5F * deepest);
    for (const std::int32_t v : component) {
      if (depth[static_cast<std::size_t>(v)] > begin && !has_neighbour_outside(graph, territory, v))
        mask[static_cast<std::size_t>(v)] = 1;
    }
  }
  return mask;
}

VertexMask without(const VertexMask& a, const VertexMask& b) {
  VertexMask rest(a.size());
  for (std::size_t v = 0; v < a.size(); ++v) rest[v] = a[v] & (b[v] ^ 1U);
  return rest;
}

}  // namespace

std::vector<PartDistances> part_distances(const EdgeGraph& graph, const std::vector<PartTerritory>& parts,
                                          double takeover) {
  const std::size_t vertex_count = graph.vertex_count();
  // A child hands on to those below it, so that its border is that of all of them together.
  std::vector<VertexMask> branch(parts.size());
  for (std::size_t p = parts.size(); p-- > 0;) {
    branch[p].resize(vertex_count, 0);
    add(branch[p], parts[p].holds);
    if (parts[p].parent < 0) continue;
    VertexMask& above = branch[static_cast<std::size_t>(parts[p].parent)];
    above.resize(vertex_count, 0);
    add(above, branch[p]);
  }

  std::vector<PartDistances> result(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const VertexMask& holds = parts[p].holds;
    VertexMask all_engulfed(vertex_count, 0);
    for (std::size_t c = p + 1; c < parts.size(); ++c) {
      if (parts[c].parent != static_cast<int>(p)) continue;
      const VertexMask own_engulfed = engulfed(graph, holds, branch[c]);
      add(all_engulfed, own_engulfed);
      // As if parent and child were alone.
      const std::vector<float> to_parent_end =
          distances_to_outside(graph, without(holds, interior(graph, own_engulfed, takeover)));
      const std::vector<float> to_child_border = distances_to_outside(graph, branch[c]);
      std::vector<float>& share = result[c].parent_share;
      share.resize(vertex_count);
      for (std::size_t v = 0; v < vertex_count; ++v) {
        const float sum = to_parent_end[v] + to_child_border[v];
        share[v] = sum > 0.0F && sum < EdgeGraph::unreached ? to_parent_end[v] / sum : 1.0F;
      }
    }
    result[p].to_outside =
        distances_to_outside(graph, without(holds, interior(graph, all_engulfed, takeover)));
  }
  return result;
}

}  // namespace reprise
