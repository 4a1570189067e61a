// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/surface_smoothing.h"

#include <limits>
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
using Values = SurfaceSmoother::Values;

std::vector<Eigen::Vector3d> points_of(const test::Shape& shape) {
  std::vector<Eigen::Vector3d> points;
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    points.emplace_back(shape.positions.row(v).transpose().cast<double>());
  }
  return points;
}

// A third of the areas of the triangles around each vertex.
Eigen::VectorXd vertex_areas(const Topology& topology, const std::vector<Eigen::Vector3d>& points) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(topology.vertex_count);
  for (const Triangle& t : topology.triangles) {
    const Eigen::Vector3d& a = points[static_cast<std::size_t>(t[0])];
    const double area =
        0.5 *
        (points[static_cast<std::size_t>(t[1])] - a).cross(points[static_cast<std::size_t>(t[2])] - a).norm();
    for (const std::int32_t v : t) areas[v] += area / 3.0;
  }
  return areas;
}

TEST(SurfaceSmoother, KeepsConstantsMeansAndRange) {
  const test::Shape body = test::body();
  const std::vector<Eigen::Vector3d> points = points_of(body);
  const Eigen::VectorXd areas = vertex_areas(*body.topology, points);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double radius : {0.02, 0.2, 2.0}) {
    const SurfaceSmoother smoother(*body.topology, points, radius);
    Values values(body.topology->vertex_count, 3);
    for (double& value : values.reshaped()) value = uniform(random);
    values.col(2).setConstant(0.25);
    const Values before = values;
    smoother.smooth(values);
    EXPECT_LT((values.col(2).array() - 0.25).abs().maxCoeff(), 1e-12);
    for (Eigen::Index c = 0; c < 2; ++c) {
      EXPECT_NEAR(areas.dot(values.col(c)), areas.dot(before.col(c)), 1e-10 * areas.sum());
      EXPECT_GE(values.col(c).minCoeff(), before.col(c).minCoeff());
      EXPECT_LE(values.col(c).maxCoeff(), before.col(c).maxCoeff());
    }
    // The wider, the flatter.
    EXPECT_LT((values.col(0).array() - values.col(0).mean()).matrix().norm(),
              (before.col(0).array() - before.col(0).mean()).matrix().norm());
  }
}

TEST(SurfaceSmoother, SpreadsLikeADiscOfTheRadius) {
  // A spot of heat in the middle of a flat sheet: its mean squared distance is that of a disc, R^2 / 2.
  const test::Shape sheet = test::sheet(60);
  const std::vector<Eigen::Vector3d> points = points_of(sheet);
  const Eigen::VectorXd areas = vertex_areas(*sheet.topology, points);
  const Eigen::Index middle = 30 * 61 + 30;
  for (const double radius : {0.05, 0.1, 0.2}) {
    Values heat = Values::Zero(sheet.topology->vertex_count, 1);
    heat(middle, 0) = 1.0;
    SurfaceSmoother(*sheet.topology, points, radius).smooth(heat);
    double moment = 0.0;
    double mass = 0.0;
    for (Eigen::Index v = 0; v < heat.rows(); ++v) {
      const double share = areas[v] * heat(v, 0);
      mass += share;
      moment += share * (points[static_cast<std::size_t>(v)] - points[middle]).squaredNorm();
    }
    EXPECT_NEAR(moment / mass, radius * radius / 2.0, 0.02 * radius * radius);
  }
}

TEST(SurfaceSmoother, NothingCrossesFromPartToPart) {
  // Two balls at the same place that share no vertex.
  const test::Shape ball = test::sphere(2);
  Topology both = *ball.topology;
  std::vector<Eigen::Vector3d> points = points_of(ball);
  points.insert(points.end(), points.begin(), points.end());
  const std::int32_t n = both.vertex_count;
  both.vertex_count = 2 * n + 1;  // and a vertex that no triangle uses
  points.emplace_back(0.0, 0.0, 0.0);
  for (const Triangle& t : ball.topology->triangles) both.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  Values values = Values::Zero(both.vertex_count, 1);
  values.topRows(n).setConstant(1.0);
  values(2 * n, 0) = 0.5;
  const Values before = values;
  SurfaceSmoother(both, points, 0.5).smooth(values);
  EXPECT_LT((values - before).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SurfaceSmoother, TakesTrianglesWithoutArea) {
  const test::Shape body = test::body();
  std::vector<Eigen::Vector3d> points = points_of(body);
  for (std::size_t v = 0; v < points.size() / 2; ++v)
    points[v] = {0.0, 1e-9 * static_cast<double>(v % 7), 0.0};
  Values values = Values::Constant(body.topology->vertex_count, 2, 0.75);
  SurfaceSmoother(*body.topology, points, 0.3).smooth(values);
  EXPECT_LT((values.array() - 0.75).abs().maxCoeff(), 1e-9);
}

TEST(SurfaceSmoother, SaysWhatIsWrong) {
  const test::Shape body = test::body();
  std::vector<Eigen::Vector3d> points = points_of(body);
  const auto message = [](const char* text) {
    return Throws<InvalidArgument>(::testing::Property(&InvalidArgument::what, HasSubstr(text)));
  };
  // A radius that is none.
  EXPECT_THAT([&] { SurfaceSmoother(*body.topology, points, 0.0); }, message("expected a positive radius"));
  // Values of another surface.
  Values values = Values::Zero(3, 1);
  EXPECT_THAT([&] { SurfaceSmoother(*body.topology, points, 0.1).smooth(values); },
              message("expected 258 values, found 3"));
  // A point that is not finite.
  points[9].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { SurfaceSmoother(*body.topology, points, 0.1); }, message("point 9"));
  // Points of another surface.
  EXPECT_THAT([&] { SurfaceSmoother(*body.topology, std::span(points).first(5), 0.1); },
              message("expected 258 points, found 5"));
}

}  // namespace
}  // namespace reprise
