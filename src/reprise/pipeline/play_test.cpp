// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/play.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/synthesis/naturalness.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Mode = PlayOptions::Mode;

class Play : public ::testing::Test {
 protected:
  static PerformanceDatabase walks() {
    PerformanceDatabase database;
    database.add(test::walk("slow", 70, 0.03, 20.0));
    database.add(test::walk("fast", 60, 0.06, 20.0, 7.0));
    return database;
  }

  test::TemporaryFolder folder_;
  PerformanceDatabase database_ = walks();
  SimilarityResult similarity_ =
      compute_similarity(database_, folder_ / "db",
                         {.transitions = {.transitions_per_pair = 12, .separation = 3}, .use_cache = false});
  SurfaceMotionGraph graph_ = make_graph(database_, similarity_, {}, std::nullopt);
};

TEST_F(Play, WhatIsReportedIsWhatIsShown) {
  for (const Mode mode : {Mode::loop, Mode::stochastic}) {
    PlayStageOptions options{.from = "slow:3", .max_pop_ratio = 3.0};
    options.play.mode = mode;
    options.play.time = 12.0;
    const auto result = run_play(database_, graph_, options);
    ASSERT_TRUE(result.has_value()) << result.error().reason;
    const nlohmann::json& report = result->report;
    EXPECT_GE(report["time"].get<double>(), 12.0);
    EXPECT_EQ(report["frames"].size(), result->animation.frame_count());
    EXPECT_EQ(report["frames"].front()["clip"], "slow");
    EXPECT_EQ(report["frames"].front()["frame"], 3);
    double seconds = 0.0;
    for (const auto& [clip, time] : report["clips"].items()) seconds += time.get<double>();
    EXPECT_NEAR(seconds, report["time"].get<double>(), 1e-9);
    const double travelled =
        ground_distance(ground_trajectory(result->animation), 0, result->animation.frame_count() - 1);
    EXPECT_NEAR(report["distance"].get<double>(), travelled, 0.01 * travelled);
    // The measure of the stage is that of the evaluation.
    EXPECT_NEAR(report["pop_ratio"].get<double>(),
                evaluate_naturalness(result->animation, database_).pop_ratio, 1e-6);
    EXPECT_EQ(report.contains("seed"), mode == Mode::stochastic);
    EXPECT_EQ(report.contains("loop"), mode == Mode::loop);
  }
}

// The limit holds of what is shown, however the graph estimated it.
TEST_F(Play, NoJoinIsAboveTheLimit) {
  PlayStageOptions options{.from = "slow:3", .max_pop_ratio = unlimited};
  options.play.time = 20.0;
  options.play.temperature = 100.0;
  const auto any = run_play(database_, graph_, options);
  ASSERT_TRUE(any.has_value());
  const double worst = any->report["pop_ratio"];
  EXPECT_TRUE(any->report["max_pop_ratio"].is_null());
  // Estimates that promise too much: the measurement must find out.
  SurfaceMotionGraph optimistic = graph_;
  for (Transition& transition : optimistic.transitions) transition.peak_acceleration = 0.0;
  options.max_pop_ratio = 0.99 * worst;
  const auto limited = run_play(database_, optimistic, options);
  ASSERT_TRUE(limited.has_value()) << limited.error().reason;
  EXPECT_GT(limited->report["joins_left_out"].get<int>(), 0);
  EXPECT_LE(limited->report["pop_ratio"].get<double>(), 0.99 * worst);
  EXPECT_LE(evaluate_naturalness(limited->animation, database_).pop_ratio, 0.99 * worst + 1e-6);
}

// Where the last frame of a period is followed by its first, brought to where it ends, nothing jumps.
TEST_F(Play, APeriodCanBeRepeatedWithoutASeam) {
  PlayStageOptions options{.from = "slow:3", .max_pop_ratio = 3.0};
  options.play.mode = Mode::period;
  const auto result = run_play(database_, graph_, options);
  ASSERT_TRUE(result.has_value()) << result.error().reason;
  const MeshSequence& round = result->animation;
  EXPECT_EQ(round.frame_count(), result->report["loop"]["period"].get<std::size_t>());
  const nlohmann::json& loop = result->report["loop"];
  const GroundTransform start_from_next{.yaw = loop["yaw"].get<double>(),
                                        .translation = Eigen::Vector2d(loop["translation"][0].get<double>(),
                                                                       loop["translation"][1].get<double>())};
  const FrameId first = database_.parse_frame(
      fmt::format("{}:{}", round.origins().front().clip, round.origins().front().frame_idx));
  // What the capture itself does from the last frame to the first.
  const MeshSequence& clip = database_.clip(first.clip_idx);
  const std::size_t last = round.frame_count() - 1;
  double worst = 0.0;
  for (Eigen::Index v = 0; v < static_cast<Eigen::Index>(round.vertex_count()); ++v) {
    const Eigen::Vector3d next = start_from_next * round.frame(0).row(v).transpose().cast<double>().eval();
    const Eigen::Vector3d step = next - round.frame(last).row(v).transpose().cast<double>();
    const Eigen::Vector3d captured =
        (clip.frame(first.frame_idx).row(v) - clip.frame(first.frame_idx - 1).row(v))
            .transpose()
            .cast<double>();
    worst = std::max(worst, std::abs(step.norm() - captured.norm()));
  }
  EXPECT_LT(worst, 1e-3);
}

TEST_F(Play, OutcomesAndMistakesAreClear) {
  const PlayStageOptions good{.from = "slow:3"};
  PlayStageOptions options = good;
  options.max_pop_ratio = 0.0;
  const auto none = run_play(database_, graph_, options);
  ASSERT_FALSE(none.has_value());
  EXPECT_THAT(none.error().reason, AllOf(HasSubstr("slow:3"), HasSubstr("dead end")));
  options = good;
  options.from = "slwo:3";
  EXPECT_THAT([&] { (void)run_play(database_, graph_, options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'slow'")));
  options = good;
  options.without = {"fsat"};
  EXPECT_THAT([&] { (void)run_play(database_, graph_, options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'fast'")));
  options = good;
  options.max_pop_ratio = std::nan("");
  EXPECT_THAT([&] { (void)run_play(database_, graph_, options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("greatest pop ratio")));
  options = good;
  options.play.temperature = -1.0;
  EXPECT_THAT([&] { (void)run_play(database_, graph_, options); },
              ThrowsMessage<InvalidArgument>(HasSubstr("temperature")));
  PerformanceDatabase other;
  other.add(test::walk("slow", 70, 0.031, 20.0));
  other.add(test::walk("fast", 60, 0.06, 20.0, 7.0));
  EXPECT_THROW((void)run_play(other, graph_, good), InvalidArgument);
}

}  // namespace
}  // namespace reprise
