// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Queries on parts of real surface motion graphs: the optimiser, GLPK on the tests' own integer program, and
// GLPK on the program that is written for the user agree.

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/core/parallel.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/path/program_case_test_support.h"
#include "reprise/path/program_writer.h"
#include "reprise/path/real_graph_test_support.h"
#include "support/keyframe_program.h"

namespace reprise {
namespace {

using test::Case;
using test::figure_graph;
using test::RealGraph;

// The three optima of a query.
void expect_agreement(const Case& query_case) {
  const auto path = query_case.solve();
  ASSERT_TRUE(path.has_value()) << path.error().reason;
  test::expect_valid(query_case, *path);
  EXPECT_EQ(path->gap(), 0.0);
  const PathMetrics metrics = query_case.metrics();
  test::KeyframeProgram program(metrics, query_case.query, query_case.options, path->cost);
  EXPECT_NEAR(program.solve(), path->cost, 1e-6);
  const auto solution = test::solve_lp_text(
      write_keyframe_program(metrics, query_case.query, query_case.options, query_case.names(), path->cost));
  ASSERT_TRUE(solution.has_value());
  EXPECT_NEAR(solution->cost, path->cost, 1e-6);
  const test::DecodedPath decoded(query_case, *solution);
  const test::Replay played = test::replay(query_case, decoded.path());
  EXPECT_TRUE(test::shows_in_order(played.pure_frames, query_case.query.keyframes));
  EXPECT_NEAR(test::cost_of(query_case, played.transition_cost, played.distance, played.frame_count),
              path->cost, 1e-6);
}

TEST(RealGraph, OptimaAgreeOnPartsOfTheFiguresGraph) {
  struct Part {
    std::vector<std::string> clips;
    std::vector<std::string> keyframes;
  };
  const std::vector<Part> parts{{{"walk", "jog"}, {"walk:3", "jog:51"}},
                                {{"stand", "start", "walk"}, {"stand:5", "walk:40"}},
                                {{"walk", "walk_jog", "jog"}, {"walk:10", "jog:20", "walk:30"}},
                                {{"start", "stop", "wave"}, {"wave:4", "stop:40"}}};
  std::mt19937 random(1);
  for (const Part& part : parts) {
    for (const auto& [distance, time] : {std::pair(2.0, 2.0), std::pair(4.0, 3.0), std::pair(0.0, 0.0)}) {
      SCOPED_TRACE(part.keyframes.front() + " to " + part.keyframes.back());
      Case query_case = figure_graph().sub_graph(part.clips, 2, part.keyframes);
      query_case.query.distance = distance;
      query_case.query.time = time;
      query_case.options.distance_weight = std::uniform_real_distribution<double>(1.0, 5.0)(random);
      expect_agreement(query_case);
    }
  }
}

TEST(RealGraph, OptimaAgreeWithinLimits) {
  Case query_case = figure_graph().sub_graph({"stand", "start", "walk", "stop"}, 2, {"stand:5", "stop:50"});
  query_case.query.distance = 3.0;
  query_case.query.time = 4.0;
  const auto free = query_case.solve();
  ASSERT_TRUE(free.has_value());
  {
    Case limited = query_case;
    limited.query.min_distance = free->distance + 0.2;
    expect_agreement(limited);
  }
  {
    Case limited = query_case;
    limited.query.max_time = free->time - 0.1;
    expect_agreement(limited);
  }
  for (std::size_t clip_idx = 1; clip_idx < 3; ++clip_idx) {
    Case limited = query_case;
    limited.query.compulsory_clips = {clip_idx};
    expect_agreement(limited);
    limited.query.compulsory_clips.clear();
    limited.query.forbidden_clips = {clip_idx};
    expect_agreement(limited);
  }
}

// Two captured clips.
TEST(RealGraph, OptimaAgreeOnCapturedClips) {
  REPRISE_REQUIRE_DATA();
  PerformanceDatabase database;
  for (const std::string name : {"crane", "jumping"}) {
    const auto reader = open_sequence({.path = test::data_folder() / "ama" / name});
    MeshSequence clip(name, reader->topology(), reader->frame_count(), test::fps);
    parallel_for(0, reader->frame_count(),
                 [&](std::size_t frame_idx) { clip.frame(frame_idx) = reader->read(frame_idx).positions; });
    database.add(std::move(clip));
  }
  const RealGraph graph(std::move(database), 4);
  for (const auto& [distance, time] : {std::pair(2.0, 5.0), std::pair(4.0, 9.0)}) {
    Case query_case = graph.sub_graph({"crane", "jumping"}, 4, {"crane:20", "jumping:140"});
    query_case.query.distance = distance;
    query_case.query.time = time;
    expect_agreement(query_case);
  }
}

}  // namespace
}  // namespace reprise
