// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/voxel_nearest.h"

#include <random>

#include <gtest/gtest.h>

#include "reprise/mesh/closest_point.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points points_of(const test::Shape& shape) {
  Points points;
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    points.emplace_back(shape.positions.row(v).transpose().cast<double>());
  }
  return points;
}

void expect_nearest(const NearestSurface& search, const Points& points,
                    const std::vector<Triangle>& triangles, double voxel_size) {
  const VoxelSolid solid(points, triangles, {0.003, 0.007, 0.011}, voxel_size);
  const std::vector<TrianglePoint> found = search.find(solid, points);
  const ClosestPointTree tree(points, triangles);
  ASSERT_EQ(found.size(), solid.voxels().size());
  ASSERT_GT(found.size(), 0U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector3d center = solid.center(static_cast<std::size_t>(solid.voxels()[i]));
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    ASSERT_GE(found[i].triangle, 0);
    const Triangle& t = triangles[static_cast<std::size_t>(found[i].triangle)];
    for (Eigen::Index c = 0; c < 3; ++c) {
      EXPECT_GE(found[i].weights[c], 0.0F);
      point += static_cast<double>(found[i].weights[c]) *
               points[static_cast<std::size_t>(t[static_cast<std::size_t>(c)])];
    }
    EXPECT_NEAR(found[i].weights.sum(), 1.0F, 1e-6F);
    EXPECT_NEAR((point - center).norm(), tree.closest(center)->distance, 1e-5 * voxel_size + 1e-6) << i;
  }
}

TEST(NearestSurface, FindsWhatTheClosestPointTreeFinds) {
  const test::Shape shape = test::body();
  const Points points = points_of(shape);
  const NearestSurface search(shape.topology->triangles, points);
  for (const double voxel_size : {0.03, 0.1, 1.0}) {
    expect_nearest(search, points, shape.topology->triangles, voxel_size);
  }
}

TEST(NearestSurface, StaysExactFarFromTheFrameItWasMadeFor) {
  const test::Shape shape = test::body();
  const Points points = points_of(shape);
  const NearestSurface search(shape.topology->triangles, points);
  Points other = points;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> offset(-0.2, 0.2);
  for (Eigen::Vector3d& p : other) {
    p = Eigen::Vector3d(p.y(), -p.x(), 1.5 * p.z()) +
        Eigen::Vector3d(offset(random), offset(random), offset(random));
  }
  expect_nearest(search, other, shape.topology->triangles, 0.05);
}

TEST(NearestSurface, TrianglesWithoutAreaAreAsNearAsTheirEdges) {
  Points points = points_of(test::body());
  std::vector<Triangle> triangles = test::body().topology->triangles;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const Triangle& triangle = triangles[t];
    points[static_cast<std::size_t>(triangle[2])] =
        0.5 * (points[static_cast<std::size_t>(triangle[0])] + points[static_cast<std::size_t>(triangle[1])]);
  }
  points.push_back(points[0]);
  triangles.push_back({0, static_cast<std::int32_t>(points.size() - 1), 0});  // all corners in one place
  expect_nearest(NearestSurface(triangles, points), points, triangles, 0.05);
}

}  // namespace
}  // namespace reprise
