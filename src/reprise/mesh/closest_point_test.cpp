// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<Eigen::Vector3d> points_of(const test::Shape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (Eigen::Index i = 0; i < shape.positions.rows(); ++i)
    points.push_back(shape.positions.row(i).cast<double>().transpose());
  return points;
}

std::vector<Eigen::Vector3d> random_points(int count) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> coordinate(-2.0, 2.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double x = coordinate(generator), y = coordinate(generator), z = coordinate(generator);
    points.emplace_back(x, y, z);
  }
  return points;
}

TEST(ClosestWeights, BeatEveryOtherPointOfTheTriangle) {
  const Eigen::Vector3d a(0.1, 0.0, 0.3), b(1.0, 0.2, -0.1), c(0.3, 0.9, 0.4);
  for (const Eigen::Vector3d& query : random_points(300)) {
    const Eigen::Vector3d w = closest_weights(query, a, b, c);
    EXPECT_NEAR(w.sum(), 1.0, 1e-12);
    EXPECT_GE(w.minCoeff(), -1e-12);
    const double distance = (w[0] * a + w[1] * b + w[2] * c - query).norm();
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Eigen::Vector3d other = (i * a + j * b + (20 - i - j) * c) / 20.0;
        EXPECT_LE(distance, (other - query).norm() + 1e-12);
      }
    }
  }
}

TEST(ClosestPointTree, AgreesWithTryingEveryTriangle) {
  const test::Shape body = test::body();
  const std::vector<Eigen::Vector3d> points = points_of(body);
  const ClosestPointTree tree(points, body.topology->triangles);
  const Eigen::Vector3d up(0.2, 1.0, 0.1);
  for (const Eigen::Vector3d& query : random_points(200)) {
    double best = 1e9, best_facing = 1e9;
    for (std::size_t t = 0; t < tree.triangles().size(); ++t) {
      const Triangle& corners = tree.triangles()[t];
      const Eigen::Vector3d w =
          closest_weights(query, points[corners[0]], points[corners[1]], points[corners[2]]);
      const double distance =
          (w[0] * points[corners[0]] + w[1] * points[corners[1]] + w[2] * points[corners[2]] - query).norm();
      best = std::min(best, distance);
      if (tree.normal(static_cast<std::int32_t>(t)).dot(up) > 0.0)
        best_facing = std::min(best_facing, distance);
    }
    const auto found = tree.closest(query);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->distance, best);
    EXPECT_NEAR((found->point - query).norm(), best, 1e-12);
    EXPECT_DOUBLE_EQ(tree.closest(query, 1e9, &up)->distance, best_facing);
    EXPECT_FALSE(tree.closest(query, 0.999 * best));
    EXPECT_TRUE(tree.closest(query, 1.001 * best));
  }
}

TEST(ClosestPointTree, GivesTheLowestOfEquallyNearTriangles) {
  const ClosestPointTree twice({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 2}, {1, 2, 0}});
  EXPECT_EQ(twice.closest({0.2, 0.2, 1.0})->triangle, 0);
}

TEST(ClosestPointTree, RaysCrossAClosedSurfaceInPairs) {
  const test::Shape sphere = test::sphere(4);
  const ClosestPointTree tree(points_of(sphere), sphere.topology->triangles);
  std::vector<RayHit> hits;
  int crossed = 0;
  for (const Eigen::Vector3d& origin : random_points(200)) {
    const Eigen::Vector3d center(0.0, 1.0, 0.0);
    if ((origin - center).norm() < 1.05) continue;
    const Eigen::Vector3d direction = center + 0.3 * Eigen::Vector3d(origin.z(), origin.x(), 0.3) - origin;
    tree.hits(origin, direction, 10.0, hits);
    // Where the ray meets the true sphere, by the quadratic formula.
    const double a = direction.squaredNorm(), b = direction.dot(origin - center);
    const double discriminant = b * b - a * ((origin - center).squaredNorm() - 1.0);
    if (std::abs(discriminant) < 0.05 * b * b) continue;  // grazing: the polyhedron may miss it
    ASSERT_EQ(hits.size(), discriminant > 0.0 ? 2U : 0U);
    if (hits.empty()) continue;
    ++crossed;
    EXPECT_TRUE(hits[0].front);
    EXPECT_FALSE(hits[1].front);
    EXPECT_NEAR(hits[0].t, (-b - std::sqrt(discriminant)) / a, 0.02);
    EXPECT_NEAR(hits[1].t, (-b + std::sqrt(discriminant)) / a, 0.02);
    tree.hits(origin, direction, 0.5 * (hits[0].t + hits[1].t), hits);
    EXPECT_EQ(hits.size(), 1U);
  }
  EXPECT_GT(crossed, 30);
}

TEST(ClosestPointTree, RefusesBrokenMeshes) {
  EXPECT_THAT(
      [] {
        ClosestPointTree({{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("triangle 0: expected indices below 2, found 2")));
  EXPECT_THAT(
      [] {
        ClosestPointTree({{0, NAN, 0}}, {});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("point 0")));
  EXPECT_FALSE(ClosestPointTree({}, {}).closest({0, 0, 0}));
}

}  // namespace
}  // namespace reprise
