// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/measure_transition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/graph/graph_test_support.h"
#include "reprise/graph/transition_test_support.h"

namespace reprise {
namespace {

using test::argument_error;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double unlimited = std::numeric_limits<double>::infinity();

auto fields(const Transition& t) {
  return std::tuple(t.source_clip, t.target_clip, t.m, t.n, t.half_window, t.source_from_target.yaw,
                    t.source_from_target.translation.x(), t.source_from_target.translation.y(), t.distortion,
                    t.peak_acceleration, t.cost);
}

class MeasureTransition : public ::testing::Test {
 protected:
  std::string error(const TransitionRequest& request, const TransitionOptions& options = {}) const {
    return argument_error([&] { measure_transition(database_, matrix_, request, options); });
  }

  PerformanceDatabase database_ = test::walks();
  DissimilarityMatrix matrix_ = vertex_dissimilarity(database_);
};

TEST_F(MeasureTransition, SaysOfFoundOnesWhatTheSearchSaid) {
  for (const TransitionOptions& options :
       {TransitionOptions{.sample_vertices = 60},
        TransitionOptions{.criterion = WindowCriterion::paper_sum, .sample_vertices = 60},
        TransitionOptions{
            .acceleration_weight = 0.0, .profile = BlendProfile::linear, .sample_vertices = 60}}) {
    const std::vector<Transition> found = find_transitions(database_, matrix_, options);
    ASSERT_FALSE(found.empty());
    for (const Transition& t : found) {
      TransitionRequest request{
          .source_clip = t.source_clip, .target_clip = t.target_clip, .m = t.m, .n = t.n};
      EXPECT_EQ(fields(measure_transition(database_, matrix_, request, options)), fields(t));
      request.half_window = t.half_window;
      EXPECT_EQ(fields(measure_transition(database_, matrix_, request, options)), fields(t));
    }
  }
}

TEST_F(MeasureTransition, FollowsTheDefinitionAtAnyPlaceAndWindow) {
  const TransitionOptions options{.sample_vertices = 1 << 20};
  for (const TransitionRequest& request :
       {TransitionRequest{0, 1, 30, 20, 7}, TransitionRequest{1, 1, 10, 11, 1},
        TransitionRequest{2, 0, 17, 35, 17}, TransitionRequest{0, 0, 34, 30, 30}}) {
    const Transition t = measure_transition(database_, matrix_, request, options);
    EXPECT_EQ(t.half_window, request.half_window) << "also outside of the options' windows";
    const test::Window expected =
        test::window_by_definition(database_, matrix_, t, request.half_window, options);
    EXPECT_NEAR(t.distortion, expected.distortion, 1e-5);
    EXPECT_NEAR(t.peak_acceleration, expected.peak, 1e-5);
    EXPECT_NEAR(t.cost, expected.cost, 5e-5);
    const GroundTransform move =
        align_on_ground(database_.clip(t.source_clip).frame(static_cast<std::size_t>(t.m)),
                        database_.clip(t.target_clip).frame(static_cast<std::size_t>(t.n)))
            .a_from_b;
    EXPECT_NEAR(t.source_from_target.yaw, move.yaw, 1e-9);
    EXPECT_LT((t.source_from_target.translation - move.translation).norm(), 1e-9);
  }
}

TEST_F(MeasureTransition, TakesTheBestWindowIfNoneIsGiven) {
  const TransitionOptions options{.max_half_window = 12, .sample_vertices = 60};
  const TransitionRequest place{.source_clip = 0, .target_clip = 1, .m = 33, .n = 21};
  const Transition best = measure_transition(database_, matrix_, place, options);
  for (int L = options.min_half_window; L <= options.max_half_window; ++L) {
    TransitionRequest request = place;
    request.half_window = L;
    EXPECT_GE(measure_transition(database_, matrix_, request, options).cost, best.cost) << L;
  }
}

TEST_F(MeasureTransition, SaysTheSameFromBounds) {
  DissimilarityMatrix bounds("vertex", database_);
  for (std::size_t a = 0; a < matrix_.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < matrix_.frame_count(); ++b) {
      const float value = matrix_.value(a, b);
      bounds.set(a, b, {0.8F * value, 1.1F * value, 0.0F});
    }
  }
  const TransitionRequest request{.source_clip = 2, .target_clip = 0, .m = 15, .n = 40};
  EXPECT_THAT(argument_error([&] { measure_transition(database_, bounds, request); }),
              HasSubstr("undecided"));
  std::size_t asked = 0;
  const ExactEntry exact = [&](std::size_t a, std::size_t b) {
    ++asked;
    return matrix_.entry(a, b);
  };
  const Transition t = measure_transition(database_, bounds, exact, request);
  EXPECT_EQ(fields(t), fields(measure_transition(database_, matrix_, request)));
  EXPECT_GT(asked, 0U);
  EXPECT_LT(asked, 50U) << "those on the diagonal of the windows alone";
  asked = 0;
  EXPECT_EQ(fields(measure_transition(database_, bounds, exact, request)), fields(t));
  EXPECT_EQ(asked, 0U) << "what was asked once is kept";
}

TEST_F(MeasureTransition, RefusesWhatDoesNotExistOrFit) {
  // Clips and frames.
  EXPECT_THAT(error({.source_clip = 3, .target_clip = 0, .m = 5, .n = 5}), HasSubstr("there are 3 clips"));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 9, .m = 5, .n = 5}), HasSubstr("there are 3 clips"));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 70, .n = 5}),
              HasSubstr("clip 'a' has frames 0 to 69, asked for 70"));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 5, .n = -1}),
              HasSubstr("clip 'b' has frames 0 to 49, asked for -1"));
  // A frame to itself.
  EXPECT_THAT(error({.source_clip = 1, .target_clip = 1, .m = 20, .n = 20}), HasSubstr("to itself"));
  // Windows.
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 30, .n = 20, .half_window = -2}),
              HasSubstr("expected at least 1"));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 30, .n = 20, .half_window = 21}),
              AllOf(HasSubstr("'a:30->b:20': a blend of half window 21 does not fit"),
                    HasSubstr("the longest that does is 20")));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 69, .n = 20, .half_window = 1}),
              HasSubstr("none does at the first or last frame"));
  EXPECT_THAT(error({.source_clip = 0, .target_clip = 1, .m = 1, .n = 20}),
              AllOf(HasSubstr("half window 2"), HasSubstr("the longest that does is 1")));
  // Options, another matrix.
  EXPECT_THAT(error({.target_clip = 1, .m = 30, .n = 20}, {.separation = 0}), HasSubstr("separation"));
  EXPECT_THAT(argument_error([&] {
                measure_transition(test::database_of({database_.clip(0)}), matrix_, {.m = 30, .n = 20});
              }),
              HasSubstr("the dissimilarity matrix is of"));
}

TEST_F(MeasureTransition, ByHandMayPopButNeedNot) {
  TransitionRequest request{.source_clip = 0, .target_clip = 1, .m = 33, .n = 21};
  const auto measured = [&](double limit) {
    return measure_transition(database_, matrix_, request,
                              {.acceleration_weight = 0.01, .max_pop_ratio = limit});
  };
  const Transition best = measured(unlimited);
  EXPECT_EQ(fields(measured(1e-6)), fields(best)) << "where every window pops";
  request.half_window = best.half_window;
  EXPECT_EQ(fields(measured(1e-6)), fields(best)) << "who gives a window has looked";
  // Just below what the best window needs another is taken, as the search would, if there is a calmer one.
  request.half_window = 0;
  int calmer_count = 0;
  for (request.m = 20; request.m < 50; ++request.m) {
    const Transition limitless = measured(unlimited);
    const Transition limited =
        measured(0.999 * limitless.peak_acceleration / captured_acceleration(database_));
    if (fields(limited) == fields(limitless)) continue;
    ++calmer_count;
    EXPECT_LT(limited.peak_acceleration, limitless.peak_acceleration);
    EXPECT_GE(limited.cost, limitless.cost);
  }
  EXPECT_GT(calmer_count, 0);
}

TEST_F(MeasureTransition, NoFoundTransitionIsAboveTheLimit) {
  const double captured = captured_acceleration(database_);
  std::vector<std::size_t> counts;
  for (const double limit : {unlimited, 1.0, 0.9, 0.8, 0.5}) {
    const std::vector<Transition> found =
        find_transitions(database_, matrix_, {.transitions_per_pair = 50, .max_pop_ratio = limit});
    for (const Transition& t : found) EXPECT_LE(t.peak_acceleration, limit * captured);
    counts.push_back(found.size());
  }
  EXPECT_TRUE(std::ranges::is_sorted(counts, std::greater())) << ::testing::PrintToString(counts);
  EXPECT_LT(counts.back(), counts.front());
  EXPECT_GT(counts[2], 0U);
}

TEST(CapturedAcceleration, IsTheNinetyNinthPercentileOfTheFramesPeaks) {
  EXPECT_EQ(captured_acceleration({}), 0.0);
  EXPECT_EQ(captured_acceleration(test::database_of({test::frozen("still", 9)})), 0.0);
  EXPECT_EQ(captured_acceleration(test::database_of({test::walk("short", 2)})), 0.0);
  // One vertex that jumps by h at frame f accelerates by h, 2 h and h about it.
  for (const std::size_t frame_count : {20U, 500U}) {
    MeshSequence clip = test::frozen("jump", frame_count);
    clip.frame(10)(3, 1) += 0.25F;
    // Of 18 accelerations the greatest is the percentile; of 498 the fifth.
    EXPECT_NEAR(captured_acceleration(test::database_of({clip})), frame_count == 20 ? 0.5 : 0.0, 1e-6);
  }
}

TEST(CapturedAcceleration, SetsNoLimitIfNothingMoves) {
  const PerformanceDatabase database = test::database_of({test::frozen("still", 30)});
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  EXPECT_EQ(find_transitions(database, matrix, {.max_pop_ratio = 0.5}).size(),
            find_transitions(database, matrix, {.max_pop_ratio = unlimited}).size());
}

}  // namespace
}  // namespace reprise
