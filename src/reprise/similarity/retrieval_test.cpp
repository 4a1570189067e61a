// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/retrieval.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reprise {
namespace {

// Distances 1, 2, 3, ... in the order given.
std::vector<RankedFrame> in_order(const std::vector<bool>& alike) {
  std::vector<RankedFrame> frames;
  for (const bool is_alike : alike)
    frames.push_back({.distance = static_cast<float>(frames.size() + 1), .is_alike = is_alike});
  return frames;
}

TEST(RankQuality, OfASmallOrderByHand) {
  // Alike at ranks 1, 3 and 4: precisions 1, 2/3 and 3/4.
  const RetrievalQuality quality = rank_quality(in_order({true, false, true, true, false}));
  EXPECT_EQ(quality.queries, 1U);
  EXPECT_NEAR(quality.average_precision, (1.0 + 2.0 / 3.0 + 3.0 / 4.0) / 3.0, 1e-12);
  EXPECT_NEAR(quality.chance, 3.0 / 5.0, 1e-12);
  EXPECT_NEAR(quality.roc_area, 4.0 / 6.0, 1e-12) << "4 of the 6 pairs (alike, not alike) are in order";
  EXPECT_NEAR(quality.precision[0], 1.0, 1e-12) << "recall 0.05";
  EXPECT_NEAR(quality.precision[5], 1.0, 1e-12) << "recall 0.30";
  EXPECT_NEAR(quality.precision[6], 0.75, 1e-12) << "recall 0.35: 3/4 at full recall beats 2/3";
  EXPECT_NEAR(quality.precision[19], 0.75, 1e-12) << "recall 1";
}

TEST(RankQuality, APerfectOrderHasPrecisionOneAndAReversedOneTheWorst) {
  for (const std::size_t alike : {1U, 4U, 9U}) {
    const std::size_t total = 10;
    std::vector<bool> perfect(total);
    std::fill_n(perfect.begin(), alike, true);
    const RetrievalQuality best = rank_quality(in_order(perfect));
    EXPECT_NEAR(best.average_precision, 1.0, 1e-12);
    EXPECT_EQ(best.roc_area, 1.0);
    for (const double precision : best.precision) EXPECT_EQ(precision, 1.0);

    std::vector<bool> reversed(perfect.rbegin(), perfect.rend());
    const RetrievalQuality worst = rank_quality(in_order(reversed));
    double expected = 0.0;
    for (std::size_t i = 1; i <= alike; ++i)
      expected += static_cast<double>(i) / static_cast<double>((total - alike + i) * alike);
    EXPECT_NEAR(worst.average_precision, expected, 1e-12);
    EXPECT_EQ(worst.roc_area, 0.0);
    // No order of the same frames is below it.
    std::mt19937 random(3);
    for (int round = 0; round < 50; ++round) {
      std::shuffle(perfect.begin(), perfect.end(), random);
      const RetrievalQuality some = rank_quality(in_order(perfect));
      EXPECT_GE(some.average_precision, worst.average_precision - 1e-12);
      EXPECT_LE(some.average_precision, 1.0 + 1e-12);
      EXPECT_TRUE(std::ranges::is_sorted(some.precision, std::greater<>()));
    }
  }
}

TEST(RankQuality, DoesNotDependOnTheOrderOfEqualDistances) {
  std::vector<RankedFrame> frames = {{1.0F, true}, {2.0F, true},  {2.0F, false},   {2.0F, false},
                                     {3.0F, true}, {3.0F, false}, {INFINITY, true}};
  const RetrievalQuality quality = rank_quality(frames);
  // Steps: 1 of 1, 2 of 4, 3 of 6, 4 of 7.
  EXPECT_NEAR(quality.average_precision, 0.25 * (1.0 + 2.0 / 4.0 + 3.0 / 6.0 + 4.0 / 7.0), 1e-12);
  std::reverse(frames.begin(), frames.end());
  EXPECT_EQ(rank_quality(frames).average_precision, quality.average_precision);
  EXPECT_EQ(rank_quality(frames).roc_area, quality.roc_area);
}

TEST(RankQuality, ByLotIsChance) {
  std::mt19937 random(5);
  std::vector<bool> alike(400);
  std::fill_n(alike.begin(), 100, true);
  double mean = 0.0;
  double roc = 0.0;
  const int rounds = 300;
  for (int round = 0; round < rounds; ++round) {
    std::shuffle(alike.begin(), alike.end(), random);
    const RetrievalQuality quality = rank_quality(in_order(alike));
    mean += quality.average_precision / rounds;
    roc += quality.roc_area / rounds;
  }
  EXPECT_NEAR(mean, 0.25, 0.02);
  EXPECT_NEAR(roc, 0.5, 0.01);
}

TEST(RankQuality, NothingOrEverythingAlikeIsNoQuery) {
  EXPECT_EQ(rank_quality({}).queries, 0U);
  EXPECT_EQ(rank_quality(in_order({true, true})).queries, 0U);
  EXPECT_EQ(rank_quality(in_order({false, false})).queries, 0U);
}

// Six frames on a line at the whole numbers; alike: no farther than 1.
TEST(RetrievalQuality, IsTheMeanOverAllQueriesThatCanBeJudged) {
  DissimilarityMatrix line("vertex", "key", {"a"}, {6});
  DissimilarityMatrix inverted("vertex", "key", {"a"}, {6});
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = a + 1; b < 6; ++b) {
      line.set(a, b, static_cast<float>(b - a), 0.0F);
      inverted.set(a, b, static_cast<float>(10 - (b - a)), 0.0F);
    }
  }
  const auto near = [](std::size_t a, std::size_t b) -> std::optional<bool> {
    return std::max(a, b) - std::min(a, b) <= 1;
  };
  const RetrievalQuality best = retrieval_quality(line, near);
  EXPECT_EQ(best.queries, 6U);
  EXPECT_EQ(best.average_precision, 1.0);
  EXPECT_NEAR(best.chance, (2 * 1 + 4 * 2) / 30.0, 1e-12);
  // Alike frames come last: 1 of 5 at the ends; in between both at once, 2 of 5.
  EXPECT_NEAR(retrieval_quality(inverted, near).average_precision, (2 * 0.2 + 4 * 0.4) / 6.0, 1e-12);

  const auto not_the_first = [&](std::size_t a, std::size_t b) -> std::optional<bool> {
    if (a == 0 || b == 0) return std::nullopt;
    return near(a, b);
  };
  EXPECT_EQ(retrieval_quality(line, not_the_first).queries, 5U);
}

}  // namespace
}  // namespace reprise
