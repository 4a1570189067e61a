// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/similarity.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Coarse, for speed.
constexpr HistogramOptions coarse = {.radius_bins = 3,
                                     .polar_bins = 4,
                                     .azimuth_bins = 8,
                                     .color_bins = {2, 2, 2},
                                     .azimuth_refinement = 4,
                                     .voxel_size = 0.1};

MeshSequence colored(MeshSequence clip, Color color) {
  clip.set_colors(std::vector<Color>(clip.vertex_count(), color));
  return clip;
}

PerformanceDatabase walks(Color second = {200, 40, 40}) {
  PerformanceDatabase database;
  database.add(colored(test::walk("slow", 22, 0.03, 9.0), {200, 40, 40}));
  database.add(colored(test::walk("fast", 18, 0.06, 9.0, 4.0), second));
  return database;
}

class SimilarityStage : public ::testing::Test {
 protected:
  ~SimilarityStage() override { set_interrupted(false); }

  SimilarityResult compute(const std::string& metric) {
    return compute_similarity(database_, folder_ / "db.reprise", {.metric = metric, .histogram = coarse});
  }
  fs::path cache() const { return folder_ / "db.reprise.cache"; }

  test::TemporaryFolder folder_;
  PerformanceDatabase database_ = walks();
};

TEST_F(SimilarityStage, KeepsEveryMetricAndNeverUsesAStaleMatrix) {
  database_.set_markup(std::nullopt);
  for (const std::string metric : {"vertex", "shape-colour", "shape"}) {
    const SimilarityResult first = compute(metric);
    EXPECT_FALSE(first.from_cache) << metric;
    EXPECT_EQ(first.matrix.metric(), metric);
    const SimilarityResult again = compute(metric);
    EXPECT_TRUE(again.from_cache) << metric;
    EXPECT_EQ(again.statistics.exact_solves, 0U);
    ASSERT_EQ(again.transitions.size(), first.transitions.size());
    EXPECT_GT(first.transitions.size(), 0U);
    for (std::size_t a = 0; a < 40; ++a) {
      for (std::size_t b = a + 1; b < 40; ++b) {
        ASSERT_EQ(again.matrix.entry(a, b), first.matrix.entry(a, b)) << metric;
      }
    }
  }
  const float value = compute("vertex").matrix.value(3, 30);
  database_.add(colored(test::walk("third", 20), {200, 40, 40}));
  const SimilarityResult larger = compute("vertex");
  EXPECT_FALSE(larger.from_cache);
  EXPECT_EQ(larger.matrix.frame_count(), 60U);
  EXPECT_EQ(larger.matrix.value(3, 30), value);
}

TEST_F(SimilarityStage, ColoursCountForTheMetricThatLooksAtThemAlone) {
  const auto compute_all = [&](const PerformanceDatabase& database) {
    std::vector<SimilarityResult> results;
    for (const char* metric : {"shape-color", "shape", "vertex"}) {
      results.push_back(compute_similarity(database, folder_ / "db.reprise",
                                           {.metric = metric, .histogram = coarse, .exact = true}));
    }
    return results;
  };
  const auto red = compute_all(walks());
  const auto blue = compute_all(walks({40, 40, 200}));
  EXPECT_EQ(blue[0].matrix.metric(), "shape-colour") << "either spelling";
  EXPECT_FALSE(blue[0].from_cache) << "a recoloured clip is another one";
  EXPECT_TRUE(blue[1].from_cache) << "but has the same shape";
  EXPECT_TRUE(blue[2].from_cache);
  for (std::size_t a = 0; a < 22; ++a) {
    for (std::size_t b = 22; b < 40; ++b) {
      EXPECT_GT(blue[0].matrix.value(a, b), red[0].matrix.value(a, b) + 0.1F);
    }
  }
}

TEST_F(SimilarityStage, OptionsThatValuesDependOnHaveMatricesOfTheirOwn) {
  SimilarityOptions options{.metric = "shape", .histogram = coarse};
  const auto is_new = [&] {
    return !compute_similarity(database_, folder_ / "db.reprise", options).from_cache;
  };
  EXPECT_TRUE(is_new());
  options.histogram.meters_per_color = 2.0;
  options.histogram.color_bins = {3, 3, 3};
  EXPECT_FALSE(is_new()) << "nothing to a shape";
  options.histogram.polar_bins = 5;
  EXPECT_TRUE(is_new());
  options.histogram.voxel_size = 0.12;
  EXPECT_TRUE(is_new());
}

TEST_F(SimilarityStage, OtherTransitionsRefineTheMatrixThatIsThere) {
  SimilarityOptions options{.metric = "shape", .histogram = coarse};
  const SimilarityResult few = compute_similarity(database_, folder_ / "db.reprise", options);
  options.transitions = {.transitions_per_pair = 30, .min_half_window = 1, .separation = 1};
  const SimilarityResult many = compute_similarity(database_, folder_ / "db.reprise", options);
  EXPECT_GE(many.matrix.exact_count(), few.matrix.exact_count());
  EXPECT_EQ(std::distance(fs::directory_iterator(cache()), {}), 1) << "one file for both";
  options.exact = true;
  const SimilarityResult exact = compute_similarity(database_, folder_ / "db.reprise", options);
  EXPECT_EQ(exact.matrix.exact_count(), exact.matrix.pair_count());
  ASSERT_EQ(exact.transitions.size(), many.transitions.size());
  for (std::size_t t = 0; t < many.transitions.size(); ++t) {
    EXPECT_EQ(exact.transitions[t].m, many.transitions[t].m);
    EXPECT_EQ(exact.transitions[t].n, many.transitions[t].n);
    EXPECT_EQ(exact.transitions[t].cost, many.transitions[t].cost);
  }
  EXPECT_TRUE(compute_similarity(database_, folder_ / "db.reprise", options).from_cache);
}

TEST_F(SimilarityStage, ADamagedCacheIsComputedAnew) {
  for (const std::string metric : {"vertex", "shape"}) {
    const float value = compute(metric).matrix.value(3, 30);
    for (const auto& entry : fs::directory_iterator(cache())) fs::resize_file(entry.path(), 64);
    const SimilarityResult result = compute(metric);
    EXPECT_FALSE(result.from_cache);
    EXPECT_EQ(result.matrix.value(3, 30), value);
  }
}

TEST_F(SimilarityStage, ARunThatWasStoppedContinues) {
  const SimilarityResult whole = compute("shape");
  fs::remove_all(cache());
  set_interrupted(true);
  EXPECT_THROW(compute("shape"), Cancelled);
  set_interrupted(false);
  const SimilarityResult result = compute("shape");
  for (std::size_t a = 0; a < 40; ++a) {
    for (std::size_t b = a + 1; b < 40; ++b) {
      ASSERT_EQ(result.matrix.entry(a, b), whole.matrix.entry(a, b));
    }
  }
}

TEST_F(SimilarityStage, SkeletonsAreFollowedByTheMarkup) {
  EXPECT_THAT([&] { compute("skeleton"); },
              ThrowsMessage<InvalidArgument>(
                  AllOf(HasSubstr("db.reprise"), HasSubstr("markup"), HasSubstr("reprise markup"))));
  database_ = make_figure({.voxel_size = 0.08});
  const SimilarityResult result = compute("skeleton");
  EXPECT_EQ(result.matrix.metric(), "skeleton");
  EXPECT_EQ(result.matrix.exact_count(), result.matrix.pair_count());
  EXPECT_GT(result.transitions.size(), 0U);
  EXPECT_TRUE(compute("skeleton").from_cache);
  // A joint that is somewhere else is another skeleton.
  Markup markup = *database_.markup();
  markup.skeleton.joints.back().rest_position.y() += 0.01;
  database_.set_markup(markup);
  EXPECT_FALSE(compute("skeleton").from_cache);
}

TEST_F(SimilarityStage, SaysWhatIsWrongWithTheQuestion) {
  EXPECT_THAT([&] { compute("vertx"); }, ThrowsMessage<InvalidArgument>(AllOf(
                                             HasSubstr("'vertx'"), HasSubstr("did you mean 'vertex'"))));
  EXPECT_THAT(
      [&] { compute("mood"); },
      ThrowsMessage<InvalidArgument>(HasSubstr("the metrics are shape-colour, shape, vertex, skeleton")));
  // Before any work.
  SimilarityOptions options{.metric = "shape", .histogram = coarse};
  options.histogram.polar_bins = 0;
  EXPECT_THROW(compute_similarity(database_, folder_ / "db.reprise", options), InvalidArgument);
  options.histogram = coarse;
  options.transitions.min_half_window = 0;
  EXPECT_THROW(compute_similarity(database_, folder_ / "db.reprise", options), InvalidArgument);
  EXPECT_FALSE(fs::exists(cache()));
}

TEST_F(SimilarityStage, DecidesTransitionsMadeByHandAndKeepsWhatTheyNeed) {
  const auto compute_with = [&](std::vector<TransitionRequest> requests) {
    return compute_similarity(database_, folder_ / "db.reprise",
                              {.metric = "shape", .histogram = coarse, .requests = std::move(requests)});
  };
  // All pairs of frames in some window, one of which at least no transition that was found depends on.
  std::vector<TransitionRequest> requests;
  for (int m = 3; m < 19; ++m) {
    for (int n = 3; n < 15; ++n) {
      requests.push_back({.source_clip = 0, .target_clip = 1, .m = m, .n = n, .half_window = 1});
    }
  }
  const SimilarityResult without = compute_with({});
  const SimilarityResult with = compute_with(requests);
  EXPECT_FALSE(with.from_cache);
  EXPECT_GT(with.matrix.exact_count(), without.matrix.exact_count());
  EXPECT_TRUE(compute_with(requests).from_cache);
  EXPECT_TRUE(compute_with({}).from_cache);
  for (const TransitionRequest& request : requests) {
    EXPECT_NO_THROW(measure_transition(database_, with.matrix, request));
  }
  EXPECT_THROW(compute_with({{.source_clip = 0, .target_clip = 1, .m = 99, .n = 3}}), InvalidArgument);
  EXPECT_THROW(compute_with({{.source_clip = 0, .target_clip = 1, .m = 9, .n = 9, .half_window = 10}}),
               InvalidArgument);
}

}  // namespace
}  // namespace reprise
