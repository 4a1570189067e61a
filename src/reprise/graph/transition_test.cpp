// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/transition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/graph/transition_test_support.h"
#include "reprise/graph/vertex_samples.h"

namespace reprise {
namespace {

using test::ama;
using test::database_of;
using test::frozen;
using test::room;
using test::uneven_walk;
using test::walks;
using test::Window;
using test::window_by_definition;
using ::testing::HasSubstr;

void expect_same(const std::vector<Transition>& a, const std::vector<Transition>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::tie(a[i].source_clip, a[i].target_clip, a[i].m, a[i].n, a[i].half_window),
              std::tie(b[i].source_clip, b[i].target_clip, b[i].m, b[i].n, b[i].half_window));
    EXPECT_NEAR(a[i].distortion, b[i].distortion, 1e-5);
    EXPECT_NEAR(a[i].peak_acceleration, b[i].peak_acceleration, 1e-5);
    EXPECT_NEAR(a[i].cost, b[i].cost, 1e-4);
  }
}

TEST(BlendWeight, RisesFromZeroToOneAndIsSymmetric) {
  for (const BlendProfile profile : {BlendProfile::linear, BlendProfile::smooth}) {
    for (const int L : {1, 2, 7, 24}) {
      EXPECT_EQ(blend_weight(profile, -L, L), 0.0);
      EXPECT_EQ(blend_weight(profile, 0, L), 0.5);
      EXPECT_EQ(blend_weight(profile, L, L), 1.0);
      EXPECT_EQ(blend_weight(profile, -L - 1, L), 0.0);
      EXPECT_EQ(blend_weight(profile, L + 1, L), 1.0);
      for (int k = -L; k < L; ++k) {
        EXPECT_LT(blend_weight(profile, k, L), blend_weight(profile, k + 1, L));
        EXPECT_NEAR(blend_weight(profile, k, L) + blend_weight(profile, -k, L), 1.0, 1e-12);
      }
    }
  }
}

TEST(BlendWeight, LinearIsEquation2AndSmoothHasNoCorner) {
  EXPECT_DOUBLE_EQ(blend_weight(BlendProfile::linear, -3, 5), 0.2);
  // The first step of a cubic that starts flat is of second order: 3 / (2L)^2.
  EXPECT_LT(blend_weight(BlendProfile::smooth, -23, 24), 3.0 / (48.0 * 48.0));
}

TEST(BlendWeight, RefusesAWindowOfLengthZero) {
  EXPECT_THROW(blend_weight(BlendProfile::linear, 0, 0), InvalidArgument);
}

TEST(SampleVertices, AreDistinctUsedVerticesSpreadOverTheSurface) {
  test::Shape shape = test::sheet(30);
  Topology topology = *shape.topology;
  topology.vertex_count += 5;  // vertices of no triangle
  const std::vector<std::int32_t> samples = sample_vertices(topology, 50);
  ASSERT_EQ(samples.size(), 50U);
  EXPECT_EQ(std::set<std::int32_t>(samples.begin(), samples.end()).size(), 50U);
  EXPECT_LT(*std::ranges::max_element(samples), shape.topology->vertex_count);
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    float nearest = std::numeric_limits<float>::max();
    for (const std::int32_t s : samples) {
      nearest = std::min(nearest, (shape.positions.row(s) - shape.positions.row(v)).norm());
    }
    EXPECT_LT(nearest, 0.3F);
  }
}

TEST(SampleVertices, BeginWithThoseOfASmallerNumber) {
  const test::Shape shape = test::body();
  std::vector<std::int32_t> samples = sample_vertices(*shape.topology, 40);
  samples.resize(7);
  EXPECT_EQ(samples, sample_vertices(*shape.topology, 7));
}

TEST(SampleVertices, ReachEveryComponent) {
  const test::Shape shape = test::sphere(1);
  Topology two = *shape.topology;
  for (const Triangle& t : shape.topology->triangles) {
    const std::int32_t N = shape.topology->vertex_count;
    two.triangles.push_back({t[0] + N, t[1] + N, t[2] + N});
  }
  two.vertex_count *= 2;
  const std::vector<std::int32_t> samples = sample_vertices(two, 2);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_LT(samples[0], shape.topology->vertex_count);
  EXPECT_GE(samples[1], shape.topology->vertex_count);
}

TEST(SampleVertices, AreAllVerticesIfThereAreNoMore) {
  const test::Shape shape = test::sphere(0);
  EXPECT_THAT(sample_vertices(*shape.topology, 1000), ::testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(FindTransitions, ChoosesTheWindowThatMinimisesItsCriterion) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  for (const WindowCriterion criterion : {WindowCriterion::blend_speed, WindowCriterion::paper_sum}) {
    for (const BlendProfile profile : {BlendProfile::linear, BlendProfile::smooth}) {
      const TransitionOptions options{.criterion = criterion, .profile = profile, .sample_vertices = 1 << 20};
      const std::vector<Transition> transitions = find_transitions(database, matrix, options);
      ASSERT_GT(transitions.size(), 9U);
      for (std::size_t i = 0; i < transitions.size(); i += 3) {
        const Transition& t = transitions[i];
        const Window chosen = window_by_definition(database, matrix, t, t.half_window, options);
        EXPECT_NEAR(t.distortion, chosen.distortion, 1e-9);
        EXPECT_NEAR(t.peak_acceleration, chosen.peak, 1e-5);
        EXPECT_NEAR(t.cost, chosen.cost, 1e-4);
        for (int L = options.min_half_window; L <= std::min(options.max_half_window, room(database, t));
             ++L) {
          EXPECT_GT(window_by_definition(database, matrix, t, L, options).cost, t.cost - 1e-4) << L;
        }
      }
    }
  }
}

TEST(FindTransitions, ByTheLiteralSumAlwaysTakesTheShortestWindow) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  for (const int shortest : {1, 2, 5}) {
    for (const Transition& t : find_transitions(
             database, matrix, {.min_half_window = shortest, .criterion = WindowCriterion::paper_sum})) {
      EXPECT_EQ(t.half_window, shortest);
    }
  }
}

TEST(FindTransitions, TradesDistortionForSlowerBlendsAsTheWeightGrows) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  // Of one and the same candidate (m, n): a larger weight never chooses a larger peak.
  std::map<std::tuple<std::size_t, std::size_t, int, int>, double> peaks;
  std::size_t compared = 0;
  for (const double weight : {0.25, 1.0, 4.0, 64.0}) {
    for (const Transition& t :
         find_transitions(database, matrix, {.transitions_per_pair = 20, .acceleration_weight = weight})) {
      const auto [entry, is_new] =
          peaks.try_emplace({t.source_clip, t.target_clip, t.m, t.n}, t.peak_acceleration);
      if (!is_new) {
        EXPECT_LE(t.peak_acceleration, entry->second + 1e-6);
        ++compared;
      }
      entry->second = t.peak_acceleration;
    }
  }
  EXPECT_GT(compared, 20U);
}

TEST(FindTransitions, KeepsItsPromises) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const TransitionOptions options{
      .transitions_per_pair = 3, .max_half_window = 9, .self_min_gap = 12, .separation = 8};
  const std::vector<Transition> transitions = find_transitions(database, matrix, options);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Transition>> of_pair;
  for (const Transition& t : transitions) {
    // The window lies inside both clips and inside the limits.
    EXPECT_GE(t.half_window, options.min_half_window);
    EXPECT_LE(t.half_window, options.max_half_window);
    EXPECT_LE(t.half_window, room(database, t));
    // A clip does not meet itself at nearly the same time.
    if (t.source_clip == t.target_clip) {
      EXPECT_GE(std::abs(t.m - t.n), options.self_min_gap);
    }
    // The transform is the best alignment of the two centre frames.
    const GroundAlignment best =
        align_on_ground(database.clip(t.source_clip).frame(static_cast<std::size_t>(t.m)),
                        database.clip(t.target_clip).frame(static_cast<std::size_t>(t.n)));
    EXPECT_NEAR(wrap_angle(t.source_from_target.yaw - best.a_from_b.yaw), 0.0, 1e-12);
    EXPECT_NEAR((t.source_from_target.translation - best.a_from_b.translation).norm(), 0.0, 1e-12);
    of_pair[{t.source_clip, t.target_clip}].push_back(t);
  }
  EXPECT_EQ(of_pair.size(), 9U);  // every ordered pair has some
  for (const auto& [pair, found] : of_pair) {
    EXPECT_LE(found.size(), 3U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LE(found[j].cost, found[i].cost);
        EXPECT_TRUE(std::abs(found[j].m - found[i].m) >= 8 || std::abs(found[j].n - found[i].n) >= 8);
      }
    }
  }
}

TEST(FindTransitions, ALargerNumberAPairOnlyAddsWorseOnes) {
  const PerformanceDatabase database = database_of({uneven_walk("a", 70, 20.0, 0.0, 1)});
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const std::vector<Transition> two = find_transitions(database, matrix, {.transitions_per_pair = 2});
  std::vector<Transition> four = find_transitions(database, matrix, {.transitions_per_pair = 4});
  ASSERT_EQ(two.size(), 2U);
  ASSERT_EQ(four.size(), 4U);
  four.resize(2);
  expect_same(two, four);
}

TEST(FindTransitions, FindTheLoopOfAPeriodicWalk) {
  const PerformanceDatabase database =
      database_of({test::walk("walk", 60)});  // period 20 frames, 0.8 m a period
  const std::vector<Transition> transitions = find_transitions(database, vertex_dissimilarity(database));
  ASSERT_FALSE(transitions.empty());
  const Transition& best = transitions.front();
  EXPECT_EQ(std::abs(best.m - best.n) % 20, 0);
  EXPECT_LT(best.distortion, 1e-4);
  EXPECT_NEAR(best.source_from_target.yaw, 0.0, 1e-5);
  EXPECT_NEAR(best.source_from_target.translation.y(), 0.04 * (best.m - best.n), 1e-4);
}

TEST(FindTransitions, MatchThePhasesOfTwoWalks) {
  const GroundTransform motion{.yaw = 1.2, .translation = {5.0, 2.0}};
  const PerformanceDatabase database =
      database_of({test::walk("a", 60), test::moved(test::walk("b", 60, 0.04, 20.0, 7.0), motion, "b")});
  for (const Transition& t :
       find_transitions(database, vertex_dissimilarity(database), {.transitions_per_pair = 1})) {
    if (t.source_clip == t.target_clip) continue;
    const int phase_m = t.m + (t.source_clip == 1 ? 7 : 0);
    const int phase_n = t.n + (t.target_clip == 1 ? 7 : 0);
    EXPECT_EQ((phase_m - phase_n) % 20, 0);
    EXPECT_NEAR(t.source_from_target.yaw, t.source_clip == 0 ? -1.2 : 1.2, 1e-4);
    // The blend does not accelerate anything beyond the walk itself: 0.08 m x 1.8 m height x (2 pi / 20)^2.
    EXPECT_LT(t.peak_acceleration, 0.025);
  }
}

TEST(FindTransitions, DoNotChangeWhenClipsMoveOnTheGround) {
  const PerformanceDatabase database = walks();
  PerformanceDatabase elsewhere;
  elsewhere.add(test::moved(database.clip(0), {.yaw = -2.5, .translation = {1.0, 6.0}}, "a"));
  elsewhere.add(database.clip(1));
  elsewhere.add(test::moved(database.clip(2), {.yaw = 2.1, .translation = {3.0, -4.0}}, "c"));
  expect_same(find_transitions(database, vertex_dissimilarity(database)),
              find_transitions(elsewhere, vertex_dissimilarity(elsewhere)));
}

TEST(FindTransitions, DoNotChangeWhenACapturedClipMovesOnTheGround) {
  REPRISE_REQUIRE_DATA();
  const PerformanceDatabase database = ama();
  PerformanceDatabase elsewhere;
  elsewhere.add(database.clip(0));
  elsewhere.add(test::moved(database.clip(1), {.yaw = 2.1, .translation = {3.0, -4.0}}, "jumping"));
  const std::vector<Transition> transitions = find_transitions(database, vertex_dissimilarity(database));
  EXPECT_EQ(transitions.size(), 16U);
  expect_same(transitions, find_transitions(elsewhere, vertex_dissimilarity(elsewhere)));
}

TEST(FindTransitions, AreTheSameForAnyNumberOfThreads) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  std::vector<std::vector<Transition>> results;
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(find_transitions(database, matrix));
  }
  expect_same(results[0], results[1]);
  for (std::size_t i = 0; i < results[0].size(); ++i) EXPECT_EQ(results[0][i].cost, results[1][i].cost);
}

TEST(FindTransitions, TakeOneOfAPlateauWhereItHasRoom) {
  const PerformanceDatabase database = database_of({frozen("a", 41), frozen("b", 31)});
  const std::vector<Transition> transitions = find_transitions(database, vertex_dissimilarity(database));
  int across = 0;
  for (const Transition& t : transitions) {
    EXPECT_EQ(t.distortion, 0.0);
    if (t.source_clip == t.target_clip) continue;
    ++across;
    EXPECT_EQ(room(database, t), 15);
  }
  EXPECT_EQ(across, 2);  // one from a to b, one from b to a
}

TEST(FindTransitions, OfAClipThatNeverRepeatsItselfDoNotExist) {
  // It leans over ever more: the nearer in time, the more alike, down to no transition at all.
  MeshSequence clip = frozen("lean", 50);
  for (std::size_t f = 0; f < 50; ++f) {
    auto frame = clip.frame(f);
    frame.col(2) += 0.02F * static_cast<float>(f) * frame.col(1);
  }
  const PerformanceDatabase database = database_of({clip});
  EXPECT_TRUE(find_transitions(database, vertex_dissimilarity(database)).empty());
}

TEST(FindTransitions, OfClipsTooShortForAWindowDoNotExist) {
  const PerformanceDatabase database =
      database_of({test::walk("one", 1), test::walk("four", 4), test::walk("five", 5)});
  const std::vector<Transition> transitions =
      find_transitions(database, vertex_dissimilarity(database), {.self_min_gap = 1});
  EXPECT_TRUE(transitions.empty());  // only 2 -> 2 of "five" with itself has room, and that is no transition
  EXPECT_TRUE(find_transitions(PerformanceDatabase(), vertex_dissimilarity(PerformanceDatabase())).empty());
}

TEST(FindTransitions, RefuseWhatDoesNotFit) {
  const PerformanceDatabase database = database_of({test::walk("a", 12)});
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const auto message = [&](const PerformanceDatabase& other, const TransitionOptions& options) {
    try {
      find_transitions(other, matrix, options);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // A matrix of other clips, or of another number of frames.
  EXPECT_THAT(message(database_of({test::walk("b", 12)}), {}), HasSubstr("clips a, the database has b"));
  EXPECT_THAT(message(database_of({test::walk("a", 13)}), {}),
              HasSubstr("12 frames in the dissimilarity matrix and 13"));
  // Options out of range.
  EXPECT_EQ(message(database, {}), "");
  EXPECT_THAT(message(database, {.transitions_per_pair = 0}), HasSubstr("transitions_per_pair is 0"));
  EXPECT_THAT(message(database, {.max_half_window = 3, .min_half_window = 4}),
              HasSubstr("max_half_window is 3"));
  EXPECT_THAT(message(database, {.min_half_window = 0}), HasSubstr("min_half_window is 0"));
  EXPECT_THAT(message(database, {.self_min_gap = 0}), HasSubstr("self_min_gap is 0"));
  EXPECT_THAT(message(database, {.separation = 0}), HasSubstr("separation is 0"));
  EXPECT_THAT(message(database, {.acceleration_weight = -1.0}), HasSubstr("acceleration_weight is -1"));
  EXPECT_THAT(message(database, {.acceleration_weight = std::nan("")}),
              HasSubstr("acceleration_weight is nan"));
  EXPECT_THAT(message(database, {.sample_vertices = 0}), HasSubstr("sample_vertices is 0"));
  // Clips of two rates.
  const test::Shape shape = test::body();
  PerformanceDatabase rates = database_of({test::walk("a", 12)});
  rates.add(MeshSequence("fast", shape.topology, 3, 50.0));
  const DissimilarityMatrix rates_matrix("vertex", "", {"a", "fast"}, {12, 3});
  EXPECT_THROW(find_transitions(rates, rates_matrix), InvalidArgument);
}

}  // namespace
}  // namespace reprise
