// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/program_writer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/path/keyframe_case_test_support.h"
#include "reprise/path/program_case_test_support.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;

using test::Case;
using test::DecodedPath;
using test::expect_valid;
using test::fps;
using test::make_transition;
using test::ProgramSolution;
using test::random_case;
using test::solve_lp_text;
using test::straight;
using test::walk_and_stand;

std::string program_of(const Case& query_case, double cost_bound) {
  return write_keyframe_program(query_case.metrics(), query_case.query, query_case.options,
                                query_case.names(), cost_bound);
}

// Solves the program, reads the path back and holds it against the definition and the optimiser's cost.
void expect_program_has_optimum(const Case& query_case, const MotionPath& path, double cost_bound) {
  const std::optional<ProgramSolution> solution = solve_lp_text(program_of(query_case, cost_bound));
  ASSERT_TRUE(solution.has_value());
  EXPECT_NEAR(solution->cost, path.cost, 1e-6);
  const DecodedPath decoded(query_case, *solution);
  const test::Replay played = test::replay(query_case, decoded.path());
  EXPECT_TRUE(test::shows_in_order(played.pure_frames, query_case.query.keyframes));
  EXPECT_TRUE(test::keeps_limits(query_case, played.pure_frames, played.distance, played.frame_count, 1e-6));
  EXPECT_NEAR(played.distance, decoded.path().distance, 1e-6);
  EXPECT_EQ(played.frame_count, decoded.path().frame_count);
  EXPECT_NEAR(test::cost_of(query_case, played.transition_cost, played.distance, played.frame_count),
              path.cost, 1e-6);
}

TEST(ProgramWriter, TheProgramsOptimumIsTheOptimisers) {
  std::mt19937 random(11);
  int looped = 0;
  for (int solved = 0; solved < 200;) {
    SCOPED_TRACE(solved);
    Case query_case = random_case({.clips = 2 + solved % 2,
                                   .min_frames = 14,
                                   .max_frames = 24,
                                   .min_transitions = 4,
                                   .max_transitions = 8,
                                   .max_half_window = 3,
                                   .max_keyframes = 2 + solved % 3},
                                  random);
    const auto real = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    query_case.query.distance = solved % 5 == 0 ? 0.0 : real(0.0, 5.0);
    query_case.query.time = solved % 7 == 0 ? 0.0 : real(0.0, 6.0);
    query_case.options.distance_weight = solved % 6 == 0 ? 0.0 : real(0.5, 5.0);
    query_case.options.time_weight = real(0.03, 0.3);
    const auto path = query_case.solve();
    if (!path || path->segments.size() < 2) continue;
    ++solved;
    looped += path->segments.size() > 4 ? 1 : 0;
    ASSERT_EQ(path->gap(), 0.0);
    // The bound shortens the search; what it is does not matter.
    expect_program_has_optimum(query_case, *path, path->cost + (solved % 2) * 0.5);
  }
  EXPECT_GT(looped, 50);
}

TEST(ProgramWriter, LimitsAreRowsOfTheProgram) {
  std::mt19937 random(13);
  int binding = 0;
  for (int solved = 0; solved < 150;) {
    SCOPED_TRACE(solved);
    Case query_case = random_case({.clips = 3,
                                   .min_frames = 14,
                                   .max_frames = 24,
                                   .min_transitions = 5,
                                   .max_transitions = 9,
                                   .max_half_window = 3,
                                   .max_keyframes = 3},
                                  random);
    query_case.query.distance = std::uniform_real_distribution<double>(0.0, 2.0)(random);
    query_case.query.time = std::uniform_real_distribution<double>(0.0, 3.0)(random);
    const auto free = query_case.solve();
    if (!free) continue;
    test::limit_at_random(query_case, *free, random);
    const auto path = query_case.solve();
    if (!path) continue;
    ++solved;
    binding += path->cost > free->cost + 1e-6 ? 1 : 0;
    expect_program_has_optimum(query_case, *path, path->cost);
  }
  EXPECT_GT(binding, 20);
}

TEST(ProgramWriter, ALoopThatNothingEntersIsNoSolution) {
  // The second clip walks in a circle of its own, which would meet the target at no cost.
  Case query_case;
  query_case.trajectories = {straight(30, 0.0), straight(40, 0.05)};
  query_case.transitions = {make_transition(query_case.trajectories, 1, 34, 1, 5, 3, 0.0),
                            make_transition(query_case.trajectories, 0, 10, 1, 6, 3, 3.0),
                            make_transition(query_case.trajectories, 1, 20, 0, 14, 3, 3.0)};
  query_case.query.keyframes = {{0, 2}, {0, 28}};
  query_case.query.distance = 1.5;
  query_case.query.time = 2.5;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  EXPECT_GT(path->cost, 1.0);
  expect_program_has_optimum(query_case, *path, path->cost);

  // Without the rows that keep loops connected the solver takes the loose loop.
  std::istringstream text(program_of(query_case, path->cost));
  std::string loose;
  bool skipping = false;
  for (std::string line; std::getline(text, line);) {
    const bool begins_row = line.size() > 1 && line[0] == ' ' && line[1] != ' ';
    const bool is_section = !line.empty() && line[0] != ' ';
    if (begins_row || is_section) {
      skipping = line.starts_with(" left.") || line.starts_with(" least.") || line.starts_with(" most.");
    }
    if (!skipping) loose += line + "\n";
  }
  const std::optional<ProgramSolution> solution = solve_lp_text(loose);
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(solution->cost, path->cost - 0.1);
}

TEST(ProgramWriter, EqualKeyframesAskForALoop) {
  Case query_case = walk_and_stand();
  query_case.query.keyframes = {{0, 15}, {0, 15}, {0, 15}};
  query_case.query.distance = 5.0;
  query_case.query.time = 4.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  expect_program_has_optimum(query_case, *path, path->cost);
}

TEST(ProgramWriter, WithoutAWeightOnTimeTheCostKeepsLoopsConnected) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 7.0;
  query_case.options.time_weight = 0.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  EXPECT_GT(path->segments.size(), 4u);
  expect_program_has_optimum(query_case, *path, path->cost);
}

// Characters that the format gives a meaning to, names that differ in nothing else, and very long ones.
TEST(ProgramWriter, AnyClipNamesMakeAReadableFile) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 4.0;
  query_case.query.time = 5.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  const PathMetrics metrics = query_case.metrics();
  const auto expect_readable = [&](const std::vector<std::string>& names) {
    const std::string text =
        write_keyframe_program(metrics, query_case.query, query_case.options, names, path->cost);
    const std::optional<ProgramSolution> solution = solve_lp_text(text);
    ASSERT_TRUE(solution.has_value());
    EXPECT_NEAR(solution->cost, path->cost, 1e-6);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 255u) << line;
  };
  expect_readable({"walk fast", "walk.fast"});
  expect_readable({"3e5 <= \\ \n End", "st"});
  expect_readable({"", "\xc3\xa9t\xc3\xa9"});
  expect_readable({std::string(400, 'a') + "1", std::string(400, 'a') + "2"});
}

TEST(ProgramWriter, ColumnsAreWholeNumbersWithinBounds) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 4.0;
  query_case.query.time = 5.0;
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value());
  const std::optional<ProgramSolution> solution = solve_lp_text(program_of(query_case, path->cost));
  ASSERT_TRUE(solution.has_value());
  const auto uses = std::count_if(solution->columns.begin(), solution->columns.end(), [](const auto& column) {
    return column.first.starts_with("play.") || column.first.starts_with("take.");
  });
  EXPECT_EQ(uses, solution->integer_count);
  EXPECT_GT(uses, 4);
}

TEST(ProgramWriter, TheSameQueryGivesTheSameText) {
  Case query_case = walk_and_stand();
  query_case.query.distance = 4.0;
  query_case.query.time = 5.0;
  EXPECT_EQ(program_of(query_case, 10.0), program_of(query_case, 10.0));
}

TEST(ProgramWriter, BadArgumentsAreNamed) {
  const Case good = walk_and_stand();
  const auto expect_refused = [&](const Case& bad, double cost_bound, const char* what) {
    try {
      (void)program_of(bad, cost_bound);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const InvalidArgument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  {
    Case bad = good;
    bad.query.keyframes = {{0, 2}, {1, 3}};
    expect_refused(bad, 10.0, "there is no path; key-frame 2 (clip1:3) cannot be reached");
  }
  {
    Case bad = good;
    bad.query.keyframes.pop_back();
    expect_refused(bad, 10.0, "key-frames: expected at least 2, found 1");
  }
  {
    Case bad = good;
    bad.query.goal = GroundGoal{};
    expect_refused(bad, 10.0, "without a goal or a route");
    bad.query.goal.reset();
    bad.query.route = GroundRoute{.points = {{0.0, 0.0}, {0.0, 1.0}}};
    expect_refused(bad, 10.0, "without a goal or a route");
  }
  {
    Case bad = good;
    bad.query.distance = 50.0;
    expect_refused(bad, 0.1, "cost bound: expected a number of at least");
    expect_refused(bad, std::nan(""), "cost bound: expected a number of at least");
    expect_refused(bad, unlimited, "cost bound: expected a number of at least");
  }
  {  // loops at no cost in time that does not count
    Case bad = good;
    bad.options.time_weight = 0.0;
    bad.transitions[0].cost = 0.0;
    expect_refused(bad, 100.0, "or transitions that all cost something");
  }
}

}  // namespace
}  // namespace reprise
