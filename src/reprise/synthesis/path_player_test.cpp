// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/path_player.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// "a" walks, "c" walks faster elsewhere on the ground.
PerformanceDatabase walking_database() {
  PerformanceDatabase database;
  database.add(test::walk("a", 60, 0.04));
  database.add(test::moved(test::walk("fast", 60, 0.07), {.yaw = 2.0, .translation = {3.0, -1.5}}, "c"));
  return database;
}

// a:5 .. a:19, a blend of 11 frames, c:37 .. c:50.
MotionPath walking_path(const PerformanceDatabase& database) {
  const Transition t{
      .source_clip = 0,
      .target_clip = 1,
      .m = 25,
      .n = 31,
      .half_window = 6,
      .source_from_target = align_on_ground(database.clip(0).frame(25), database.clip(1).frame(31)).a_from_b};
  MotionPath path;
  path.segments = {{.clip_idx = 0, .first_frame = 5, .last_frame = t.leave(), .transition = t},
                   {.clip_idx = 1, .first_frame = t.arrive(), .last_frame = 50}};
  path.frame_count = (t.leave() - 5) + 2 * t.half_window + (50 - t.arrive()) + 1;
  return path;
}

class PathPlaying : public ::testing::Test {
 protected:
  PathPlayer player(std::vector<double> times) const {
    return {database_, poisson_, path_, BlendProfile::smooth, std::move(times)};
  }
  MeshSequence played(std::vector<double> times) const {
    const PathPlayer all = player(std::move(times));
    return all.frames(0, all.frame_count());
  }
  std::vector<double> every_frame() const {
    std::vector<double> times;
    for (int f = 0; f < path_.frame_count; ++f) times.push_back(f);
    return times;
  }
  // A query that lingers, hurries and stands, all along the path.
  std::vector<int> uneven() const {
    std::vector<int> frames;
    double time = 0.0;
    for (int k = 0; time < path_.frame_count - 1; ++k) {
      frames.push_back(static_cast<int>(time));
      time += 1.0 + 0.7 * std::sin(0.3 * k);
    }
    frames.push_back(path_.frame_count - 1);
    return frames;
  }

  PerformanceDatabase database_ = walking_database();
  PoissonReconstruction poisson_{database_.topology(), database_.clip(0).frame(0)};
  MotionPath path_ = walking_path(database_);
};

TEST_F(PathPlaying, WholeTimesAreTheFramesOfTheSynthesis) {
  const MeshSequence synthesis = Synthesizer(database_).synthesize(path_, {.plant_feet = false});
  const MeshSequence all = played(every_frame());
  EXPECT_EQ(all.data(), synthesis.data());
  EXPECT_EQ(all.origins(), synthesis.origins());
  EXPECT_EQ(all.frames_per_second(), synthesis.frames_per_second());
  // So the first are captured frames, and those beyond the join captured ones that were moved.
  EXPECT_EQ(all.frame(3), database_.clip(0).frame(8));
  Positions moved(all.frame(0).rows(), 3);
  transform_positions(path_.segments[0].transition->source_from_target, database_.clip(1).frame(50),
                      PositionsRef(moved.data(), moved.rows(), 3));
  EXPECT_EQ(all.frame(all.frame_count() - 1), moved);
}

TEST_F(PathPlaying, TheSameBitsHoweverItIsCut) {
  const PathPlayer all = player(path_times(uneven(), Timing::smooth));
  const std::size_t count = all.frame_count();
  const MeshSequence whole = all.frames(0, count);
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 4);
  for (const std::size_t length : {1, 2, 7, 19}) {
    for (std::size_t first = 0; first < count; first += length) {
      const std::size_t last = std::min(count, first + length);
      const MeshSequence stretch = all.frames(first, last);
      ASSERT_EQ(stretch.frame_count(), last - first);
      for (std::size_t f = first; f < last; ++f) {
        ASSERT_EQ(stretch.frame(f - first), whole.frame(f)) << f << " in stretches of " << length;
        ASSERT_EQ(stretch.origins()[f - first], whole.origins()[f]);
      }
    }
  }
  EXPECT_EQ(all.frames(4, 4).frame_count(), 0U);
}

TEST_F(PathPlaying, AllFramesPlayedEvenlySlowerAreTheRetimedSynthesis) {
  const MeshSequence synthesis = Synthesizer(database_).synthesize(path_, {.plant_feet = false});
  std::vector<double> times;
  for (int f = 0; 3 * f <= 4 * (path_.frame_count - 1); ++f) times.push_back(0.75 * f);
  ASSERT_EQ(times.back(), path_.frame_count - 1);
  EXPECT_EQ(played(times).data(), retimed(synthesis, static_cast<int>(times.size()), poisson_).data());
}

// Squared accelerations of all vertices, summed.
double unrest(const MeshSequence& motion) {
  double sum = 0.0;
  for (std::size_t f = 1; f + 1 < motion.frame_count(); ++f) {
    sum += (motion.frame(f + 1) - 2.0F * motion.frame(f) + motion.frame(f - 1)).cast<double>().squaredNorm();
  }
  return sum;
}

TEST_F(PathPlaying, InterpolatedRepeatsDoNotStopTheMotion) {
  const std::vector<int> frames = uneven();
  const MeshSequence repeats = played(path_times(frames, Timing::repeats));
  const MeshSequence linear = played(path_times(frames, Timing::linear));
  const MeshSequence smooth = played(path_times(frames, Timing::smooth));
  int stops = 0;
  for (std::size_t f = 0; f + 1 < repeats.frame_count(); ++f) {
    stops += repeats.frame(f) == repeats.frame(f + 1) ? 1 : 0;
    EXPECT_NE(linear.frame(f), linear.frame(f + 1)) << f;
    EXPECT_NE(smooth.frame(f), smooth.frame(f + 1)) << f;
  }
  ASSERT_GT(stops, 5) << "the test needs repeats";
  EXPECT_LT(unrest(linear), 0.8 * unrest(repeats));
  EXPECT_LT(unrest(smooth), 0.5 * unrest(linear));
}

TEST_F(PathPlaying, OriginsAndColoursAreThoseOfTheNearerFrame) {
  PerformanceDatabase painted;
  for (const char* name : {"a", "c"}) {
    MeshSequence clip = database_.clip(database_.clip_idx(name));
    std::vector<Color> colors;
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      colors.insert(colors.end(), clip.vertex_count(), Color{static_cast<std::uint8_t>(f), 0, *name == 'c'});
    }
    clip.set_colors(std::move(colors));
    painted.add(std::move(clip));
  }
  const PathPlayer all(painted, poisson_, path_, BlendProfile::smooth, {0.0, 2.4, 2.6, 38.6});
  const MeshSequence result = all.frames(0, 4);
  const std::vector<FrameOrigin> origins = path_frames(path_, painted, BlendProfile::smooth);
  EXPECT_EQ(result.origins()[1], origins[2]);
  EXPECT_EQ(result.origins()[2], origins[3]);
  ASSERT_TRUE(result.has_colors_per_frame());
  EXPECT_EQ(result.colors(1)[0], (Color{7, 0, 0}));
  EXPECT_EQ(result.colors(2)[0], (Color{8, 0, 0}));
  EXPECT_EQ(result.colors(3)[0], (Color{50, 0, 1}));
  // Colours that never change are kept once, in every stretch.
  PerformanceDatabase plain;
  for (const MeshSequence& clip : database_.clips()) {
    MeshSequence red = clip;
    red.set_colors(std::vector<Color>(clip.vertex_count(), Color{200, 0, 0}));
    plain.add(std::move(red));
  }
  const PathPlayer constant(plain, poisson_, path_, BlendProfile::smooth, {0.0, 2.4, 38.6});
  EXPECT_TRUE(constant.frames(1, 3).has_colors());
  EXPECT_FALSE(constant.frames(1, 3).has_colors_per_frame());
}

TEST_F(PathPlaying, NormalsAreThoseOfTheSurfaceShown) {
  PerformanceDatabase with_normals;
  for (const MeshSequence& clip : database_.clips()) {
    MeshSequence copy = clip;
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      copy.mutable_normals(f) = vertex_normals(*clip.topology(), clip.frame(f));
    }
    with_normals.add(std::move(copy));
  }
  EXPECT_FALSE(player({1.0}).frames(0, 1).has_normals());
  const PathPlayer all(with_normals, poisson_, path_, BlendProfile::smooth, {1.0, 2.5, 16.0, 16.5, 38.0});
  const MeshSequence result = all.frames(0, 5);
  ASSERT_TRUE(result.has_normals());
  for (std::size_t f = 0; f < result.frame_count(); ++f) {
    const Positions expected = vertex_normals(*result.topology(), result.frame(f));
    EXPECT_LT((result.normals(f) - expected).cwiseAbs().maxCoeff(), 1e-4F) << f;
  }
}

TEST_F(PathPlaying, ShortestPaths) {
  for (const int last : {5, 6, 7}) {
    path_.segments = {{.clip_idx = 0, .first_frame = 5, .last_frame = last}};
    path_.frame_count = last - 4;
    EXPECT_EQ(played({0.0, last - 5.0}).frame(1), database_.clip(0).frame(static_cast<std::size_t>(last)));
    if (last > 5) {
      EXPECT_TRUE(played({0.5}).frame(0).allFinite());
    }
  }
}

TEST_F(PathPlaying, RefusesTimesOutsideOfThePathAndBackwards) {
  EXPECT_THAT(
      [&] {
        (void)player({0.0, 38.9, 39.1});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("frame 2 shows the path at 39.1")));
  EXPECT_THAT([&] { (void)player({-0.1}); }, ThrowsMessage<InvalidArgument>(HasSubstr("from 0 to 39")));
  EXPECT_THAT([&] { (void)player({std::nan("")}); }, ThrowsMessage<InvalidArgument>(HasSubstr("nan")));
  EXPECT_THAT(
      [&] {
        (void)player({3.0, 2.5});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("does not go back")));
  EXPECT_THROW((void)player({0.0}).frames(0, 2), InvalidArgument);
  path_.segments.back().last_frame = 60;
  EXPECT_THAT([&] { (void)player({0.0}); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame 60 of clip 1")));
  path_ = {};
  EXPECT_THAT([&] { (void)player({}); }, ThrowsMessage<InvalidArgument>(HasSubstr("the path is empty")));
}

}  // namespace
}  // namespace reprise
