// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframe_grid.h"

#include <algorithm>
#include <array>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/pipeline/keyframe_figures.h"
#include "support/shapes.h"

namespace reprise {
namespace {

// Targets of 1 to 3 m and 1 to 2 s; the path of each is off by (distance, time).
KeyframeGrid small_grid(const std::vector<std::array<double, 2>>& errors) {
  KeyframeGrid grid;
  for (int time = 1; time <= 2; ++time) {
    for (int distance = 1; distance <= 3; ++distance) {
      GridQuery query{.target_distance = distance, .target_time = time, .cpu_seconds = 0.5};
      const auto& [off_distance, off_time] = errors[grid.queries.size()];
      query.path.distance = distance + off_distance;
      query.path.time = time + off_time;
      query.path.frame_count = static_cast<int>(std::lround(25.0 * query.path.time));
      grid.queries.push_back(query);
    }
  }
  return grid;
}

TEST(KeyframeGrid, ReachableIsWhatTheOptimumMissesByNoMore) {
  KeyframeGrid grid =
      small_grid({{1.0, 0.0}, {1.01, 0.0}, {-1.0, 1.0}, {0.0, 1.04}, {0.3, 0.2}, {-1.2, 0.0}});
  complete_grid(grid, {}, {});
  std::vector<bool> reachable;
  for (const GridQuery& query : grid.queries) reachable.push_back(query.is_reachable);
  EXPECT_EQ(reachable, std::vector<bool>({true, false, true, false, true, false}));

  const GridResult result{.grid = grid};
  const GridFigures figures = figures_of({&result});
  EXPECT_EQ(figures.targets, 6U);
  EXPECT_EQ(figures.reachable, 3U);
  EXPECT_NEAR(figures.distance_error.rms, std::sqrt((1.0 + 1.0 + 0.09) / 3.0), 1e-9);
  EXPECT_NEAR(figures.time_error.max, 1.0, 1e-9);
  EXPECT_NEAR(figures.all_time_error.max, 1.04, 1e-9);
  EXPECT_EQ(figures.smoothness.count, 0U) << "no path has a transition";
  EXPECT_NEAR(figures.total_cpu(), 3.0, 1e-12);
}

TEST(KeyframeGrid, NearestReachableIsNearestByTheWeights) {
  KeyframeGrid grid = small_grid({{0, 0}, {2, 0}, {2, 0}, {2, 0}, {2, 0}, {0, 0}});
  complete_grid(grid, {}, {});
  const auto nearest = [&](std::size_t query, const KeyframeOptions& options) {
    const GridQuery* found = nearest_reachable(grid, grid.queries[query], options);
    return found == nullptr ? -1 : static_cast<int>(found - grid.queries.data());
  };
  // 3 m in 1 s: 2 m from the first target, 1 s from the last.
  EXPECT_EQ(nearest(2, {.distance_weight = 1.0, .time_weight = 0.1}), 0);
  EXPECT_EQ(nearest(2, {.distance_weight = 1.0, .time_weight = 0.01}), 5);
  EXPECT_EQ(nearest(2, {.distance_weight = 2.0, .time_weight = 0.1}), 5);
  for (GridQuery& query : grid.queries) query.is_reachable = false;
  EXPECT_EQ(nearest(2, {}), -1);
}

TEST(KeyframeGrid, SmoothnessOfAPathIsTheMeanOfItsTransitionsAsOftenAsTaken) {
  KeyframeGrid grid = small_grid(std::vector<std::array<double, 2>>(6));
  grid.queries[1].transitions = {4, 7, 4};
  complete_grid(grid, {{4, {0.1, 0.4}}, {7, {0.4, 1.6}}}, {});
  EXPECT_FALSE(grid.queries[0].smoothness);
  ASSERT_TRUE(grid.queries[1].smoothness);
  EXPECT_NEAR(grid.queries[1].smoothness->weighted, 0.2, 1e-12);
  EXPECT_NEAR(grid.queries[1].smoothness->normalized, 0.8, 1e-12);
}

TEST(PathSegments, JoinTransitionsAndRefuseWhatDoesNotFit) {
  const PathMetrics metrics({std::vector<Eigen::Vector2d>(40), std::vector<Eigen::Vector2d>(30)},
                            {{.source_clip = 0, .target_clip = 1, .m = 20, .n = 5, .half_window = 3},
                             {.source_clip = 1, .target_clip = 0, .m = 15, .n = 8, .half_window = 2}},
                            BlendProfile::smooth, 25.0);
  const std::vector<FrameId> keyframes = {{0, 2}, {0, 39}};
  const std::vector<PathSegment> segments = path_segments(keyframes, metrics, {0, 1});
  ASSERT_EQ(segments.size(), 3U);
  const auto frames = [](const PathSegment& s) {
    return std::array{int(s.clip_idx), s.first_frame, s.last_frame};
  };
  EXPECT_EQ(frames(segments[0]), (std::array{0, 2, 17}));
  EXPECT_EQ(frames(segments[1]), (std::array{1, 8, 13}));
  EXPECT_EQ(frames(segments[2]), (std::array{0, 10, 39}));
  EXPECT_FALSE(segments[2].transition);
  EXPECT_EQ(path_segments(keyframes, metrics, {}).size(), 1U);
  for (const std::vector<int>& bad : {std::vector{0}, {1}, {0, 0}, {2}, {-1}})
    EXPECT_THROW(path_segments(keyframes, metrics, bad), InvalidArgument);
  EXPECT_THROW(path_segments({{0, 18}, {0, 39}}, metrics, {0, 1}), InvalidArgument)
      << "the start is too late";
  EXPECT_THROW(path_segments({{0, 2}, {0, 9}}, metrics, {0, 1}), InvalidArgument) << "the end is too early";
}

TEST(Spread, OfKnownValues) {
  const Spread spread = spread_of({4.0, 1.0, 3.0, 0.0});
  EXPECT_EQ(spread.count, 4U);
  EXPECT_EQ(spread.min, 0.0);
  EXPECT_EQ(spread.max, 4.0);
  EXPECT_EQ(spread.mean, 2.0);
  EXPECT_EQ(spread.median, 2.0);
  EXPECT_NEAR(spread.rms * spread.rms, 6.5, 1e-12);
  EXPECT_NEAR(spread.rms * spread.rms, spread.mean * spread.mean + spread.deviation * spread.deviation,
              1e-12);
  EXPECT_EQ(spread_of({5.0}).median, 5.0);
  EXPECT_EQ(spread_of({}).count, 0U);
}

TEST(ChooseSamples, AreSpreadEvenlyOverPairsAndTargets) {
  const EvaluateKeyframesOptions options{.max_distance = 20, .max_time = 40, .samples = 200};
  const std::vector<std::vector<std::size_t>> samples = choose_samples(12, options);
  ASSERT_EQ(samples.size(), 12U);
  std::size_t total = 0;
  std::array<std::array<std::size_t, 4>, 4> blocks{};  // of 5 m x 10 s
  for (const std::vector<std::size_t>& pair : samples) {
    EXPECT_TRUE(pair.size() == 16 || pair.size() == 17) << pair.size();
    EXPECT_EQ(std::set<std::size_t>(pair.begin(), pair.end()).size(), pair.size()) << "no target twice";
    total += pair.size();
    for (const std::size_t query : pair) {
      ASSERT_LT(query, 800U);
      ++blocks[query % 20 / 5][query / 20 / 10];
    }
  }
  EXPECT_EQ(total, 200U);
  for (const auto& row : blocks) {
    for (const std::size_t count : row) EXPECT_NEAR(static_cast<double>(count), 200.0 / 16.0, 4.0);
  }
  EXPECT_EQ(choose_samples(12, options), samples);
  // More than there are: every target.
  for (const auto& pair : choose_samples(3, {.max_distance = 4, .max_time = 3, .samples = 500}))
    EXPECT_EQ(pair.size(), 12U);
  for (const auto& pair : choose_samples(3, {.samples = 0})) EXPECT_TRUE(pair.empty());
}

TEST(PaperTable, HasTwelveRowsInOrder) {
  EXPECT_EQ(paper_table().size(), 12U);
  for (const PaperRow& row : paper_table()) {
    EXPECT_LE(row.smoothness_min, row.smoothness_max);
    EXPECT_LE(row.distance_min, row.distance_rms);
    EXPECT_LE(row.distance_rms, row.distance_max);
    EXPECT_LE(row.time_rms, row.time_max);
    EXPECT_LT(row.cpu_deviation, row.cpu_mean);
  }
}

TEST(PaperTable, RowsAreThoseOfTheCostumeThatTheNameSays) {
  PerformanceDatabase fashion;
  for (const char* clip : {"pose", "walk", "twirl", "walk_pose"}) fashion.add(test::walk(clip, 101));
  EXPECT_STREQ(paper_rows(fashion, "fashion2")[0].to, "twirl:100");
  EXPECT_STREQ(paper_rows(fashion, "fashion1")[0].to, "twirl:85");
  EXPECT_STREQ(paper_rows(fashion, "mine")[0].to, "twirl:85");
  PerformanceDatabase shorter;
  for (const char* clip : {"pose", "walk", "twirl", "walk_pose"}) shorter.add(test::walk(clip, 90));
  EXPECT_STREQ(paper_rows(shorter, "fashion2")[0].to, "twirl:85") << "it has no frame 100";
  EXPECT_TRUE(paper_rows(test::database_of({test::walk("walk", 60)}), "fashion1").empty());
}

}  // namespace
}  // namespace reprise
