// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/keyframe_optimizer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/keyframe_program.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using Trajectory = std::vector<Eigen::Vector2d>;

constexpr double fps = 25.0;

// Straight ahead at a constant speed, metres per frame.
Trajectory straight(int frame_count, double speed) {
  Trajectory trajectory;
  for (int i = 0; i < frame_count; ++i) trajectory.emplace_back(0.0, speed * i);
  return trajectory;
}

struct Case {
  std::vector<Trajectory> trajectories;
  std::vector<Transition> transitions;
  KeyframeQuery query;
  KeyframeOptions options;

  PathMetrics metrics() const { return {trajectories, transitions, BlendProfile::smooth, fps}; }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < trajectories.size(); ++i) names.push_back(fmt::format("clip{}", i));
    return names;
  }
  tl::expected<MotionPath, NoPath> solve() const {
    return find_keyframe_path(metrics(), query, options, names());
  }
  double target_frames() const { return query.time * fps; }
};

Transition make_transition(const std::vector<Trajectory>& trajectories, std::size_t source, int m,
                           std::size_t target, int n, int half_window, double cost) {
  Transition transition;
  transition.source_clip = source;
  transition.target_clip = target;
  transition.m = m;
  transition.n = n;
  transition.half_window = half_window;
  transition.cost = cost;
  transition.source_from_target.translation =
      trajectories[source][static_cast<std::size_t>(m)] - trajectories[target][static_cast<std::size_t>(n)];
  return transition;
}

struct Sizes {
  int clips = 2;
  int min_frames = 8;
  int max_frames = 14;
  int min_transitions = 3;
  int max_transitions = 5;
  int max_half_window = 2;
  int max_keyframes = 3;
  // Transitions leave and arrive at multiples of this, so that walks of as many frames but other distances
  // meet.
  int grid = 1;
};

Case random_case(const Sizes& sizes, std::mt19937& random) {
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Case result;
  for (int i = 0; i < sizes.clips; ++i) {
    Trajectory trajectory{Eigen::Vector2d::Zero()};
    const double speed = real(0.0, 0.08);
    for (int frame = integer(sizes.min_frames, sizes.max_frames); frame > 1; --frame) {
      trajectory.push_back(trajectory.back() + Eigen::Vector2d(real(-0.02, 0.02), speed + real(-0.02, 0.02)));
    }
    result.trajectories.push_back(std::move(trajectory));
  }
  const auto last_frame = [&](std::size_t clip_idx) {
    return static_cast<int>(result.trajectories[clip_idx].size()) - 1;
  };
  // Some graphs have transitions at no cost, and then many walks cost the same.
  const bool free_transitions = integer(0, 4) == 0;
  for (int count = integer(sizes.min_transitions, sizes.max_transitions); count > 0; --count) {
    const auto source = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    const auto target = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    const int L = sizes.grid == 1 ? integer(1, sizes.max_half_window) : sizes.max_half_window;
    const int m = integer(0, (last_frame(source) - 2 * L) / sizes.grid) * sizes.grid + L;
    const int n = integer(2 * L / sizes.grid + 1, last_frame(target) / sizes.grid) * sizes.grid - L;
    const double cost = free_transitions && integer(0, 1) == 0 ? 0.0 : real(0.05, 0.6);
    result.transitions.push_back(make_transition(result.trajectories, source, m, target, n, L, cost));
    result.transitions.back().source_from_target.yaw = real(-3.0, 3.0);
  }
  for (int count = integer(2, sizes.max_keyframes); count > 0; --count) {
    const auto clip_idx = static_cast<std::size_t>(integer(0, sizes.clips - 1));
    result.query.keyframes.push_back({clip_idx, static_cast<std::size_t>(integer(0, last_frame(clip_idx)))});
  }
  return result;
}

// What a path plays, told by its segments alone.
struct Replay {
  std::vector<FrameId> pure_frames;
  double transition_cost = 0.0;
  double distance = 0.0;
  int frame_count = 0;
};

// Plays every frame, blended ones too, and adds up the distances between neighbours (Eq. 10). Each segment is
// placed by the transitions before it; only distances count, so the placing itself does not.
Replay replay(const Case& query_case, const MotionPath& path) {
  Replay result;
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    const Trajectory& source = query_case.trajectories[segment.clip_idx];
    for (int frame = segment.first_frame; frame <= segment.last_frame; ++frame) {
      result.pure_frames.push_back({segment.clip_idx, static_cast<std::size_t>(frame)});
      ++result.frame_count;
      if (frame > segment.first_frame) {
        result.distance +=
            (source[static_cast<std::size_t>(frame)] - source[static_cast<std::size_t>(frame - 1)]).norm();
      }
    }
    if (!segment.transition) continue;
    const Transition& transition = *segment.transition;
    result.transition_cost += transition.cost;
    const Trajectory& target = query_case.trajectories[transition.target_clip];
    Eigen::Vector2d previous = source[static_cast<std::size_t>(transition.leave())];
    for (int k = -transition.half_window + 1; k <= transition.half_window; ++k) {
      const double alpha = blend_weight(BlendProfile::smooth, k, transition.half_window);
      const Eigen::Vector2d target_center =
          transition.source_from_target * target[static_cast<std::size_t>(transition.n + k)];
      const Eigen::Vector2d center =
          (1.0 - alpha) * source[static_cast<std::size_t>(transition.m + k)] + alpha * target_center;
      result.distance += (center - previous).norm();
      previous = center;
      // The last frame of the window is the first pure one of the next segment.
      if (k < transition.half_window) ++result.frame_count;
    }
  }
  return result;
}

// Whether the key-frames are shown in order, from the first pure frame to the last.
bool shows_in_order(const std::vector<FrameId>& pure_frames, const std::vector<FrameId>& keyframes) {
  if (pure_frames.size() < 2 || !(pure_frames.front() == keyframes.front()) ||
      !(pure_frames.back() == keyframes.back())) {
    return false;
  }
  std::size_t due = 1;
  for (std::size_t i = 1; i + 1 < pure_frames.size() && due + 1 < keyframes.size(); ++i) {
    if (pure_frames[i] == keyframes[due]) ++due;
  }
  return due + 1 == keyframes.size();
}

double cost_of(const Case& query_case, double transition_cost, double distance, int frame_count) {
  return transition_cost +
         query_case.options.distance_weight * std::abs(distance - query_case.query.distance) +
         query_case.options.time_weight * std::abs(frame_count - query_case.target_frames());
}

// All that must hold of any answer.
void expect_valid(const Case& query_case, const MotionPath& path) {
  ASSERT_FALSE(path.segments.empty());
  for (std::size_t i = 0; i < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    EXPECT_LE(segment.first_frame, segment.last_frame);
    ASSERT_EQ(segment.transition.has_value(), i + 1 < path.segments.size());
    if (!segment.transition) continue;
    EXPECT_EQ(segment.transition->source_clip, segment.clip_idx);
    EXPECT_EQ(segment.transition->leave(), segment.last_frame);
    EXPECT_EQ(segment.transition->target_clip, path.segments[i + 1].clip_idx);
    EXPECT_EQ(segment.transition->arrive(), path.segments[i + 1].first_frame);
  }
  const Replay played = replay(query_case, path);
  EXPECT_TRUE(shows_in_order(played.pure_frames, query_case.query.keyframes));
  EXPECT_EQ(path.frame_count, played.frame_count);
  EXPECT_NEAR(path.time, played.frame_count / fps, 1e-12);
  EXPECT_NEAR(path.distance, played.distance, 1e-9);
  EXPECT_NEAR(path.transition_cost, played.transition_cost, 1e-9);
  EXPECT_NEAR(path.cost, cost_of(query_case, played.transition_cost, played.distance, played.frame_count),
              1e-8);
  EXPECT_LE(path.lower_bound, path.cost);
}

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
      if (shows_in_order(shown_, case_.query.keyframes)) {
        best_ = std::min(
            best_, cost_of(case_, cost, distance + metrics_.clip_distance(clip_idx, arrived, last_frame),
                           frames + last_frame - arrived));
      }
      shown_.resize(before);
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
      if (next_frames > most_frames_ || least > cutoff_) continue;
      const std::size_t before = shown_.size();
      show(clip_idx, arrived, transition.leave());
      explore(transition.target_clip, transition.arrive(), next_frames, next_distance, next_cost);
      shown_.resize(before);
    }
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

// A walk that can loop (0 -> 0) and a stand that it can go to and come back from.
Case walk_and_stand() {
  Case result;
  result.trajectories = {straight(40, 0.04), straight(30, 0.0)};
  result.transitions = {make_transition(result.trajectories, 0, 34, 0, 5, 4, 0.2),
                        make_transition(result.trajectories, 0, 20, 1, 6, 3, 0.3),
                        make_transition(result.trajectories, 1, 22, 0, 8, 3, 0.3)};
  result.query.keyframes = {{0, 2}, {0, 36}};
  return result;
}

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

TEST(KeyframeOptimizer, EqualsTheIntegerProgram) {
  std::mt19937 random(3);
  int cuts = 0;
  for (int solved = 0; solved < 200;) {
    SCOPED_TRACE(solved);
    // Half of the graphs are small, half have many walks that meet.
    const bool dense = solved % 2 == 1;
    Case query_case = random_case({.clips = 3,
                                   .min_frames = 20,
                                   .max_frames = 30,
                                   .min_transitions = dense ? 12 : 4,
                                   .max_transitions = dense ? 18 : 8,
                                   .max_half_window = dense ? 2 : 5,
                                   .max_keyframes = 3,
                                   .grid = dense ? 4 : 1},
                                  random);
    query_case.query.distance = std::uniform_real_distribution<double>(0.0, dense ? 6.0 : 4.0)(random);
    query_case.query.time = std::uniform_real_distribution<double>(0.0, dense ? 8.0 : 5.0)(random);
    const auto path = query_case.solve();
    if (!path || path->segments.size() < 2) continue;
    ++solved;
    expect_valid(query_case, *path);
    EXPECT_EQ(path->gap(), 0.0);
    const PathMetrics metrics = query_case.metrics();
    test::KeyframeProgram program(metrics, query_case.query, query_case.options, path->cost);
    EXPECT_NEAR(program.solve(), path->cost, 1e-6);
    cuts += program.cut_count();
  }
  // The oracle had loose loops to cut off.
  EXPECT_GT(cuts, 0);
}

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

TEST(NoPath, NamesThePairThatFailsAndWhatTheGraphLacks) {
  Case query_case = walk_and_stand();
  {  // nothing leaves
    query_case.query.keyframes = {{0, 2}, {0, 38}, {1, 20}};
    const auto path = query_case.solve();
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason,
                HasSubstr("key-frame 3 (clip1:20) cannot be reached from key-frame 2 (clip0:38)"));
    EXPECT_THAT(path.error().reason, HasSubstr("the first leads to 'clip0' from frame 38; the second"));
    EXPECT_THAT(path.error().reason,
                HasSubstr("reached from 'clip0' up to frame 30, 'clip1' up to frame 20"));
    EXPECT_THAT(
        path.error().reason,
        HasSubstr("no transition leaves 'clip0' at or after frame 38 (the last one leaves at frame 30)"));
    EXPECT_THAT(path.error().reason, Not(HasSubstr("arrives")));
  }
  {  // nothing arrives early enough
    query_case.query.keyframes = {{0, 2}, {1, 3}};
    const auto path = query_case.solve();
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason,
                HasSubstr("key-frame 2 (clip1:3) cannot be reached from key-frame 1 (clip0:2)"));
    EXPECT_THAT(
        path.error().reason,
        HasSubstr(
            "no transition arrives in 'clip1' at or before frame 3 (the first one arrives at frame 9)"));
    EXPECT_THAT(path.error().reason, Not(HasSubstr("leaves")));
  }
  {  // a clip that nothing enters or leaves
    query_case.trajectories.push_back(straight(10, 0.0));
    query_case.query.keyframes = {{0, 2}, {2, 5}};
    auto path = query_case.solve();
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason, HasSubstr("no transition arrives in 'clip2'"));
    query_case.query.keyframes = {{2, 5}, {2, 5}};
    path = query_case.solve();
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason, HasSubstr("no transition leaves 'clip2'"));
  }
  {  // two parts that do not meet
    query_case.trajectories.push_back(straight(30, 0.0));
    query_case.transitions.push_back(make_transition(query_case.trajectories, 2, 5, 3, 5, 1, 0.1));
    query_case.query.keyframes = {{0, 2}, {3, 20}};
    const auto path = query_case.solve();
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason, HasSubstr("no transition joins the one to the other"));
  }
}

TEST(KeyframeOptimizer, BadArgumentsAreNamed) {
  const Case good = walk_and_stand();
  const auto expect_refused = [&](const Case& bad, const char* what) {
    try {
      (void)bad.solve();
      ADD_FAILURE() << "accepted: " << what;
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  {
    Case bad = good;
    bad.query.keyframes.pop_back();
    expect_refused(bad, "key-frames: expected at least 2, found 1");
  }
  {
    Case bad = good;
    bad.query.keyframes[1] = {0, 40};
    expect_refused(bad, "key-frame 2: expected a frame of 'clip0' below 40, found 40");
  }
  {
    Case bad = good;
    bad.query.keyframes[0] = {2, 0};
    expect_refused(bad, "key-frame 1: expected a clip index below 2, found 2");
  }
  for (const double value : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    Case bad = good;
    bad.query.distance = value;
    expect_refused(bad, "target distance");
    bad = good;
    bad.query.time = value;
    expect_refused(bad, "target time");
    bad = good;
    bad.options.distance_weight = value;
    expect_refused(bad, "distance weight");
    bad = good;
    bad.options.time_weight = value;
    expect_refused(bad, "time weight");
    bad = good;
    bad.transitions[0].cost = value;
    expect_refused(bad, "transition 0 has cost");
  }
  {
    Case bad = good;
    bad.transitions[1].m = 38;
    expect_refused(bad, "transition 1 needs source frames 35 to 41, but the clip has frames 0 to 39");
    bad.transitions[1] = good.transitions[1];
    bad.transitions[1].target_clip = 5;
    expect_refused(bad, "transition 1 joins clips 0 and 5");
    bad.transitions[1] = good.transitions[1];
    bad.transitions[1].half_window = 0;
    expect_refused(bad, "transition 1 has half window 0");
  }
  EXPECT_THROW((void)find_keyframe_path(good.metrics(), good.query, good.options, {"one"}), InvalidArgument);
  EXPECT_THROW(PathMetrics(good.trajectories, good.transitions, BlendProfile::smooth, 0.0), InvalidArgument);
}

TEST(PathMetrics, ABlendOfTwoEqualWalksCoversTheSameGround) {
  const std::vector<Trajectory> trajectories{straight(40, 0.04)};
  const PathMetrics metrics(trajectories, {make_transition(trajectories, 0, 30, 0, 10, 6, 0.1)},
                            BlendProfile::smooth, fps);
  EXPECT_NEAR(metrics.blend_distance(0), 12 * 0.04, 1e-12);
  EXPECT_NEAR(metrics.clip_distance(0, 5, 25), 20 * 0.04, 1e-12);
}

TEST(PathMetrics, MovingAClipOnTheGroundChangesNoDistance) {
  std::mt19937 random(6);
  for (int i = 0; i < 20; ++i) {
    const Case query_case = random_case({.clips = 2, .min_frames = 20, .max_frames = 30}, random);
    const GroundTransform moved_from_clip{.yaw = 1.3, .translation = {4.0, -2.0}};
    Case moved = query_case;
    for (Eigen::Vector2d& point : moved.trajectories[1]) point = moved_from_clip * point;
    for (Transition& transition : moved.transitions) {
      if (transition.source_clip == 1) {
        transition.source_from_target = moved_from_clip * transition.source_from_target;
      }
      if (transition.target_clip == 1) {
        transition.source_from_target = transition.source_from_target * moved_from_clip.inverse();
      }
    }
    const PathMetrics before = query_case.metrics();
    const PathMetrics after = moved.metrics();
    for (std::size_t j = 0; j < query_case.transitions.size(); ++j) {
      EXPECT_NEAR(before.blend_distance(j), after.blend_distance(j), 1e-9);
    }
    EXPECT_NEAR(before.clip_distance(1, 0, 19), after.clip_distance(1, 0, 19), 1e-9);
  }
}

}  // namespace
}  // namespace reprise
