// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/keyframe_optimizer.h"

#include <algorithm>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reprise/path/keyframe_case_test_support.h"

namespace reprise {
namespace {

using test::Case;
using test::expect_valid;
using test::make_transition;
using test::random_case;
using test::straight;
using test::walk_and_stand;

TEST(KeyframeOptimizer, LoopsMeetLongTargets) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 10.0;
  query_case.query.time = 12.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  EXPECT_EQ(path->gap(), 0.0);
  EXPECT_NEAR(path->distance, 10.0, 0.6);
  EXPECT_NEAR(path->time, 12.0, 1.0);
  EXPECT_GE(path->segments.size(), 8u);
}

TEST(KeyframeOptimizer, ZeroTargetsGiveTheShortestPath) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 0.0;
  query_case.query.time = 0.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  EXPECT_EQ(path->frame_count, 35);
  EXPECT_EQ(path->segments.size(), 1u);
  EXPECT_NEAR(path->distance, 34 * 0.04, 1e-12);
}

TEST(KeyframeOptimizer, EqualKeyframesAskForALoop) {
  Case query_case = walk_and_stand();
  query_case.query.keyframes = {{0, 15}, {0, 15}};
  query_case.query.time = 0.0;
  query_case.options.distance_weight = 0.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  ASSERT_EQ(path->segments.size(), 2u);
  // 15..30, the blend of 8 steps to 9, and on to 15.
  EXPECT_EQ(path->frame_count, 15 + 8 + 6 + 1);
}

TEST(KeyframeOptimizer, ThreeEqualKeyframesAskForTwoLoops) {
  Case query_case = walk_and_stand();
  query_case.query.keyframes = {{0, 15}, {0, 15}, {0, 15}};
  query_case.query.time = 0.0;
  query_case.options.distance_weight = 0.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  EXPECT_EQ(path->frame_count, 2 * 29 + 1);
}

TEST(KeyframeOptimizer, KeyframesAreShownInTheOrderAsked) {
  Case query_case = walk_and_stand();
  // Forward through the walk, then the stand, back to an earlier frame of the walk, then the stand again.
  query_case.query.keyframes = {{0, 2}, {0, 14}, {1, 15}, {0, 12}, {1, 12}, {0, 38}};
  query_case.query.distance = 3.0;
  query_case.query.time = 8.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  EXPECT_EQ(path->gap(), 0.0);
}

TEST(KeyframeOptimizer, AFrameInsideABlendIsNotShown) {
  Case query_case = walk_and_stand();
  // The transition into the stand arrives at frame 9, pure; frame 8 is still blended.
  query_case.query.keyframes = {{0, 2}, {1, 9}};
  EXPECT_TRUE(query_case.solve().has_value());
  query_case.query.keyframes = {{0, 2}, {1, 8}};
  EXPECT_FALSE(query_case.solve().has_value());
}

TEST(KeyframeOptimizer, AbuttingWindowsShareOneFrame) {
  Case query_case;
  query_case.trajectories = {straight(20, 0.02), straight(20, 0.03), straight(20, 0.05)};
  query_case.transitions = {
      make_transition(query_case.trajectories, 0, 10, 1, 8, 2, 0.1),
      make_transition(query_case.trajectories, 1, 13, 2, 6, 3, 0.1)};  // arrives at, leaves from 10
  query_case.query.keyframes = {{0, 8}, {1, 10}, {2, 9}};
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  ASSERT_EQ(path->segments.size(), 3u);
  EXPECT_EQ(path->segments[1].first_frame, path->segments[1].last_frame);
  EXPECT_EQ(path->frame_count, 4 + 6 + 1);
  query_case.transitions[1].m = 12;  // leaves one frame too early
  EXPECT_FALSE(query_case.solve().has_value());
}

TEST(KeyframeOptimizer, WithoutWeightsTheCheapestPathWins) {
  Case query_case = walk_and_stand();
  query_case.query.keyframes = {{0, 2}, {1, 20}};
  query_case.query.distance = 100.0;
  query_case.query.time = 100.0;
  query_case.options.distance_weight = 0.0;
  query_case.options.time_weight = 0.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_valid(query_case, *path);
  EXPECT_EQ(path->gap(), 0.0);
  EXPECT_NEAR(path->cost, 0.3, 1e-12);
}

TEST(KeyframeOptimizer, FreeLoopsEndTheSearchWhateverTheWeights) {
  for (const double distance_weight : {0.0, 1e-9, 1.0 / 0.3}) {
    for (const double time_weight : {0.0, 1e-9, 0.1}) {
      for (const double speed : {0.0, 0.04}) {
        SCOPED_TRACE(fmt::format("weights {} and {}, {} m a frame", distance_weight, time_weight, speed));
        Case query_case;
        query_case.trajectories = {straight(40, speed), straight(30, 0.0)};
        query_case.transitions = {make_transition(query_case.trajectories, 0, 30, 0, 5, 2, 0.0),
                                  make_transition(query_case.trajectories, 1, 20, 1, 6, 3, 0.0),
                                  make_transition(query_case.trajectories, 0, 22, 1, 6, 3, 0.0),
                                  make_transition(query_case.trajectories, 1, 22, 0, 8, 3, 0.0)};
        query_case.query.keyframes = {{0, 2}, {0, 36}};
        query_case.query.distance = 5.0;
        query_case.query.time = 6.0;
        query_case.options.distance_weight = distance_weight;
        query_case.options.time_weight = time_weight;
        query_case.options.max_labels = 200'000;
        const auto path = query_case.solve();
        ASSERT_TRUE(path.has_value());
        expect_valid(query_case, *path);
        EXPECT_LE(path->gap(), 1e-6);
      }
    }
  }
}

TEST(KeyframeOptimizer, ASpentBudgetLeavesAFeasiblePathAndASoundBound) {
  std::mt19937 random(4);
  int unproved = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Case query_case = random_case({.clips = 3,
                                   .min_frames = 20,
                                   .max_frames = 30,
                                   .min_transitions = 8,
                                   .max_transitions = 12,
                                   .max_half_window = 5,
                                   .max_keyframes = 3},
                                  random);
    query_case.query.distance = 5.0;
    query_case.query.time = 8.0;
    const auto best = query_case.solve();
    if (!best) continue;
    ASSERT_EQ(best->gap(), 0.0);
    for (const std::size_t max_labels : {0u, 1u, 10u, 40u, 100u}) {
      query_case.options.max_labels = max_labels;
      const auto path = query_case.solve();
      ASSERT_TRUE(path.has_value());
      expect_valid(query_case, *path);
      EXPECT_GE(path->cost, best->cost - 1e-9);
      EXPECT_LE(path->lower_bound, best->cost + 1e-9);
      unproved += path->gap() > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(unproved, 20);
}

// One optimiser for many targets, asked in any order and beyond the time it was made for, finds what each
// query finds alone.
TEST(KeyframeOptimizer, ManyTargetsOfOneQueryCostWhatEachCostsAlone) {
  std::mt19937 random(8);
  int compared = 0;
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    Case query_case =
        random_case({.clips = 3, .min_frames = 20, .max_frames = 30, .max_transitions = 10}, random);
    if (i % 3 == 0) query_case.query.max_time = 4.0;
    if (i % 3 == 1) query_case.query.min_distance = 0.5;
    const PathMetrics metrics = query_case.metrics();
    const KeyframeOptimizer optimizer(metrics, query_case.query, query_case.options, query_case.names(), 4.0);
    for (int j = 0; j < 10; ++j) {
      query_case.query.distance = std::uniform_real_distribution<double>(0.0, 4.0)(random);
      query_case.query.time = std::uniform_real_distribution<double>(0.0, 6.0)(random);
      const auto alone = query_case.solve();
      const auto shared = optimizer.find(query_case.query.distance, query_case.query.time);
      ASSERT_EQ(alone.has_value(), shared.has_value());
      if (!alone) continue;
      ++compared;
      expect_valid(query_case, *shared);
      EXPECT_EQ(shared->gap(), 0.0);
      EXPECT_NEAR(shared->cost, alone->cost, 1e-9);
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(KeyframeOptimizer, TheSameQueryGivesTheSamePath) {
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    Case query_case =
        random_case({.clips = 3, .min_frames = 20, .max_frames = 30, .max_transitions = 10}, random);
    query_case.query.distance = 3.0;
    query_case.query.time = 5.0;
    const auto first = query_case.solve();
    const auto second = query_case.solve();
    ASSERT_EQ(first.has_value(), second.has_value());
    if (!first) continue;
    EXPECT_EQ(first->cost, second->cost);
    EXPECT_EQ(first->labels, second->labels);
    ASSERT_EQ(first->segments.size(), second->segments.size());
    for (std::size_t j = 0; j < first->segments.size(); ++j) {
      EXPECT_EQ(first->segments[j].clip_idx, second->segments[j].clip_idx);
      EXPECT_EQ(first->segments[j].last_frame, second->segments[j].last_frame);
    }
    // Nor does the order of the transitions matter to the optimum.
    std::reverse(query_case.transitions.begin(), query_case.transitions.end());
    EXPECT_NEAR(query_case.solve()->cost, first->cost, 1e-9);
  }
}

}  // namespace
}  // namespace reprise
