// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/shape_color_metric.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/parallel.h"
#include "reprise/math/ground_transform.h"
#include "reprise/similarity/histogram_test_support.h"

namespace reprise {
namespace {

using test::blue;
using test::database_of;
using test::dressed;
using test::green;

// Few bins and turns, so that brute force is quick.
HistogramOptions coarse() {
  return {.radius_bins = 3,
          .polar_bins = 5,
          .azimuth_bins = 8,
          .color_bins = {4, 4, 4},
          .azimuth_refinement = 5,
          .voxel_size = 0.05,
          .min_color_share = 0.0};
}

PerformanceDatabase two_walks() {
  return database_of({dressed("a", 13, blue), dressed("b", 12, green, 5.0)});
}

// Bounds of all pairs, row-major over all frames.
std::vector<MatrixEntry> bound_all(ShapeColorMetric& metric, const PerformanceDatabase& database,
                                   SearchStatistics* statistics = nullptr) {
  std::vector<std::size_t> counts;
  for (const MeshSequence& clip : database.clips()) counts.push_back(clip.frame_count());
  const std::size_t frames = database.frame_count();
  std::vector<MatrixEntry> all(frames * frames);
  const std::vector<FrameTile> tiles = ShapeColorMetric::tiles(counts);
  std::vector<SearchStatistics> done(tiles.size());
  parallel_for(0, tiles.size(), [&](std::size_t t) {
    const FrameTile& tile = tiles[t];
    const std::size_t columns = tile.b_last - tile.b_first;
    std::vector<MatrixEntry> out((tile.a_last - tile.a_first) * columns);
    done[t] = metric.bound_tile(tile, out);
    for (std::size_t k = 0; k < out.size(); ++k) {
      all[(tile.a_first + k / columns) * frames + tile.b_first + k % columns] = out[k];
    }
  });
  for (const SearchStatistics& s : done) {
    if (statistics != nullptr) *statistics += s;
  }
  return all;
}

TEST(ShapeColorMetric, TilesHoldEveryPairOnce) {
  const std::vector<std::size_t> counts = {1, 25, 10, 0, 31};
  const std::size_t frames = 67;
  std::vector<int> seen(frames * frames);
  for (const FrameTile& tile : ShapeColorMetric::tiles(counts)) {
    for (std::size_t a = tile.a_first; a < tile.a_last; ++a) {
      for (std::size_t b = tile.b_first; b < tile.b_last; ++b) ++seen[a * frames + b];
    }
  }
  for (std::size_t a = 0; a < frames; ++a) {
    for (std::size_t b = a + 1; b < frames; ++b) ASSERT_EQ(seen[a * frames + b], 1) << a << " " << b;
  }
}

TEST(ShapeColorMetric, ExactEqualsBruteForceAndLiesWithinTheBounds) {
  const PerformanceDatabase database = two_walks();
  ShapeColorMetric metric(database, coarse());
  const ShapeColorMetric unprepared(database, coarse());  // knows no bounds
  SearchStatistics bounding;
  const std::vector<MatrixEntry> bounds = bound_all(metric, database, &bounding);
  SearchStatistics exact;
  SearchStatistics all;
  const std::size_t frames = database.frame_count();
  std::uint64_t pairs = 0;
  for (std::size_t a = 0; a < frames; ++a) {
    for (std::size_t b = a + 1; b < frames; b += 4, ++pairs) {
      const MatrixEntry truth = metric.brute_force(a, b, &all);
      ASSERT_TRUE(truth.is_exact());
      ASSERT_EQ(metric.exact(a, b, &exact), truth) << a << " " << b;
      ASSERT_EQ(unprepared.exact(a, b), truth) << a << " " << b;
      const MatrixEntry& bound = bounds[a * frames + b];
      ASSERT_LE(bound.lower, truth.value);
      ASSERT_GE(bound.value, truth.value);
    }
  }
  EXPECT_EQ(all.exact_solves, pairs * 40);
  // The point of it all.
  EXPECT_LT(bounding.exact_solves, 4 * frames * (frames - 1) / 2);
  EXPECT_LT(exact.exact_solves + exact.cut_solves, all.exact_solves / 4);
}

TEST(ShapeColorMetric, BoundsDoNotDependOnThreads) {
  const PerformanceDatabase database = two_walks();
  ShapeColorMetric metric(database, coarse());
  const std::vector<MatrixEntry> many = bound_all(metric, database);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  ShapeColorMetric again(database, coarse());
  EXPECT_EQ(bound_all(again, database), many);
}

TEST(ShapeColorMetric, IsSymmetric) {
  const ShapeColorMetric metric(database_of({dressed("a", 6, blue), dressed("b", 5, green, 5.0)}), coarse());
  // The same canonical direction in both: it is that of the first frame of a database.
  const ShapeColorMetric swapped(
      database_of({dressed("a", 6, blue), dressed("b", 5, green, 5.0), dressed("a again", 6, blue)}),
      coarse());
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = 6; b < 11; ++b) {
      const MatrixEntry there = metric.exact(a, b);
      const MatrixEntry back = swapped.exact(b, 11 + a);
      EXPECT_EQ(there.value, back.value);
      EXPECT_NEAR(wrap_angle(there.yaw + back.yaw), 0.0, 1e-5);
    }
  }
}

TEST(ShapeColorMetric, IgnoresWhereAClipLiesAndHowItFaces) {
  const MeshSequence clip = dressed("a", 6, blue);
  for (const double yaw : {0.0, 0.5, -2.0, std::numbers::pi}) {
    const GroundTransform transform{.yaw = yaw, .translation = {3.0, -7.0}};
    const ShapeColorMetric metric(database_of({clip, test::moved(clip, transform, "b")}), coarse());
    for (std::size_t f = 0; f < 6; ++f) {
      // A few voxels may fall to the other side of a border by rounding.
      const MatrixEntry entry = metric.exact(f, 6 + f);
      EXPECT_LT(entry.value, 1e-3);
      EXPECT_NEAR(wrap_angle(entry.yaw + yaw), 0.0, 1e-3);
    }
    EXPECT_NEAR(metric.exact(0, 3).value, metric.exact(0, 9).value, 1e-3);
  }
}

TEST(ShapeColorMetric, FindsTheTurnOfATurnedBody) {
  // The clip's own frames keep their directions to each other: only the body of one frame is turned.
  MeshSequence clip = dressed("a", 2, blue);
  const double yaw = 0.4;
  const MeshSequence& still = clip;
  transform_positions({.yaw = yaw}, still.frame(0), clip.frame(1));
  const ShapeColorMetric metric(database_of({clip}), {.voxel_size = 0.04});
  const double fine_bin = 2.0 * std::numbers::pi / 200.0;
  EXPECT_NEAR(metric.exact(0, 1).yaw, -yaw, fine_bin);
  EXPECT_LT(metric.exact(0, 1).value, 2e-3);
}

TEST(ShapeColorMetric, ARecoloredCopyIsFarInColorAndNearInShape) {
  const PerformanceDatabase database = database_of({dressed("a", 3, blue), dressed("b", 3, green)});
  HistogramOptions shape = coarse();
  shape.use_color = false;
  const ShapeColorMetric with_color(database, coarse());
  const ShapeColorMetric without(database, shape);
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_GT(with_color.exact(f, 3 + f).value, 0.05);
    EXPECT_EQ(without.exact(f, 3 + f).value, 0.0F);
  }
}

TEST(ShapeColorMetric, ColorNeverBringsFramesNearer) {
  // Leaving out the colour is a map that lengthens no distance.
  HistogramOptions shape = coarse();
  shape.use_color = false;
  const PerformanceDatabase database = two_walks();
  const ShapeColorMetric with_color(database, coarse());
  const ShapeColorMetric without(database, shape);
  for (std::size_t b = 1; b < database.frame_count(); b += 2) {
    EXPECT_LE(without.exact(0, b).value, with_color.exact(0, b).value + 1e-6F);
  }
}

}  // namespace
}  // namespace reprise
