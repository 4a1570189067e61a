// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/matrix_search.h"

#include <atomic>
#include <fstream>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

// A number in [0, 1) that looks random and depends on its arguments alone.
float noise(std::size_t a, std::size_t b, std::size_t c) {
  std::uint64_t x = (a * 1'000'003U + b) * 1'000'003U + c + 12345U;
  for (int round = 0; round < 3; ++round) {
    x ^= x >> 33U;
    x *= 0xff51afd7ed558ccdU;
  }
  return static_cast<float>(x >> 40U) / static_cast<float>(1U << 24U);
}

// The vertex metric behind bounds, some of them tight. As with a warm start, bounds depend on the run they
// are made in; what comes out of a search may not.
class FakeMetric {
 public:
  explicit FakeMetric(const PerformanceDatabase& database) : exact_(vertex_dissimilarity(database)) {}

  const DissimilarityMatrix& exact() const { return exact_; }

  // Raises the flag of Ctrl-C at this call of either function.
  void interrupt_at(int call) { countdown_ = call; }
  int bound_calls() const { return bound_calls_; }
  int bounded_pairs() const { return bounded_pairs_; }
  int exact_calls() const { return exact_calls_; }

  BoundedMetric functions() {
    return {.bound_tile =
                [this](const FrameTile& tile, std::span<MatrixEntry> out) {
                  SearchStatistics statistics;
                  for (std::size_t a = tile.a_first; a < tile.a_last; ++a) {
                    for (std::size_t b = std::max(a + 1, tile.b_first); b < tile.b_last; ++b) {
                      const MatrixEntry truth = exact_.entry(a, b);
                      const float slack =
                          noise(a, b, tile.a_first) < 0.3F ? 0.0F : 0.3F * noise(a, tile.b_first, b);
                      out[(a - tile.a_first) * (tile.b_last - tile.b_first) + b - tile.b_first] = {
                          .lower = truth.value * (1.0F - slack),
                          .value = truth.value * (1.0F + 0.5F * slack),
                          .yaw = truth.yaw};
                      ++statistics.exact_solves;
                      ++bounded_pairs_;
                    }
                  }
                  ++bound_calls_;
                  count();
                  return statistics;
                },
            .exact =
                [this](std::size_t a, std::size_t b, SearchStatistics& statistics) {
                  ++statistics.exact_solves;
                  ++exact_calls_;
                  count();
                  return exact_.entry(a, b);
                }};
  }

 private:
  void count() {
    if (--countdown_ == 0) set_interrupted(true);
  }

  DissimilarityMatrix exact_;
  std::atomic<int> countdown_{0};
  std::atomic<int> bound_calls_{0};
  std::atomic<int> bounded_pairs_{0};
  std::atomic<int> exact_calls_{0};
};

struct Outcome {
  DissimilarityMatrix matrix;
  std::vector<Transition> transitions;
  SearchStatistics statistics;
};

void expect_same(const DissimilarityMatrix& a, const DissimilarityMatrix& b) {
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (std::size_t m = 0; m < a.frame_count(); ++m) {
    for (std::size_t n = m + 1; n < a.frame_count(); ++n) ASSERT_EQ(a.entry(m, n), b.entry(m, n));
  }
}

void expect_same(const std::vector<Transition>& a, const std::vector<Transition>& b) {
  const auto key = [](const Transition& t) {
    return std::tuple(t.source_clip, t.target_clip, t.m, t.n, t.half_window, t.cost);
  };
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t t = 0; t < a.size(); ++t) EXPECT_EQ(key(a[t]), key(b[t])) << "transition " << t;
}

class MatrixSearchTest : public ::testing::Test {
 protected:
  MatrixSearchTest() {
    database_.add(test::walk("slow", 70, 0.03, 20.0));
    database_.add(test::walk("fast", 50, 0.06, 17.0, 7.0));
    database_.add(test::walk("single", 1));
  }
  ~MatrixSearchTest() override { set_interrupted(false); }

  fs::path file() const { return folder_ / "cache" / "fake.matrix"; }

  // A whole run, as the stage makes it.
  Outcome run(FakeMetric& metric, bool exact = false) const {
    Outcome outcome{.matrix = DissimilarityMatrix("fake", database_)};
    MatrixStore store(file(), outcome.matrix.key());
    std::vector<PairEntry> found;
    if (store.load(outcome.matrix)) found = store.load_found(database_.frame_count());
    MatrixSearch search(metric.functions(), outcome.matrix, store);
    if (exact) {
      search.make_all_exact(found);
    } else {
      search.bound_all();
    }
    outcome.transitions = search.find(database_, {}, found);
    outcome.statistics = search.statistics();
    return outcome;
  }

  PerformanceDatabase database_;
  test::TemporaryFolder folder_;
};

TEST_F(MatrixSearchTest, DecidesTheTransitionsOfTheExactMatrix) {
  FakeMetric metric(database_);
  const Outcome outcome = run(metric);
  expect_same(outcome.transitions, find_transitions(database_, metric.exact()));
  EXPECT_EQ(outcome.matrix.unknown_count(), 0U);
  EXPECT_EQ(outcome.statistics.exact_solves,
            outcome.matrix.pair_count() + static_cast<std::size_t>(metric.exact_calls()));
  EXPECT_LT(metric.exact_calls(), static_cast<int>(outcome.matrix.pair_count())) << "not by computing all";
  for (std::size_t a = 0; a < outcome.matrix.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < outcome.matrix.frame_count(); ++b) {
      const MatrixEntry entry = outcome.matrix.entry(a, b);
      const float truth = metric.exact().value(a, b);
      ASSERT_LE(entry.lower, truth);
      ASSERT_GE(entry.value, truth);
      if (entry.is_exact()) {
        ASSERT_EQ(entry, metric.exact().entry(a, b));
      }
    }
  }
}

TEST_F(MatrixSearchTest, HasTheSameBitsForAnyNumberOfThreads) {
  std::vector<Outcome> outcomes;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    fs::remove_all(file().parent_path());
    FakeMetric metric(database_);
    outcomes.push_back(run(metric));
  }
  for (const Outcome& other : outcomes) {
    expect_same(outcomes[0].matrix, other.matrix);
    expect_same(outcomes[0].transitions, other.transitions);
    EXPECT_EQ(outcomes[0].statistics.exact_solves, other.statistics.exact_solves);
  }
}

// Stopped at many places, in both phases, the work goes on where it was, to the same bits.
TEST_F(MatrixSearchTest, ContinuesAfterEveryStop) {
  FakeMetric whole(database_);
  const Outcome expected = run(whole);
  fs::remove_all(file().parent_path());
  std::set<bool> phases;  // stops with unknown pairs left, and without
  for (const int step : {1, 20, 47}) {
    fs::remove_all(file().parent_path());
    FakeMetric metric(database_);
    int stops = 0;
    while (true) {
      metric.interrupt_at(step + 20 * stops);
      try {
        const Outcome outcome = run(metric);
        expect_same(outcome.matrix, expected.matrix);
        expect_same(outcome.transitions, expected.transitions);
        break;
      } catch (const Cancelled&) {
        set_interrupted(false);
        ++stops;
        const DissimilarityMatrix kept = DissimilarityMatrix::load(file());
        phases.insert(kept.unknown_count() > 0);
      }
    }
    metric.interrupt_at(0);
    EXPECT_GT(stops, 1);
    // A stop costs at most the work that each thread had in hand.
    const FrameTile tile = ShapeColorMetric::tiles(metric.exact().clip_frame_counts()).front();
    const auto in_hand = static_cast<int>(16 * (tile.a_last - tile.a_first) * (tile.b_last - tile.b_first));
    EXPECT_LE(metric.bounded_pairs(), whole.bounded_pairs() + stops * in_hand);
    EXPECT_LE(metric.exact_calls(), whole.exact_calls() + stops * in_hand);
    EXPECT_EQ(std::distance(fs::directory_iterator(file().parent_path()), {}), 1)
        << "only the matrix is left";
  }
  EXPECT_EQ(phases.size(), 2U) << "both phases were stopped";
}

TEST_F(MatrixSearchTest, MakesAllExactFromWhereADefaultRunEnded) {
  FakeMetric metric(database_);
  const Outcome bounded = run(metric);
  FakeMetric rest(database_);
  const Outcome exact = run(rest, true);
  expect_same(exact.matrix, metric.exact());
  expect_same(exact.transitions, bounded.transitions);
  EXPECT_EQ(static_cast<std::size_t>(rest.exact_calls()),
            bounded.matrix.pair_count() - bounded.matrix.exact_count());
  // And at once, in an empty folder; stopped twice.
  fs::remove_all(file().parent_path());
  FakeMetric at_once(database_);
  for (const int call : {50, 3000}) {
    at_once.interrupt_at(call);
    EXPECT_THROW(run(at_once, true), Cancelled);
    set_interrupted(false);
  }
  expect_same(run(at_once, true).matrix, metric.exact());
}

TEST_F(MatrixSearchTest, ARunThatIsThereIsOnlyRefinedFurther) {
  FakeMetric metric(database_);
  const Outcome first = run(metric);
  FakeMetric again(database_);
  const Outcome second = run(again);
  EXPECT_EQ(again.bounded_pairs() + again.exact_calls(), 0);
  expect_same(second.matrix, first.matrix);
  expect_same(second.transitions, first.transitions);
}

TEST_F(MatrixSearchTest, DamagedFilesAreComputedAnew) {
  FakeMetric whole(database_);
  const Outcome expected = run(whole);
  // Stopped within the search for transitions, so that both kinds of files are there.
  const auto stop_late = [&] {
    fs::remove_all(file().parent_path());
    FakeMetric metric(database_);
    metric.interrupt_at(whole.bound_calls() + whole.exact_calls() / 2);
    EXPECT_THROW(run(metric), Cancelled);
    set_interrupted(false);
    const fs::path found = file().string() + ".found-0";
    EXPECT_TRUE(fs::exists(found)) << "the test wants a stop in the second phase";
    return found;
  };
  const auto expect_anew = [&] {
    FakeMetric metric(database_);
    const Outcome outcome = run(metric);
    expect_same(outcome.matrix, expected.matrix);
    expect_same(outcome.transitions, expected.transitions);
    return metric.exact_calls() + metric.bounded_pairs();
  };
  // Found entries: cut short, of another program.
  fs::path found = stop_late();
  fs::resize_file(found, fs::file_size(found) / 2);
  EXPECT_EQ(expect_anew(), whole.exact_calls());
  found = stop_late();
  std::ofstream(found) << "shopping list";
  EXPECT_EQ(expect_anew(), whole.exact_calls());
  // The matrix.
  stop_late();
  fs::resize_file(file(), fs::file_size(file()) / 2);
  EXPECT_EQ(expect_anew(), whole.exact_calls() + whole.bounded_pairs());
  stop_late();
  std::ofstream(file()) << "shopping list";
  EXPECT_EQ(expect_anew(), whole.exact_calls() + whole.bounded_pairs());
}

TEST_F(MatrixSearchTest, AMatrixOfAnotherKeyIsNotUsed) {
  FakeMetric metric(database_);
  run(metric);
  DissimilarityMatrix matrix("fake", database_);
  matrix.set_key("other");
  MatrixStore store(file(), "other");
  EXPECT_FALSE(store.load(matrix));
  EXPECT_EQ(matrix.unknown_count(), matrix.pair_count());
  EXPECT_EQ(matrix.key(), "other");
  EXPECT_EQ(matrix.clip_frame_counts(), DissimilarityMatrix("fake", database_).clip_frame_counts());
}

TEST_F(MatrixSearchTest, WhatCannotBeKeptIsStillComputed) {
  FakeMetric whole(database_);
  const Outcome expected = run(whole);
  fs::remove_all(file().parent_path());
  std::ofstream(file().parent_path()) << "a file where the folder should be";
  FakeMetric metric(database_);
  expect_same(run(metric).transitions, expected.transitions);
}

TEST_F(MatrixSearchTest, ErrorsOfTheMetricPassAndKeepWhatIsDone) {
  FakeMetric metric(database_);
  BoundedMetric functions = metric.functions();
  functions.bound_tile = [bound = functions.bound_tile](const FrameTile& tile, std::span<MatrixEntry> out) {
    if (tile.a_first <= 60 && 60 < tile.a_last) throw Error("frame 60 is bad");
    return bound(tile, out);
  };
  DissimilarityMatrix matrix("fake", database_);
  MatrixStore store(file(), matrix.key());
  MatrixSearch search(functions, matrix, store);
  EXPECT_THROW(search.bound_all(), Error);
  const DissimilarityMatrix kept = DissimilarityMatrix::load(file());
  EXPECT_GT(kept.unknown_count(), 0U);
  EXPECT_LT(kept.unknown_count(), kept.pair_count());
}

}  // namespace
}  // namespace reprise
