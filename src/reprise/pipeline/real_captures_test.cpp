// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The whole way on real captures, held to what the project promises of them.

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reprise/io/database_file.h"
#include "reprise/pipeline/import.h"
#include "support/promises.h"
#include "support/test_data.h"

namespace reprise {
namespace {

PerformanceDatabase import_all(const std::vector<std::string>& sequences) {
  const test::TemporaryFolder folder;
  ImportOptions options;
  for (const std::string& text : sequences) options.sequences.push_back(parse_import_sequence(text));
  import_sequences(folder / "db.reprise", options);
  return load_database(folder / "db.reprise");
}

PerformanceDatabase import_ama() {
  const std::string ama = (test::data_folder() / "ama").string();
  return import_all({"crane=" + ama + "/crane", "jumping=" + ama + "/jumping"});
}

PerformanceDatabase import_fashion() {
  const std::string fashion = (test::data_folder() / "fashion").string();
  std::vector<std::string> sequences;
  for (const char* name : {"walk", "stride", "slowwalk", "walk_stop", "run", "run_fast", "run_stop",
                           "veer_left", "turn_around"}) {
    sequences.push_back(fmt::format("{0}={1}/{0}.pc2,topology={1}/topology.ply", name, fashion));
  }
  return import_all(sequences);
}

TEST(RealCaptures, CraneToJumpingKeepsItsPromises) {
  REPRISE_REQUIRE_DATA();
  const PerformanceDatabase database = import_ama();
  const SurfaceMotionGraph graph = test::graph_of(database);
  const auto result = run_keyframes(
      database, graph, {.keyframes = {"crane:20", "jumping:140"}, .distance = 6.0, .time = 10.0});
  ASSERT_TRUE(result.has_value());
  test::expect_kept_promises(*result, database);
  const auto detour =
      run_keyframes(database, graph,
                    {.keyframes = {"jumping:30", "crane:90", "jumping:140"}, .distance = 12.0, .time = 25.0});
  ASSERT_TRUE(detour.has_value());
  test::expect_kept_promises(*detour, database);
}

TEST(RealCaptures, WalkRunStopIsMetWithinAStepAndKeepsItsColours) {
  REPRISE_REQUIRE_DATA();
  const PerformanceDatabase database = import_fashion();
  const auto result =
      run_keyframes(database, test::graph_of(database),
                    {.keyframes = {"walk:5", "run:17", "run_stop:54"}, .distance = 12.0, .time = 8.0});
  ASSERT_TRUE(result.has_value());
  test::expect_kept_promises(*result, database);
  EXPECT_NEAR(result->path.distance, 12.0, 0.3);
  EXPECT_NEAR(result->path.time, 8.0, 0.4);
  ASSERT_TRUE(result->animation.has_colors());
  EXPECT_FALSE(result->animation.has_colors_per_frame());
  EXPECT_TRUE(std::ranges::equal(result->animation.colors(0), database.clip(0).colors(0)));
}

TEST(RealCaptures, HorseLoopsThoughItIsOpenAndNotHuman) {
  REPRISE_REQUIRE_DATA();
  const PerformanceDatabase database =
      import_all({"gallop=" + (test::data_folder() / "horse_gallop").string()});
  const auto result = run_keyframes(database, test::graph_of(database),
                                    {.keyframes = {"gallop:20", "gallop:20"}, .distance = 3.0, .time = 4.0});
  ASSERT_TRUE(result.has_value());
  test::expect_kept_promises(*result, database);
  EXPECT_GT(result->animation.frame_count(), database.frame_count()) << "the loop is played more than once";
}

}  // namespace
}  // namespace reprise
