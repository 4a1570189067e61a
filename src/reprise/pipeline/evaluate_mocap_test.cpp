// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_mocap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/mocap_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class EvaluateMocap : public testing::Test {
 protected:
  EvaluateMocap() {
    save_database(test::driven_figure(), folder_ / "figure.reprise");
    save_graph(test::driven_figure_graph(), folder_ / "graph.json");
    fs::create_directory(folder_ / "bvh");
    test::write_true_motion("stop", folder_ / "bvh" / "stop.bvh");
    test::write_true_motion("jog", folder_ / "bvh" / "jog.bvh");
    write_text_file(folder_ / "bvh" / "bad.bvh", "HIERARCHY\n");
    write_text_file(folder_ / "index.csv",
                    "trial,class,description,tier\nstop,walk,\"walk, then stop\",core\njog,run,jog,core\n"
                    "bad,run,nothing,broken\n");
    options_.corpus = folder_ / "index.csv";
    options_.mocap.graph = folder_ / "graph.json";
  }

  std::vector<MocapTrial> run(const fs::path& folder) const {
    return evaluate_mocap(folder_ / "figure.reprise", folder, options_);
  }

  const test::TemporaryFolder folder_;
  MocapEvaluationOptions options_;
};

TEST_F(EvaluateMocap, TablesPicturesAndFailures) {
  const auto trials = run(folder_ / "out");
  ASSERT_EQ(trials.size(), 3U);
  EXPECT_EQ(trials[0].failure, "");
  EXPECT_THAT(trials[2].failure, HasSubstr("bad.bvh"));
  for (const char* file : {"mocap.md", "mocap.csv", "times.csv", "walks.png", "runs.png"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  }
  EXPECT_FALSE(fs::exists(folder_ / "out" / "truth.csv"));
  const std::string text = read_text_file(folder_ / "out" / "mocap.md");
  EXPECT_THAT(text, HasSubstr("| walks | 1 of 1 |"));
  EXPECT_THAT(text, HasSubstr("| runs | 1 of 2 |"));
  EXPECT_THAT(text, HasSubstr("## Failures\n\n- bad: "));
  const std::string csv = read_text_file(folder_ / "out" / "mocap.csv");
  EXPECT_THAT(csv, HasSubstr("\"walk, then stop\""));
  // As many fields in every row; the commas inside of quotes are one of the description, and none elsewhere.
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  const auto columns = std::ranges::count(line, ',');
  std::getline(lines, line);
  EXPECT_EQ(std::ranges::count(line, ','), columns + 1);
  std::getline(lines, line);
  EXPECT_EQ(std::ranges::count(line, ','), columns);
}

TEST_F(EvaluateMocap, SecondRunWritesTheSame) {
  options_.trials = {"stop"};
  run(folder_ / "a");
  run(folder_ / "b");
  EXPECT_EQ(read_text_file(folder_ / "a" / "mocap.csv"), read_text_file(folder_ / "b" / "mocap.csv"));
  EXPECT_EQ(read_text_file(folder_ / "a" / "walks.png"), read_text_file(folder_ / "b" / "walks.png"));
}

TEST_F(EvaluateMocap, DatabaseItselfAsTruthIsMetAndAHeldClipIsNot) {
  options_.trials = {"stop"};
  PerformanceDatabase truth;
  truth.add(test::driven_figure().clip(test::driven_figure().clip_idx("stop")));
  save_database(truth, folder_ / "truth.reprise");
  options_.truth = {folder_ / "truth.reprise"};
  const auto met = run(folder_ / "met");
  ASSERT_EQ(met[0].truth.size(), truth_methods().size());
  // The very frames are retrieved.
  EXPECT_LT(met[0].truth[1].aligned_mean, 0.002);
  EXPECT_TRUE(fs::exists(folder_ / "met" / "truth.png"));

  options_.truth.clear();
  options_.held = {{"stop", "stop"}};
  options_.mocap.mocap.retrieval.threshold = 10.0;
  const auto held = run(folder_ / "held");
  ASSERT_EQ(held[0].failure, "");
  EXPECT_EQ(held[0].held_clip, "stop");
  EXPECT_GT(held[0].truth[1].aligned_mean, met[0].truth[1].aligned_mean);
  // Driven, it comes nearer than retrieved alone.
  EXPECT_LT(held[0].truth.back().aligned_mean, held[0].truth.front().aligned_mean);
}

TEST_F(EvaluateMocap, ExchangeKeepsEveryBit) {
  MocapTrial trial{.trial = "x", .failure = "why", .notes = {"a", "b"}, .frames = 7, .scale = 1.0 / 3.0};
  trial.deformation.velocity.mean = 0.1;
  trial.truth.push_back({.method = "part", .mean = 2.0 / 7.0});
  const MocapTrial back = from_exchange(nlohmann::json::parse(to_exchange(trial).dump()));
  EXPECT_EQ(to_exchange(back), to_exchange(trial));
  EXPECT_EQ(back.scale, trial.scale);
  EXPECT_EQ(back.truth[0].mean, trial.truth[0].mean);
}

TEST_F(EvaluateMocap, WhatIsWrongIsSaidBeforeTheWork) {
  const auto refused = [&](const char* text) {
    EXPECT_THAT([&] { run(folder_ / "out"); }, ThrowsMessage<Error>(HasSubstr(text)));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  const MocapEvaluationOptions good = options_;
  options_.tiers = {"cor"};
  refused("did you mean 'core'?");
  options_ = good;
  options_.held = {{"stop", "stob"}};
  refused("'stop'");
  options_.held = {{"stob", "stop"}};
  refused("did you mean 'stop'?");
  options_ = good;
  options_.corpus = folder_ / "nowhere.csv";
  refused("nowhere.csv");
  options_ = good;
  save_database(make_figure({.voxel_size = 0.09}), folder_ / "other.reprise");
  options_.truth = {folder_ / "other.reprise"};
  refused("is no truth of this database");
}

TEST_F(EvaluateMocap, HeldClipsAsAFile) {
  write_text_file(folder_ / "held.json", R"({"walk": "07_01", "run": "16_35"})");
  EXPECT_EQ(read_held_clips(folder_ / "held.json"),
            (std::map<std::string, std::string>{{"07_01", "walk"}, {"16_35", "run"}}));
  for (const char* bad : {"{}", "[1]", R"({"a": 1})", R"({"a": "x", "b": "x"})"}) {
    write_text_file(folder_ / "held.json", bad);
    EXPECT_THROW(read_held_clips(folder_ / "held.json"), FileError) << bad;
  }
}

}  // namespace
}  // namespace reprise
