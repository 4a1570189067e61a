// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/path/keyframe_optimizer.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/synthesis/feet_test_support.h"
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
  Synthesizer synthesizer_{database_};
};

TEST_F(Synthesis, PathWithoutTransitionsPlaysTheCapturedFramesUnchanged) {
  MotionPath path;
  path.segments = {{.clip_idx = 2, .first_frame = 7, .last_frame = 30, .transition = {}}};
  const MeshSequence result = synthesizer_.synthesize(path);
  ASSERT_EQ(result.frame_count(), 24U);
  for (std::size_t f = 0; f < 24; ++f) {
    EXPECT_EQ(result.frame(f), database_.clip(2).frame(f + 7));
    EXPECT_EQ(result.origins()[f], (FrameOrigin{.clip = "c", .frame_idx = static_cast<std::int32_t>(f + 7)}));
  }
}

TEST_F(Synthesis, TransitionToTheSameMotionElsewhereContinuesAsIfNothingHappened) {
  const Transition t = make_transition(database_, 0, 25, 1, 25, 6);
  const MeshSequence result = synthesizer_.synthesize(join(t, 5, 50));
  ASSERT_EQ(result.frame_count(), 46U);
  for (std::size_t f = 0; f < result.frame_count(); ++f) {
    EXPECT_LT(largest_difference(result.frame(f), database_.clip(0).frame(f + 5)), 2e-5) << "frame " << f;
  }
}

TEST_F(Synthesis, BlendsNameBothFramesAndTheirWeight) {
  const Transition t = make_transition(database_, 0, 25, 2, 31, 6);
  const MeshSequence result = synthesizer_.synthesize(join(t, 10, 50), {.profile = BlendProfile::linear});
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
  const MeshSequence result = synthesizer_.synthesize(*path);
  EXPECT_EQ(result.frame_count(), static_cast<std::size_t>(path->frame_count));
  const double distance = ground_distance(ground_trajectory(result), 0, result.frame_count() - 1);
  EXPECT_NEAR(distance, path->distance, 1e-4);
}

TEST_F(Synthesis, GroundTrajectoryNeverJumps) {
  const Transition t = make_transition(database_, 0, 25, 2, 31, 6);
  const std::vector<Eigen::Vector2d> trajectory = ground_trajectory(synthesizer_.synthesize(join(t, 5, 50)));
  for (std::size_t f = 0; f + 1 < trajectory.size(); ++f) {
    EXPECT_LT((trajectory[f + 1] - trajectory[f]).norm(), 0.12) << "frame " << f;
  }
}

TEST_F(Synthesis, SameBytesForAnyNumberOfThreads) {
  const MotionPath path = join(make_transition(database_, 0, 25, 2, 31, 6), 5, 50);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SynthesisOptions options{.correction = Correction{.frame_count = 49, .distance = 2.2}};
  const MeshSequence serial = synthesizer_.synthesize(path, options);
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 4);
  EXPECT_EQ(synthesizer_.synthesize(path, options).data(), serial.data());
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
        Synthesizer(database).synthesize(join(make_transition(database, 0, 20, 1, 20, 4), 5, 35));
    *middle = result.colors(15)[0][2];
    return result.has_colors_per_frame();
  };
  double middle = 0.0;
  EXPECT_FALSE(colors_at(&middle));
  blue.set_colors(std::vector<Color>(red.vertex_count(), Color{200, 0, 100}));
  EXPECT_TRUE(colors_at(&middle));
  EXPECT_EQ(middle, 50.0);
}

TEST_F(Synthesis, CorrectedAnimationMeasuresWhatThePlanPredicts) {
  const Transition there = make_transition(database_, 0, 25, 2, 31, 6);
  for (const bool plant_feet : {false, true}) {
    MotionPath path = join(there, 5, 50);
    const MeshSequence plain = synthesizer_.synthesize(path, {.plant_feet = false});
    path.distance = ground_distance(ground_trajectory(plain), 0, plain.frame_count() - 1);
    for (const double distance : {0.92, 1.0, 1.09, 3.0}) {
      for (const double time : {0.0, 1.7, 1.94}) {
        const Correction correction = plan_correction(path, distance * path.distance, time, 25.0);
        const MeshSequence result =
            synthesizer_.synthesize(path, {.plant_feet = plant_feet, .correction = correction});
        ASSERT_EQ(result.frame_count(), static_cast<std::size_t>(correction.frame_count));
        EXPECT_DOUBLE_EQ(result.duration(), correction.time);
        EXPECT_EQ(result.origins().size(), result.frame_count());
        const auto trajectory = ground_trajectory(result);
        EXPECT_NEAR(ground_distance(trajectory, 0, trajectory.size() - 1), correction.distance, 1e-5);
      }
    }
  }
}

TEST_F(Synthesis, CorrectedAnimationStillShowsItsFirstAndLastFrame) {
  MotionPath path = join(make_transition(database_, 0, 25, 2, 31, 6), 5, 50);
  path.distance = 2.0;
  for (const bool plant_feet : {false, true}) {
    const MeshSequence plain = synthesizer_.synthesize(path, {.plant_feet = false});
    const MeshSequence result = synthesizer_.synthesize(
        path, {.plant_feet = plant_feet, .correction = plan_correction(path, 2.18, 1.7, 25.0)});
    EXPECT_EQ(result.frame(0), database_.clip(0).frame(5));
    EXPECT_EQ(result.origins().front(), (FrameOrigin{.clip = "a", .frame_idx = 5}));
    EXPECT_EQ(result.origins().back(), (FrameOrigin{.clip = "c", .frame_idx = 50}));
    // The last one stands elsewhere on the ground, and is turned as in the path.
    const PositionsView end = result.frame(result.frame_count() - 1);
    const PositionsView plain_end = plain.frame(plain.frame_count() - 1);
    const Eigen::RowVector3f shift = end.row(0) - plain_end.row(0);
    EXPECT_EQ(shift.y(), 0.0F);
    EXPECT_GT(shift.norm(), 0.05F);
    EXPECT_LT((end - plain_end).rowwise().operator-(shift).cwiseAbs().maxCoeff(), 2e-6F);
  }
}

TEST_F(Synthesis, CorrectionThatChangesNothingChangesNothing) {
  MotionPath path = join(make_transition(database_, 0, 25, 2, 31, 6), 5, 50);
  const MeshSequence plain = synthesizer_.synthesize(path, {.plant_feet = false});
  path.distance = ground_distance(ground_trajectory(plain), 0, plain.frame_count() - 1);
  const Correction none = plan_correction(path, 99.0, 99.0, 25.0, {.max_retiming = 0.0, .max_stretch = 0.0});
  EXPECT_EQ(synthesizer_.synthesize(path, {.plant_feet = false, .correction = none}).data(), plain.data());
}

TEST_F(Synthesis, PathOfOneFrameIsThatFrame) {
  MotionPath path;
  path.segments = {{.clip_idx = 1, .first_frame = 9, .last_frame = 9, .transition = {}}};
  path.frame_count = 1;
  const MeshSequence result =
      synthesizer_.synthesize(path, {.correction = plan_correction(path, 3.0, 2.0, 25.0)});
  ASSERT_EQ(result.frame_count(), 1U);
  EXPECT_EQ(result.frame(0), database_.clip(1).frame(9));
}

TEST_F(Synthesis, CorrectionThatWasNotPlannedIsRefused) {
  const MotionPath path = join(make_transition(database_, 0, 25, 2, 31, 6), 5, 50);
  EXPECT_THAT([&] { synthesizer_.synthesize(path, {.correction = Correction{}}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("in 0: expected 2 or more")));
  EXPECT_THAT(
      [&] { synthesizer_.synthesize(path, {.correction = Correction{.frame_count = 40, .distance = -1.0}}); },
      ThrowsMessage<InvalidArgument>(HasSubstr("trajectory's length")));
}

TEST_F(Synthesis, PathBeyondTheDatabaseIsRefused) {
  MotionPath path;
  path.segments = {{.clip_idx = 1, .first_frame = 55, .last_frame = 60, .transition = {}}};
  EXPECT_THAT([&] { synthesizer_.synthesize(path); },
              ThrowsMessage<InvalidArgument>(HasSubstr("frame 60 of clip 1")));
  EXPECT_THROW(synthesizer_.synthesize(MotionPath{}), InvalidArgument);
}

TEST(SynthesisOnFeet, StretchedWalkKeepsItsLengthAndItsFeetPlanted) {
  const PerformanceDatabase& database = test::performer_with_feet();
  const Synthesizer synthesizer(database);
  const std::size_t walk = database.clip_idx("walk");
  const MeshSequence& clip = database.clip(walk);
  const auto last = static_cast<int>(clip.frame_count()) - 1;
  MotionPath path;
  path.segments = {{.clip_idx = walk, .first_frame = 0, .last_frame = last, .transition = {}}};
  path.frame_count = last + 1;
  path.distance = ground_distance(ground_trajectory(clip), 0, clip.frame_count() - 1);
  for (const double factor : {0.9, 1.1}) {
    const Correction correction =
        plan_correction(path, factor * path.distance, factor * clip.duration(), clip.frames_per_second());
    const auto made = [&](bool plant_feet) {
      return synthesizer.synthesize(path, {.plant_feet = plant_feet, .correction = correction});
    };
    const MeshSequence sliding = made(false);
    const MeshSequence planted = made(true);
    const auto trajectory = ground_trajectory(planted);
    EXPECT_NEAR(ground_distance(trajectory, 0, trajectory.size() - 1), factor * path.distance, 1e-4);
    EXPECT_EQ(planted.frame(0), clip.frame(0));
    EXPECT_NE(planted.data(), sliding.data());
    const Naturalness before = evaluate_naturalness(sliding, database);
    const Naturalness after = evaluate_naturalness(planted, database);
    ASSERT_GT(before.foot_drift, after.shown_foot_drift + 1.0) << "the test needs feet that slide";
    EXPECT_LT(after.foot_drift - after.shown_foot_drift, 0.5 * (before.foot_drift - after.shown_foot_drift));
  }
}

class NaturalnessTest : public Synthesis {};

TEST_F(NaturalnessTest, ReplayedCaptureIsAsNaturalAsTheCapture) {
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 0, .last_frame = 59, .transition = {}}};
  PerformanceDatabase only_a;
  only_a.add(database_.clip(0));
  const Naturalness n = evaluate_naturalness(Synthesizer(only_a).synthesize(path), only_a, {.speed = 2.0});
  EXPECT_EQ(n.pop_ratio, 0.0) << "nothing is blended";
  EXPECT_GT(n.captured_foot_drift, 0.0);
  EXPECT_NEAR(n.foot_drift, n.captured_foot_drift, 1e-9);
  EXPECT_DOUBLE_EQ(n.edge_stretch_p99, n.captured_edge_stretch_p99);
}

TEST_F(NaturalnessTest, JoinOfTheSameMotionDoesNotPopAndAMismatchedCutDoes) {
  const MeshSequence good = synthesizer_.synthesize(join(make_transition(database_, 0, 25, 1, 25, 6), 5, 50));
  const MeshSequence cut = synthesizer_.synthesize(
      join(make_transition(database_, 0, 25, 2, 25 + static_cast<int>(period) / 2, 1), 5, 50));
  const double smooth_ratio = evaluate_naturalness(good, database_).pop_ratio;
  EXPECT_GT(smooth_ratio, 0.0);
  EXPECT_LT(smooth_ratio, 1.1);
  EXPECT_GT(evaluate_naturalness(cut, database_).pop_ratio, 3.0);
}

TEST_F(NaturalnessTest, StretchedResultShowsInTheStretchFigureAlone) {
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 0, .last_frame = 59, .transition = {}}};
  MeshSequence result = synthesizer_.synthesize(path);
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
