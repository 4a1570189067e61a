// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stages "markup" and "skeleton", and what other stages do with a markup.

#include "reprise/pipeline/skeleton.h"

#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/bvh.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/import.h"
#include "reprise/pipeline/inspect.h"
#include "reprise/pipeline/markup.h"
#include "reprise/pipeline/part_colors.h"
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
  EXPECT_EQ(info["format_version"], 2);  // without learnt models
}

TEST(MarkupStage, PartsAreMadeAnewFromTheLabels) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase all = make_figure({.voxel_size = 0.03});
  PerformanceDatabase figure;
  figure.add(all.clip(0));
  figure.set_markup(*all.markup());
  figure.set_truth(0, *all.truth(0));
  save_database(figure, folder / "f.reprise", "a note");
  const auto parts_of = [&](PartScheme scheme) {
    const Markup made = mark_up(folder / "f.reprise", {.parts = scheme}, folder / "g.reprise");
    const PerformanceDatabase written = load_database(folder / "g.reprise");
    EXPECT_EQ(written.content_hash(), figure.content_hash());
    EXPECT_EQ(written.markup()->joint_of_vertex, figure.markup()->joint_of_vertex);
    EXPECT_NE(written.truth(0), nullptr);
    EXPECT_EQ(DatabaseReader(folder / "g.reprise").note(), "a note");
    EXPECT_EQ(written.markup()->parts.size(), made.parts.size());
    return written.markup()->parts;
  };
  const std::vector<BodyPart> limbs = parts_of(PartScheme::limbs);
  ASSERT_EQ(limbs.size(), 14U);
  EXPECT_EQ(limbs[4].name, "left_hand");
  EXPECT_EQ(limbs[4].parent, 3);
  const std::vector<BodyPart> whole = parts_of(PartScheme::whole);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].vertices.size(), static_cast<std::size_t>(figure.topology()->vertex_count));
  // Six parts are those the figure has already.
  const std::vector<BodyPart> six = parts_of(PartScheme::six);
  ASSERT_EQ(six.size(), 6U);
  for (std::size_t p = 0; p < six.size(); ++p) EXPECT_EQ(six[p].vertices, figure.markup()->parts[p].vertices);

  EXPECT_EQ(parse_part_scheme("limbs"), PartScheme::limbs);
  EXPECT_THAT([] { parse_part_scheme("two"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("expected six, limbs or whole")));
  PerformanceDatabase bare = figure;
  bare.set_markup(std::nullopt);
  save_database(bare, folder / "bare.reprise");
  EXPECT_THAT([&] { mark_up(folder / "bare.reprise", {.parts = PartScheme::six}, folder / "h.reprise"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no markup whose joint labels")));
}

TEST(PartColors, ShowWhichPartsHoldAVertex) {
  const test::TemporaryFolder folder;
  PerformanceDatabase figure = make_figure({.voxel_size = 0.06});
  save_database(figure, folder / "f.reprise");
  MeshSequence clip = figure.clip(0);
  color_parts(clip, folder / "f.reprise");
  ASSERT_FALSE(clip.has_colors_per_frame());
  const std::span<const Color> colors = clip.colors(0);
  // Where one part alone holds a vertex, the part's colour; else one that is none of them.
  const Markup& markup = *figure.markup();
  std::vector<int> holders(colors.size(), 0);
  std::vector<std::size_t> holder(colors.size(), 0);
  for (std::size_t p = 0; p < markup.parts.size(); ++p) {
    for (const std::int32_t v : markup.parts[p].vertices) {
      ++holders[static_cast<std::size_t>(v)];
      holder[static_cast<std::size_t>(v)] = p;
    }
  }
  std::map<std::size_t, std::set<Color>> pure;
  std::set<Color> all;
  for (std::size_t v = 0; v < colors.size(); ++v) {
    if (holders[v] == 1) pure[holder[v]].insert(colors[v]);
    all.insert(colors[v]);
  }
  std::set<Color> distinct;
  for (const auto& [part, part_colors] : pure) {
    EXPECT_EQ(part_colors.size(), 1U) << markup.parts[part].name;
    distinct.insert(part_colors.begin(), part_colors.end());
  }
  EXPECT_EQ(distinct.size(), markup.parts.size());
  EXPECT_GT(all.size(), 4 * distinct.size());

  figure.set_markup(std::nullopt);
  save_database(figure, folder / "f.reprise");
  EXPECT_THAT([&] { color_parts(clip, folder / "f.reprise"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("has no body parts")));
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
