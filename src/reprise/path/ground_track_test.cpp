// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/path/ground_case_test_support.h"
#include "reprise/path/ground_search.h"

namespace reprise {
namespace {

using test::Case;
using test::PlayedWalk;

TEST(GroundTrack, IsThatOfThePathPlayedFrameByFrame) {
  std::mt19937 random(9);
  for (int i = 0; i < 20; ++i) {
    Case query_case = test::turning_case(random);
    query_case.query.goal = test::random_goal(random);
    const tl::expected<MotionPath, NoPath> path =
        find_ground_path(query_case.metrics(), query_case.query, query_case.options, query_case.names());
    ASSERT_TRUE(path.has_value());
    const GroundTrack track = ground_track(query_case.metrics(), *path);
    ASSERT_EQ(static_cast<int>(track.centers.size()), path->frame_count);
    EXPECT_EQ(track.centers.front().norm(), 0.0);
    // One of all paths has these very frames.
    bool found = false;
    test::EveryPath(query_case, [&](const PlayedWalk& walk) {
      if (found || walk.centers.size() != track.centers.size()) return;
      double difference = std::abs(wrap_angle(walk.turn - track.turn));
      for (std::size_t f = 0; f < walk.centers.size(); ++f) {
        difference = std::max(difference, (walk.centers[f] - track.centers[f]).norm());
      }
      found = difference < 1e-9;
    });
    EXPECT_TRUE(found);
  }
}

TEST(GroundTrack, RefusesATransitionThatTheGraphDoesNotHave) {
  const Case query_case = test::walk_and_stand();
  MotionPath path;
  path.segments = {
      {.clip_idx = 0, .first_frame = 2, .last_frame = 17, .transition = query_case.transitions[1]},
      {.clip_idx = 1, .first_frame = 9, .last_frame = 12, .transition = {}}};
  EXPECT_NO_THROW(ground_track(query_case.metrics(), path));
  path.segments[0].transition->n += 1;
  EXPECT_THROW(ground_track(query_case.metrics(), path), InvalidArgument);
}

}  // namespace
}  // namespace reprise
