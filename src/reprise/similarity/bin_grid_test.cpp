// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/bin_grid.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;

std::string message_of(const HistogramOptions& options) {
  try {
    validate(options);
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "";
}

TEST(BinGrid, PointsAreTheCentroidsOfTheCells) {
  const HistogramOptions options{.radius_bins = 3, .polar_bins = 4, .azimuth_bins = 6};
  const BinGrid grid(options, 0.9, {{0, 0, 0}});
  std::vector<Eigen::Vector3d> sums(static_cast<std::size_t>(grid.cell_count()), Eigen::Vector3d::Zero());
  std::vector<int> counts(sums.size());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-0.9, 0.9);
  for (int k = 0; k < 2'000'000; ++k) {
    const Eigen::Vector3d p(coordinate(random), coordinate(random), coordinate(random));
    const double radius = p.norm();
    if (radius >= 0.9) continue;
    const double phi = std::atan2(p.x(), p.z());
    const int r = static_cast<int>(radius / 0.3);
    const int theta = static_cast<int>(std::acos(p.y() / radius) / (std::numbers::pi / 4.0));
    const int azimuth =
        static_cast<int>((phi < 0.0 ? phi + 2.0 * std::numbers::pi : phi) / (std::numbers::pi / 3.0));
    const auto cell = static_cast<std::size_t>((r * 4 + std::min(theta, 3)) * 6 + std::min(azimuth, 5));
    sums[cell] += p;
    ++counts[cell];
  }
  for (int cell = 0; cell < grid.cell_count(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    ASSERT_GT(counts[c], 300);
    // Three standard errors of a cell 0.3 m wide.
    EXPECT_LT((sums[c] / counts[c] - grid.cell_point(cell)).norm(), 3.0 * 0.3 / std::sqrt(counts[c]))
        << "cell " << cell;
  }
}

TEST(BinGrid, DistancesAreAMetric) {
  std::vector<BinGrid::ColorBin> palette;
  for (std::uint16_t k = 0; k < 10; ++k)
    palette.push_back({k, k, 0});  // on a line: the hard case of rounding
  const BinGrid grid({}, 0.95, palette);
  std::mt19937 random(2);
  std::uniform_int_distribution<BinId> any(0, grid.cell_count() * grid.color_count() - 1);
  for (int k = 0; k < 300'000; ++k) {
    // In one cell every other time, so that only colours differ.
    const BinId a = any(random);
    const BinId b = k % 2 == 0 ? any(random) : grid.bin(grid.cell_of(a), grid.color_of(any(random)));
    const BinId c = k % 2 == 0 ? any(random) : grid.bin(grid.cell_of(a), grid.color_of(any(random)));
    ASSERT_EQ(grid.distance(a, a), 0);
    ASSERT_EQ(grid.distance(a, b), grid.distance(b, a));
    ASSERT_LE(grid.distance(a, c), grid.distance(a, b) + grid.distance(b, c));
  }
}

TEST(BinGrid, DistanceIsThatOfPositionsAndScaledColors) {
  const HistogramOptions options{.color_bins = {10, 5, 1}, .meters_per_color = 0.4};
  const BinGrid grid(options, 0.95, {{0, 0, 0}, {3, 4, 0}});
  const BinId a = grid.bin(17, 0);
  const BinId b = grid.bin(640, 1);
  const double color = 0.4 * std::hypot(0.3, 0.8);
  const double expected = std::hypot((grid.cell_point(17) - grid.cell_point(640)).norm(), color);
  EXPECT_NEAR(grid.distance(a, b) * BinGrid::distance_unit, expected, 2e-6);
}

TEST(BinGrid, ManyDistancesAreThoseOneByOne) {
  const BinGrid grid({}, 0.95, {{0, 0, 0}, {1, 2, 3}, {9, 9, 9}});
  std::vector<BinGrid::Place> places;
  for (BinId bin = 0; bin < 777; ++bin) places.push_back(grid.place(3 * bin));
  std::vector<std::int32_t> distances(places.size());
  grid.distances(1234, places, distances.data());
  for (BinId bin = 0; bin < 777; ++bin) {
    ASSERT_EQ(distances[static_cast<std::size_t>(bin)], grid.distance(1234, 3 * bin));
  }
}

TEST(BinGrid, RefusesBadOptions) {
  EXPECT_EQ(message_of({}), "");
  EXPECT_THAT(message_of({.radius_bins = 0}), HasSubstr("radius_bins is 0, expected 1 to"));
  EXPECT_THAT(message_of({.azimuth_bins = 21}), HasSubstr("azimuth_bins is 21, expected an even number"));
  EXPECT_THAT(message_of({.color_bins = {10, 300, 10}}), HasSubstr("color_bins is 300"));
  EXPECT_THAT(message_of({.radius_bins = 100, .polar_bins = 100}),
              HasSubstr("100 x 100 x 20 bins of space are 200000 cells, expected at most 8192"));
  EXPECT_THAT(message_of({.azimuth_refinement = 1000}),
              HasSubstr("azimuth_bins x azimuth_refinement is 20000"));
  EXPECT_THAT(message_of({.voxel_size = 0.0}), HasSubstr("voxel_size is 0"));
  EXPECT_THAT(message_of({.voxel_size = std::nan("")}), HasSubstr("voxel_size is nan"));
  EXPECT_THAT(message_of({.meters_per_color = -1.0}), HasSubstr("meters_per_color is -1"));
}

TEST(BinGrid, RefusesABadPaletteOrSize) {
  EXPECT_THROW(BinGrid({}, 0.0, {{0, 0, 0}}), InvalidArgument);
  EXPECT_THROW(BinGrid({}, 170.0, {{0, 0, 0}}), InvalidArgument);
  EXPECT_THROW(BinGrid({}, 1.0, {}), InvalidArgument);
  EXPECT_THROW(BinGrid({}, 1.0, {{1, 0, 0}, {0, 0, 0}}), InvalidArgument);
  EXPECT_THROW(BinGrid({}, 1.0, {{0, 0, 0}, {0, 0, 0}}), InvalidArgument);
  EXPECT_THROW(BinGrid({}, 1.0, {{10, 0, 0}}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
