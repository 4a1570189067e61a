// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The optimum of the exact optimiser against that of two others: an enumeration of all walks, and an integer
// program solved by GLPK.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/path/keyframe_case_test_support.h"
#include "support/keyframe_program.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;

using test::Case;
using test::expect_valid;
using test::fps;
using test::limit_at_random;
using test::random_case;
using test::Sizes;

// Enumerates walks from the definition: lists of pure stretches and transitions, judged only when complete.
// Stops following a walk once its transitions and its overshoot alone cost more than `cutoff`.
class Enumeration {
 public:
  Enumeration(const Case& query_case, double cutoff, int most_frames)
      : case_(query_case), metrics_(query_case.metrics()), cutoff_(cutoff), most_frames_(most_frames) {
    const FrameId first = case_.query.keyframes.front();
    explore(first.clip_idx, static_cast<int>(first.frame_idx), 1, 0.0, 0.0);
  }
  double best() const { return best_; }

 private:
  void explore(std::size_t clip_idx, int arrived, int frames, double distance, double cost) {
    const FrameId last = case_.query.keyframes.back();
    const int last_frame = static_cast<int>(last.frame_idx);
    if (last.clip_idx == clip_idx && last_frame >= arrived) {
      const std::size_t before = shown_.size();
      show(clip_idx, arrived, last_frame);
      const double whole_distance = distance + metrics_.clip_distance(clip_idx, arrived, last_frame);
      const int whole_frames = frames + last_frame - arrived;
      if (test::shows_in_order(shown_, case_.query.keyframes) &&
          test::keeps_limits(case_, shown_, whole_distance, whole_frames)) {
        best_ = std::min(best_, test::cost_of(case_, cost, whole_distance, whole_frames));
      }
      shown_.resize(before);
    }
    for (std::size_t i = 0; i < case_.transitions.size(); ++i) {
      const Transition& transition = case_.transitions[i];
      if (transition.source_clip != clip_idx || transition.leave() < arrived) continue;
      if (is_forbidden(transition.source_clip) || is_forbidden(transition.target_clip)) continue;
      const int next_frames = frames + transition.leave() - arrived + 2 * transition.half_window;
      const double next_cost = cost + transition.cost;
      const double next_distance = distance + metrics_.clip_distance(clip_idx, arrived, transition.leave()) +
                                   metrics_.blend_distance(i);
      const double least =
          next_cost + case_.options.distance_weight * std::max(0.0, next_distance - case_.query.distance) +
          case_.options.time_weight * std::max(0.0, next_frames - case_.target_frames());
      if (next_frames > most_frames_ || least > cutoff_) continue;
      const std::size_t before = shown_.size();
      show(clip_idx, arrived, transition.leave());
      explore(transition.target_clip, transition.arrive(), next_frames, next_distance, next_cost);
      shown_.resize(before);
    }
  }

  bool is_forbidden(std::size_t clip_idx) const {
    const std::vector<std::size_t>& forbidden = case_.query.forbidden_clips;
    return std::find(forbidden.begin(), forbidden.end(), clip_idx) != forbidden.end();
  }

  void show(std::size_t clip_idx, int first, int last) {
    for (int frame = first; frame <= last; ++frame)
      shown_.push_back({clip_idx, static_cast<std::size_t>(frame)});
  }

  const Case& case_;
  PathMetrics metrics_;
  double cutoff_;
  int most_frames_;
  std::vector<FrameId> shown_;
  double best_ = std::numeric_limits<double>::infinity();
};

TEST(KeyframeOptimizer, EqualsEnumerationOnSmallGraphs) {
  std::mt19937 random(1);
  int solved = 0;
  int looped = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    Sizes sizes;
    sizes.clips = 1 + i % 3;
    sizes.max_transitions = 7;
    sizes.max_keyframes = 2 + i % 3;
    Case query_case = random_case(sizes, random);
    query_case.query.distance = std::uniform_real_distribution<double>(0.0, 1.5)(random);
    query_case.query.time = std::uniform_int_distribution<int>(0, 45)(random) / fps;
    query_case.options.time_weight = i % 4 == 0 ? 0.3 : 0.1;
    query_case.options.distance_weight = i % 7 == 0 ? 0.0 : 1.0 / 0.3;
    const auto path = query_case.solve();
    if (!path) {
      EXPECT_EQ(Enumeration(query_case, 4.0, 45).best(), std::numeric_limits<double>::infinity())
          << path.error().reason;
      EXPECT_THAT(path.error().reason, HasSubstr("cannot be reached from"));
      continue;
    }
    ++solved;
    looped += path->segments.size() > 3 ? 1 : 0;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    EXPECT_NEAR(Enumeration(query_case, path->cost + 1e-9, 1000).best(), path->cost, 1e-8);
  }
  EXPECT_GT(solved, 600);
  EXPECT_GT(looped, 100);
}

// Long targets on graphs whose walks often meet after as many frames: what a careless search would drop by
// mistake.
TEST(KeyframeOptimizer, EqualsEnumerationWhereManyWalksMeet) {
  std::mt19937 random(7);
  for (int solved = 0; solved < 60;) {
    SCOPED_TRACE(solved);
    Case query_case = random_case({.clips = 2,
                                   .min_frames = 16,
                                   .max_frames = 24,
                                   .min_transitions = 6,
                                   .max_transitions = 8,
                                   .max_half_window = 2,
                                   .max_keyframes = 3,
                                   .grid = 4},
                                  random);
    query_case.query.distance = std::uniform_real_distribution<double>(0.5, 4.0)(random);
    query_case.query.time = std::uniform_real_distribution<double>(0.0, 2.0)(random);
    const auto path = query_case.solve();
    if (!path || path->segments.size() < 4) continue;
    ++solved;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    EXPECT_NEAR(Enumeration(query_case, path->cost + 1e-9, 1000).best(), path->cost, 1e-8);
  }
}

TEST(KeyframeOptimizer, EqualsEnumerationWhenTimeHasNoWeight) {
  std::mt19937 random(2);
  int solved = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    Case query_case = random_case({.clips = 2, .max_keyframes = 3}, random);
    // Every transition costs something, so that the enumeration ends.
    for (Transition& transition : query_case.transitions) transition.cost = std::max(transition.cost, 0.15);
    query_case.query.distance = std::uniform_real_distribution<double>(0.0, 1.5)(random);
    query_case.options.time_weight = 0.0;
    const auto path = query_case.solve();
    if (!path) continue;
    ++solved;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    EXPECT_NEAR(Enumeration(query_case, path->cost + 1e-9, 100000).best(), path->cost, 1e-8);
  }
  EXPECT_GT(solved, 150);
}

TEST(KeyframeOptimizer, EqualsEnumerationWithinLimits) {
  std::mt19937 random(12);
  int solved = 0;
  int refused = 0;
  int binding = 0;
  while (solved < 600) {
    SCOPED_TRACE(solved);
    Case query_case = random_case({.clips = 3, .max_transitions = 8, .max_keyframes = 3}, random);
    query_case.query.distance = std::uniform_real_distribution<double>(0.0, 1.5)(random);
    query_case.query.time = std::uniform_int_distribution<int>(0, 40)(random) / fps;
    const auto free = query_case.solve();
    if (!free) continue;
    limit_at_random(query_case, *free, random);
    const auto path = query_case.solve();
    if (!path) {
      ++refused;
      EXPECT_EQ(Enumeration(query_case, free->cost + 3.0, 60).best(), unlimited) << path.error().reason;
      continue;
    }
    ++solved;
    binding += path->cost > free->cost + 1e-6 ? 1 : 0;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    EXPECT_NEAR(Enumeration(query_case, path->cost + 1e-9, 1000).best(), path->cost, 1e-8);
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(binding, 50);
}

// Random weights, targets of zero, several key-frames; a third of the queries with limits.
TEST(KeyframeOptimizer, EqualsTheIntegerProgram) {
  std::mt19937 random(3);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int cuts = 0;
  int binding = 0;
  for (int compared = 0; compared < 500;) {
    SCOPED_TRACE(compared);
    // Half of the graphs are small, half have many walks that meet.
    const bool dense = compared % 2 == 1;
    Case query_case = random_case({.clips = 3,
                                   .min_frames = 20,
                                   .max_frames = 30,
                                   .min_transitions = dense ? 12 : 4,
                                   .max_transitions = dense ? 18 : 8,
                                   .max_half_window = dense ? 2 : 5,
                                   .max_keyframes = 2 + compared % 3,
                                   .grid = dense ? 4 : 1},
                                  random);
    query_case.query.distance = compared % 10 == 0 ? 0.0 : real(0.0, dense ? 6.0 : 4.0);
    query_case.query.time = compared % 10 <= 1 ? 0.0 : real(0.0, dense ? 8.0 : 5.0);
    query_case.options.distance_weight = compared % 7 == 0 ? 0.0 : real(0.5, 6.0);
    query_case.options.time_weight = real(0.03, 0.3);
    const auto free = query_case.solve();
    if (!free || free->segments.size() < 2) continue;
    if (compared % 3 == 2) limit_at_random(query_case, *free, random);
    const auto path = query_case.solve();
    if (!path) continue;
    ++compared;
    binding += path->cost > free->cost + 1e-6 ? 1 : 0;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    const PathMetrics metrics = query_case.metrics();
    test::KeyframeProgram program(metrics, query_case.query, query_case.options, path->cost);
    EXPECT_NEAR(program.solve(), path->cost, 1e-6);
    cuts += program.cut_count();
  }
  // The oracle had loose loops to cut off, and limits that told.
  EXPECT_GT(cuts, 0);
  EXPECT_GT(binding, 30);
}

}  // namespace
}  // namespace reprise
