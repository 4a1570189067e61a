// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/leg_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/path/keyframe_case_test_support.h"

namespace reprise::path_detail {
namespace {

double steps_of(const LegGraph::Edge& edge) {
  return edge.steps;
}
double cost_of(const LegGraph::Edge& edge) {
  return edge.cost;
}

LegGraph leg_of(const test::Case& query_case) {
  return make_leg_graph(query_case.metrics(), query_case.query.keyframes[0], query_case.query.keyframes[1],
                        std::vector<bool>(query_case.transitions.size(), false));
}

// Follows every walk of at most `budget` and counts how often each edge is used by those that reach the end.
class EveryWalk {
 public:
  EveryWalk(const LegGraph& leg, double budget)
      : most(leg.edges.size(), 0), leg_(leg), budget_(budget), uses_(leg.edges.size(), 0) {
    follow(leg.first, 0.0);
  }
  std::vector<int> most;
  double least = std::numeric_limits<double>::infinity();  // length of a walk

 private:
  void follow(std::size_t node, double spent) {
    if (node == leg_.last && spent > 0.0) {
      least = std::min(least, spent);
      for (std::size_t i = 0; i < uses_.size(); ++i) most[i] = std::max(most[i], uses_[i]);
    }
    for (std::size_t i = 0; i < leg_.edges.size(); ++i) {
      const LegGraph::Edge& edge = leg_.edges[i];
      if (edge.source != node || spent + edge.steps > budget_) continue;
      ++uses_[i];
      follow(edge.target, spent + edge.steps);
      --uses_[i];
    }
  }

  const LegGraph& leg_;
  double budget_;
  std::vector<int> uses_;
};

TEST(LegGraph, NoWalkUsesAnEdgeMoreOftenThanItsBound) {
  std::mt19937 random(1);
  int met = 0;
  int edges = 0;
  for (int compared = 0; compared < 200;) {
    SCOPED_TRACE(compared);
    test::Case query_case = test::random_case(
        {.clips = 2, .min_transitions = 3, .max_transitions = 6, .max_keyframes = 2}, random);
    const LegGraph leg = leg_of(query_case);
    if (leg.edges.empty()) continue;
    ++compared;
    const double budget = 40.0;
    const EveryWalk walks(leg, budget);
    EXPECT_EQ(least_length(leg, steps_of), walks.least);
    const std::vector<double> bound = most_uses(leg, steps_of, budget);
    for (std::size_t i = 0; i < leg.edges.size(); ++i) {
      EXPECT_LE(walks.most[i], bound[i]);
      // Nought means that no walk uses the edge, and that is exact.
      EXPECT_EQ(walks.most[i] == 0, bound[i] == 0.0);
      met += walks.most[i] == static_cast<int>(bound[i]) ? 1 : 0;
      ++edges;
    }
  }
  EXPECT_GT(met, edges * 3 / 4);
}

TEST(LegGraph, LoopsWithoutLengthAreUsedWithoutBound) {
  test::Case query_case = test::walk_and_stand();
  query_case.transitions[0].cost = 0.0;
  const LegGraph leg = leg_of(query_case);
  const std::vector<double> bound = most_uses(leg, cost_of, 1.0);
  for (std::size_t i = 0; i < leg.edges.size(); ++i) {
    const LegGraph::Edge& edge = leg.edges[i];
    if (edge.transition == 0) {
      EXPECT_EQ(bound[i], unlimited);
    }
    // There and back costs 0.6, and one budget of 1 pays for it once.
    if (edge.transition == 1) {
      EXPECT_EQ(bound[i], 1.0);
    }
  }
}

TEST(LegGraph, ForbiddenTransitionsAreLeftOut) {
  const test::Case query_case = test::walk_and_stand();
  const PathMetrics metrics = query_case.metrics();
  const auto has = [&](const std::vector<bool>& forbidden, int transition) {
    const LegGraph leg =
        make_leg_graph(metrics, query_case.query.keyframes[0], query_case.query.keyframes[1], forbidden);
    return std::any_of(leg.edges.begin(), leg.edges.end(),
                       [&](const LegGraph::Edge& edge) { return edge.transition == transition; });
  };
  EXPECT_TRUE(has({false, false, false}, 1));
  EXPECT_FALSE(has({true, true, false}, 0));
  // Nothing comes back from the stand any more, so nothing leads there either.
  EXPECT_FALSE(has({false, false, true}, 1));
  EXPECT_FALSE(has({false, false, true}, 2));
}

TEST(LegGraph, WithoutAWalkThereAreNoEdges) {
  test::Case query_case = test::walk_and_stand();
  query_case.query.keyframes = {{0, 2}, {1, 3}};
  EXPECT_TRUE(leg_of(query_case).edges.empty());
}

}  // namespace
}  // namespace reprise::path_detail
