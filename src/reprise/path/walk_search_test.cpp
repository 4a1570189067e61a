// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/walk_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace reprise::path_detail {
namespace {

constexpr double distance_unit = 1.0 / 128.0;  // all distances are multiples of it

// A chain from start to end, so that the end can be reached, with random edges forward and back.
StateGraph random_graph(int node_count, int edges_per_node, std::mt19937& random) {
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  StateGraph graph;
  for (int node = 0; node + 1 < node_count; ++node) {
    graph.first_edge.push_back(static_cast<std::int32_t>(graph.edges.size()));
    for (int i = 0; i < edges_per_node; ++i) {
      StateEdge edge;
      edge.target = i == 0 ? node + 1 : integer(0, node_count - 2);
      edge.steps = integer(2, 9);
      edge.distance = integer(0, 64) * distance_unit;
      edge.cost = std::uniform_real_distribution<double>(0.1, 0.2)(random);
      graph.edges.push_back(edge);
    }
  }
  graph.first_edge.insert(graph.first_edge.end(), 2, static_cast<std::int32_t>(graph.edges.size()));
  return graph;
}

double penalty(const WalkTargets& targets, double distance, int steps) {
  return targets.distance_weight * std::abs(distance - targets.distance) +
         targets.time_weight * std::abs(steps + 1 - targets.frames);
}

// The least cost over all walks of at most `most_steps` frames and `most_units` of distance: every state
// there is.
double exhaustive(const StateGraph& graph, const WalkTargets& targets, int most_steps, int most_units) {
  const auto nodes = static_cast<std::size_t>(graph.node_count());
  const auto units = static_cast<std::size_t>(most_units) + 1;
  const auto cell = [&](int steps, std::size_t node, std::size_t unit) {
    return (static_cast<std::size_t>(steps) * nodes + node) * units + unit;
  };
  std::vector<double> cost((static_cast<std::size_t>(most_steps) + 1) * nodes * units,
                           std::numeric_limits<double>::infinity());
  cost[cell(0, static_cast<std::size_t>(graph.start), 0)] = 0.0;
  double best = std::numeric_limits<double>::infinity();
  for (int steps = 0; steps <= most_steps; ++steps) {
    for (std::size_t unit = 0; unit < units; ++unit) {
      best = std::min(best, cost[cell(steps, nodes - 1, unit)] +
                                penalty(targets, static_cast<double>(unit) * distance_unit, steps));
    }
    for (std::size_t node = 0; node + 1 < nodes; ++node) {
      for (auto i = static_cast<std::size_t>(graph.first_edge[node]);
           i < static_cast<std::size_t>(graph.first_edge[node + 1]); ++i) {
        const StateEdge& edge = graph.edges[i];
        if (steps + edge.steps > most_steps) continue;
        const auto added = static_cast<std::size_t>(std::lround(edge.distance / distance_unit));
        for (std::size_t unit = 0; unit + added < units; ++unit) {
          double& there = cost[cell(steps + edge.steps, static_cast<std::size_t>(edge.target), unit + added)];
          there = std::min(there, cost[cell(steps, node, unit)] + edge.cost);
        }
      }
    }
  }
  return best;
}

void expect_walk_costs_what_it_says(const StateGraph& graph, const WalkTargets& targets, const Walk& walk) {
  double cost = 0.0;
  double distance = 0.0;
  int steps = 0;
  std::int32_t node = graph.start;
  for (const std::int32_t edge_idx : walk.edges) {
    ASSERT_GE(edge_idx, graph.first_edge[static_cast<std::size_t>(node)]);
    ASSERT_LT(edge_idx, graph.first_edge[static_cast<std::size_t>(node) + 1]);
    const StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    cost += edge.cost;
    distance += edge.distance;
    steps += edge.steps;
    node = edge.target;
  }
  EXPECT_EQ(node, graph.end());
  EXPECT_NEAR(walk.cost, cost + penalty(targets, distance, steps), 1e-9);
}

TEST(WalkSearch, EqualsExhaustiveSearchOfAllStates) {
  std::mt19937 random(1);
  std::size_t labels = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const StateGraph graph = random_graph(8 + i % 12, 3, random);
    const WalkTargets targets{.distance = std::uniform_real_distribution<double>(0.0, 12.0)(random),
                              .frames = std::uniform_real_distribution<double>(0.0, 300.0)(random),
                              .distance_weight = i % 3 == 0 ? 1.0 : 1.0 / 0.3,
                              .time_weight = i % 2 == 0 ? 0.1 : 0.05};
    const Walk walk = find_cheapest_walk(graph, targets, 4'000'000);
    labels += walk.labels;
    expect_walk_costs_what_it_says(graph, targets, walk);
    EXPECT_EQ(walk.lower_bound, walk.cost);
    // No better walk is longer or farther than this.
    const int most_steps = static_cast<int>(targets.frames + walk.cost / targets.time_weight);
    const int most_units =
        static_cast<int>((targets.distance + walk.cost / targets.distance_weight) / distance_unit) + 1;
    EXPECT_NEAR(walk.cost, exhaustive(graph, targets, most_steps, most_units), 1e-8);
  }
  EXPECT_GT(labels, 50000u);
}

TEST(WalkSearch, MoreLabelsNeverWidenTheGap) {
  std::mt19937 random(2);
  for (int i = 0; i < 10; ++i) {
    const StateGraph graph = random_graph(30, 3, random);
    const WalkTargets targets{
        .distance = 12.0, .frames = 250.0, .distance_weight = 1.0 / 0.3, .time_weight = 0.1};
    const Walk best = find_cheapest_walk(graph, targets, 4'000'000);
    ASSERT_EQ(best.lower_bound, best.cost);
    double lower_bound = 0.0;
    for (const std::size_t max_labels : {10u, 100u, 1000u, 10000u}) {
      const Walk walk = find_cheapest_walk(graph, targets, max_labels);
      expect_walk_costs_what_it_says(graph, targets, walk);
      EXPECT_GE(walk.cost, best.cost - 1e-9);
      EXPECT_LE(walk.lower_bound, best.cost + 1e-9);
      EXPECT_GE(walk.lower_bound, lower_bound - 1e-9);
      lower_bound = walk.lower_bound;
    }
  }
}

// A weight on time too small for a table over time: the bound still holds, and the gap is no wider than what
// the walk's time costs.
TEST(WalkSearch, AHardlyWeightedTimeLeavesASmallGap) {
  std::mt19937 random(3);
  for (int i = 0; i < 10; ++i) {
    const StateGraph graph = random_graph(20, 3, random);
    WalkTargets targets{.distance = 3.0, .frames = 100.0, .distance_weight = 1.0 / 0.3, .time_weight = 1e-7};
    const Walk walk = find_cheapest_walk(graph, targets, 1'000'000);
    expect_walk_costs_what_it_says(graph, targets, walk);
    EXPECT_LE(walk.lower_bound, walk.cost);
    EXPECT_LT(walk.cost - walk.lower_bound, 1e-4);
    targets.time_weight = 0.0;
    EXPECT_NEAR(find_cheapest_walk(graph, targets, 1'000'000).cost, walk.lower_bound, 1e-4);
  }
}

}  // namespace
}  // namespace reprise::path_detail
