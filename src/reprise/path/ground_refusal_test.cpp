// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/path/ground_case_test_support.h"
#include "reprise/path/ground_search.h"

namespace reprise {
namespace {

using test::Case;
using ::testing::HasSubstr;

tl::expected<MotionPath, NoPath> solve(const Case& query_case) {
  return find_ground_path(query_case.metrics(), query_case.query, query_case.options, query_case.names());
}

TEST(GroundSearch, SaysWhyNoPathKeepsTheLimitsAndHowNearOneComes) {
  Case query_case;
  query_case.trajectories = {test::straight(40, 0.04)};
  query_case.query.keyframes = {{0, 5}, {0, 30}};
  query_case.query.goal = GroundGoal{.position = {0.0, 2.0}, .turn = {}, .position_tolerance = 0.5};
  const tl::expected<MotionPath, NoPath> path = solve(query_case);
  ASSERT_FALSE(path.has_value());
  EXPECT_THAT(path.error().reason, HasSubstr("ends 1.000 m from the goal (at most 0.500 m)"));
  EXPECT_THAT(path.error().reason, HasSubstr("There is none: proved."));  // the graph has no loop

  query_case.query.goal.reset();
  query_case.query.route = GroundRoute{.points = {{0.0, 0.0}, {2.0, 0.0}}, .max_deviation = 0.5};
  const tl::expected<MotionPath, NoPath> lost = solve(query_case);
  ASSERT_FALSE(lost.has_value());
  EXPECT_THAT(lost.error().reason, HasSubstr("m of its 2.000 m along"));
}

void expect_refused(const Case& query_case, const std::string& part_of_message) {
  try {
    solve(query_case);
    FAIL() << "expected a message with: " << part_of_message;
  } catch (const InvalidArgument& error) {
    EXPECT_THAT(error.what(), HasSubstr(part_of_message));
  }
}

TEST(GroundSearch, RefusesWhatMakesNoSense) {
  const Case plain = test::walk_and_stand();
  const double nan = std::nan("");
  {  // a goal that is nowhere
    Case query_case = plain;
    query_case.query.goal = GroundGoal{.position = {nan, 0.0}, .turn = {}};
    expect_refused(query_case, "goal: expected two finite numbers");
  }
  {  // a turn that is not a number
    Case query_case = plain;
    query_case.query.goal = GroundGoal{.turn = nan};
    expect_refused(query_case, "turn of the goal");
  }
  {  // negative tolerances
    Case query_case = plain;
    query_case.query.goal = GroundGoal{.turn = {}, .position_tolerance = -1.0};
    expect_refused(query_case, "position tolerance of the goal: expected a number of at least 0, found -1");
    query_case.query.goal = GroundGoal{.turn = {}, .turn_tolerance = nan};
    expect_refused(query_case, "turn tolerance of the goal");
  }
  {  // weights
    Case query_case = plain;
    query_case.query.goal = GroundGoal{.turn = {}};
    query_case.options.position_weight = -1.0;
    expect_refused(query_case, "position weight");
    query_case.options.position_weight = 1.0;
    query_case.options.turn_weight = nan;
    expect_refused(query_case, "turn weight");
  }
  {  // routes that are none
    Case query_case = plain;
    query_case.query.route = GroundRoute{.points = {{0.0, 0.0}}};
    expect_refused(query_case, "route: expected at least two different points, found 1");
    query_case.query.route = GroundRoute{.points = {{1.0, 0.0}, {1.0, 0.0}}};
    expect_refused(query_case, "all the same");
    query_case.query.route = GroundRoute{.points = {{0.0, 0.0}, {0.0, nan}}};
    expect_refused(query_case, "route: expected two finite numbers");
    query_case.query.route = GroundRoute{.points = {{0.0, 0.0}, {0.0, 1.0}}, .max_deviation = -0.1};
    expect_refused(query_case, "greatest deviation from the route");
  }
  {  // limits that contradict each other
    Case query_case = plain;
    query_case.query.goal = GroundGoal{.position = {3.0, 4.0}, .turn = {}, .position_tolerance = 1.0};
    query_case.query.max_distance = 3.9;
    expect_refused(query_case, "the goal is 5.000 m away");
    query_case = plain;
    query_case.query.route = GroundRoute{.points = {{1.0, 0.0}, {1.0, 5.0}}, .max_deviation = 0.5};
    expect_refused(query_case, "the route begins 1.000 m from where the first key-frame stands");
  }
}

}  // namespace
}  // namespace reprise
