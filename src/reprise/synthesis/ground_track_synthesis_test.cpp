// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where a path says its frames stand, and where they stand once they are made.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "reprise/path/ground_search.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/synthesis/synthesize.h"
#include "support/shapes.h"

namespace reprise {
namespace {

Transition make_transition(const PerformanceDatabase& database, std::size_t source, int m, std::size_t target,
                           int n, int half_window) {
  const GroundAlignment alignment = align_on_ground(database.clip(source).frame(static_cast<std::size_t>(m)),
                                                    database.clip(target).frame(static_cast<std::size_t>(n)));
  return {.source_clip = source,
          .target_clip = target,
          .m = m,
          .n = n,
          .half_window = half_window,
          .source_from_target = alignment.a_from_b,
          .cost = 0.1};
}

TEST(GroundTrack, IsWhereTheSynthesisedFramesStand) {
  const double period = 20.0;
  const GroundTransform moved_from_clip{.yaw = 2.0, .translation = {3.0, -1.5}};
  PerformanceDatabase database;
  database.add(test::walk("a", 60, 0.04, period));
  database.add(test::moved(test::walk("b", 60, 0.07, period), moved_from_clip, "b"));
  std::vector<Transition> transitions = {make_transition(database, 0, 25, 1, 31, 6),
                                         make_transition(database, 1, 45, 0, 12, 8)};
  // A turn at each of them, about the place where they meet.
  for (Transition& transition : transitions) {
    const auto source = ground_trajectory(database.clip(transition.source_clip));
    const Eigen::Vector2d pivot = source[static_cast<std::size_t>(transition.m)];
    GroundTransform turn{.yaw = 0.4};
    turn.translation = pivot - turn * pivot;
    transition.source_from_target = turn * transition.source_from_target;
  }
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  for (const MeshSequence& clip : database.clips()) trajectories.push_back(ground_trajectory(clip));
  const PathMetrics metrics(trajectories, transitions, BlendProfile::smooth, 25.0);
  KeyframeQuery query{.keyframes = {{0, 3}, {0, 40}}, .distance = 9.0, .time = 7.0};
  query.goal = GroundGoal{.position = {2.0, 3.0}, .turn = std::numbers::pi / 2.0};
  const auto path = find_ground_path(metrics, query, {}, database.clip_names());
  ASSERT_TRUE(path.has_value());
  ASSERT_GT(path->segments.size(), 2U) << "the test needs transitions on the path";

  const GroundTrack track = ground_track(metrics, *path);
  const MeshSequence result = Synthesizer(database).synthesize(*path, {.plant_feet = false});
  const std::vector<Eigen::Vector2d> centers = ground_trajectory(result);
  ASSERT_EQ(centers.size(), track.centers.size());
  for (std::size_t f = 0; f < centers.size(); ++f) {
    EXPECT_LT((centers[f] - centers[0] - track.centers[f]).norm(), 1e-4) << "frame " << f;
  }
  // The last frame is the captured one, turned by what the track says.
  const GroundAlignment alignment =
      align_on_ground(result.frame(result.frame_count() - 1), database.clip(0).frame(40));
  EXPECT_NEAR(wrap_angle(alignment.a_from_b.yaw - track.turn), 0.0, 1e-4);
}

}  // namespace
}  // namespace reprise
