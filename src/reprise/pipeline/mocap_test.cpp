// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/mocap/drive_vertices.h"
#include "reprise/pipeline/mocap_strip.h"
#include "reprise/pipeline/mocap_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class MocapStageTest : public testing::Test {
 protected:
  MocapStageTest() {
    test::write_true_motion("walk", folder_ / "walk.bvh");
    test::write_true_motion("wave", folder_ / "wave.bvh");
  }

  static std::unique_ptr<MocapStage> stage(const MocapStageOptions& options = {}) {
    return std::make_unique<MocapStage>(test::driven_figure(), test::driven_figure_graph(), options);
  }
  MocapQuery query(const std::string& name) const {
    return {.source = {.motion = folder_ / (name + ".bvh")}, .name = name};
  }

  const test::TemporaryFolder folder_;
};

TEST_F(MocapStageTest, CapturedMotionComesBackAsItWasCaptured) {
  MocapStageOptions options;
  options.measure = true;
  const auto result = stage(options)->run(query("walk"), folder_ / "new.reprise");
  ASSERT_TRUE(result);
  const nlohmann::json report = full_report(*result);
  const nlohmann::json& answer = report["answers"][0];
  EXPECT_EQ(answer["repeats"], 0);
  EXPECT_EQ(answer["skips"], 0);
  EXPECT_EQ(answer["transition_count"], 0);
  for (const nlohmann::json& frame : answer["frames"]) EXPECT_EQ(frame["clip"], "walk");
  EXPECT_NEAR(report["scale"].get<double>(), 1.0, 0.02);
  EXPECT_TRUE(report["joint_map"]["missing"].is_array());
  // The paper is content with 0.3 cm/frame where the query is another person.
  EXPECT_LT(answer["measures"]["animation"]["velocity_error_cm_frame"]["mean"].get<double>(), 0.3);
  EXPECT_GT(report["frames_per_second"].get<double>(), 0.0);
}

TEST_F(MocapStageTest, FileHoldsTheClipItsOriginsMarkupModelsAndReport) {
  const auto made = stage();
  const auto result = made->run(query("walk"), folder_ / "new.reprise");
  ASSERT_TRUE(result);
  const PerformanceDatabase written = load_database(folder_ / "new.reprise");
  ASSERT_EQ(written.clip_names(), std::vector<std::string>{"walk"});
  const MeshSequence& clip = written.clip(0);
  EXPECT_EQ(clip.frame_count(), result->plans[0].target.motion.frames.size());
  EXPECT_EQ(clip.origins().size(), clip.frame_count());
  EXPECT_EQ(clip.frames_per_second(), test::driven_figure().frames_per_second());
  EXPECT_TRUE(written.markup().has_value());
  EXPECT_FALSE(written.models().empty());
  EXPECT_EQ(nlohmann::json::parse(DatabaseReader(folder_ / "new.reprise").note()), result->report);
  // The streamed frames are those that are made at once.
  MocapOptions options = made->options().mocap;
  const MeshSequence whole = made->character().animate(result->plans[0], options);
  EXPECT_EQ(whole.data(), clip.data());
}

TEST_F(MocapStageTest, SameBytesForAnyNumberOfThreadsAloneAndInAFolder) {
  const auto made = stage();
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    ASSERT_TRUE(made->run(query("wave"), folder_ / "alone.reprise"));
  }
  const auto outcomes = run_mocap_folder(*made, {query("walk"), query("wave")}, folder_ / "all");
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].name, "walk");
  EXPECT_EQ(read_text_file(folder_ / "alone.reprise"), read_text_file(outcomes[1].output));
}

TEST_F(MocapStageTest, MeasuringDoesNotChangeTheFile) {
  MocapStageOptions options;
  ASSERT_TRUE(stage(options)->run(query("wave"), folder_ / "a.reprise"));
  options.measure = true;
  options.strip_frames = 3;
  ASSERT_TRUE(stage(options)->run(query("wave"), folder_ / "b.reprise"));
  EXPECT_EQ(read_text_file(folder_ / "a.reprise"), read_text_file(folder_ / "b.reprise"));
}

TEST_F(MocapStageTest, QueryThatNoFrameIsNearIsAnOutcomeAndLeavesNoFile) {
  MocapStageOptions options;
  options.mocap.retrieval.threshold = 1e-6;
  const auto made = stage(options);
  const auto result = made->run(query("walk"), folder_ / "new.reprise");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().reason, HasSubstr("frame"));
  EXPECT_FALSE(fs::exists(folder_ / "new.reprise"));
}

TEST_F(MocapStageTest, OneBadMotionOfManyIsAnOutcome) {
  write_text_file(folder_ / "bad.bvh", "HIERARCHY\nROOT Hips\n{\n");
  const auto outcomes =
      run_mocap_folder(*stage(), {query("bad"), query("nowhere"), query("wave")}, folder_ / "all");
  EXPECT_THAT(outcomes[0].failure, HasSubstr("bad.bvh"));
  EXPECT_THAT(outcomes[1].failure, HasSubstr("nowhere.bvh"));
  EXPECT_EQ(outcomes[2].failure, "");
  EXPECT_FALSE(fs::exists(folder_ / "all" / "bad.reprise"));
  EXPECT_TRUE(fs::exists(folder_ / "all" / "wave.reprise"));
}

TEST_F(MocapStageTest, NamesThatCannotBeFilesAreRefusedBeforeTheWork) {
  const auto made = stage();
  EXPECT_THAT(
      [&] {
        run_mocap_folder(*made, {query("walk"), query("walk")}, folder_ / "all");
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("two motions are called 'walk'")));
  MocapQuery elsewhere = query("walk");
  elsewhere.name = "../walk";
  EXPECT_THROW(run_mocap_folder(*made, {elsewhere}, folder_ / "all"), InvalidArgument);
  EXPECT_THROW(run_mocap_folder(*made, {}, folder_ / "all"), InvalidArgument);
  EXPECT_FALSE(fs::exists(folder_ / "all"));
}

TEST_F(MocapStageTest, ClipsThatAreNotWantedAreNotShown) {
  MocapStageOptions options;
  options.without = {"walk"};
  options.mocap.retrieval.threshold = 10.0;
  const auto result = stage(options)->run(query("walk"), folder_ / "new.reprise");
  ASSERT_TRUE(result);
  for (const nlohmann::json& frame : result->report["answers"][0]["frames"]) {
    EXPECT_NE(frame["clip"], "walk");
    EXPECT_NE(frame.value("partner_clip", "none"), "walk");
  }
  options.without = {"wlak"};
  EXPECT_THAT([&] { stage(options); }, ThrowsMessage<InvalidArgument>(HasSubstr("walk")));
}

TEST_F(MocapStageTest, FurtherAnswersAreFurtherClips) {
  MocapStageOptions options;
  options.mocap.retrieval.count = 2;
  options.mocap.retrieval.threshold = 10.0;
  const auto result = stage(options)->run(query("walk"), folder_ / "new.reprise");
  ASSERT_TRUE(result);
  ASSERT_EQ(result->plans.size(), 2U);
  EXPECT_EQ(load_database(folder_ / "new.reprise").clip_names(),
            (std::vector<std::string>{"walk", "walk-2"}));
  EXPECT_EQ(result->report["answers"][1]["name"], "walk-2");
}

TEST_F(MocapStageTest, DriveVerticesOfAFileAreUsed) {
  const auto chosen = stage();
  std::vector<DriveVertex> few = chosen->character().drive_vertices();
  ASSERT_GT(few.size(), 40U);
  few.resize(40);
  write_drive_vertices(few, test::driven_figure().markup()->skeleton, folder_ / "drive.json");
  MocapStageOptions options;
  options.drive_vertices = folder_ / "drive.json";
  EXPECT_EQ(stage(options)->character().drive_vertices().size(), 40U);
}

TEST_F(MocapStageTest, WhatIsNotLearntIsLearnt) {
  PerformanceDatabase figure = test::driven_figure();
  figure.set_models({});
  learn_what_is_missing(figure, {DriveModel::none, DriveModel::lbs});
  EXPECT_TRUE(figure.models().empty());
  learn_what_is_missing(figure, {DriveModel::whole});
  EXPECT_TRUE(figure.models().part.parts.empty());
  EXPECT_FALSE(figure.models().whole.parts.empty());
}

TEST_F(MocapStageTest, SurfaceWithoutMarkupIsRefused) {
  PerformanceDatabase plain = test::driven_figure();
  plain.set_markup(std::nullopt);
  EXPECT_THAT([&] { MocapStage(plain, test::driven_figure_graph(), {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("reprise markup")));
}

TEST_F(MocapStageTest, StripHasTheQueryAboveTheResult) {
  MocapStageOptions options;
  options.strip_frames = 4;
  const auto result = stage(options)->run(query("walk"), folder_ / "new.reprise");
  ASSERT_TRUE(result);
  ASSERT_EQ(result->strip.frame_count(), 4U);
  ASSERT_EQ(result->strip_query.frames.size(), 4U);
  const MeshSequence whole = load_database(folder_ / "new.reprise").clip(0);
  EXPECT_EQ(std::as_const(result->strip).frame(0), whole.frame(0));
  EXPECT_EQ(std::as_const(result->strip).frame(3), whole.frame(whole.frame_count() - 1));
  // The query is where the character is.
  const std::vector<SkeletonPose>& target = result->plans[0].target.motion.frames;
  EXPECT_LT((result->query.frames.front().position[0] - target.front().position[0]).norm(), 0.1);
  EXPECT_LT((result->query.frames.back().position[0] - target.back().position[0]).norm(), 0.1);
  EXPECT_THROW(draw_strip({}, result->strip, folder_ / "strip.png"), InvalidArgument);
}

TEST(MocapShares, EveryRankGetsAboutAsMuchAndEveryQueryHasOne) {
  std::vector<std::uintmax_t> sizes(37);
  std::iota(sizes.begin(), sizes.end(), 10);
  for (const int ranks : {1, 2, 5}) {
    const std::vector<int> rank_of = shares_of_ranks(sizes, ranks);
    std::vector<std::uintmax_t> load(static_cast<std::size_t>(ranks), 0);
    for (std::size_t q = 0; q < sizes.size(); ++q) load.at(static_cast<std::size_t>(rank_of[q])) += sizes[q];
    EXPECT_LE(std::ranges::max(load) - std::ranges::min(load), sizes.back());
  }
}

}  // namespace
}  // namespace reprise
