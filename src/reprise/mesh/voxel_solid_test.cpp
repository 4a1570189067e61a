// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/voxel_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::Throws;

using Points = std::vector<Eigen::Vector3d>;

Points points_of(const test::Shape& shape) {
  Points points;
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    points.emplace_back(shape.positions.row(v).transpose().cast<double>());
  }
  return points;
}

// `body()` with every vertex moved at random: folded all over, still closed.
Points crumpled(double most, unsigned seed) {
  Points points = points_of(test::body());
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-most, most);
  for (Eigen::Vector3d& p : points) p += Eigen::Vector3d(offset(random), offset(random), offset(random));
  return points;
}

// The generalised winding number: sum of the solid angles of all triangles (Van Oosterom and Strackee), over
// 4 pi. Shares nothing with rays.
double winding_number(const Points& points, std::span<const Triangle> triangles, const Eigen::Vector3d& at) {
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Eigen::Vector3d a = points[static_cast<std::size_t>(t[0])] - at;
    const Eigen::Vector3d b = points[static_cast<std::size_t>(t[1])] - at;
    const Eigen::Vector3d c = points[static_cast<std::size_t>(t[2])] - at;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

// Whether a triangle has a point in a box: cut by the six sides of the box, something is left. Shares nothing
// with separating axes.
bool meets(std::vector<Eigen::Vector3d> polygon, const Eigen::AlignedBox3d& box) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const double limit = side > 0.0 ? box.max()[axis] : -box.min()[axis];
      std::vector<Eigen::Vector3d> cut;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector3d& p = polygon[i];
        const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
        const double dp = limit - side * p[axis];
        const double dq = limit - side * q[axis];
        if (dp >= 0.0) cut.push_back(p);
        if ((dp < 0.0) != (dq < 0.0)) cut.emplace_back(p + dp / (dp - dq) * (q - p));
      }
      polygon = std::move(cut);
    }
  }
  return !polygon.empty();
}

double volume(const Points& points, std::span<const Triangle> triangles) {
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    sum += points[static_cast<std::size_t>(t[0])].dot(
        points[static_cast<std::size_t>(t[1])].cross(points[static_cast<std::size_t>(t[2])]));
  }
  return sum / 6.0;
}

double area(const Points& points, std::span<const Triangle> triangles) {
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Eigen::Vector3d& a = points[static_cast<std::size_t>(t[0])];
    sum +=
        0.5 *
        (points[static_cast<std::size_t>(t[1])] - a).cross(points[static_cast<std::size_t>(t[2])] - a).norm();
  }
  return sum;
}

std::int64_t touched_count(const VoxelSolid& solid) {
  std::int64_t count = 0;
  for (const std::int32_t cell : solid.voxels()) count += solid.is_touched(static_cast<std::size_t>(cell));
  return count;
}

TEST(VoxelSolid, VolumeAndAreaOfASphereConverge) {
  const test::Shape shape = test::sphere(4);
  const Points points = points_of(shape);
  const double exact_volume = volume(points, shape.topology->triangles);
  const double exact_area = area(points, shape.topology->triangles);
  for (const double h : {0.1, 0.05, 0.025}) {
    const VoxelSolid solid(points, shape.topology->triangles, {0.013, 0.007, 0.021}, h);
    // Centres are sampled at random places relative to the surface: the error shrinks faster than h.
    EXPECT_NEAR(static_cast<double>(solid.inside_count()) * h * h * h, exact_volume, 1.0 * h * h) << h;
    EXPECT_EQ(solid.reversed_count(), 0);
    // A plane of normal n meets |n_x| + |n_y| + |n_z| voxels per h^2, on average over directions 3/2.
    EXPECT_NEAR(static_cast<double>(touched_count(solid)) * h * h, 1.5 * exact_area, 1.5 * exact_area * h)
        << h;
  }
}

TEST(VoxelSolid, ABoxIsCountedExactly) {
  // From (0.1, 0.2, 0.3) to (1.6, 2.3, 3.4) voxels of size 1/2.
  Points points;
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back(0.5 * ((corner & 1) != 0 ? 1.6 : 0.1), 0.5 * ((corner & 2) != 0 ? 2.3 : 0.2),
                        0.5 * ((corner & 4) != 0 ? 3.4 : 0.3));
  }
  const std::vector<Triangle> triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  ASSERT_GT(volume(points, triangles), 0.0);
  const VoxelSolid solid(points, triangles, Eigen::Vector3d::Zero(), 0.5);
  EXPECT_EQ(solid.size(), (std::array<std::int32_t, 3>{2, 3, 4}));
  EXPECT_EQ(solid.inside_count(), 2 * 2 * 3);  // centres 0.5, 1.5; 0.5, 1.5; 0.5, 1.5, 2.5
  EXPECT_EQ(solid.voxels().size(), 2U * 3U * 4U);
  EXPECT_EQ(touched_count(solid), 2 * 3 * 4);
  EXPECT_EQ(solid.center(0), Eigen::Vector3d(0.25, 0.25, 0.25));
  EXPECT_EQ(solid.center(23), Eigen::Vector3d(0.75, 1.25, 1.75));
}

TEST(VoxelSolid, ClosedSurfacesAgreeWithSolidAngles) {
  const TopologyPtr topology = test::body().topology;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Points points = crumpled(0.3, seed);  // passes through itself everywhere
    const VoxelSolid solid(points, topology->triangles, {0.01, 0.02, 0.03}, 0.04);
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> any(0, solid.cell_count() - 1);
    int inside = 0;
    int several_times = 0;
    for (int k = 0; k < 1000; ++k) {
      const std::size_t cell = any(random);
      const double winding = winding_number(points, topology->triangles, solid.center(cell));
      ASSERT_NEAR(winding, std::round(winding), 1e-6);
      EXPECT_EQ(solid.is_inside(cell), winding > 0.5) << solid.center(cell).transpose();
      inside += solid.is_inside(cell) ? 1 : 0;
      several_times += std::abs(winding) > 1.5 ? 1 : 0;
    }
    EXPECT_GT(inside, 50);
    EXPECT_GT(several_times, 10) << "the surface was to pass through itself";
  }
}

TEST(VoxelSolid, RaysThroughEdgesAndVerticesCountOnce) {
  // An octahedron whose vertices are centres of voxels: lines through centres run along its edges and through
  // its vertices.
  const test::Shape shape = test::sphere(0);
  Points points = points_of(shape);
  const Eigen::Vector3d middle(0.5, 0.5, 0.5);
  for (Eigen::Vector3d& p : points) p = middle + 8.0 * (p - Eigen::Vector3d(0, 1, 0));
  const VoxelSolid solid(points, shape.topology->triangles, Eigen::Vector3d::Zero(), 1.0);
  EXPECT_EQ(solid.reversed_count(), 0);
  for (std::size_t cell = 0; cell < solid.cell_count(); ++cell) {
    const double distance = (solid.center(cell) - middle).lpNorm<1>();
    if (distance > 7.5 && distance < 8.5) continue;  // on the surface
    EXPECT_EQ(solid.is_inside(cell), distance < 8.0) << solid.center(cell).transpose();
  }
}

TEST(VoxelSolid, TouchedVoxelsAreThoseATriangleHasAPointIn) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(0.0, 6.0);
  for (int trial = 0; trial < 40; ++trial) {
    Points points;
    for (int v = 0; v < 3; ++v)
      points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    if (trial % 4 == 0) points[2] = points[0] + 0.001 * (points[2] - points[0]);  // a needle
    const std::vector<Triangle> triangles = {{0, 1, 2}};
    const VoxelSolid solid(points, triangles, Eigen::Vector3d::Zero(), 1.0);
    for (std::size_t cell = 0; cell < solid.cell_count(); ++cell) {
      const Eigen::Vector3d c = solid.center(cell);
      const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5);
      EXPECT_EQ(solid.is_touched(cell), meets(points, {c - half, c + half}))
          << trial << ": " << c.transpose();
      EXPECT_FALSE(solid.is_inside(cell));
    }
  }
}

TEST(VoxelSolid, SmallHolesChangeLittle) {
  const test::Shape shape = test::sphere(4);
  const Points points = points_of(shape);
  const VoxelSolid closed(points, shape.topology->triangles, Eigen::Vector3d::Zero(), 0.05);
  std::vector<Triangle> open = shape.topology->triangles;
  std::mt19937 random(3);
  for (int hole = 0; hole < 10; ++hole) {
    const auto v = static_cast<std::int32_t>(random() % points.size());
    std::erase_if(open, [&](const Triangle& t) { return std::ranges::count(t, v) > 0; });
  }
  ASSERT_LT(open.size(), shape.topology->triangles.size() - 40);
  const VoxelSolid holed(points, open, Eigen::Vector3d::Zero(), 0.05);
  ASSERT_EQ(holed.size(), closed.size());
  std::int64_t different = 0;
  std::int64_t disputed = 0;
  for (std::size_t cell = 0; cell < closed.cell_count(); ++cell) {
    different += holed.is_inside(cell) != closed.is_inside(cell) ? 1 : 0;
    if (cell % 7 != 0) continue;  // solid angles take long
    disputed += (winding_number(points, open, closed.center(cell)) > 0.5) != holed.is_inside(cell) ? 1 : 0;
  }
  EXPECT_GT(different, 0);
  EXPECT_LT(different, closed.inside_count() / 200);
  EXPECT_LT(7 * disputed, closed.inside_count() / 200);
}

TEST(VoxelSolid, InsideOutIsFoundReversed) {
  const test::Shape shape = test::body();
  const Points points = points_of(shape);
  std::vector<Triangle> flipped = shape.topology->triangles;
  for (Triangle& t : flipped) std::swap(t[1], t[2]);
  const VoxelSolid solid(points, shape.topology->triangles, Eigen::Vector3d::Zero(), 0.03);
  const VoxelSolid reversed(points, flipped, Eigen::Vector3d::Zero(), 0.03);
  EXPECT_GT(solid.inside_count(), 1000);
  EXPECT_EQ(reversed.reversed_count(), solid.inside_count());
  EXPECT_EQ(reversed.inside_count(), 0);
}

TEST(VoxelSolid, AThinSheetDoesNotVanish) {
  const test::Shape sheet = test::sheet(3);
  // From half a voxel before the first centre to half a voxel beyond the last: one layer of 9 x 9.
  const VoxelSolid solid(points_of(sheet), sheet.topology->triangles, {0.0625, 0.0625, 0.0625}, 0.125);
  EXPECT_EQ(solid.inside_count(), 0);
  EXPECT_EQ(solid.voxels().size(), 9U * 9U);
  EXPECT_EQ(solid.size()[1], 1);
}

TEST(VoxelSolid, MovesWithItsAnchor) {
  const test::Shape shape = test::body();
  Points points = points_of(shape);
  const VoxelSolid here(points, shape.topology->triangles, {0.25, 0.5, 0.75}, 0.03125);
  const Eigen::Vector3d offset(512.0, -3.5, 0.125);
  for (Eigen::Vector3d& p : points) p += offset;
  const VoxelSolid there(points, shape.topology->triangles, Eigen::Vector3d(0.25, 0.5, 0.75) + offset,
                         0.03125);
  EXPECT_EQ(there.size(), here.size());
  EXPECT_EQ(there.voxels(), here.voxels());
  EXPECT_EQ(there.inside_count(), here.inside_count());
  EXPECT_LT((there.center(7) - here.center(7) - offset).norm(), 1e-9);
}

TEST(VoxelSolid, SaysWhatIsWrong) {
  const test::Shape shape = test::body();
  const std::vector<Triangle>& triangles = shape.topology->triangles;
  Points points = points_of(shape);
  const auto make = [&](double voxel_size) {
    return VoxelSolid(points, triangles, Eigen::Vector3d::Zero(), voxel_size);
  };
  const auto message = [](const char* text) {
    return Throws<InvalidArgument>(::testing::Property(&InvalidArgument::what, HasSubstr(text)));
  };
  // No triangles: nothing counts.
  EXPECT_TRUE(VoxelSolid(points, {}, Eigen::Vector3d::Zero(), 0.1).voxels().empty());
  // Too many voxels, named before memory is taken.
  EXPECT_THAT([&] { make(1e-4); }, message("expected at most 67108864 in all"));
  EXPECT_THAT([&] { make(1e-300); }, message("expected at most"));
  // A size that is none.
  EXPECT_THAT([&] { make(0.0); }, message("voxel size: expected a positive number of metres, found 0"));
  EXPECT_THAT([&] { make(std::numeric_limits<double>::quiet_NaN()); }, message("found nan"));
  // A point that is not finite.
  points[5].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { make(0.1); }, message("point 5: expected finite coordinates"));
}

}  // namespace
}  // namespace reprise
