// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/path/keyframe_case_test_support.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using test::Case;
using test::make_transition;
using test::straight;
using test::walk_and_stand;

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

TEST(NoPath, SaysWhatTheLimitsLeaveNoRoomFor) {
  Case query_case = walk_and_stand();
  query_case.query.max_time = 1.0;
  const auto path = query_case.solve();
  ASSERT_FALSE(path.has_value());
  // 34 steps of 0.04 m from frame 2 to 36.
  EXPECT_THAT(path.error().reason, HasSubstr("no path through the key-frames and clips asked for keeps the limits"));
  EXPECT_THAT(path.error().reason, HasSubstr("at least 1.360 m long and take at least 1.40 s"));
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
  {
    Case bad = good;
    bad.query.min_distance = 3.0;
    bad.query.max_distance = 2.0;
    expect_refused(bad,
                   "the limits on distance contradict each other: expected the least (3 m) to be at most the "
                   "greatest (2 m)");
    bad = good;
    bad.query.min_time = 3.0;
    bad.query.max_time = 2.0;
    expect_refused(bad, "the limits on time contradict each other");
  }
  for (const double value : {-1.0, std::nan("")}) {
    Case bad = good;
    bad.query.min_distance = value;
    expect_refused(bad, "least distance");
    bad = good;
    bad.query.max_distance = value;
    expect_refused(bad, "greatest distance");
    bad = good;
    bad.query.min_time = value;
    expect_refused(bad, "least time");
    bad = good;
    bad.query.max_time = value;
    expect_refused(bad, "greatest time");
  }
  {
    Case bad = good;
    bad.query.compulsory_clips = {1};
    bad.query.forbidden_clips = {1};
    expect_refused(bad, "clip 'clip1' is both compulsory and forbidden");
    bad.query.compulsory_clips.clear();
    bad.query.forbidden_clips = {0};
    expect_refused(bad, "key-frame 1 lies in 'clip0', which is forbidden");
    bad.query.forbidden_clips = {2};
    expect_refused(bad, "forbidden clips: expected indices below 2, found 2");
    bad.query.forbidden_clips.clear();
    bad.query.compulsory_clips = {2};
    expect_refused(bad, "compulsory clips: expected indices below 2, found 2");
  }
  EXPECT_THROW((void)find_keyframe_path(good.metrics(), good.query, good.options, {"one"}), InvalidArgument);
  EXPECT_THROW(PathMetrics(good.trajectories, good.transitions, BlendProfile::smooth, 0.0), InvalidArgument);
}

}  // namespace
}  // namespace reprise
