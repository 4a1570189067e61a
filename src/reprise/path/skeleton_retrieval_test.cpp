// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/skeleton_retrieval.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "reprise/path/retrieval_case_test_support.h"

namespace reprise {
namespace {

using test::answer_nodes;
using test::random_retrieval_case;
using test::RetrievalCase;
using test::RetrievalOracle;
using test::ShownNode;

// Rows are compared in single precision.
constexpr double rounding = 1e-4;

// A walk on the graph that keeps the options, and what is said of it.
void expect_valid(const RetrievalCase& c, const RetrievalOracle& oracle, const Retrieval& answer) {
  ASSERT_EQ(answer.path_frame.size(), c.query.size());
  ASSERT_EQ(answer.dissimilarity.size(), c.query.size());
  const std::vector<ShownNode> path = test::shown_nodes(c, answer.path);
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(answer.path.frame_count, static_cast<int>(path.size()));
  EXPECT_DOUBLE_EQ(answer.path.time, answer.path.frame_count / 25.0);
  EXPECT_FALSE(answer.path.segments.back().transition.has_value());
  double transition_cost = 0.0;
  int transitions = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_FALSE(oracle.forbidden(path[i]));
    if (i == 0) continue;
    const auto steps = test::steps_from(c, path[i - 1]);
    const auto step = std::ranges::find(steps, path[i], &test::GraphStep::to);
    ASSERT_NE(step, steps.end());
    transition_cost += step->cost;
    transitions += path[i].blended && path[i].position == 0 ? 1 : 0;
  }
  EXPECT_FALSE(path.front().blended);
  EXPECT_EQ(answer.path_frame.front(), 0);
  int repeats = 0;
  int skips = 0;
  int in_a_row = 0;
  double retrieval_cost = 0.0;
  for (std::size_t k = 0; k < c.query.size(); ++k) {
    const int i = answer.path_frame[k];
    ASSERT_LT(i, static_cast<int>(path.size()));
    const double dissimilarity = oracle.dissimilarity(k, path[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(answer.dissimilarity[k] * c.weight_sum(), dissimilarity, 1e-9);
    EXPECT_LE(answer.dissimilarity[k], c.options.threshold + 1e-6);
    retrieval_cost += dissimilarity;
    if (k == 0) continue;
    const int advance = i - answer.path_frame[k - 1];
    ASSERT_GE(advance, 0);
    ASSERT_LE(advance, c.options.allow_skips ? 2 : 1);
    in_a_row = advance == 0 ? in_a_row + 1 : 0;
    EXPECT_LE(in_a_row, c.options.most_repeats);
    repeats += advance == 0 ? 1 : 0;
    skips += advance == 2 ? 1 : 0;
  }
  // Nothing is behind the last frame shown but the rest of a blend and what it leads to.
  for (std::size_t i = static_cast<std::size_t>(answer.path_frame.back()) + 1; i < path.size(); ++i) {
    EXPECT_TRUE(path[i - 1].blended);
  }
  EXPECT_EQ(answer.repeats, repeats);
  EXPECT_EQ(answer.skips, skips);
  EXPECT_EQ(answer.transitions, transitions);
  EXPECT_NEAR(answer.transition_cost, transition_cost, 1e-12);
  EXPECT_NEAR(answer.path.costs.transitions, transition_cost, 1e-12);
  EXPECT_NEAR(answer.retrieval_cost, retrieval_cost, 1e-9);
  EXPECT_NEAR(answer.cost,
              transition_cost + c.options.retrieval_weight * retrieval_cost +
                  repeats * c.options.repeat_cost + skips * c.options.skip_cost,
              1e-9);
}

TEST(SkeletonRetrieval, RandomQueriesCostWhatDijkstraFinds) {
  std::mt19937 random(5);
  int found = 0;
  int with_transition = 0;
  int repeated = 0;
  int skipped = 0;
  int ended_in_blend = 0;
  for (int trial = 0; trial < 600; ++trial) {
    SCOPED_TRACE(trial);
    const RetrievalCase c = random_retrieval_case(random);
    RetrievalOracle oracle(c);
    const RetrievalOracle::Result expected = oracle.solve();
    const auto answers = c.retrieve();
    ASSERT_EQ(answers.has_value(), expected.cost.has_value());
    if (!answers) {
      EXPECT_EQ(answers.error().query_frame, expected.deepest);
      continue;
    }
    ASSERT_EQ(answers->size(), 1U);
    const Retrieval& answer = answers->front();
    EXPECT_NEAR(answer.cost, *expected.cost, rounding);
    expect_valid(c, oracle, answer);
    ++found;
    with_transition += answer.transitions > 0 ? 1 : 0;
    repeated += answer.repeats > 0 ? 1 : 0;
    skipped += answer.skips > 0 ? 1 : 0;
    ended_in_blend += answer_nodes(c, answer).back().blended ? 1 : 0;
  }
  // What the test is about happens often enough.
  EXPECT_GT(found, 200);
  EXPECT_LT(found, 550);
  EXPECT_GT(with_transition, 50);
  EXPECT_GT(repeated, 50);
  EXPECT_GT(skipped, 50);
  EXPECT_GT(ended_in_blend, 15);
}

TEST(SkeletonRetrieval, LaterAnswersAreTheBestThatStayApart) {
  std::mt19937 random(6);
  std::size_t later = 0;
  for (int trial = 0; trial < 150; ++trial) {
    SCOPED_TRACE(trial);
    RetrievalCase c = random_retrieval_case(random);
    c.options.threshold = 10.0;
    c.options.count = 4;
    c.options.apart = static_cast<int>(random() % 4);
    RetrievalOracle oracle(c);
    const auto answers = c.retrieve();
    if (!answers) continue;
    ASSERT_LE(answers->size(), c.options.count);
    for (const Retrieval& answer : *answers) {
      const auto expected = oracle.solve();
      ASSERT_TRUE(expected.cost.has_value());
      EXPECT_NEAR(answer.cost, *expected.cost, rounding);
      expect_valid(c, oracle, answer);
      const std::vector<ShownNode> nodes = answer_nodes(c, answer);
      oracle.keep_apart(nodes);
    }
    if (answers->size() < c.options.count) {
      EXPECT_FALSE(oracle.solve().cost.has_value());
    }
    later += answers->size() - 1;
  }
  EXPECT_GT(later, 150U);
}

TEST(SkeletonRetrieval, AFailureSaysWhereAndWhatThresholdIsEnough) {
  std::mt19937 random(7);
  int enough_known = 0;
  int hopeless = 0;
  for (int trial = 0; trial < 500; ++trial) {
    SCOPED_TRACE(trial);
    RetrievalCase c = random_retrieval_case(random);
    RetrievalOracle oracle(c);
    const auto answers = c.retrieve();
    if (answers) continue;
    const NoRetrieval& error = answers.error();
    double nearest = std::numeric_limits<double>::infinity();
    ShownNode nearest_node;
    for (const ShownNode& node : oracle.nodes()) {
      if (node.blended || oracle.forbidden(node)) continue;
      const double dissimilarity = oracle.dissimilarity(error.query_frame, node) / c.weight_sum();
      if (dissimilarity >= nearest) continue;
      nearest = dissimilarity;
      nearest_node = node;
    }
    if (std::isinf(nearest)) {
      EXPECT_TRUE(std::isinf(error.nearest));
      EXPECT_NE(error.reason.find("forbidden"), std::string::npos) << error.reason;
      continue;
    }
    EXPECT_NEAR(error.nearest, nearest, rounding);
    EXPECT_EQ(error.nearest_frame, fmt::format("clip{}:{}", nearest_node.owner, nearest_node.position));
    EXPECT_NE(error.reason.find(error.nearest_frame), std::string::npos) << error.reason;
    EXPECT_NE(error.reason.find(fmt::format("frame {} of", error.query_frame)), std::string::npos)
        << error.reason;
    if (std::isinf(error.enough)) {
      EXPECT_FALSE(oracle.solve(1e6).cost.has_value());
      EXPECT_NE(error.reason.find("repeats"), std::string::npos) << error.reason;
      ++hopeless;
      continue;
    }
    EXPECT_GT(error.enough, c.options.threshold);
    EXPECT_TRUE(oracle.solve(error.enough + rounding).cost.has_value());
    EXPECT_FALSE(oracle.solve(error.enough - rounding).cost.has_value());
    c.options.threshold = error.enough + 1e-6;
    EXPECT_TRUE(c.retrieve().has_value());
    ++enough_known;
  }
  EXPECT_GT(enough_known, 20);
  EXPECT_GT(hopeless, 20);
}

}  // namespace
}  // namespace reprise
