// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/route_line.h"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace reprise::path_detail {
namespace {

// The point of a line so many metres along it.
Eigen::Vector2d point_at(const std::vector<Eigen::Vector2d>& points, double at) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double stretch = (points[i] - points[i - 1]).norm();
    if (at <= stretch || i + 1 == points.size())
      return points[i - 1] + at / stretch * (points[i] - points[i - 1]);
    at -= stretch;
  }
  return points.back();
}

TEST(RouteLine, TheMarkerIsTheNearestPointThatItMayMoveTo) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> real(-2.0, 2.0);
  for (int i = 0; i < 300; ++i) {
    std::vector<Eigen::Vector2d> points;
    for (int k = 0; k < 5; ++k) points.emplace_back(real(random), real(random));
    const RouteLine line(points);
    const double marker = line.length() * std::abs(real(random)) / 2.0;
    const Eigen::Vector2d center(real(random), real(random));
    const RouteLine::Match match = line.follow(marker, center);
    EXPECT_GE(match.marker, marker - 1e-12);
    EXPECT_LE(match.marker, std::min(marker + RouteLine::look_ahead, line.length()) + 1e-12);
    EXPECT_NEAR(match.deviation, (center - point_at(points, match.marker)).norm(), 1e-9);
    for (int k = 0; k <= 200; ++k) {
      const double other = std::min(marker + RouteLine::look_ahead * k / 200.0, line.length());
      EXPECT_LE(match.deviation, (center - point_at(points, other)).norm() + 1e-9);
    }
  }
}

TEST(RouteLine, OnTheLineNothingIsLeftOfItAtTheEnd) {
  const std::vector<Eigen::Vector2d> points{{0.0, 0.0}, {0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}, {-1.0, -2.0}};
  const RouteLine line(points);
  EXPECT_NEAR(line.length(), 5.0 + std::sqrt(32.0), 1e-12);
  const std::vector<Eigen::Vector2d> distinct(points.begin() + 1, points.end());
  RouteLine::Match match;
  for (double at = 0.0; at < line.length(); at += 0.05) {
    match = line.follow(match.marker, point_at(distinct, at));
    EXPECT_NEAR(match.deviation, 0.0, 1e-9);
    // Past the crossing at (1, 0) too, where two points of the line are as near.
    EXPECT_NEAR(match.marker, at, 1e-9);
  }
}

TEST(RouteLine, MovingLineAndPerformerTogetherChangesNothing) {
  const std::vector<Eigen::Vector2d> points{{0.0, 0.0}, {1.0, 3.0}, {4.0, 3.5}};
  std::vector<Eigen::Vector2d> moved;
  const Eigen::Rotation2Dd turn(0.7);
  const Eigen::Vector2d shift(5.0, -3.0);
  for (const Eigen::Vector2d& point : points) moved.emplace_back(turn * point + shift);
  const Eigen::Vector2d center(0.9, 2.0);
  const RouteLine::Match before = RouteLine(points).follow(0.5, center);
  const RouteLine::Match after = RouteLine(moved).follow(0.5, turn * center + shift);
  EXPECT_NEAR(before.marker, after.marker, 1e-9);
  EXPECT_NEAR(before.deviation, after.deviation, 1e-9);
}

}  // namespace
}  // namespace reprise::path_detail
