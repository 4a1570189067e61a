// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/path/keyframe_optimizer.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/synthesis/naturalness.h"
#include "reprise/synthesis/synthesize.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double period = 20.0;
const GroundTransform turn_and_shift{.yaw = 2.0, .translation = {3.0, -1.5}};

// "a" walks; "b" is the same motion elsewhere on the ground; "c" walks faster.
PerformanceDatabase walking_database() {
  const MeshSequence a = test::walk("a", 60, 0.04, period);
  PerformanceDatabase database;
  database.add(a);
  database.add(test::moved(a, turn_and_shift, "b"));
  database.add(test::walk("c", 60, 0.07, period));
  return database;
}

Transition make_transition(const PerformanceDatabase& database, std::size_t source, int m, std::size_t target,
                           int n, int half_window) {
  const GroundAlignment alignment = align_on_ground(database.clip(source).frame(static_cast<std::size_t>(m)),
                                                    database.clip(target).frame(static_cast<std::size_t>(n)));
  return {.source_clip = source,
          .target_clip = target,
          .m = m,
          .n = n,
          .half_window = half_window,
          .source_from_target = alignment.a_from_b};
}

MotionPath join(const Transition& t, int first, int last) {
  MotionPath path;
  path.segments = {
      {.clip_idx = t.source_clip, .first_frame = first, .last_frame = t.leave(), .transition = t},
      {.clip_idx = t.target_clip, .first_frame = t.arrive(), .last_frame = last, .transition = {}}};
  path.frame_count = (t.leave() - first) + 2 * t.half_window + (last - t.arrive()) + 1;
  return path;
}

double largest_difference(const PositionsView& a, const PositionsView& b) {
  return static_cast<double>((a - b).rowwise().norm().maxCoeff());
}

class Synthesis : public ::testing::Test {
 protected:
  PerformanceDatabase database_ = walking_database();
  PoissonReconstruction poisson_{database_.topology(), database_.clip(0).frame(0)};
};

TEST_F(Synthesis, PathWithoutTransitionsPlaysTheCapturedFramesUnchanged) {
  MotionPath path;
  path.segments = {{.clip_idx = 2, .first_frame = 7, .last_frame = 30, .transition = {}}};
  const MeshSequence result = synthesize(path, database_, poisson_);
  ASSERT_EQ(result.frame_count(), 24U);
  for (std::size_t f = 0; f < 24; ++f) {
    EXPECT_EQ(result.frame(f), database_.clip(2).frame(f + 7));
    EXPECT_EQ(result.origins()[f], (FrameOrigin{.clip = "c", .frame_idx = static_cast<std::int32_t>(f + 7)}));
  }
}

TEST_F(Synthesis, TransitionToTheSameMotionElsewhereContinuesAsIfNothingHappened) {
  const Transition t = make_transition(database_, 0, 25, 1, 25, 6);
  const MeshSequence result = synthesize(join(t, 5, 50), database_, poisson_);
  ASSERT_EQ(result.frame_count(), 46U);
  for (std::size_t f = 0; f < result.frame_count(); ++f) {
    EXPECT_LT(largest_difference(result.frame(f), database_.clip(0).frame(f + 5)), 2e-5) << "frame " << f;
  }
}

TEST_F(Synthesis, BlendsNameBothFramesAndTheirWeight) {
  const Transition t = make_transition(database_, 0, 25, 2, 31, 6);
  const MeshSequence result =
      synthesize(join(t, 10, 50), database_, poisson_, {.profile = BlendProfile::linear});
  const auto& origins = result.origins();
  EXPECT_EQ(origins[9], (FrameOrigin{.clip = "a", .frame_idx = 19}));
  EXPECT_EQ(origins[12].clip, "a");
  EXPECT_EQ(origins[12].frame_idx, 22);
  EXPECT_EQ(origins[12].partner_clip, "c");
  EXPECT_EQ(origins[12].partner_frame_idx, 28);
  EXPECT_DOUBLE_EQ(origins[12].partner_weight, 3.0 / 12.0);
  EXPECT_EQ(origins[21], (FrameOrigin{.clip = "c", .frame_idx = 37}));
}

TEST_F(Synthesis, DistanceAndFrameCountAreThoseThePathPredicts) {
  std::vector<Transition> transitions = {make_transition(database_, 0, 25, 2, 31, 6),
                                         make_transition(database_, 2, 45, 0, 12, 8)};
  for (Transition& t : transitions) t.cost = 0.1;
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  for (const MeshSequence& clip : database_.clips()) trajectories.push_back(ground_trajectory(clip));
  const PathMetrics metrics(trajectories, transitions, BlendProfile::smooth, 25.0);
  const auto path = find_keyframe_path(
      metrics, {.keyframes = {{0, 3}, {0, 40}}, .distance = 9.0, .time = 7.0}, {}, database_.clip_names());
  ASSERT_TRUE(path.has_value());
  ASSERT_GT(path->segments.size(), 2U) << "the test needs transitions on the path";
  const MeshSequence result = synthesize(*path, database_, poisson_);
  EXPECT_EQ(result.frame_count(), static_cast<std::size_t>(path->frame_count));
  const double distance = ground_distance(ground_trajectory(result), 0, result.frame_count() - 1);
  EXPECT_NEAR(distance, path->distance, 1e-4);
}

TEST_F(Synthesis, GroundTrajectoryNeverJumps) {
  const Transition t = make_transition(database_, 0, 25, 2, 31, 6);
  const std::vector<Eigen::Vector2d> trajectory =
      ground_trajectory(synthesize(join(t, 5, 50), database_, poisson_));
  for (std::size_t f = 0; f + 1 < trajectory.size(); ++f) {
    EXPECT_LT((trajectory[f + 1] - trajectory[f]).norm(), 0.12) << "frame " << f;
  }
}

TEST_F(Synthesis, SameBytesForAnyNumberOfThreads) {
  const MotionPath path = join(make_transition(database_, 0, 25, 2, 31, 6), 5, 50);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const MeshSequence serial = synthesize(path, database_, poisson_);
  {
    const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 4);
    EXPECT_EQ(synthesize(path, database_, poisson_).data(), serial.data());
  }
}

TEST_F(Synthesis, ColoursThatNeverChangeAreKeptOnceAndOthersAreBlended) {
  MeshSequence red = test::walk("red", 40);
  MeshSequence blue = test::walk("blue", 40);
  red.set_colors(std::vector<Color>(red.vertex_count(), Color{200, 0, 0}));
  blue.set_colors(std::vector<Color>(red.vertex_count(), Color{200, 0, 0}));
  const auto colors_at = [&](double* middle) {
    PerformanceDatabase database;
    database.add(red);
    database.add(blue);
    const MeshSequence result =
        synthesize(join(make_transition(database, 0, 20, 1, 20, 4), 5, 35), database, poisson_);
    *middle = result.colors(15)[0][2];
    return result.has_colors_per_frame();
  };
  double middle = 0.0;
  EXPECT_FALSE(colors_at(&middle));
  blue.set_colors(std::vector<Color>(red.vertex_count(), Color{200, 0, 100}));
  EXPECT_TRUE(colors_at(&middle));
  EXPECT_EQ(middle, 50.0);
}

TEST_F(Synthesis, PathBeyondTheDatabaseIsRefused) {
  MotionPath path;
  path.segments = {{.clip_idx = 1, .first_frame = 55, .last_frame = 60, .transition = {}}};
  EXPECT_THAT([&] { synthesize(path, database_, poisson_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("frame 60 of clip 1")));
  EXPECT_THROW(synthesize(MotionPath{}, database_, poisson_), InvalidArgument);
}

class NaturalnessTest : public Synthesis {};

TEST_F(NaturalnessTest, ReplayedCaptureIsAsNaturalAsTheCapture) {
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 0, .last_frame = 59, .transition = {}}};
  PerformanceDatabase only_a;
  only_a.add(database_.clip(0));
  const Naturalness n =
      evaluate_naturalness(synthesize(path, only_a, poisson_), only_a, {.contact_speed = 2.0});
  EXPECT_EQ(n.pop_ratio, 0.0) << "nothing is blended";
  EXPECT_GT(n.captured_foot_drift, 0.0);
  EXPECT_NEAR(n.foot_drift, n.captured_foot_drift, 1e-9);
  EXPECT_DOUBLE_EQ(n.edge_stretch_p99, n.captured_edge_stretch_p99);
}

TEST_F(NaturalnessTest, JoinOfTheSameMotionDoesNotPopAndAMismatchedCutDoes) {
  const MeshSequence good =
      synthesize(join(make_transition(database_, 0, 25, 1, 25, 6), 5, 50), database_, poisson_);
  const MeshSequence cut =
      synthesize(join(make_transition(database_, 0, 25, 2, 25 + static_cast<int>(period) / 2, 1), 5, 50),
                 database_, poisson_);
  const double smooth_ratio = evaluate_naturalness(good, database_).pop_ratio;
  EXPECT_GT(smooth_ratio, 0.0);
  EXPECT_LT(smooth_ratio, 1.1);
  EXPECT_GT(evaluate_naturalness(cut, database_).pop_ratio, 3.0);
}

TEST_F(NaturalnessTest, StretchedResultShowsInTheStretchFigureAlone) {
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 0, .last_frame = 59, .transition = {}}};
  MeshSequence result = synthesize(path, database_, poisson_);
  const Naturalness before = evaluate_naturalness(result, database_);
  for (std::size_t f = 0; f < result.frame_count(); ++f) result.frame(f) *= 1.5F;
  const Naturalness after = evaluate_naturalness(result, database_);
  EXPECT_NEAR(after.edge_stretch_p99 / before.edge_stretch_p99, 1.5, 1e-3);
  EXPECT_DOUBLE_EQ(after.captured_edge_stretch_p99, before.captured_edge_stretch_p99);
}

TEST_F(NaturalnessTest, MotionOfUnknownOriginIsRefused) {
  EXPECT_THAT([&] { evaluate_naturalness(database_.clip(0), database_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("has no origins")));
  MeshSequence foreign = test::walk("x", 2);
  foreign.set_origins({{.clip = "a", .frame_idx = 0}, {.clip = "nobody", .frame_idx = 1}});
  EXPECT_THAT([&] { evaluate_naturalness(foreign, database_); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no clip 'nobody'")));
}

}  // namespace
}  // namespace reprise
