// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/io/database_file.h"
#include "reprise/io/sequence_writer.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/import.h"
#include "reprise/pipeline/inspect.h"
#include "reprise/pipeline/keyframes.h"
#include "reprise/pipeline/open.h"
#include "reprise/pipeline/render.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/synthesis/naturalness.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PerformanceDatabase walking_database() {
  PerformanceDatabase database;
  database.add(test::walk("slow", 70, 0.03, 20.0));
  database.add(test::walk("fast", 60, 0.06, 20.0, 7.0));
  return database;
}

// Import

TEST(ParseImportSequence, ReadsEverySetting) {
  const ImportSequence s = parse_import_sequence("run=dir/run.pc2,fps=30,topology=dir/t.ply,scale=0.01,id=x");
  EXPECT_EQ(s.name, "run");
  EXPECT_EQ(s.source.path, "dir/run.pc2");
  EXPECT_EQ(s.frames_per_second, 30.0);
  EXPECT_EQ(s.source.topology, std::filesystem::path("dir/t.ply"));
  EXPECT_EQ(s.source.scale, 0.01);
  EXPECT_EQ(s.source.sequence_id, "x");
}

TEST(ParseImportSequence, SaysWhatIsWrong) {
  EXPECT_THAT([] { parse_import_sequence("dir"); }, ThrowsMessage<InvalidArgument>(HasSubstr("NAME=PATH")));
  EXPECT_THAT([] { parse_import_sequence("a="); }, ThrowsMessage<InvalidArgument>(HasSubstr("no path")));
  EXPECT_THAT([] { parse_import_sequence("a=b,fps=0"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("positive")));
  EXPECT_THAT([] { parse_import_sequence("a=b,rate=25"); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'rate'"), HasSubstr("fps"))));
}

class Import : public ::testing::Test {
 protected:
  void SetUp() override {
    write_sequence(clip_, folder_ / "frames", SequenceFormat::ply);
    options_.sequences = {{.name = "walk", .source = {.path = folder_ / "frames"}}};
  }

  test::TemporaryFolder folder_;
  MeshSequence clip_ = test::walk("walk", 12);
  ImportOptions options_;
};

TEST_F(Import, RoundTripKeepsEveryFrameBitForBit) {
  const ImportReport report = import_sequences(folder_ / "db.reprise", options_);
  EXPECT_EQ(report.frames, 12U);
  const PerformanceDatabase database = load_database(folder_ / "db.reprise");
  EXPECT_EQ(database.clip(0).data(), clip_.data());
  EXPECT_EQ(database.frames_per_second(), 25.0);
}

TEST_F(Import, AppendKeepsTheClipsThatAreThere) {
  import_sequences(folder_ / "db.reprise", options_);
  options_.sequences[0].name = "again";
  options_.append = true;
  import_sequences(folder_ / "db.reprise", options_);
  EXPECT_THAT(load_database(folder_ / "db.reprise").clip_names(), ::testing::ElementsAre("walk", "again"));
  EXPECT_THROW(import_sequences(folder_ / "db.reprise", options_), Error) << "the name is taken now";
  EXPECT_EQ(load_database(folder_ / "db.reprise").clips().size(), 2U);
}

TEST_F(Import, FailureKeepsTheOlderDatabaseAndLeavesNothingElse) {
  import_sequences(folder_ / "db.reprise", options_);
  std::filesystem::resize_file(folder_ / "frames" / "walk_00007.ply", 100);
  EXPECT_THAT([&] { import_sequences(folder_ / "db.reprise", options_); },
              ThrowsMessage<FileError>(HasSubstr("walk_00007.ply")));
  EXPECT_EQ(load_database(folder_ / "db.reprise").frame_count(), 12U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2)
      << "frames and db.reprise";
}

TEST_F(Import, StopsOnRequestWithoutLeavingAnything) {
  set_interrupted(true);
  EXPECT_THROW(import_sequences(folder_ / "db.reprise", options_), Cancelled);
  set_interrupted(false);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "frames";
}

TEST_F(Import, SequencesOfOtherSurfacesAreNamedWithTheirFirstDifference) {
  MeshSequence ball("ball", test::sphere(2).topology, 3, 25.0);
  for (std::size_t f = 0; f < 3; ++f) ball.frame(f) = test::sphere(2).positions;
  write_sequence(ball, folder_ / "ball", SequenceFormat::obj);
  options_.sequences.push_back({.name = "ball", .source = {.path = folder_ / "ball"}});
  EXPECT_THAT([&] { import_sequences(folder_ / "db.reprise", options_); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("258 vertices"), HasSubstr("66"))));
}

// Info and validate

TEST_F(Import, InfoDescribesWhatWasImported) {
  import_sequences(folder_ / "db.reprise", options_);
  const nlohmann::json info = describe_database(folder_ / "db.reprise");
  EXPECT_EQ(info["vertices"], 258);
  EXPECT_EQ(info["clips"][0]["name"], "walk");
  EXPECT_EQ(info["clips"][0]["frames"], 12);
}

TEST_F(Import, ValidateFindsAllBadFramesAndNotOnlyTheFirst) {
  EXPECT_TRUE(validate_path(folder_ / "frames").ok());
  std::filesystem::resize_file(folder_ / "frames" / "walk_00007.ply", 100);
  std::filesystem::resize_file(folder_ / "frames" / "walk_00009.ply", 200);
  const ValidationReport report = validate_path(folder_ / "frames");
  EXPECT_FALSE(report.ok());
  ASSERT_EQ(report.findings.size(), 2U);
  EXPECT_THAT(report.findings[0].where, HasSubstr("walk_00007.ply"));
  EXPECT_THAT(report.findings[1].where, HasSubstr("walk_00009.ply"));
}

TEST(Validate, WarnsOfOpenSurfacesAndJumps) {
  const test::TemporaryFolder folder;
  const test::Shape sheet = test::sheet(4);
  MeshSequence clip("sheet", sheet.topology, 3, 25.0);
  for (std::size_t f = 0; f < 3; ++f) clip.frame(f) = sheet.positions;
  clip.frame(2).col(1).array() += 5.0F;
  PerformanceDatabase database;
  database.add(clip);
  save_database(database, folder / "sheet.reprise");
  const ValidationReport report = validate_path(folder / "sheet.reprise");
  EXPECT_TRUE(report.ok());
  ASSERT_EQ(report.findings.size(), 2U);
  EXPECT_THAT(report.findings[0].what, HasSubstr("16 boundary edges"));
  EXPECT_EQ(report.findings[1].where, "sheet:2");
}

// Graph, key-frames

class WholeWay : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  PerformanceDatabase database_ = walking_database();
  SimilarityResult similarity_ = compute_similarity(database_, folder_ / "db", {.use_cache = false});
  SurfaceMotionGraph graph_ = make_graph(database_, similarity_, {}, std::nullopt);
};

TEST_F(WholeWay, QueryBecomesTheAnimationTheReportDescribes) {
  const KeyframesOptions options{.keyframes = {"slow:3", "fast:50"}, .distance = 6.0, .time = 5.0};
  const auto result = run_keyframes(database_, graph_, options);
  ASSERT_TRUE(result.has_value());
  const nlohmann::json& report = result->report;
  EXPECT_EQ(report["frames"].size(), result->animation.frame_count());
  EXPECT_EQ(report["frames"].front()["clip"], "slow");
  EXPECT_EQ(report["frames"].front()["frame"], 3);
  EXPECT_EQ(report["frames"].back()["clip"], "fast");
  EXPECT_EQ(report["frames"].back()["frame"], 50);
  EXPECT_EQ(report["gap"], 0.0);
  const double travelled =
      ground_distance(ground_trajectory(result->animation), 0, result->animation.frame_count() - 1);
  EXPECT_NEAR(report["distance"].get<double>(), travelled, 1e-4);
  EXPECT_NEAR(report["cost"].get<double>(),
              report["costs"]["transitions"].get<double>() + std::abs(result->path.distance - 6.0) / 0.3 +
                  std::abs(result->path.frame_count - 5.0 * 25.0) / 10.0,
              1e-9);
  EXPECT_LT(evaluate_naturalness(result->animation, database_).pop_ratio, 2.0);
}

TEST_F(WholeWay, UnreachableKeyframeIsAnOutcomeWithAReason) {
  const SurfaceMotionGraph cut = make_graph(database_, similarity_, {.remove = {"slow->fast"}}, std::nullopt);
  const auto result =
      run_keyframes(database_, cut, {.keyframes = {"slow:3", "fast:50"}, .distance = 1, .time = 1});
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().reason, AllOf(HasSubstr("slow"), HasSubstr("fast:50")));
}

TEST_F(WholeWay, GraphOfAnotherDatabaseIsRefused) {
  PerformanceDatabase other;
  other.add(test::walk("slow", 70, 0.031, 20.0));
  other.add(test::walk("fast", 60, 0.06, 20.0, 7.0));
  EXPECT_THROW((void)run_keyframes(other, graph_, {.keyframes = {"slow:3", "fast:50"}}), InvalidArgument);
}

// Open, render

TEST(OpenClip, AsksForANameAmongSeveralAndOffersTheNearest) {
  const test::TemporaryFolder folder;
  save_database(walking_database(), folder / "db.reprise");
  EXPECT_EQ(open_clip(folder / "db.reprise", "fast").frame_count(), 60U);
  EXPECT_THAT([&] { open_clip(folder / "db.reprise", ""); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("--clip"), HasSubstr("slow, fast"))));
  EXPECT_THAT([&] { open_clip(folder / "db.reprise", "fats"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'fast'?")));
}

TEST(RenderStage, ParsesSizesRangesAndCameras) {
  RenderOptions view;
  parse_size("640x360", view);
  EXPECT_EQ(view.width, 640);
  EXPECT_EQ(view.height, 360);
  for (const char* bad : {"640", "640x", "x360", "0x10", "640x360x2", "-1x2", "99999x2"}) {
    EXPECT_THROW(parse_size(bad, view), InvalidArgument) << bad;
  }
  EXPECT_EQ(parse_frame_range("3:9:2").step, 2U);
  for (const char* bad : {"3", "9:3", "1:2:0", "a:b", "1:2:3:4"}) {
    EXPECT_THROW(parse_frame_range(bad), InvalidArgument) << bad;
  }
  EXPECT_EQ(parse_camera("orbit"), CameraMode::orbit);
  EXPECT_THROW(parse_camera("top"), InvalidArgument);
  EXPECT_EQ(parse_appearance("colors"), Appearance::vertex_colors);
  EXPECT_THROW(parse_appearance("shiny"), InvalidArgument);
  parse_look_at("-0.25,0.93", view);
  EXPECT_EQ(view.look_at, (std::array<double, 2>{-0.25, 0.93}));
  for (const char* bad : {"", "1", "1,", ",1", "1,2,3", "a,b", "1;2"}) {
    EXPECT_THROW(parse_look_at(bad, view), InvalidArgument) << bad;
  }
}

TEST(RenderStage, WritesTheFramesAskedForAndKeepsForeignFolders) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 10);
  RenderStageOptions options{.frames = FrameRange{.first = 2, .last = 8, .step = 3}};
  options.view.width = 64;
  options.view.height = 48;
  EXPECT_EQ(render_sequence(clip, folder / "pictures", options).frames, 3U);
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures" / "00005.png"));
  EXPECT_EQ(render_sequence(clip, folder / "pictures", options).frames, 3U)
      << "an earlier rendering is replaced";
  std::ofstream(folder / "pictures" / "thesis.txt") << "mine";
  EXPECT_THAT([&] { render_sequence(clip, folder / "pictures", options); },
              ThrowsMessage<FileError>(HasSubstr("thesis.txt")));
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures" / "thesis.txt"));
  std::filesystem::create_directory(folder / "photos");
  std::ofstream(folder / "photos" / "00000.png") << "not ours";
  EXPECT_THROW(render_sequence(clip, folder / "photos", options), FileError);
  EXPECT_TRUE(std::filesystem::exists(folder / "photos" / "00000.png"));
  EXPECT_THROW(render_sequence(clip, folder / "film.avi", options), InvalidArgument);
  options.frames->last = 10;
  EXPECT_THROW(render_sequence(clip, folder / "strip.png", options), InvalidArgument);
}

}  // namespace
}  // namespace reprise
