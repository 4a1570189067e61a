// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Distances along the surface, measured over its edges.

#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "reprise/mesh/mesh.h"

namespace reprise {

// The vertices and edges of a surface with edge lengths in metres. Distances over edges are longer than on
// the surface by up to some 15 % on even triangles.
class EdgeGraph {
 public:
  // Throws `InvalidArgument` unless `positions` has one row per vertex.
  EdgeGraph(const Topology& topology, const PositionsView& positions);

  struct Neighbour {
    std::int32_t vertex = 0;
    float length = 0.0F;
  };
  std::size_t vertex_count() const { return first_.size() - 1; }
  // In ascending order.
  std::span<const Neighbour> neighbours(std::int32_t vertex) const;

  static constexpr float unreached = std::numeric_limits<float>::infinity();
  // Factor on the length of an edge between two vertices: below 1 where growth is eased.
  using Stretch = std::function<double(std::int32_t, std::int32_t)>;
  // Shortest distance of every vertex from the nearest source, up to `limit`; `unreached` beyond. Dijkstra.
  std::vector<float> distances(std::span<const std::int32_t> sources, float limit = unreached,
                               const Stretch& stretch = {}) const;

  // For every vertex the index (into `sources`) of the nearest source vertex, ties to the lower index; -1 if
  // unreachable.
  std::vector<std::int32_t> nearest_source(std::span<const std::int32_t> sources) const;

  struct Reached {
    std::int32_t vertex = 0;
    float distance = 0.0F;
  };
  // The vertices within `radius` of one vertex, itself included, nearest first.
  std::vector<Reached> neighbourhood(std::int32_t vertex, float radius) const;

 private:
  std::vector<std::size_t> first_;  // of each vertex's neighbours; one more entry than vertices
  std::vector<Neighbour> neighbours_;
};

}  // namespace reprise
