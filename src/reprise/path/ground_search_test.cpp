// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_search.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/path/ground_case_test_support.h"

namespace reprise {
namespace {

using test::Case;
using test::exhaust;
using test::Exhausted;
using test::fps;
using test::ground_cost;
using test::make_transition;
using test::PlayedWalk;
using test::random_goal;
using test::Trajectory;
using test::turning_case;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double degrees = std::numbers::pi / 180.0;

tl::expected<MotionPath, NoPath> solve(const Case& query_case) {
  return find_ground_path(query_case.metrics(), query_case.query, query_case.options, query_case.names());
}

GroundRoute random_route(std::mt19937& random) {
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  GroundRoute route{.points = {Eigen::Vector2d(real(-0.1, 0.1), real(-0.1, 0.1))}};
  for (int i = 0; i < 3; ++i) {
    route.points.emplace_back(route.points.back() + Eigen::Vector2d(real(-0.5, 0.5), real(-0.2, 0.6)));
  }
  return route;
}

// The path's own account of itself, played anew.
PlayedWalk played(const Case& query_case, const MotionPath& path) {
  const GroundTrack track = ground_track(query_case.metrics(), path);
  return {.centers = track.centers, .turn = track.turn, .transition_cost = path.costs.transitions};
}

void expect_consistent(const Case& query_case, const MotionPath& path) {
  const test::Replay replay = test::replay(query_case, path);
  EXPECT_TRUE(test::shows_in_order(replay.pure_frames, query_case.query.keyframes));
  EXPECT_TRUE(test::keeps_limits(query_case, replay.pure_frames, replay.distance, replay.frame_count));
  EXPECT_EQ(path.frame_count, replay.frame_count);
  EXPECT_NEAR(path.distance, replay.distance, 1e-9);
  EXPECT_NEAR(path.costs.transitions, replay.transition_cost, 1e-9);
  EXPECT_NEAR(path.cost, path.costs.total(), 1e-12);
  EXPECT_NEAR(path.cost, ground_cost(query_case, played(query_case, path)), 1e-8);  // finite: limits are kept
  EXPECT_LE(path.lower_bound, path.cost);
}

void expect_optimum(const Case& query_case) {
  const Exhausted truth = exhaust(query_case);
  const tl::expected<MotionPath, NoPath> path = solve(query_case);
  if (std::isinf(truth.least_cost)) {
    ASSERT_FALSE(path.has_value());
    EXPECT_THAT(path.error().reason, HasSubstr("There is none: proved."));
    return;
  }
  ASSERT_TRUE(path.has_value()) << path.error().reason;
  expect_consistent(query_case, *path);
  EXPECT_EQ(path->gap(), 0.0);
  EXPECT_NEAR(path->cost, truth.least_cost, 1e-8);
}

TEST(GroundSearch, TheOptimumForAGoalIsThatOfAllPaths) {
  std::mt19937 random(1);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.goal = random_goal(random);
    expect_optimum(query_case);
  }
}

TEST(GroundSearch, TheOptimumForARouteIsThatOfAllPaths) {
  std::mt19937 random(2);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.route = random_route(random);
    if (i % 3 == 0) query_case.query.goal = random_goal(random);
    expect_optimum(query_case);
  }
}

TEST(GroundSearch, HardLimitsAreKeptOrProvedToBeTooMuch) {
  std::mt19937 random(3);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int infeasible = 0;
  int count = 0;
  for (; count < 80; ++count) {
    SCOPED_TRACE(count);
    Case query_case = turning_case(random);
    KeyframeQuery& query = query_case.query;
    if (count % 4 != 0) {
      query.goal = random_goal(random);
      query.goal->position_tolerance = real(0.1, 0.6);
      query.goal->turn_tolerance = real(0.3, 2.0);
    }
    if (count % 4 == 0 || count % 4 == 3) {
      query.route = random_route(random);
      query.route->max_deviation = real(0.2, 0.6);
    }
    if (count % 2 == 0) {
      query.min_distance = real(0.0, 0.5);
      query.max_distance = query.min_distance + real(0.3, 1.5);
      query.min_time = real(0.0, 0.6);
    }
    if (query.goal && query.goal->position.norm() > query.goal->position_tolerance + query.max_distance)
      continue;
    if (std::isinf(exhaust(query_case).least_cost)) ++infeasible;
    expect_optimum(query_case);
  }
  EXPECT_GT(infeasible, 5);
  EXPECT_LT(infeasible, count - 20);
}

TEST(GroundSearch, WhenLabelsRunOutTheBoundsStillHold) {
  std::mt19937 random(4);
  int open = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.goal = random_goal(random);
    if (i % 2 == 0) query_case.query.route = random_route(random);
    query_case.options.max_labels = 60;
    const tl::expected<MotionPath, NoPath> path = solve(query_case);
    if (!path) {
      EXPECT_THAT(path.error().reason, Not(HasSubstr("There is none: proved.")));
      continue;
    }
    expect_consistent(query_case, *path);
    const double optimum = exhaust(query_case).least_cost;
    EXPECT_LE(path->lower_bound, optimum + 1e-8);
    EXPECT_GE(path->cost, optimum - 1e-8);
    if (path->gap() > 0.0) ++open;
  }
  EXPECT_GT(open, 5);
}

// Without a greatest time the search sets its own horizon, and must say what lies beyond.
TEST(GroundSearch, WithoutAGreatestTimeTheProofHoldsForLongerPathsToo) {
  std::mt19937 random(5);
  int proved = 0;
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.goal = random_goal(random);
    query_case.options.time_weight = i % 3 == 0 ? 0.0 : 0.3;
    query_case.options.max_labels = 40'000;
    Case open_end = query_case;
    open_end.query.max_time = unlimited;
    const tl::expected<MotionPath, NoPath> path = solve(open_end);
    ASSERT_TRUE(path.has_value());
    expect_consistent(open_end, *path);
    const double optimum = exhaust(query_case).least_cost;  // of the paths that are short enough to list
    EXPECT_LE(path->lower_bound, optimum + 1e-8);
    if (path->gap() == 0.0) {
      ++proved;
      EXPECT_LE(path->cost, optimum + 1e-8);
    }
  }
  EXPECT_GT(proved, 10);
}

// The same database captured with each clip lying elsewhere.
Case moved(const Case& query_case, const std::vector<GroundTransform>& moved_from_clip) {
  Case result = query_case;
  for (std::size_t i = 0; i < result.trajectories.size(); ++i) {
    for (Eigen::Vector2d& point : result.trajectories[i]) point = moved_from_clip[i] * point;
  }
  for (Transition& transition : result.transitions) {
    transition.source_from_target = moved_from_clip[transition.source_clip] * transition.source_from_target *
                                    moved_from_clip[transition.target_clip].inverse();
  }
  return result;
}

TEST(GroundSearch, WhereClipsWereCapturedChangesNothing) {
  std::mt19937 random(6);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.goal = random_goal(random);
    query_case.query.route = random_route(random);
    const tl::expected<MotionPath, NoPath> before = solve(query_case);
    ASSERT_TRUE(before.has_value());

    // Moved anywhere: the same query.
    const Case elsewhere = moved(
        query_case, {{.yaw = 0.0, .translation = {3.0, -2.0}}, {.yaw = 0.0, .translation = {-5.0, 1.0}}});
    const tl::expected<MotionPath, NoPath> after = solve(elsewhere);
    ASSERT_TRUE(after.has_value());
    EXPECT_NEAR(before->cost, after->cost, 1e-8);

    // All turned together: the query turns with the axes, and how far the performer turns is the same.
    const GroundTransform turned_from_clip{.yaw = 1.1, .translation = {0.5, 0.25}};
    Case turned = moved(query_case, {turned_from_clip, turned_from_clip});
    const GroundTransform turn{.yaw = 1.1};
    turned.query.goal->position = turn * turned.query.goal->position;
    for (Eigen::Vector2d& point : turned.query.route->points) point = turn * point;
    const tl::expected<MotionPath, NoPath> again = solve(turned);
    ASSERT_TRUE(again.has_value());
    EXPECT_NEAR(before->cost, again->cost, 1e-8);
    EXPECT_NEAR(ground_track(query_case.metrics(), *before).turn, ground_track(turned.metrics(), *again).turn,
                1e-8);
  }
}

// Walks of all kinds, their ends as goals and their own tracks as routes: each must be found again.
TEST(GroundSearch, AWalkIsFoundByItsOwnTrack) {
  std::mt19937 random(7);
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    Case query_case = turning_case(random);
    query_case.query.max_time = 30.0 / fps;
    std::vector<PlayedWalk> walks;
    test::EveryPath(query_case, [&](const PlayedWalk& walk) {
      if (walk.distance() > 0.1) walks.push_back(walk);
    });
    if (walks.empty()) continue;
    const PlayedWalk& walk = walks[random() % walks.size()];
    KeyframeQuery& query = query_case.query;
    query.distance = walk.distance();
    query.time = static_cast<double>(walk.centers.size()) / fps;
    query.goal = GroundGoal{.position = walk.centers.back(),
                            .turn = walk.turn,
                            .position_tolerance = 1e-6,
                            .turn_tolerance = 1e-6};
    query.route = GroundRoute{.points = walk.centers, .max_deviation = 1e-6};
    const tl::expected<MotionPath, NoPath> path = solve(query_case);
    ASSERT_TRUE(path.has_value()) << path.error().reason;
    EXPECT_LE(path->cost, walk.transition_cost + 1e-6);
    const PlayedWalk found = played(query_case, *path);
    EXPECT_NEAR((found.centers.back() - walk.centers.back()).norm(), 0.0, 2e-6);
    EXPECT_NEAR(wrap_angle(found.turn - walk.turn), 0.0, 2e-6);
  }
}

// A walk straight on (0) and one that turns by 30 degrees to the left (1): any route can be walked.
Case walk_and_turn() {
  Case result;
  const int frames = 30;
  Trajectory arc{Eigen::Vector2d::Zero()};
  const double step = 0.04;
  for (int i = 1; i < frames; ++i) {
    const double heading = 30.0 * degrees * (i - 0.5) / (frames - 1);
    arc.emplace_back(arc.back() + step * Eigen::Vector2d(std::sin(heading), std::cos(heading)));
  }
  result.trajectories = {test::straight(frames, step), arc};
  const auto join = [&](std::size_t source, std::size_t target) {
    const int L = 3;
    Transition transition = make_transition(result.trajectories, source, frames - 1 - L, target, L, L, 0.05);
    const double turned = source == 1 ? 30.0 * degrees * (frames - 1 - 2 * L) / (frames - 1) : 0.0;
    transition.source_from_target.yaw = turned;
    transition.source_from_target.translation = Eigen::Vector2d::Zero();
    transition.source_from_target.translation =
        result.trajectories[source][static_cast<std::size_t>(transition.m)] -
        transition.source_from_target * result.trajectories[target][L];
    result.transitions.push_back(transition);
  };
  for (const std::size_t source : {0, 1}) {
    for (const std::size_t target : {0, 1}) join(source, target);
  }
  result.query.keyframes = {{0, 2}, {0, 26}};
  return result;
}

TEST(GroundSearch, ARouteRoundACornerIsWalkedWhereWithoutItThePathIsStraight) {
  Case query_case = walk_and_turn();
  query_case.query.distance = 8.0;
  query_case.query.time = 8.0;
  query_case.options.max_labels = 300'000;
  const tl::expected<MotionPath, NoPath> plain =
      find_keyframe_path(query_case.metrics(), query_case.query, query_case.options, query_case.names());
  ASSERT_TRUE(plain.has_value());
  query_case.query.route = GroundRoute{.points = {{0.0, 0.0}, {0.0, 4.0}, {4.0, 4.0}}, .max_deviation = 0.8};
  const tl::expected<MotionPath, NoPath> path = solve(query_case);
  ASSERT_TRUE(path.has_value()) << path.error().reason;
  expect_consistent(query_case, *path);
  const GroundTrack track = ground_track(query_case.metrics(), *path);
  EXPECT_LT((track.centers.back() - Eigen::Vector2d(4.0, 4.0)).norm(), 0.6);
  EXPECT_NEAR(track.turn, 90.0 * degrees, 20.0 * degrees);
  // The route's terms are why: the plain path, charged for them, costs more.
  EXPECT_LT(path->cost, ground_cost(query_case, played(query_case, *plain)) + 1e-9);
}

TEST(GroundSearch, ALineThatCrossesItselfIsWalkedFromOneEndToTheOther) {
  Case query_case = walk_and_turn();
  query_case.options.max_labels = 300'000;
  // Straight on, once round to the left as tightly as the performer can turn, and on: the loop may not be
  // left out.
  std::vector<Eigen::Vector2d> points{{0.0, 0.0}};
  const double radius = 2.3;
  for (int i = 0; i <= 24; ++i) {
    const double angle = i * 15.0 * degrees;
    points.emplace_back(radius - radius * std::cos(angle), 2.0 + radius * std::sin(angle));
  }
  points.emplace_back(0.0, 4.0);
  query_case.query.distance = 4.0 + 2.0 * std::numbers::pi * radius;
  query_case.query.time = query_case.query.distance;  // at 1 m/s
  query_case.query.route = GroundRoute{.points = points};
  const tl::expected<MotionPath, NoPath> path = solve(query_case);
  ASSERT_TRUE(path.has_value());
  const GroundTrack track = ground_track(query_case.metrics(), *path);
  double farthest_left = 0.0;
  for (const Eigen::Vector2d& center : track.centers) farthest_left = std::max(farthest_left, center.x());
  EXPECT_GT(farthest_left, radius);
  EXPECT_LT((track.centers.back() - points.back()).norm(), 1.0);
}

TEST(GroundSearch, TheSameQueryGivesTheSamePath) {
  std::mt19937 random(8);
  Case query_case = turning_case(random);
  query_case.query.goal = random_goal(random);
  query_case.query.route = random_route(random);
  const tl::expected<MotionPath, NoPath> one = solve(query_case);
  const tl::expected<MotionPath, NoPath> two = solve(query_case);
  ASSERT_TRUE(one.has_value());
  ASSERT_TRUE(two.has_value());
  EXPECT_EQ(one->cost, two->cost);
  EXPECT_EQ(one->lower_bound, two->lower_bound);
  EXPECT_EQ(one->labels, two->labels);
  ASSERT_EQ(one->segments.size(), two->segments.size());
  for (std::size_t i = 0; i < one->segments.size(); ++i) {
    EXPECT_EQ(one->segments[i].first_frame, two->segments[i].first_frame);
    EXPECT_EQ(one->segments[i].last_frame, two->segments[i].last_frame);
  }
}

TEST(GroundSearch, StopsWhenTheUserAsksTo) {
  Case query_case = walk_and_turn();
  query_case.query.goal = GroundGoal{.position = {3.0, 3.0}, .turn = {}};
  set_interrupted(true);
  EXPECT_THROW(solve(query_case), Cancelled);
  set_interrupted(false);
}

}  // namespace
}  // namespace reprise
