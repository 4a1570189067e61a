// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/endless_play.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
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
using Mode = PlayOptions::Mode;

tl::expected<EndlessPlay, NoPath> play(const Case& graph, const FrameId& from, const PlayOptions& options) {
  return play_endlessly(graph.metrics(), from, options, graph.names());
}

// Loops from the definition: every simple cycle of transitions ("after a, b is next") among those that a walk
// from a frame can take.
class Loops {
 public:
  Loops(const Case& graph, const FrameId& from, const PlayOptions& options) : case_(graph) {
    for (std::size_t i = 0; i < graph.transitions.size(); ++i) {
      const Transition& transition = graph.transitions[i];
      allowed_.push_back(transition.cost <= options.max_transition_cost &&
                         transition.peak_acceleration <= options.max_peak_acceleration);
    }
    for (std::size_t i = 0; i < graph.transitions.size(); ++i) {
      const Transition& transition = graph.transitions[i];
      if (allowed_[i] && transition.source_clip == from.clip_idx &&
          transition.leave() >= static_cast<int>(from.frame_idx)) {
        reach(i);
      }
    }
    for (const std::size_t i : reached_) {
      std::vector<std::size_t> cycle{i};
      extend(cycle, 0.0, 0.0);
    }
  }

  bool any() const { return !ratios_.empty(); }
  // Metres a frame.
  double least_ratio() const { return *std::ranges::min_element(ratios_); }

 private:
  bool follows(std::size_t i, std::size_t j) const {
    const Transition& a = case_.transitions[i];
    const Transition& b = case_.transitions[j];
    return allowed_[j] && a.target_clip == b.source_clip && a.arrive() <= b.leave();
  }
  void reach(std::size_t i) {
    if (!reached_.insert(i).second) return;
    for (std::size_t j = 0; j < case_.transitions.size(); ++j) {
      if (follows(i, j)) reach(j);
    }
  }
  void extend(std::vector<std::size_t>& cycle, double cost, double frames) {
    const Transition& last = case_.transitions[cycle.back()];
    for (std::size_t j = cycle.front(); j < case_.transitions.size(); ++j) {
      if (!follows(cycle.back(), j)) continue;
      const double next_cost = cost + last.cost;
      const double next_frames = frames + 2 * last.half_window + case_.transitions[j].leave() - last.arrive();
      if (j == cycle.front()) {
        ratios_.push_back(next_cost / next_frames);
      } else if (std::ranges::count(cycle, j) == 0) {
        cycle.push_back(j);
        extend(cycle, next_cost, next_frames);
        cycle.pop_back();
      }
    }
  }

  const Case& case_;
  std::vector<bool> allowed_;
  std::set<std::size_t> reached_;
  std::vector<double> ratios_;
};

// What must hold of any walk: what it shows is in the graph, and it starts where it was asked to.
void expect_walk(const Case& graph, const FrameId& from, const MotionPath& path) {
  Case as_query = graph;
  const PathSegment& last = path.segments.back();
  as_query.query.keyframes = {from, {last.clip_idx, static_cast<std::size_t>(last.last_frame)}};
  const test::Replay played = test::replay(as_query, path);
  ASSERT_FALSE(path.segments.empty());
  EXPECT_EQ(path.segments.front().clip_idx, from.clip_idx);
  EXPECT_EQ(path.segments.front().first_frame, static_cast<int>(from.frame_idx));
  for (std::size_t i = 0; i + 1 < path.segments.size(); ++i) {
    const PathSegment& segment = path.segments[i];
    ASSERT_TRUE(segment.transition.has_value());
    EXPECT_LE(segment.first_frame, segment.last_frame);
    EXPECT_EQ(segment.transition->source_clip, segment.clip_idx);
    EXPECT_EQ(segment.transition->leave(), segment.last_frame);
    EXPECT_EQ(segment.transition->target_clip, path.segments[i + 1].clip_idx);
    EXPECT_EQ(segment.transition->arrive(), path.segments[i + 1].first_frame);
  }
  EXPECT_LE(last.first_frame, last.last_frame);
  EXPECT_EQ(path.frame_count, played.frame_count);
  EXPECT_NEAR(path.distance, played.distance, 1e-9);
  EXPECT_NEAR(path.cost, played.transition_cost, 1e-9);
}

std::vector<FrameId> shown(const Case& graph, const MotionPath& path) {
  return test::replay(graph, path).pure_frames;
}

Case random_graph(int i, std::mt19937& random) {
  Case graph = test::random_case({.clips = 1 + i % 4,
                                  .min_frames = 12,
                                  .max_frames = 20,
                                  .min_transitions = 3,
                                  .max_transitions = 9,
                                  .max_half_window = 2,
                                  .max_keyframes = 2},
                                 random);
  for (Transition& transition : graph.transitions) {
    transition.peak_acceleration = std::uniform_real_distribution<double>(0.0, 0.1)(random);
  }
  return graph;
}

PlayOptions random_limits(Mode mode, int i) {
  PlayOptions options{.mode = mode, .time = 6.0};
  if (i % 3 == 1) options.max_transition_cost = 0.4;
  if (i % 3 == 2) options.max_peak_acceleration = 0.07;
  return options;
}

TEST(EndlessPlay, TheLoopIsTheCheapestOfAllCycles) {
  std::mt19937 random(21);
  int looped = 0;
  int ended = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const Case graph = random_graph(i, random);
    const FrameId from = graph.query.keyframes.front();
    const PlayOptions options = random_limits(Mode::loop, i);
    const Loops loops(graph, from, options);
    const auto found = play(graph, from, options);
    ASSERT_EQ(found.has_value(), loops.any());
    if (!found) {
      ++ended;
      EXPECT_THAT(found.error().reason, HasSubstr("ends in a dead end"));
      continue;
    }
    ++looped;
    EXPECT_NEAR(found->loop_cost / found->period, loops.least_ratio(), 1e-10);
    expect_walk(graph, from, found->path);
    EXPECT_GE(found->path.time, options.time);
    // The first round takes the transitions of the loop.
    double round = 0.0;
    int at = 0;
    for (const PathSegment& segment : found->path.segments) {
      at += segment.last_frame - segment.first_frame;
      if (!segment.transition) break;
      if (at >= found->loop_start && at < found->loop_start + found->period) {
        round += segment.transition->cost;
      }
      at += 2 * segment.transition->half_window;
    }
    if (found->path.frame_count > found->loop_start + found->period) {
      EXPECT_NEAR(round, found->loop_cost, 1e-9);
    }
  }
  EXPECT_GT(looped, 500);
  EXPECT_GT(ended, 100);
}

// A dear short way into the loop and a cheap long one.
TEST(EndlessPlay, TheWayIntoTheLoopIsTheCheapest) {
  Case graph;
  graph.trajectories = {straight(60, 0.02), straight(60, 0.02), straight(60, 0.0)};
  graph.transitions = {make_transition(graph.trajectories, 0, 10, 2, 10, 2, 0.9),
                       make_transition(graph.trajectories, 0, 20, 1, 10, 2, 0.2),
                       make_transition(graph.trajectories, 1, 40, 2, 10, 2, 0.3),
                       make_transition(graph.trajectories, 2, 50, 2, 8, 2, 0.1)};
  const auto found = play(graph, {0, 0}, {.mode = Mode::loop, .time = 20.0});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->loop_cost, 0.1, 1e-12);
  EXPECT_EQ(found->period, 42);
  EXPECT_EQ(found->path.segments[0].transition->cost, 0.2);
  EXPECT_EQ(found->path.segments[1].transition->cost, 0.3);
  EXPECT_EQ(found->path.segments[2].transition->cost, 0.1);
}

TEST(EndlessPlay, APeriodLeadsBackToItsFirstFrame) {
  std::mt19937 random(22);
  int periods = 0;
  int uncut = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Case graph = random_graph(i, random);
    const FrameId from = graph.query.keyframes.front();
    const auto period = play(graph, from, random_limits(Mode::period, i));
    const auto loop = play(graph, from, random_limits(Mode::loop, i));
    if (!period) {
      if (loop) {
        ++uncut;
        EXPECT_THAT(period.error().reason, HasSubstr("cannot be cut"));
      }
      continue;
    }
    ++periods;
    EXPECT_EQ(period->period, loop->period);
    EXPECT_EQ(period->path.frame_count, period->period);
    EXPECT_NEAR(period->path.cost, period->loop_cost, 1e-12);
    const PathSegment& first = period->path.segments.front();
    const PathSegment& last = period->path.segments.back();
    expect_walk(graph, {first.clip_idx, static_cast<std::size_t>(first.first_frame)}, period->path);
    EXPECT_EQ(last.clip_idx, first.clip_idx);
    EXPECT_EQ(last.last_frame + 1, first.first_frame);
    // The next round goes on where this one ends: its first centre, brought onto this round, is where the
    // last clip's next frame lies.
    GroundTransform world_from_last;
    for (const PathSegment& segment : period->path.segments) {
      if (segment.transition) world_from_last = world_from_last * segment.transition->source_from_target;
    }
    const Eigen::Vector2d next =
        graph.trajectories[first.clip_idx][static_cast<std::size_t>(first.first_frame)];
    EXPECT_LT((world_from_last * next - period->start_from_next * next).norm(), 1e-9);
  }
  EXPECT_GT(periods, 200);
  EXPECT_GT(uncut, 0);
}

TEST(EndlessPlay, ARandomWalkNeverEndsAndKeepsTheLimits) {
  std::mt19937 random(23);
  int played = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const Case graph = random_graph(i, random);
    const FrameId from = graph.query.keyframes.front();
    PlayOptions options = random_limits(Mode::stochastic, i);
    options.seed = static_cast<std::uint64_t>(i);
    options.temperature = i % 2 == 0 ? 0.1 : 100.0;
    const auto found = play(graph, from, options);
    ASSERT_EQ(found.has_value(), Loops(graph, from, options).any());
    if (!found) continue;
    ++played;
    expect_walk(graph, from, found->path);
    EXPECT_GE(found->path.time, options.time);
    for (const PathSegment& segment : found->path.segments) {
      if (!segment.transition) continue;
      EXPECT_LE(segment.transition->cost, options.max_transition_cost);
      EXPECT_LE(segment.transition->peak_acceleration, options.max_peak_acceleration);
    }
    // Wherever it stops it could have gone on.
    const PathSegment& last = found->path.segments.back();
    EXPECT_TRUE(Loops(graph, {last.clip_idx, static_cast<std::size_t>(last.last_frame)}, options).any());
  }
  EXPECT_GT(played, 300);
}

TEST(EndlessPlay, TheSameSeedGivesTheSameWalkAndALongerOneBeginsAlike) {
  std::mt19937 random(24);
  std::set<double> distances;
  Case graph = random_graph(3, random);
  while (!play(graph, graph.query.keyframes.front(), {.mode = Mode::loop})) graph = random_graph(3, random);
  const FrameId from = graph.query.keyframes.front();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PlayOptions options{.time = 20.0, .seed = seed, .temperature = 10.0};
    PlayOptions longer = options;
    longer.time = 40.0;
    const auto once = play(graph, from, options);
    const auto again = play(graph, from, options);
    const auto more = play(graph, from, longer);
    EXPECT_EQ(shown(graph, once->path), shown(graph, again->path));
    std::vector<FrameId> beginning = shown(graph, more->path);
    const std::vector<FrameId> frames = shown(graph, once->path);
    ASSERT_LE(frames.size(), beginning.size());
    beginning.resize(frames.size());
    EXPECT_EQ(frames, beginning);
    distances.insert(once->path.distance);
  }
  EXPECT_GT(distances.size(), 1U) << "other seeds, other walks";
}

// Two ways round a stand: one at 0.1, one dearer by the temperature, which must be taken 1/e times as often.
TEST(EndlessPlay, ProbabilityFallsWithCostAsTheTemperatureSays) {
  Case graph;
  graph.trajectories = {straight(40, 0.0)};
  graph.transitions = {make_transition(graph.trajectories, 0, 34, 0, 6, 3, 0.1),
                       make_transition(graph.trajectories, 0, 34, 0, 6, 3, 0.3)};
  const auto found = play(graph, {0, 0}, {.time = 8000.0, .seed = 5, .temperature = 0.2});
  ASSERT_TRUE(found.has_value());
  double cheap = 0.0;
  double dear = 0.0;
  for (const PathSegment& segment : found->path.segments) {
    // The first choice is made at frame 0, where both costs to come count less.
    if (segment.transition && segment.first_frame > 0) {
      (segment.transition->cost == 0.1 ? cheap : dear) += 1.0;
    }
  }
  const double wait = std::exp(-(31.0 - 9.0) / (5.0 * fps));
  const double expected = 1.0 / (1.0 + std::exp(wait * 0.2 / 0.2));
  const double draws = cheap + dear;
  ASSERT_GT(draws, 5000.0);
  EXPECT_NEAR(dear / draws, expected, 4.0 * std::sqrt(expected * (1.0 - expected) / draws));
}

// A cheap join into a clip that can only be left at a price, and a dearer one that stays clear of it.
TEST(EndlessPlay, WhatAJoinLeadsToCounts) {
  Case graph;
  graph.trajectories = {straight(40, 0.0), straight(40, 0.02)};
  graph.transitions = {make_transition(graph.trajectories, 0, 34, 0, 6, 3, 0.2),
                       make_transition(graph.trajectories, 0, 34, 1, 6, 3, 0.1),
                       make_transition(graph.trajectories, 1, 34, 0, 6, 3, 2.0)};
  const auto visits = [&](double foresight) {
    const auto found = play(graph, {0, 0}, {.time = 300.0, .temperature = 0.0, .foresight = foresight});
    return std::ranges::count_if(found->path.segments,
                                 [](const PathSegment& segment) { return segment.clip_idx == 1; });
  };
  EXPECT_EQ(visits(5.0), 0);
  EXPECT_GT(visits(0.05), 100) << "blind to what comes";
}

TEST(EndlessPlay, ForbiddenClipsAreLeftAndNotEnteredAgain) {
  Case graph = test::walk_and_stand();
  graph.transitions.push_back(make_transition(graph.trajectories, 1, 24, 1, 4, 2, 0.05));
  PlayOptions options{.time = 30.0, .temperature = 10.0, .forbidden_clips = {0}};
  const auto found = play(graph, {0, 3}, options);
  ASSERT_TRUE(found.has_value());
  for (std::size_t i = 1; i < found->path.segments.size(); ++i) {
    EXPECT_EQ(found->path.segments[i].clip_idx, 1U);
  }
  options.forbidden_clips = {1};
  const auto other = play(graph, {0, 3}, options);
  ASSERT_TRUE(other.has_value());
  for (const PathSegment& segment : other->path.segments) EXPECT_EQ(segment.clip_idx, 0U);
}

TEST(EndlessPlay, ADeadEndIsAnOutcomeWithAReason) {
  const Case graph = test::walk_and_stand();
  const auto reason = [&](const Case& of, const FrameId& from, const PlayOptions& options) {
    const auto found = play(of, from, options);
    return found ? "it plays" : found.error().reason;
  };
  EXPECT_THAT(reason(graph, {0, 35}, {}),
              HasSubstr("every way on from clip0:35 ends in a dead end: no transition leaves 'clip0' at or "
                        "after frame 35 (the last one leaves at frame 30)"));
  EXPECT_THAT(
      reason(graph, {0, 2}, {.max_transition_cost = 0.1}),
      HasSubstr("of the 2 transitions that leave 'clip0' at or after frame 2 none is within the limits"));
  Case one_way = graph;
  one_way.transitions = {graph.transitions[1]};
  EXPECT_THAT(reason(one_way, {0, 2}, {}),
              HasSubstr("1 are within the limits, and none of these leads to a loop"));
  EXPECT_THAT(reason(one_way, {1, 2}, {}), HasSubstr("no transition leaves 'clip1'"));
}

TEST(EndlessPlay, BadArgumentsAreNamed) {
  const Case graph = test::walk_and_stand();
  const auto expect_refused = [&](const FrameId& from, const PlayOptions& options, const char* what) {
    try {
      (void)play(graph, from, options);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  expect_refused({2, 0}, {}, "expected a clip index below 2, found 2");
  expect_refused({0, 40}, {}, "expected a frame of 'clip0' below 40, found 40");
  for (const double bad : {-1.0, std::nan("")}) {
    expect_refused({0, 0}, {.time = bad}, "time:");
    expect_refused({0, 0}, {.temperature = bad}, "temperature:");
    expect_refused({0, 0}, {.foresight = bad}, "foresight:");
    expect_refused({0, 0}, {.max_transition_cost = bad}, "greatest transition cost:");
    expect_refused({0, 0}, {.max_peak_acceleration = bad}, "greatest peak acceleration:");
  }
  expect_refused({0, 0}, {.time = unlimited}, "time:");
  expect_refused({0, 0}, {.foresight = 0.0}, "foresight:");
  expect_refused({0, 0}, {.forbidden_clips = {2}}, "forbidden clip:");
  EXPECT_THROW((void)play_endlessly(graph.metrics(), {0, 0}, {}, {"one"}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
