// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_deformation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/io/image_file.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const PerformanceDatabase& all_clips() {
  static const PerformanceDatabase database = make_figure({.frames_per_second = 12.0, .voxel_size = 0.06});
  return database;
}

PerformanceDatabase figure(const std::vector<std::string>& clips) {
  PerformanceDatabase some;
  for (const std::string& name : clips) some.add(all_clips().clip(all_clips().clip_idx(name)));
  some.set_markup(all_clips().markup());
  return some;
}

// A clip's frames, turned and moved, as a clip of another name.
MeshSequence moved(const MeshSequence& clip, const std::string& name) {
  MeshSequence result(name, clip.topology(), clip.frame_count(), clip.frames_per_second());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(0.2, 1.0, 0.1).normalized()).matrix();
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    result.frame(f) =
        ((clip.frame(f).cast<double>() * turn.transpose()).rowwise() + Eigen::RowVector3d(3.0, 0.5, -2.0))
            .cast<float>();
  }
  return result;
}

const DeformationFigures& figures_of(const DeformationEvaluation& evaluation, const std::string& model,
                                     DeformationSource source) {
  const auto found = std::ranges::find_if(evaluation.figures, [&](const DeformationFigures& f) {
    return f.model == model && f.source == source;
  });
  if (found == evaluation.figures.end()) throw Error("no figures of " + model);
  return *found;
}

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

TEST(DeformationTrial, VerticesAreSpreadNestedAndDistinct) {
  const Positions reference = all_clips().markup()->reference;
  const std::vector<std::int32_t> many = spread_vertices(reference, 30);
  const std::vector<std::int32_t> few = spread_vertices(reference, 8);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  EXPECT_EQ(std::set(many.begin(), many.end()).size(), 30U);
  EXPECT_EQ(reference(many[0], 1), reference.col(1).maxCoeff());
  // No vertex is farther from the chosen ones than they are from each other (Gonzalez 1985).
  const auto distance = [&](Eigen::Index a, Eigen::Index b) {
    return (reference.row(a) - reference.row(b)).norm();
  };
  float apart = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < many.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) apart = std::min(apart, distance(many[i], many[j]));
  }
  for (Eigen::Index v = 0; v < reference.rows(); ++v) {
    float nearest = std::numeric_limits<float>::infinity();
    for (const std::int32_t chosen : many) nearest = std::min(nearest, distance(v, chosen));
    EXPECT_LE(nearest, apart + 1e-6F) << v;
  }
  const Positions doubled = Positions::Ones(3, 3);
  EXPECT_EQ(spread_vertices(doubled, 3).size(), 3U) << "vertices in one place are chosen once each";
  EXPECT_THROW(spread_vertices(doubled, 4), InvalidArgument);
  EXPECT_THROW(spread_vertices(doubled, 0), InvalidArgument);
}

TEST(DeformationTrial, TheNearestFrameOfAMovedFrameIsItself) {
  const PerformanceDatabase database = figure({"walk", "wave"});
  const MeshSequence copy = moved(database.clip(1), "copy");
  const std::vector<std::int32_t> vertices = spread_vertices(database.markup()->reference, 20);
  for (const std::size_t f : {0U, 9U, 17U}) {
    EXPECT_EQ(nearest_frame(database, constraints_at(vertices, copy.frame(f))),
              (FrameId{.clip_idx = 1, .frame_idx = f}));
  }
}

TEST(DeformationTrial, TheMeterMeasuresErrorsAndStretchBeyondWhatWasSeen) {
  const PerformanceDatabase database = figure({"walk"});
  const Markup& markup = *database.markup();
  const PartHierarchy hierarchy(database.topology(), view(markup.reference), markup.parts);
  const TrialMeter meter(database, markup.reference, &hierarchy);
  ASSERT_TRUE(meter.has_frontier());
  const PositionsView truth = database.clip(0).frame(3);
  Coordinates result = truth.cast<double>();
  result.col(0).array() += 0.25;
  const TrialFigures moved_away = meter(result, truth);
  EXPECT_NEAR(moved_away.mean_error, 0.25, 1e-6);
  EXPECT_NEAR(moved_away.max_error, 0.25, 1e-6);
  EXPECT_NEAR(moved_away.inside_stretch_max, 1.0, 1e-6) << "a frame that was seen";
  EXPECT_NEAR(moved_away.frontier_stretch_max, 1.0, 1e-6);
  // Of each edge the longest frame is somewhere in the clip, so 10 x a frame is 10 x that at most, and 10 x
  // somewhere if that frame is the longest.
  const TrialFigures grown = meter(10.0 * truth.cast<double>(), truth);
  EXPECT_LE(grown.inside_stretch_max, 10.0 + 1e-6);
  EXPECT_GT(grown.inside_stretch_max, 8.0);
  EXPECT_GT(grown.frontier_stretch_p99, 5.0);
  const TrialFigures shrunk = meter(0.01 * truth.cast<double>(), truth);
  EXPECT_GT(shrunk.inside_stretch_max, 10.0);
  EXPECT_TRUE(std::isfinite(meter(0.0 * truth.cast<double>(), truth).inside_stretch_max));
  // One torn vertex is seen where it is.
  result = truth.cast<double>();
  std::int32_t shared = 0;
  while (hierarchy.shares(shared).size() < 2) ++shared;
  result(shared, 1) += 0.5;
  const TrialFigures torn = meter(result, truth);
  EXPECT_GT(torn.frontier_stretch_max, 4.0);
  EXPECT_NEAR(torn.frontier_stretch_p99, 1.0, 0.5);
  EXPECT_NEAR(torn.inside_stretch_max, 1.0, 1e-6) << "edges of shared vertices are frontier edges";
  EXPECT_FALSE(TrialMeter(database, markup.reference, nullptr).has_frontier());
}

TEST(EvaluateDeformation, ALearntFrameMovedRigidlyIsReproducedByEveryModel) {
  PerformanceDatabase database = figure({"walk", "wave"});
  database.add(moved(database.clip(0), "copy"));
  database.set_markup(all_clips().markup());
  const test::TemporaryFolder folder;
  const DeformationEvaluation evaluation = evaluate_deformation(
      database, folder / "out", {.held = {"copy"}, .constraints = {20}, .stride = 7, .pictures = 0});
  for (const std::string& model : deformation_models()) {
    EXPECT_LT(figures_of(evaluation, model, DeformationSource::nearest).worst.max_error, 2e-4) << model;
  }
  // From another frame it takes the learnt spaces, which know the pose.
  const double rigid = figures_of(evaluation, "rigid", DeformationSource::first).mean.mean_error;
  for (const char* model : {"part", "whole"}) {
    EXPECT_LT(figures_of(evaluation, model, DeformationSource::first).mean.mean_error, 0.3 * rigid) << model;
  }
  EXPECT_FALSE(fs::exists(folder / "out" / "pictures.png"));
}

TEST(EvaluateDeformation, ModelsBeatARigidBodyAndRunsAreTheSame) {
  const PerformanceDatabase database = figure({"walk", "jog", "wave", "walk_jog"});
  const test::TemporaryFolder folder;
  const DeformationEvaluationOptions options{.constraints = {10, 20}, .stride = 8, .pictures = 1};
  const DeformationEvaluation evaluation = evaluate_deformation(database, folder / "a", options);
  EXPECT_EQ(evaluation.held_clips, std::vector<std::string>{"walk_jog"}) << "the last clip, unless named";
  EXPECT_EQ(evaluation.learnt_clips, (std::vector<std::string>{"walk", "jog", "wave"}));
  EXPECT_EQ(evaluation.trials.size(), evaluation.frames * 2 * 2 * deformation_models().size());
  EXPECT_EQ(evaluation.figures.size(), 2 * 2 * deformation_models().size());
  EXPECT_TRUE(std::ranges::none_of(evaluation.trials, [](const DeformationTrial& trial) {
    return trial.source_frame.starts_with("walk_jog");
  })) << "a held-out frame was edited";
  for (const DeformationSource source : {DeformationSource::first, DeformationSource::nearest}) {
    const double rigid = figures_of(evaluation, "rigid", source).mean.mean_error;
    for (const std::string& model : deformation_models()) {
      if (model == "rigid") continue;
      EXPECT_LT(figures_of(evaluation, model, source).mean.mean_error, rigid) << model;
    }
  }
  for (const DeformationFigures& f : evaluation.figures) {
    EXPECT_LE(f.mean.mean_error, f.mean.max_error);
    EXPECT_LE(f.mean.max_error, f.worst.max_error);
    EXPECT_LE(f.mean.inside_stretch_p99, f.worst.inside_stretch_max);
  }
  static_cast<void>(evaluate_deformation(database, folder / "b", options));
  for (const char* file : {"frames.csv", "pictures.png"}) {
    EXPECT_EQ(read_text_file(folder / "a" / file), read_text_file(folder / "b" / file)) << file;
  }
  const std::string markdown = read_text_file(folder / "a" / "deformation.md");
  EXPECT_THAT(markdown, HasSubstr("| 20 | part |"));
  EXPECT_THAT(markdown, HasSubstr("| walk_jog | nearest |"));
  EXPECT_GT(read_image(folder / "a" / "deformation.png").width, 200);
}

TEST(EvaluateDeformation, ATruthIsReproducedAndNothingElseIsHeldOut) {
  const test::TemporaryFolder folder;
  save_database(figure({"wave"}), folder / "truth.reprise");
  const DeformationEvaluation evaluation = evaluate_deformation(figure({"walk", "jog"}), folder / "out",
                                                                {.truth = folder / "truth.reprise",
                                                                 .models = {"rigid", "laplacian"},
                                                                 .constraints = {12},
                                                                 .stride = 10,
                                                                 .pictures = 0});
  EXPECT_EQ(evaluation.learnt_clips, (std::vector<std::string>{"walk", "jog"}));
  EXPECT_EQ(evaluation.held_clips, std::vector<std::string>{"truth/wave"});
  EXPECT_TRUE(evaluation.learning.is_null()) << "neither model learns";
}

TEST(EvaluateDeformation, WithoutMarkupItDoesWhatItCan) {
  PerformanceDatabase bare = figure({"walk", "jog"});
  bare.set_markup(std::nullopt);
  const test::TemporaryFolder folder;
  const DeformationEvaluation evaluation =
      evaluate_deformation(bare, folder / "out", {.constraints = {12}, .stride = 12, .pictures = 0});
  std::set<std::string> models;
  for (const DeformationFigures& f : evaluation.figures) models.insert(f.model);
  EXPECT_EQ(models, (std::set<std::string>{"laplacian", "rigid", "whole"}));
  EXPECT_FALSE(evaluation.has_frontier);
  EXPECT_EQ(evaluation.notes.size(), 3U);
}

TEST(EvaluateDeformation, SaysWhatIsWrongBeforeItWorks) {
  const PerformanceDatabase database = figure({"walk", "jog"});
  const test::TemporaryFolder folder;
  const auto evaluate = [&](const PerformanceDatabase& d, const DeformationEvaluationOptions& options) {
    return [&d, &folder, options] { evaluate_deformation(d, folder / "out", options); };
  };
  const auto expect = [](const auto& call, const char* text) {
    EXPECT_THAT(call, ThrowsMessage<InvalidArgument>(HasSubstr(text)));
  };
  expect(evaluate({}, {}), "no clip");
  expect(evaluate(database, {.held = {"wlak"}}), "walk");
  expect(evaluate(database, {.held = {"walk", "jog"}}), "nothing is left to learn from");
  expect(evaluate(figure({"walk"}), {}), "nothing is left to learn from");
  expect(evaluate(database, {.models = {"parts"}}), "did you mean 'part'");
  expect(evaluate(database, {.constraints = {}}), "at least one number");
  expect(evaluate(database, {.constraints = {0}}), "expected 1 to");
  expect(evaluate(database, {.constraints = {100000}}), "found 100000");
  expect(evaluate(database, {.stride = 0}), "stride");
  expect(evaluate(database, {.pictures = 21}), "pictures");
  PerformanceDatabase bare = figure({"walk", "jog"});
  bare.set_markup(std::nullopt);
  expect(evaluate(bare, {.models = {"lbs"}}), "reprise markup");
  PerformanceDatabase other;
  other.add(test::walk("slow", 40, 0.03, 20.0));
  save_database(other, folder / "other.reprise");
  expect(evaluate(database, {.truth = folder / "other.reprise"}), "is no truth of this database");
  EXPECT_FALSE(fs::exists(folder / "out")) << "nothing was begun";
  write_text_file(folder / "out", "a file");
  EXPECT_THROW(evaluate(database, {})(), FileError);
}

}  // namespace
}  // namespace reprise
