// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/path/keyframe_case_test_support.h"

namespace reprise {
namespace {

using test::Case;
using test::fps;
using test::make_transition;
using test::random_case;
using test::straight;
using test::Trajectory;

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
