// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_similarity.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/io/image_file.h"
#include "reprise/pipeline/evaluation_looks.h"
#include "reprise/similarity/performance_truth.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two short clips of the capsule figure, with markup and truth.
const PerformanceDatabase& figure() {
  static const PerformanceDatabase database = [] {
    const PerformanceDatabase all = make_figure({.frames_per_second = 12.0, .voxel_size = 0.06});
    PerformanceDatabase two;
    for (const char* name : {"walk", "walk_jog"}) two.add(all.clip(all.clip_idx(name)));
    two.set_markup(all.markup());
    for (std::size_t c = 0; c < 2; ++c) two.set_truth(c, *all.truth(all.clip_idx(two.clip(c).name())));
    return two;
  }();
  return database;
}

PerformanceDatabase walking_shapes() {
  PerformanceDatabase database;
  database.add(test::walk("slow", 40, 0.03, 20.0));
  database.add(test::walk("fast", 36, 0.06, 20.0, 7.0));
  return database;
}

// Few bins: here it matters what is done with the metrics, not how fine they are.
HistogramOptions coarse() {
  return {.radius_bins = 3,
          .polar_bins = 5,
          .azimuth_bins = 8,
          .color_bins = {3, 3, 3},
          .azimuth_refinement = 2,
          .voxel_size = 0.06};
}

SimilarityEvaluationOptions quick(const std::vector<std::string>& metrics) {
  SimilarityEvaluationOptions options{.metrics = metrics, .query_gap = 3, .pictured_transitions = 2};
  options.similarity.use_cache = false;
  options.similarity.histogram = coarse();
  options.similarity.transitions.transitions_per_pair = 2;
  return options;
}

// As the default options of the evaluation judge.
FrameJudge by_pose_and_shape(const PerformanceDatabase& database) {
  return [truth = performance_truth(database), frames = database.clip(0).frame_count()](
             std::size_t a, std::size_t b) -> std::optional<bool> {
    const bool same_clip = (a < frames) == (b < frames);
    if (same_clip && std::max(a, b) - std::min(a, b) < 3) return std::nullopt;
    return truth.pose_and_shape.value(a, b) < 0.05;
  };
}

TEST(PerformanceTruth, IsZeroForEqualFramesAndHoldsItsParts) {
  const PerformanceDatabase& database = figure();
  const PerformanceTruth truth = performance_truth(database);
  EXPECT_TRUE(has_truth(database));
  for (std::size_t a = 0; a < database.frame_count(); a += 5) {
    for (std::size_t b = a + 1; b < database.frame_count(); b += 3) {
      const double whole = truth.pose_and_shape.value(a, b);
      const double pose = truth.pose.value(a, b);
      EXPECT_GE(whole, pose / std::sqrt(2.0) - 1e-6) << "the joints are half of it";
      EXPECT_EQ(truth.clothing.value(a, b) > 0.0F, truth.free_vertices > 0);
    }
  }
}

// The same poses elsewhere on the ground: nothing truly differs.
TEST(PerformanceTruth, DoesNotSeeWhereAClipStands) {
  const PerformanceDatabase& database = figure();
  const GroundTransform moved{.yaw = 2.0, .translation = {4.0, -1.0}};
  PerformanceDatabase twice;
  twice.add(database.clip(0));
  twice.add(test::moved(database.clip(0), moved, "moved"));
  Markup markup = *database.markup();
  // Some of the surface is declared to hang free.
  for (std::size_t v = 0; v < markup.joint_of_vertex.size(); v += 7) markup.joint_of_vertex[v] = -1;
  twice.set_markup(markup);
  ClipTruth truth = *database.truth(0);
  twice.set_truth(0, truth);
  const Eigen::Quaterniond turn(moved.rotation());
  for (SkeletonPose& pose : truth.poses) {
    for (Eigen::Vector3d& position : pose.position) position = moved * position;
    for (Eigen::Quaterniond& rotation : pose.rotation) rotation = turn * rotation;
  }
  twice.set_truth(1, truth);
  const PerformanceTruth found = performance_truth(twice);
  const std::size_t frames = database.clip(0).frame_count();
  EXPECT_GT(found.free_vertices, 10U);
  for (std::size_t f = 0; f < frames; ++f) {
    EXPECT_LT(found.pose_and_shape.value(f, frames + f), 1e-5);
    EXPECT_LT(found.pose.value(f, frames + f), 1e-5);
    EXPECT_LT(found.clothing.value(f, frames + f), 1e-5);
  }
  EXPECT_GT(found.clothing.value(0, frames / 2), 1e-4);
}

TEST(PerformanceTruth, NamesTheClipWithout) {
  EXPECT_FALSE(has_truth(walking_shapes()));
  EXPECT_THAT([] { performance_truth(walking_shapes()); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'slow'"), HasSubstr("truth"))));
}

TEST(EvaluateSimilarity, WritesEverythingForTheFigure) {
  const test::TemporaryFolder folder;
  const fs::path target = folder / "new" / "deeper";
  const SimilarityEvaluation evaluation =
      evaluate_similarity(figure(), folder / "figure.reprise", target, quick({}));
  ASSERT_EQ(evaluation.metrics.size(), 4U);
  EXPECT_TRUE(evaluation.has_truth);
  for (const MetricEvaluation& m : evaluation.metrics) {
    EXPECT_FALSE(m.transitions.empty()) << m.metric;
    EXPECT_EQ(m.changes.size(), m.transitions.size()) << m.metric;
    EXPECT_GT(m.pose_and_shape.queries, 10U) << m.metric;
    EXPECT_GT(m.pose_and_shape.average_precision, 0.6) << m.metric;
    EXPECT_GT(m.pose_and_shape.average_precision, m.pose_and_shape.chance + 0.2) << m.metric;
    EXPECT_GT(m.looks.average_precision, m.looks.chance + 0.1) << m.metric;
    EXPECT_GT(read_image(target / ("transitions-" + m.metric + ".png")).width, 300);
  }
  EXPECT_GT(read_image(target / "metrics.png").width, 1000);
  EXPECT_GT(read_image(target / "retrieval.png").width, 500);
  const auto json = nlohmann::json::parse(read_text_file(target / "similarity.json"));
  ASSERT_EQ(json["metrics"].size(), 4U);
  EXPECT_EQ(json["metrics"][0]["pose_and_shape"]["precision"].size(), recall_level_count);
  const std::string csv = read_text_file(target / "similarity.csv");
  const auto count = [](const std::string& text, char c) { return std::count(text.begin(), text.end(), c); };
  EXPECT_EQ(count(csv, '\n'), 5);
  EXPECT_EQ(count(csv, ',') % 5, 0) << "every row has as many fields as the head";
  const std::string table = read_text_file(target / "similarity.md");
  for (const std::string& metric : similarity_metrics()) EXPECT_THAT(table, HasSubstr("| " + metric + " |"));
}

// The vertex metric ranks by what the first part of the truth is made of: with the skeleton's the same, it
// must be all but perfect, and it must stay so from one run to the next.
TEST(EvaluateSimilarity, TheVertexMetricFindsTheTruthOfACleanPerformance) {
  const test::TemporaryFolder folder;
  const auto run = [&] {
    return evaluate_similarity(figure(), folder / "figure.reprise", folder / "out", quick({"vertex"}));
  };
  const SimilarityEvaluation first = run();
  EXPECT_GT(first.metrics.at(0).pose_and_shape.average_precision, 0.95);
  const std::string csv = read_text_file(folder / "out" / "similarity.csv");
  const SimilarityEvaluation second = run();
  EXPECT_EQ(first.metrics[0].pose_and_shape.average_precision,
            second.metrics[0].pose_and_shape.average_precision);
  EXPECT_EQ(first.metrics[0].looks.average_precision, second.metrics[0].looks.average_precision);
  EXPECT_EQ(first.metrics[0].appearance.color, second.metrics[0].appearance.color);
}

TEST(EvaluateSimilarity, WithoutTruthTheRestIsStillMade) {
  const test::TemporaryFolder folder;
  const SimilarityEvaluation evaluation =
      evaluate_similarity(walking_shapes(), folder / "walks.reprise", folder / "out", quick({"vertex"}));
  EXPECT_FALSE(evaluation.has_truth);
  EXPECT_EQ(evaluation.metrics.at(0).pose_and_shape.queries, 0U);
  EXPECT_TRUE(fs::exists(folder / "out" / "metrics.png"));
  EXPECT_TRUE(fs::exists(folder / "out" / "transitions-vertex.png"));
  EXPECT_THAT(read_text_file(folder / "out" / "similarity.md"), HasSubstr("carries no truth"));
  const auto json = nlohmann::json::parse(read_text_file(folder / "out" / "similarity.json"));
  EXPECT_TRUE(json["metrics"][0]["pose_and_shape"].is_null());
}

TEST(EvaluateSimilarity, RanksANoisyCaptureByTheCleanTruth) {
  const test::TemporaryFolder folder;
  PerformanceDatabase noisy;
  for (MeshSequence clip : figure().clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      // Ripples of 2 cm that run over the surface.
      for (Eigen::Index v = 0; v < clip.frame(f).rows(); ++v)
        clip.frame(f)(v, 0) += 0.02F * std::sin(3.0F * static_cast<float>(f) + 40.0F * clip.frame(f)(v, 1));
    }
    noisy.add(std::move(clip));
  }
  save_database(figure(), folder / "clean.reprise");
  SimilarityEvaluationOptions options = quick({"vertex"});
  options.truth = folder / "clean.reprise";
  const SimilarityEvaluation evaluation =
      evaluate_similarity(noisy, folder / "noisy.reprise", folder / "out", options);
  EXPECT_TRUE(evaluation.has_truth);
  EXPECT_LT(evaluation.metrics.at(0).pose_and_shape.average_precision,
            retrieval_quality(vertex_dissimilarity(figure()), by_pose_and_shape(figure())).average_precision);
  EXPECT_GT(evaluation.metrics.at(0).pose_and_shape.average_precision, 0.5);
}

TEST(EvaluateSimilarity, SaysWhatIsWrong) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase walks = walking_shapes();
  const auto run = [&](const SimilarityEvaluationOptions& options, const fs::path& target) {
    evaluate_similarity(walks, folder / "walks.reprise", target, options);
  };
  const auto with = [](auto change) {
    SimilarityEvaluationOptions options = quick({"vertex"});
    change(options);
    return options;
  };
  using Options = SimilarityEvaluationOptions;
  EXPECT_THAT([&] { run(quick({"vertax"}), folder / "a"); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'vertax'"), HasSubstr("'vertex'"))));
  EXPECT_THAT([&] { run(with([](Options& o) { o.pairs = {"slow"}; }), folder / "b"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("SOURCE:TARGET")));
  EXPECT_THAT([&] { run(with([](Options& o) { o.pairs = {"slow:fest"}; }), folder / "b"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("fast")));
  EXPECT_FALSE(fs::exists(folder / "b")) << "nothing is begun with wrong options";
  EXPECT_THROW(run(with([](Options& o) { o.alike = 0.0; }), folder / "b"), InvalidArgument);
  EXPECT_THROW(run(with([](Options& o) { o.looks_alike = NAN; }), folder / "b"), InvalidArgument);
  EXPECT_THROW(run(with([](Options& o) { o.query_gap = 0; }), folder / "b"), InvalidArgument);
  EXPECT_THROW(run(with([](Options& o) { o.pictured_transitions = 0; }), folder / "b"), InvalidArgument);
  EXPECT_THROW(run(with([](Options& o) { o.filter_half_window = 0; }), folder / "b"), InvalidArgument);

  save_database(figure(), folder / "figure.reprise");
  EXPECT_THAT([&] { run(with([&](Options& o) { o.truth = folder / "figure.reprise"; }), folder / "c"); },
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("slow (40)"), HasSubstr("walk_jog"))));
  save_database(walks, folder / "same.reprise");
  EXPECT_THAT([&] { run(with([&](Options& o) { o.truth = folder / "same.reprise"; }), folder / "c"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("carries no truth")));
  EXPECT_THROW(run(with([&](Options& o) { o.truth = folder / "none.reprise"; }), folder / "c"), FileError);

  write_text_file(folder / "file", "in the way");
  EXPECT_THROW(run(quick({"vertex"}), folder / "file"), FileError);
  EXPECT_THROW(run(quick({"vertex"}), folder / "file" / "below"), FileError);
  EXPECT_EQ(read_text_file(folder / "file"), "in the way");
  EXPECT_THROW(evaluate_similarity({}, folder / "x.reprise", folder / "d", {}), InvalidArgument);
}

TEST(PicturedTransitions, AreTheCheapestOfThePairsAskedFor) {
  const PerformanceDatabase walks = walking_shapes();
  const std::vector<Transition> found = {{.source_clip = 0, .target_clip = 0, .m = 1, .cost = 0.1},
                                         {.source_clip = 0, .target_clip = 1, .m = 2, .cost = 0.4},
                                         {.source_clip = 0, .target_clip = 1, .m = 3, .cost = 0.2},
                                         {.source_clip = 1, .target_clip = 0, .m = 4, .cost = 0.3}};
  const auto frames = [&](const std::vector<std::string>& pairs, std::size_t count) {
    std::vector<int> m;
    for (const Transition& t : pictured_transitions(walks, found, pairs, count)) m.push_back(t.m);
    return m;
  };
  EXPECT_EQ(frames({}, 8), std::vector<int>({3})) << "one between every two clips";
  EXPECT_EQ(frames({"slow:fast"}, 8), std::vector<int>({3, 2}));
  EXPECT_EQ(frames({"slow:fast", "fast:slow"}, 2), std::vector<int>({3, 4}));
  EXPECT_EQ(frames({"slow:slow"}, 8), std::vector<int>({1}));
  EXPECT_EQ(frames({"fast:fast"}, 8), std::vector<int>());
}

// What colour is for: a clip and a copy of it in other colours are the same shape.
TEST(SimilarityOfRecoloredClips, IsFarByShapeAndColorAndZeroByShape) {
  const test::TemporaryFolder folder;
  PerformanceDatabase database;
  const MeshSequence& whole = figure().clip(0);
  MeshSequence walk("walk", whole.topology(), 8, 12.0);
  for (std::size_t f = 0; f < 8; ++f) walk.frame(f) = whole.frame(2 * f);
  walk.set_colors({whole.colors(0).begin(), whole.colors(0).end()});
  database.add(walk);
  MeshSequence copy = walk;
  copy.set_name("recoloured");
  std::vector<Color> colors;
  for (const Color& c : walk.colors(0))
    colors.push_back({static_cast<std::uint8_t>(255 - c[0]), static_cast<std::uint8_t>(255 - c[1]),
                      static_cast<std::uint8_t>(255 - c[2])});
  copy.set_colors(colors);
  database.add(std::move(copy));
  const auto matrix = [&](const char* metric) {
    return compute_similarity(database, folder / "two.reprise",
                              {.metric = metric, .histogram = coarse(), .exact = true, .use_cache = false})
        .matrix;
  };
  const DissimilarityMatrix by_shape = matrix("shape");
  const DissimilarityMatrix by_both = matrix("shape-colour");
  const std::size_t frames = walk.frame_count();
  float farthest_pose = 0.0F;
  for (std::size_t a = 0; a < frames; ++a) {
    for (std::size_t b = a + 1; b < frames; ++b) farthest_pose = std::max(farthest_pose, by_both.value(a, b));
  }
  for (std::size_t f = 0; f < frames; ++f) {
    EXPECT_EQ(by_shape.value(f, frames + f), 0.0F);
    EXPECT_GT(by_both.value(f, frames + f), farthest_pose) << "farther than any two poses of the walk";
  }
}

}  // namespace
}  // namespace reprise
