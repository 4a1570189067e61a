// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/alternatives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/path/keyframe_case_test_support.h"

namespace reprise {
namespace {

using test::Case;
using test::fps;
using test::make_transition;
using test::straight;
using ::testing::HasSubstr;

// All walks of a query that cost no more than `cutoff`, from the definition.
class AllPaths {
 public:
  AllPaths(const Case& query_case, double cutoff)
      : case_(query_case), metrics_(query_case.metrics()), cutoff_(cutoff) {
    const FrameId first = case_.query.keyframes.front();
    explore(first.clip_idx, static_cast<int>(first.frame_idx), 1, 0.0, 0.0);
  }

  double best_beside(const std::vector<MotionPath>& answers, const AlternativesOptions& options) const {
    double best = std::numeric_limits<double>::infinity();
    for (const MotionPath& path : paths_) {
      if (path.cost < best && std::ranges::all_of(answers, [&](const MotionPath& answer) {
            return differs(path, answer, options);
          })) {
        best = path.cost;
      }
    }
    return best;
  }

 private:
  void explore(std::size_t clip_idx, int arrived, int frames, double distance, double cost) {
    const FrameId last = case_.query.keyframes.back();
    const int last_frame = static_cast<int>(last.frame_idx);
    if (last.clip_idx == clip_idx && last_frame >= arrived) {
      MotionPath path{.segments = segments_};
      path.segments.push_back(
          {.clip_idx = clip_idx, .first_frame = arrived, .last_frame = last_frame, .transition = {}});
      const test::Replay played = test::replay(case_, path);
      if (test::shows_in_order(played.pure_frames, case_.query.keyframes)) {
        path.frame_count = played.frame_count;
        path.time = played.frame_count / fps;
        path.cost = test::cost_of(case_, played.transition_cost, played.distance, played.frame_count);
        if (path.cost <= cutoff_) paths_.push_back(std::move(path));
      }
    }
    for (std::size_t i = 0; i < case_.transitions.size(); ++i) {
      const Transition& transition = case_.transitions[i];
      if (transition.source_clip != clip_idx || transition.leave() < arrived) continue;
      const int next_frames = frames + transition.leave() - arrived + 2 * transition.half_window;
      const double next_cost = cost + transition.cost;
      const double next_distance = distance + metrics_.clip_distance(clip_idx, arrived, transition.leave()) +
                                   metrics_.blend_distance(i);
      const double least =
          next_cost + case_.options.distance_weight * std::max(0.0, next_distance - case_.query.distance) +
          case_.options.time_weight * std::max(0.0, next_frames - case_.target_frames());
      if (least > cutoff_) continue;
      segments_.push_back({.clip_idx = clip_idx,
                           .first_frame = arrived,
                           .last_frame = transition.leave(),
                           .transition = transition});
      explore(transition.target_clip, transition.arrive(), next_frames, next_distance, next_cost);
      segments_.pop_back();
    }
  }

  const Case& case_;
  PathMetrics metrics_;
  double cutoff_;
  std::vector<PathSegment> segments_;
  std::vector<MotionPath> paths_;
};

tl::expected<std::vector<MotionPath>, NoPath> solve(const Case& query_case,
                                                    const AlternativesOptions& options) {
  return find_alternative_paths(query_case.metrics(), query_case.query, query_case.options, options,
                                query_case.names());
}

Case random_query(int i, std::mt19937& random) {
  Case query_case =
      test::random_case({.clips = 1 + i % 3, .max_transitions = 7, .max_keyframes = 2 + i % 2}, random);
  // Every transition costs something, so that the enumeration ends soon.
  for (Transition& transition : query_case.transitions) transition.cost = std::max(transition.cost, 0.1);
  query_case.query.distance = std::uniform_real_distribution<double>(0.0, 1.2)(random);
  query_case.query.time = std::uniform_int_distribution<int>(0, 35)(random) / fps;
  return query_case;
}

AlternativesOptions random_options(std::mt19937& random) {
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  AlternativesOptions options{.count = static_cast<std::size_t>(integer(2, 4)), .radius = integer(0, 3)};
  options.share = integer(0, 3) == 0 ? 1.0 : std::uniform_real_distribution<double>(0.05, 0.9)(random);
  return options;
}

void expect_different(const std::vector<MotionPath>& answers, const AlternativesOptions& options) {
  for (std::size_t i = 0; i < answers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_TRUE(differs(answers[i], answers[j], options)) << i << j;
  }
}

TEST(Alternatives, EachIsTheOptimumAmongThoseThatDiffer) {
  std::mt19937 random(11);
  int answered = 0;
  int exhausted = 0;
  for (int i = 0; i < 2400; ++i) {
    SCOPED_TRACE(i);
    const Case query_case = random_query(i, random);
    const AlternativesOptions options = random_options(random);
    const auto found = solve(query_case, options);
    ASSERT_EQ(found.has_value(), query_case.solve().has_value());
    if (!found) continue;
    expect_different(*found, options);
    EXPECT_NEAR(found->front().cost, query_case.solve()->cost, 1e-9);
    const bool complete = found->size() == options.count;
    const AllPaths all(query_case, complete ? found->back().cost + 1e-9 : found->back().cost + 1.5);
    std::vector<MotionPath> earlier;
    for (const MotionPath& path : *found) {
      test::expect_valid(query_case, path);
      EXPECT_EQ(path.gap(), 0.0);
      EXPECT_NEAR(all.best_beside(earlier, options), path.cost, 1e-8);
      earlier.push_back(path);
      if (earlier.size() > 1) ++answered;
    }
    if (complete) continue;
    ++exhausted;
    EXPECT_EQ(all.best_beside(earlier, options), std::numeric_limits<double>::infinity());
  }
  EXPECT_GT(answered, 300);
  EXPECT_GT(exhausted, 20);
}

TEST(Alternatives, AnEffortThatEndsEarlySaysByHowMuchItMayBeWrong) {
  std::mt19937 random(12);
  int gaps = 0;
  for (int i = 0; i < 600; ++i) {
    SCOPED_TRACE(i);
    const Case query_case = random_query(i, random);
    AlternativesOptions options = random_options(random);
    options.max_searches = static_cast<std::size_t>(1 + i % 5);
    const auto found = solve(query_case, options);
    if (!found) continue;
    expect_different(*found, options);
    double dearest = 0.0;
    for (const MotionPath& path : *found) dearest = std::max(dearest, path.cost);
    const AllPaths all(query_case, dearest + 1e-9);
    std::vector<MotionPath> earlier;
    for (const MotionPath& path : *found) {
      test::expect_valid(query_case, path);
      const double best = all.best_beside(earlier, options);
      EXPECT_LE(path.lower_bound, best + 1e-8);
      EXPECT_GE(path.cost, best - 1e-8);
      if (path.gap() == 0.0) {
        EXPECT_NEAR(path.cost, best, 1e-8);
      }
      gaps += path.gap() > 0.0 ? 1 : 0;
      earlier.push_back(path);
    }
  }
  EXPECT_GT(gaps, 5);
}

// One clip, so short that plain playing is best, with a join of length zero in time beside one that skips.
TEST(Alternatives, WhatLastsLongerOrLessLongDiffersFromPlainPlaying) {
  Case query_case;
  query_case.trajectories = {straight(60, 0.02)};
  query_case.transitions = {make_transition(query_case.trajectories, 0, 20, 0, 32, 3, 0.4),
                            make_transition(query_case.trajectories, 0, 40, 0, 25, 3, 0.5)};
  query_case.query = {.keyframes = {{0, 5}, {0, 55}}, .distance = 1.0, .time = 51 / fps};
  const auto found = solve(query_case, {.count = 3});
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->size(), 3U);
  EXPECT_EQ((*found)[0].segments.size(), 1U);
  EXPECT_EQ((*found)[0].frame_count, 51);
  const AllPaths all(query_case, (*found)[2].cost + 1e-9);
  EXPECT_NEAR((*found)[1].cost, all.best_beside({(*found)[0]}, {}), 1e-9);
  EXPECT_NEAR((*found)[2].cost, all.best_beside({(*found)[0], (*found)[1]}, {}), 1e-9);
}

TEST(Alternatives, JoinsCountByTheTimeAroundThem) {
  const std::vector<test::Trajectory> trajectories{straight(100, 0.02), straight(100, 0.02)};
  const Transition a = make_transition(trajectories, 0, 20, 1, 20, 2, 0.1);
  const Transition b = make_transition(trajectories, 1, 80, 0, 50, 2, 0.1);
  const Transition b_near = make_transition(trajectories, 1, 84, 0, 54, 2, 0.1);
  const Transition b_far = make_transition(trajectories, 1, 60, 0, 50, 2, 0.1);
  const auto path_of = [](const Transition& first, const Transition& second) {
    MotionPath path;
    path.segments = {
        {.clip_idx = 0, .first_frame = 10, .last_frame = first.leave(), .transition = first},
        {.clip_idx = 1, .first_frame = first.arrive(), .last_frame = second.leave(), .transition = second},
        {.clip_idx = 0, .first_frame = second.arrive(), .last_frame = 99, .transition = {}}};
    path.frame_count = 1;
    for (const PathSegment& segment : path.segments) {
      path.frame_count += segment.last_frame - segment.first_frame;
      if (segment.transition) path.frame_count += 2 * segment.transition->half_window;
    }
    return path;
  };
  // Around a: 9 + 57 / 2 + 3 = 40.5 frames, around b: 57 / 2 + 3 + 48 = 79.5, of 120.
  const MotionPath path = path_of(a, b);
  const MotionPath other_b = path_of(a, b_far);
  EXPECT_EQ(path.frame_count, 120);
  EXPECT_FALSE(differs(path, path, {.share = 0.01}));
  EXPECT_FALSE(differs(path_of(a, b_near), path, {.radius = 4, .share = 0.5}));
  EXPECT_TRUE(differs(path_of(a, b_near), path, {.radius = 3, .share = 0.5}));
  EXPECT_TRUE(differs(other_b, path, {.share = 79.5 / 120.0}));
  EXPECT_FALSE(differs(other_b, path, {.share = 79.6 / 120.0}));
  EXPECT_EQ(difference(path, path), 0.0);
  // Without the 20 frames 60 to 79 of clip 1.
  EXPECT_NEAR(difference(path, other_b), 20.0 / 120.0, 1e-12);
  EXPECT_EQ(difference(path, other_b), difference(other_b, path));
}

TEST(Alternatives, BadOptionsAreNamed) {
  const Case query_case = test::walk_and_stand();
  const auto expect_refused = [&](const AlternativesOptions& options, const char* what) {
    try {
      (void)solve(query_case, options);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  expect_refused({.count = 0}, "count of at least 1");
  expect_refused({.radius = -1}, "radius of at least 0 frames, found -1");
  expect_refused({.share = 0.0}, "share of joins in (0, 1], found 0");
  expect_refused({.share = 1.5}, "found 1.5");
  expect_refused({.share = std::nan("")}, "found nan");
  expect_refused({.max_searches = 0}, "at least 1 search");
}

}  // namespace
}  // namespace reprise
