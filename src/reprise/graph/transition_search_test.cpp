// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The search of transitions against its definition, and from bounds against exact values.

#include <cmath>
#include <map>
#include <mutex>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/graph/transition_test_support.h"

namespace reprise {
namespace {

using test::database_of;
using test::uneven_walk;
using test::walks;
using ::testing::HasSubstr;

using Pair = std::pair<std::size_t, std::size_t>;

// Candidates by definition: every pixel of a plateau without a lower neighbour; the plateau's number with it.
std::map<std::pair<int, int>, int> minima_by_definition(const DissimilarityMatrix& matrix, std::size_t source,
                                                        std::size_t target,
                                                        const TransitionOptions& options) {
  const auto value = [&](int m, int n) {
    return matrix.value(matrix.first_frame(source) + static_cast<std::size_t>(m),
                        matrix.first_frame(target) + static_cast<std::size_t>(n));
  };
  const int least = options.min_half_window;
  const int last_m = static_cast<int>(matrix.clip_frame_counts()[source]) - 1 - least;
  const int last_n = static_cast<int>(matrix.clip_frame_counts()[target]) - 1 - least;
  std::map<std::pair<int, int>, int> plateaus;
  for (int m = least; m <= last_m; ++m) {
    for (int n = least; n <= last_n; ++n) {
      if (source != target || std::abs(m - n) >= options.self_min_gap) {
        plateaus[{m, n}] = static_cast<int>(plateaus.size());
      }
    }
  }
  std::set<int> lost;
  // Numbers spread over plateaus, and so does the news of a lower neighbour, until nothing changes.
  for (bool changes = true; changes;) {
    changes = false;
    for (auto& [at, plateau] : plateaus) {
      for (int m = at.first - 1; m <= at.first + 1; ++m) {
        for (int n = at.second - 1; n <= at.second + 1; ++n) {
          if (m < least || m > last_m || n < least || n > last_n) continue;
          if (value(m, n) < value(at.first, at.second)) changes |= lost.insert(plateau).second;
          const auto other = plateaus.find({m, n});
          if (other == plateaus.end() || value(m, n) != value(at.first, at.second)) continue;
          if (other->second >= plateau) continue;
          if (lost.contains(plateau)) lost.insert(other->second);
          plateau = other->second;
          changes = true;
        }
      }
    }
  }
  std::erase_if(plateaus, [&](const auto& item) { return lost.contains(item.second); });
  return plateaus;
}

// The whole definition, window by window and vertex by vertex.
std::vector<Transition> transitions_by_definition(const PerformanceDatabase& database,
                                                  const DissimilarityMatrix& matrix,
                                                  const TransitionOptions& options) {
  std::vector<Transition> result;
  const double max_peak = options.max_pop_ratio * captured_acceleration(database);
  for (std::size_t source = 0; source < database.clips().size(); ++source) {
    for (std::size_t target = 0; target < database.clips().size(); ++target) {
      std::map<int, Transition> of_plateau;
      for (const auto& [at, plateau] : minima_by_definition(matrix, source, target, options)) {
        const Transition t{.source_clip = source, .target_clip = target, .m = at.first, .n = at.second};
        const auto known = of_plateau.find(plateau);
        if (known == of_plateau.end()) {
          of_plateau.emplace(plateau, t);
        } else if (test::room(database, t) > test::room(database, known->second)) {
          known->second = t;
        }
      }
      std::vector<Transition> ranked;
      for (auto& [plateau, t] : of_plateau) {
        t.cost = std::numeric_limits<double>::infinity();
        for (int L = options.min_half_window; L <= std::min(options.max_half_window, test::room(database, t));
             ++L) {
          const test::Window window = test::window_by_definition(database, matrix, t, L, options);
          if (window.cost >= t.cost || window.peak > max_peak) continue;
          t.half_window = L;
          t.cost = window.cost;
        }
        if (std::isfinite(t.cost)) ranked.push_back(t);
      }
      std::ranges::sort(ranked, {}, [](const Transition& t) { return std::tuple(t.cost, t.m, t.n); });
      std::vector<Transition> kept;
      for (const Transition& t : ranked) {
        const bool is_near = std::ranges::any_of(kept, [&](const Transition& other) {
          return std::abs(t.m - other.m) < options.separation && std::abs(t.n - other.n) < options.separation;
        });
        if (!is_near && static_cast<int>(kept.size()) < options.transitions_per_pair) kept.push_back(t);
      }
      result.insert(result.end(), kept.begin(), kept.end());
    }
  }
  return result;
}

// What is shown of a transition, to the last bit.
auto fields(const Transition& t) {
  return std::tuple(t.source_clip, t.target_clip, t.m, t.n, t.half_window, t.source_from_target.yaw,
                    t.source_from_target.translation.x(), t.source_from_target.translation.y(), t.distortion,
                    t.peak_acceleration, t.cost);
}

void expect_identical(const std::vector<Transition>& a, const std::vector<Transition>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(fields(a[i]), fields(b[i])) << i;
}

PerformanceDatabase short_walks() {
  return database_of({uneven_walk("a", 34, 14.0, 0.0, 1), uneven_walk("b", 27, 11.0, 7.0, 2),
                      uneven_walk("c", 5, 9.0, 3.0, 3)});
}

// Values of any kind for the clips of a database.
DissimilarityMatrix random_matrix(const PerformanceDatabase& database, int levels, unsigned seed) {
  DissimilarityMatrix matrix("random", database);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.0F, 0.3F);
  for (std::size_t a = 0; a < matrix.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < matrix.frame_count(); ++b) {
      const float v = value(random);
      matrix.set(a, b, levels > 0 ? std::floor(v / 0.3F * static_cast<float>(levels)) * 0.1F : v, 0.0F);
    }
  }
  return matrix;
}

// Bounds around exact values: the gap up to `gap` of the value on either side, some exact, some unknown.
DissimilarityMatrix bounds_of(const DissimilarityMatrix& exact, float gap, unsigned seed) {
  DissimilarityMatrix matrix = exact;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> share(0.0F, 1.0F);
  for (std::size_t a = 0; a < exact.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < exact.frame_count(); ++b) {
      const float v = exact.value(a, b);
      const float kind = share(random);
      const float below = share(random);
      const float above = share(random);
      if (kind < 0.2F) continue;
      if (kind < 0.25F) {
        matrix.set(a, b, MatrixEntry());
      } else {
        // Most upper bounds are the value itself, as those of a good guess are.
        matrix.set(a, b, {(1.0F - gap * below) * v, kind < 0.8F ? v : (1.0F + gap * above) * v, 0.0F});
      }
    }
  }
  return matrix;
}

// Answers from an exact matrix and remembers what was asked.
class Oracle {
 public:
  explicit Oracle(const DissimilarityMatrix& exact) : exact_(exact) {}

  ExactEntry answer() {
    return [this](std::size_t a, std::size_t b) {
      EXPECT_LT(a, b);
      const std::lock_guard lock(mutex_);
      EXPECT_TRUE(asked_.emplace(a, b).second) << "asked twice for " << a << ", " << b;
      return exact_.entry(a, b);
    };
  }
  const std::set<Pair>& asked() const { return asked_; }

 private:
  const DissimilarityMatrix& exact_;
  std::mutex mutex_;
  std::set<Pair> asked_;
};

std::vector<TransitionOptions> kinds_of_options() {
  return {{.sample_vertices = 60},
          {.transitions_per_pair = 1, .sample_vertices = 60},
          {.transitions_per_pair = 50, .max_half_window = 6, .separation = 3, .sample_vertices = 20},
          {.criterion = WindowCriterion::paper_sum, .sample_vertices = 60},
          {.min_half_window = 1, .self_min_gap = 1, .acceleration_weight = 0.0, .sample_vertices = 60},
          {.acceleration_weight = 0.1, .profile = BlendProfile::linear, .sample_vertices = 60},
          {.transitions_per_pair = 9, .sample_vertices = 60, .max_pop_ratio = 0.8},
          {.criterion = WindowCriterion::paper_sum, .sample_vertices = 60, .max_pop_ratio = 0.7}};
}

TEST(TransitionSearch, FollowsItsDefinition) {
  const PerformanceDatabase database = short_walks();
  for (const int levels : {-1, 0, 3, 40}) {
    const DissimilarityMatrix matrix =
        levels < 0 ? vertex_dissimilarity(database) : random_matrix(database, levels, 4);
    for (TransitionOptions options : kinds_of_options()) {
      options.sample_vertices = 1 << 20;
      // Sums of few levels tie, and then the order is a matter of the last bit.
      if (levels > 0 &&
          (options.criterion == WindowCriterion::paper_sum || options.acceleration_weight == 0.0))
        continue;
      const std::vector<Transition> expected = transitions_by_definition(database, matrix, options);
      const std::vector<Transition> found = find_transitions(database, matrix, options);
      ASSERT_EQ(found.size(), expected.size());
      EXPECT_FALSE(found.empty());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(std::tie(found[i].source_clip, found[i].target_clip, found[i].m, found[i].n),
                  std::tie(expected[i].source_clip, expected[i].target_clip, expected[i].m, expected[i].n))
            << i;
        EXPECT_NEAR(found[i].cost, expected[i].cost, 2e-5);
      }
    }
  }
}

TEST(TransitionSearch, FindsTheSameFromBounds) {
  const PerformanceDatabase database = short_walks();
  for (const int levels : {-1, 0, 1, 4}) {
    const DissimilarityMatrix exact =
        levels < 0 ? vertex_dissimilarity(database) : random_matrix(database, levels, 5);
    for (const float gap : {0.03F, 1.0F}) {
      const DissimilarityMatrix bounds = bounds_of(exact, gap, 6);
      for (const TransitionOptions& options : kinds_of_options()) {
        DissimilarityMatrix matrix = bounds;
        Oracle oracle(exact);
        const std::vector<Transition> expected = find_transitions(database, exact, options);
        expect_identical(find_transitions(database, matrix, oracle.answer(), options), expected);
        // What was asked for is exact now, all else is as it was.
        for (std::size_t a = 0; a < matrix.frame_count(); ++a) {
          for (std::size_t b = a + 1; b < matrix.frame_count(); ++b) {
            const bool is_asked = oracle.asked().contains({a, b});
            ASSERT_EQ(matrix.entry(a, b), is_asked ? exact.entry(a, b) : bounds.entry(a, b));
            ASSERT_FALSE(is_asked && bounds.is_exact(a, b));
          }
        }
        // And it is enough.
        expect_identical(find_transitions(database, std::as_const(matrix), options), expected);
        Oracle nobody(exact);
        expect_identical(find_transitions(database, matrix, nobody.answer(), options), expected);
        EXPECT_TRUE(nobody.asked().empty());
      }
    }
  }
}

TEST(TransitionSearch, FindsTheSameFromNothingKnown) {
  const PerformanceDatabase database = database_of({uneven_walk("a", 40, 14.0, 0.0, 1)});
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  DissimilarityMatrix matrix("vertex", database);
  Oracle oracle(exact);
  expect_identical(find_transitions(database, matrix, oracle.answer()), find_transitions(database, exact));
}

TEST(TransitionSearch, AsksForFewEntriesIfBoundsAreClose) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  std::size_t last = 0;
  for (const float gap : {0.001F, 0.03F, 0.9F}) {
    DissimilarityMatrix matrix = exact;
    for (std::size_t a = 0; a < exact.frame_count(); ++a) {
      for (std::size_t b = a + 1; b < exact.frame_count(); ++b) {
        matrix.set(a, b, {.lower = (1.0F - gap) * exact.value(a, b), .value = exact.value(a, b)});
      }
    }
    Oracle oracle(exact);
    find_transitions(database, matrix, oracle.answer());
    EXPECT_GE(oracle.asked().size(), last);
    last = oracle.asked().size();
    if (gap < 0.1F) {
      EXPECT_LT(last, exact.pair_count() / 20);
    }
  }
}

TEST(TransitionSearch, OfTheCapturedFindsTheSameFromBounds) {
  REPRISE_REQUIRE_DATA();
  const PerformanceDatabase database = test::ama();
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  DissimilarityMatrix matrix = bounds_of(exact, 0.03F, 7);
  Oracle oracle(exact);
  expect_identical(find_transitions(database, matrix, oracle.answer()), find_transitions(database, exact));
  EXPECT_LT(oracle.asked().size(), exact.pair_count() / 5);
}

TEST(TransitionSearch, AsksForTheSameEntriesForAnyNumberOfThreads) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  std::vector<std::set<Pair>> asked;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    DissimilarityMatrix matrix = bounds_of(exact, 0.1F, 8);
    Oracle oracle(exact);
    find_transitions(database, matrix, oracle.answer());
    asked.push_back(oracle.asked());
  }
  EXPECT_GT(asked[0].size(), 100U);
  EXPECT_EQ(asked[0], asked[1]);
  EXPECT_EQ(asked[0], asked[2]);
}

TEST(TransitionSearch, IsSharedOutByPairsOfClips) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  const DissimilarityMatrix bounds = bounds_of(exact, 0.1F, 9);
  DissimilarityMatrix whole = bounds;
  Oracle oracle(exact);
  const std::vector<Transition> transitions = find_transitions(database, whole, oracle.answer());
  std::set<Pair> asked;
  std::size_t found = 0;
  for (const std::size_t rank : {0, 1}) {
    const auto share = [&](std::size_t a, std::size_t b) {
      EXPECT_LE(a, b);
      return (a + b) % 2 == rank;
    };
    DissimilarityMatrix matrix = bounds;
    Oracle part(exact);
    std::vector<Transition> expected;
    for (const Transition& t : transitions) {
      if ((t.source_clip + t.target_clip) % 2 == rank) expected.push_back(t);
    }
    found += expected.size();
    expect_identical(find_transitions(database, matrix, part.answer(), {}, share), expected);
    asked.insert(part.asked().begin(), part.asked().end());
  }
  EXPECT_EQ(found, transitions.size());
  EXPECT_EQ(asked, oracle.asked());
}

TEST(TransitionSearch, RefusesBoundsThatLeaveItUndecided) {
  const PerformanceDatabase database = walks();
  const auto message = [&](const DissimilarityMatrix& matrix) {
    try {
      find_transitions(database, matrix);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message(DissimilarityMatrix("vertex", database)), HasSubstr("undecided"));
  EXPECT_THAT(message(bounds_of(vertex_dissimilarity(database), 0.1F, 10)),
              HasSubstr("compute it with these transition options"));
}

TEST(TransitionSearch, RefusesAnswersThatCannotBe) {
  const PerformanceDatabase database = walks();
  const DissimilarityMatrix exact = vertex_dissimilarity(database);
  const auto message = [&](const ExactEntry& answer) {
    DissimilarityMatrix matrix = bounds_of(exact, 0.1F, 11);
    try {
      find_transitions(database, matrix, answer);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // Bounds instead of a value.
  EXPECT_THAT(message([&](std::size_t a, std::size_t b) {
                return MatrixEntry{.lower = 0.99F * exact.value(a, b), .value = exact.value(a, b)};
              }),
              HasSubstr("expected one value from"));
  // Nothing at all, and a value no metric gives.
  EXPECT_THAT(message([](std::size_t, std::size_t) { return MatrixEntry(); }),
              HasSubstr("expected one value"));
  EXPECT_THAT(message([](std::size_t, std::size_t) {
                return MatrixEntry{.lower = std::nanf(""), .value = std::nanf("")};
              }),
              HasSubstr("expected one value"));
  // Outside the bounds.
  EXPECT_THAT(message([&](std::size_t a, std::size_t b) {
                return MatrixEntry{.lower = 2.0F * exact.value(a, b), .value = 2.0F * exact.value(a, b)};
              }),
              HasSubstr("expected one value"));
}

TEST(TransitionSearch, PassesOnWhatTheAnswerThrows) {
  const PerformanceDatabase database = walks();
  DissimilarityMatrix matrix = bounds_of(vertex_dissimilarity(database), 0.1F, 12);
  EXPECT_THROW(
      find_transitions(database, matrix, [](std::size_t, std::size_t) -> MatrixEntry { throw Cancelled(); }),
      Cancelled);
}

}  // namespace
}  // namespace reprise
