// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/geodesic.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/random.h"

namespace reprise {
namespace {

// A flat sheet of n x n vertices, `spacing` metres apart, both diagonals by turns.
struct Sheet {
  Sheet(int n, float spacing) : positions(n * n, 3) {
    topology.vertex_count = n * n;
    const auto at = [n](int x, int y) { return static_cast<std::int32_t>(y * n + x); };
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        positions.row(at(x, y)) << static_cast<float>(x) * spacing, static_cast<float>(y) * spacing, 0.0F;
        if (x + 1 == n || y + 1 == n) continue;
        if ((x + y) % 2 == 0) {
          topology.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
          topology.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
        } else {
          topology.triangles.push_back({at(x, y), at(x + 1, y), at(x, y + 1)});
          topology.triangles.push_back({at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
        }
      }
    }
  }
  EdgeGraph graph() const { return {topology, PositionsView(positions.data(), positions.rows(), 3)}; }

  Topology topology;
  Positions positions;
};

TEST(EdgeGraph, DistancesLieBetweenTheStraightLineAndTheWorstWayOverEdges) {
  const Sheet sheet(30, 0.1F);
  const std::vector<std::int32_t> source = {7 * 30 + 11};
  const std::vector<float> distances = sheet.graph().distances(source);
  for (int v = 0; v < sheet.topology.vertex_count; ++v) {
    const float straight = (sheet.positions.row(v) - sheet.positions.row(source[0])).norm();
    EXPECT_GE(distances[static_cast<std::size_t>(v)], straight - 1e-5F);
    // Along axes and diagonals in steps: at most sqrt(2) longer.
    EXPECT_LE(distances[static_cast<std::size_t>(v)], straight * std::sqrt(2.0F) + 1e-5F);
  }
}

TEST(EdgeGraph, EveryDistanceIsReachedFromANeighbour) {
  const Sheet sheet(20, 0.05F);
  const EdgeGraph graph = sheet.graph();
  const std::vector<std::int32_t> sources = {3, 250, 399};
  const std::vector<float> distances = graph.distances(sources);
  for (std::int32_t v = 0; v < sheet.topology.vertex_count; ++v) {
    float best = std::find(sources.begin(), sources.end(), v) != sources.end() ? 0.0F : EdgeGraph::unreached;
    for (const auto& [n, length] : graph.neighbours(v)) {
      best = std::min(best, distances[static_cast<std::size_t>(n)] + length);
    }
    EXPECT_FLOAT_EQ(distances[static_cast<std::size_t>(v)], best) << v;
  }
}

TEST(EdgeGraph, LimitCutsAndNothingElseChanges) {
  const Sheet sheet(20, 0.05F);
  const EdgeGraph graph = sheet.graph();
  const std::vector<std::int32_t> source = {210};
  const std::vector<float> all = graph.distances(source);
  const std::vector<float> near = graph.distances(source, 0.3F);
  for (std::size_t v = 0; v < all.size(); ++v) {
    EXPECT_EQ(near[v], all[v] <= 0.3F ? all[v] : EdgeGraph::unreached);
  }
  for (const auto& [v, distance] : graph.neighbourhood(210, 0.3F)) {
    EXPECT_EQ(distance, all[static_cast<std::size_t>(v)]);
  }
  EXPECT_EQ(
      graph.neighbourhood(210, 0.3F).size(),
      static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [](float d) { return d <= 0.3F; })));
}

TEST(EdgeGraph, StretchScalesLengths) {
  const Sheet sheet(12, 0.1F);
  const EdgeGraph graph = sheet.graph();
  const std::vector<std::int32_t> source = {0};
  const std::vector<float> plain = graph.distances(source);
  const std::vector<float> half =
      graph.distances(source, EdgeGraph::unreached, [](auto, auto) { return 0.5; });
  for (std::size_t v = 0; v < plain.size(); ++v) EXPECT_NEAR(half[v], 0.5F * plain[v], 1e-5F);
}

TEST(EdgeGraph, NearestSourceIsTheOneOfLeastDistance) {
  const Sheet sheet(25, 0.04F);
  const EdgeGraph graph = sheet.graph();
  std::vector<std::int32_t> sources;
  const RandomField random(4);
  for (std::uint64_t k = 0; k < 9; ++k) sources.push_back(static_cast<std::int32_t>(random.uniform(k) * 625));
  const std::vector<std::int32_t> nearest = graph.nearest_source(sources);
  std::vector<std::vector<float>> single;
  for (const std::int32_t source : sources) single.push_back(graph.distances(std::vector{source}));
  for (std::size_t v = 0; v < nearest.size(); ++v) {
    float least = EdgeGraph::unreached;
    for (const auto& distances : single) least = std::min(least, distances[v]);
    EXPECT_NEAR(single[static_cast<std::size_t>(nearest[v])][v], least, 1e-5F) << v;
  }
}

TEST(EdgeGraph, WhatIsNotConnectedIsNotReached) {
  Topology two;
  two.vertex_count = 6;
  two.triangles = {{0, 1, 2}, {3, 4, 5}};
  Positions positions = Positions::Random(6, 3);
  const EdgeGraph graph(two, PositionsView(positions.data(), 6, 3));
  const std::vector<std::int32_t> source = {1};
  EXPECT_EQ(graph.distances(source)[4], EdgeGraph::unreached);
  EXPECT_EQ(graph.nearest_source(source)[4], -1);
  EXPECT_THROW(graph.neighbourhood(6, 1.0F), InvalidArgument);
  EXPECT_THROW(graph.distances(std::vector<std::int32_t>{-1}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
