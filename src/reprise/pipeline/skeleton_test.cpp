// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stages "markup" and "skeleton", and what other stages do with a markup.

#include "reprise/pipeline/skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/bvh.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/import.h"
#include "reprise/pipeline/inspect.h"
#include "reprise/pipeline/markup.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(SkeletonStage, FollowsTheFigureAndSaysHowFarItIsFromTheTruth) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase figure = make_figure({.voxel_size = 0.03});
  save_database(figure, folder / "f.reprise");
  const SkeletonResult result = extract_skeletons(folder / "f.reprise", {.clip = "walk"});
  ASSERT_EQ(result.motions.size(), 1U);
  const nlohmann::json& clip = result.report["clips"][0];
  EXPECT_EQ(clip["name"], "walk");
  EXPECT_LT(clip["difference"]["distance"].get<double>(), 0.001);
  EXPECT_LT(clip["difference"]["angle_degrees"].get<double>(), 0.5);
  EXPECT_LT(clip["length_error"]["mean"].get<double>(), 0.01);
  EXPECT_EQ(result.report["joints"].size(), figure.markup()->skeleton.joints.size());

  write_skeletons(result.motions, folder / "bvh");
  const SkeletalMotion read = read_bvh(folder / "bvh" / "walk.bvh");
  ASSERT_EQ(read.frames.size(), result.motions[0].frames.size());
  // The file has rest lengths, so that joints far from the root may differ by what the lengths strayed.
  const int hand = read.skeleton.joint_idx("left_hand");
  const int same = result.motions[0].skeleton.joint_idx("left_hand");
  for (std::size_t f = 0; f < read.frames.size(); ++f) {
    EXPECT_LT((read.frames[f].position[static_cast<std::size_t>(hand)] -
               result.motions[0].frames[f].position[static_cast<std::size_t>(same)])
                  .norm(),
              0.01);
  }
  EXPECT_THAT([&] { (void)extract_skeletons(folder / "f.reprise", {.clip = "wlak"}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'walk'")));
}

TEST(MarkupStage, ADatabaseComesBackFromItsOwnMarkupFileAsItWas) {
  const test::TemporaryFolder folder;
  save_database(make_figure({.voxel_size = 0.06}), folder / "f.reprise");
  mark_up(folder / "f.reprise", {.write_json = folder / "m.json"}, {});
  mark_up(folder / "f.reprise", {.file = folder / "m.json"}, folder / "g.reprise");
  const PerformanceDatabase f = load_database(folder / "f.reprise");
  const PerformanceDatabase g = load_database(folder / "g.reprise");
  EXPECT_EQ(f.content_hash(), g.content_hash());
  ASSERT_TRUE(g.markup());
  EXPECT_EQ(f.markup()->joint_of_vertex, g.markup()->joint_of_vertex);
  EXPECT_NE(g.truth(0), nullptr);
  const nlohmann::json info = describe_database(folder / "g.reprise");
  EXPECT_EQ(info["markup"]["joints"].size(), f.markup()->skeleton.joints.size());
  EXPECT_EQ(info["markup"]["parts"].size(), 6U);
  EXPECT_EQ(info["clips"][0]["truth"], true);
  EXPECT_EQ(info["format_version"], database_format_version);
}

TEST(MarkupStage, AppendedClipsJoinTheMarkup) {
  REPRISE_REQUIRE_DATA();
  const test::TemporaryFolder folder;
  const std::string ama = (test::data_folder() / "ama").string();
  const auto path = folder / "ama.reprise";
  import_sequences(path, {.sequences = {parse_import_sequence("crane=" + ama + "/crane")}});
  mark_up(path,
          {.landmarks = std::filesystem::path(REPRISE_SOURCE_DIR) / "tests/fixtures/ama_landmarks.json"},
          folder / "marked.reprise");
  import_sequences(folder / "marked.reprise",
                   {.sequences = {parse_import_sequence("jumping=" + ama + "/jumping")}, .append = true});
  const SkeletonResult result = extract_skeletons(folder / "marked.reprise", {});
  ASSERT_EQ(result.motions.size(), 2U);
  for (const nlohmann::json& clip : result.report["clips"]) {
    // Loose clothes over a body whose joints were never measured.
    EXPECT_LT(clip["length_error"]["mean"].get<double>(), 0.04) << clip["name"];
    EXPECT_TRUE(clip["difference"].is_null());
  }
}

TEST(SkeletonStage, NeedsAMarkup) {
  const test::TemporaryFolder folder;
  PerformanceDatabase figure = make_figure({.voxel_size = 0.06});
  figure.set_markup(std::nullopt);
  save_database(figure, folder / "f.reprise");
  EXPECT_THAT([&] { (void)extract_skeletons(folder / "f.reprise", {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("has no markup")));
  EXPECT_THAT([&] { mark_up(folder / "f.reprise", {.write_json = folder / "m.json"}, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no markup to write")));
}

}  // namespace
}  // namespace reprise
