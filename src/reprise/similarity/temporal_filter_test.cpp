// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/temporal_filter.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr std::size_t frame_count = 23;  // of all three clips

DissimilarityMatrix random_matrix(float gap) {
  DissimilarityMatrix matrix("vertex", "key", {"a", "b", "c"}, {9, 4, 10});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(0.1F, 1.0F);
  for (std::size_t a = 0; a < frame_count; ++a) {
    for (std::size_t b = a + 1; b < frame_count; ++b) {
      const float v = value(random);
      matrix.set(a, b, {.lower = (1.0F - gap) * v, .value = v, .yaw = value(random)});
    }
  }
  return matrix;
}

TEST(TemporalFilter, OfTheShortestWindowChangesNothing) {
  const DissimilarityMatrix matrix = random_matrix(0.1F);
  const DissimilarityMatrix filtered = temporally_filtered(matrix, 1);
  for (std::size_t a = 0; a < frame_count; ++a) {
    for (std::size_t b = 0; b < frame_count; ++b) EXPECT_EQ(filtered.entry(a, b), matrix.entry(a, b));
  }
}

TEST(TemporalFilter, AveragesAlongTheWindowWithTheWeightsOfEquation2) {
  const DissimilarityMatrix matrix = random_matrix(0.1F);
  const DissimilarityMatrix filtered = temporally_filtered(matrix, 3);
  // Frames 4 of "a" and 5 of "c": alpha'(k) = 0, 1/6, 1/3, 1/2, 1/3, 1/6, 0.
  const std::size_t a = 4;
  const std::size_t b = matrix.first_frame(2) + 5;
  const auto expected = [&](auto bound) {
    return (0.5 * bound(a, b) + (bound(a - 1, b - 1) + bound(a + 1, b + 1)) / 3.0 +
            (bound(a - 2, b - 2) + bound(a + 2, b + 2)) / 6.0) /
           1.5;
  };
  EXPECT_NEAR(filtered.value(a, b),
              expected([&](auto i, auto j) { return static_cast<double>(matrix.value(i, j)); }), 1e-6);
  EXPECT_NEAR(filtered.lower_bound(a, b),
              expected([&](auto i, auto j) { return static_cast<double>(matrix.lower_bound(i, j)); }), 1e-6);
  EXPECT_EQ(filtered.yaw(a, b), matrix.yaw(a, b));
}

TEST(TemporalFilter, LeavesOutWhatLiesBeyondEitherClip) {
  const DissimilarityMatrix matrix = random_matrix(0.0F);
  const DissimilarityMatrix filtered = temporally_filtered(matrix, 2);
  // The first frame of "b" and a middle one of "c": nothing before.
  const std::size_t a = matrix.first_frame(1);
  const std::size_t b = matrix.first_frame(2) + 5;
  EXPECT_NEAR(filtered.value(a, b),
              (0.5 * static_cast<double>(matrix.value(a, b)) +
               0.25 * static_cast<double>(matrix.value(a + 1, b + 1))) /
                  0.75,
              1e-6);
  // The first frame of one and the last of the other: nothing beside it.
  const std::size_t last = frame_count - 1;
  EXPECT_EQ(filtered.value(a, last), matrix.value(a, last));
}

TEST(TemporalFilter, KeepsAConstantAndStaysWithinItsExtremes) {
  DissimilarityMatrix constant("vertex", "key", {"a", "b"}, {12, 8});
  for (std::size_t a = 0; a < 20; ++a) {
    for (std::size_t b = a + 1; b < 20; ++b) constant.set(a, b, 0.25F, 0.0F);
  }
  const DissimilarityMatrix same = temporally_filtered(constant, 5);
  EXPECT_EQ(same.exact_count(), same.pair_count());
  const DissimilarityMatrix matrix = random_matrix(0.1F);
  const DissimilarityMatrix filtered = temporally_filtered(matrix, 5);
  for (std::size_t a = 0; a < 20; ++a) {
    for (std::size_t b = a + 1; b < 20; ++b) {
      EXPECT_EQ(same.value(a, b), 0.25F);
      EXPECT_GT(filtered.value(a, b), 0.1F);
      EXPECT_LT(filtered.value(a, b), 1.0F);
      EXPECT_LT(filtered.lower_bound(a, b), filtered.value(a, b));
    }
  }
}

TEST(TemporalFilter, OfSomethingUnknownIsUnknown) {
  DissimilarityMatrix matrix = random_matrix(0.0F);
  matrix.set(2, 15, MatrixEntry());
  const DissimilarityMatrix filtered = temporally_filtered(matrix, 2);
  for (std::size_t k = 1; k <= 3; ++k) {
    EXPECT_EQ(filtered.value(k, 13 + k), std::numeric_limits<float>::infinity());
    EXPECT_TRUE(std::isfinite(filtered.lower_bound(k, 13 + k)));
  }
  EXPECT_EQ(filtered.unknown_count(), 3U);
}

TEST(TemporalFilter, IsNotMistakenForTheMatrixItself) {
  const DissimilarityMatrix matrix = random_matrix(0.0F);
  EXPECT_NE(temporally_filtered(matrix, 2).key(), matrix.key());
  EXPECT_NE(temporally_filtered(matrix, 2).key(), temporally_filtered(matrix, 3).key());
  EXPECT_EQ(temporally_filtered(DissimilarityMatrix(), 2).frame_count(), 0U);
}

TEST(TemporalFilter, RefusesAnEmptyWindow) {
  EXPECT_THROW(temporally_filtered(random_matrix(0.0F), 0), InvalidArgument);
}

}  // namespace
}  // namespace reprise
