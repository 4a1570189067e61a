// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/mesh.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/math/ground_transform.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

Positions moved(const Positions& positions, const GroundTransform& transform) {
  Positions result = positions;
  transform_positions(transform, view(positions), PositionsRef(result.data(), result.rows(), 3));
  return result;
}

const GroundTransform some_motion{.yaw = 2.1, .translation = {3.0, -1.5}};

TEST(VertexNormals, OfASphereArePositionsAboutItsCentre) {
  double last_error = std::numeric_limits<double>::infinity();
  for (const int level : {2, 3, 4}) {
    const test::Shape sphere = test::sphere(level);
    const Positions normals = vertex_normals(*sphere.topology, view(sphere.positions));
    const Positions directions = sphere.positions.rowwise() - Eigen::RowVector3f(0, 1, 0);
    const double error = (normals - directions).rowwise().norm().maxCoeff();
    EXPECT_LT(error, 0.6 * last_error) << "level " << level;
    last_error = error;
    EXPECT_NEAR(normals.rowwise().norm().minCoeff(), 1.0, 1e-6);
    EXPECT_NEAR(normals.rowwise().norm().maxCoeff(), 1.0, 1e-6);
  }
  EXPECT_LT(last_error, 0.03);
}

TEST(VertexNormals, OfALevelSheetPointUp) {
  const test::Shape sheet = test::sheet(3);
  const Positions normals = vertex_normals(*sheet.topology, view(sheet.positions));
  for (Eigen::Index v = 0; v < normals.rows(); ++v) EXPECT_EQ(normals.row(v), Eigen::RowVector3f(0, 1, 0));
}

TEST(VertexNormals, DoNotDependOnTheUnit) {
  const test::Shape body = test::body();
  const Positions small = body.positions * 1e-12F;
  const Positions expected = vertex_normals(*body.topology, view(body.positions));
  EXPECT_LT((vertex_normals(*body.topology, view(small)) - expected).cwiseAbs().maxCoeff(), 1e-5F);
}

TEST(VertexNormals, TurnWithTheSurface) {
  const test::Shape body = test::body();
  const Positions turned =
      moved(vertex_normals(*body.topology, view(body.positions)), {.yaw = some_motion.yaw});
  const Positions of_turned = vertex_normals(*body.topology, view(moved(body.positions, some_motion)));
  EXPECT_LT((turned - of_turned).cwiseAbs().maxCoeff(), 1e-4F);
}

TEST(VertexNormals, AreZeroWhereNoTriangleWithAreaMeetsTheVertex) {
  // Vertex 3 is in no triangle; vertex 4 only in one that has collapsed.
  const Topology topology{.vertex_count = 5, .triangles = {{0, 1, 2}, {0, 4, 1}}};
  Positions positions(5, 3);
  positions << 0, 0, 0, 0, 0, 1, 1, 0, 0, 9, 9, 9, 0, 0, 0.5F;
  const Positions normals = vertex_normals(topology, view(positions));
  EXPECT_EQ(normals.row(0), Eigen::RowVector3f(0, 1, 0));
  EXPECT_EQ(normals.row(3), Eigen::RowVector3f(0, 0, 0));
  EXPECT_EQ(normals.row(4), Eigen::RowVector3f(0, 0, 0));
}

TEST(SurfaceArea, OfAnInscribedSphereConvergesToFourPiFromBelowInSecondOrder) {
  const auto missing = [](int level) {
    const test::Shape sphere = test::sphere(level);
    return 4.0 * std::numbers::pi - surface_area(*sphere.topology, view(sphere.positions));
  };
  // Half the edge length leaves a quarter of the error.
  for (const int level : {2, 3, 4})
    EXPECT_NEAR(missing(level) / missing(level + 1), 4.0, 0.2) << "level " << level;
  EXPECT_GT(missing(5), 0.0);
  EXPECT_LT(missing(5), 0.02);
}

TEST(SurfaceArea, OfTheUnitSheetIsOne) {
  const test::Shape sheet = test::sheet(7);
  EXPECT_NEAR(surface_area(*sheet.topology, view(sheet.positions)), 1.0, 1e-6);
}

TEST(SurfaceArea, DoesNotChangeUnderRigidMotionAndScalesWithTheSquare) {
  const test::Shape body = test::body();
  const double area = surface_area(*body.topology, view(body.positions));
  EXPECT_NEAR(surface_area(*body.topology, view(moved(body.positions, some_motion))), area, 1e-5 * area);
  EXPECT_NEAR(surface_area(*body.topology, view(body.positions * 2.0F)), 4.0 * area, 1e-5 * area);
}

TEST(Degeneracy, NamesWhatMakesAFrameUnusable) {
  const test::Shape sheet = test::sheet(2);
  EXPECT_EQ(degeneracy(*sheet.topology, view(sheet.positions)), "");
  // Not a number.
  Positions broken = sheet.positions;
  broken(4, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(degeneracy(*sheet.topology, view(broken)), HasSubstr("vertex 4 is (0.5, nan, 0.5)"));
  // Infinite.
  broken = sheet.positions;
  broken(7, 2) = std::numeric_limits<float>::infinity();
  EXPECT_THAT(degeneracy(*sheet.topology, view(broken)), HasSubstr("vertex 7"));
  // Collapsed to a point and to a line.
  EXPECT_THAT(degeneracy(*sheet.topology, view(sheet.positions * 0.0F)), HasSubstr("zero area"));
  broken = sheet.positions;
  broken.col(0).setZero();
  EXPECT_THAT(degeneracy(*sheet.topology, view(broken)), HasSubstr("zero area"));
  // One collapsed triangle does no harm.
  broken = sheet.positions;
  broken.row(1) = broken.row(0);
  EXPECT_EQ(degeneracy(*sheet.topology, view(broken)), "");
}

TEST(MeshFunctions, RefusePositionsOfAnotherVertexCount) {
  const test::Shape sheet = test::sheet(2);
  const Positions fewer = sheet.positions.topRows(8);
  const auto message =
      ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("8 vertices"), HasSubstr("9 vertices")));
  EXPECT_THAT([&] { vertex_normals(*sheet.topology, view(fewer)); }, message);
  EXPECT_THAT([&] { surface_area(*sheet.topology, view(fewer)); }, message);
  EXPECT_THAT([&] { degeneracy(*sheet.topology, view(fewer)); }, message);
}

TEST(Validate, AcceptsATopologyWithAndWithoutTextureCoordinates) {
  Topology topology{.vertex_count = 3, .triangles = {{0, 1, 2}}};
  EXPECT_NO_THROW(validate(topology));
  EXPECT_FALSE(topology.has_uvs());
  topology.uvs = {{0, 0}, {1, 0}};
  topology.triangle_uvs = {{0, 1, 1}};
  EXPECT_NO_THROW(validate(topology));
  EXPECT_TRUE(topology.has_uvs());
}

TEST(Validate, NamesWhatIsWrong) {
  const auto message_of = [](const Topology& topology) {
    try {
      validate(topology);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  // No vertices.
  EXPECT_THAT(message_of({}), HasSubstr("at least one vertex"));
  // A negative number of vertices.
  EXPECT_THAT(message_of({.vertex_count = -4}), HasSubstr("at least one vertex"));
  // A vertex beyond the last.
  EXPECT_THAT(message_of({.vertex_count = 3, .triangles = {{0, 1, 2}, {1, 2, 3}}}),
              HasSubstr("triangle 1 refers to vertex 3, but there are 3"));
  // A negative vertex.
  EXPECT_THAT(message_of({.vertex_count = 3, .triangles = {{0, -1, 2}}}),
              HasSubstr("triangle 0 refers to vertex -1"));
  // Every pair of equal corners.
  for (const Triangle& twice : {Triangle{1, 1, 2}, Triangle{0, 1, 1}, Triangle{2, 1, 2}}) {
    EXPECT_THAT(message_of({.vertex_count = 3, .triangles = {twice}}),
                HasSubstr("triangle 0 uses a vertex twice"));
  }
  // Texture triangles for some of the triangles.
  EXPECT_THAT(message_of({.vertex_count = 3,
                          .triangles = {{0, 1, 2}, {0, 2, 1}},
                          .uvs = {{0, 0}},
                          .triangle_uvs = {{0, 0, 0}}}),
              HasSubstr("1 of 2 triangles"));
  // Texture coordinates that no triangle refers to.
  EXPECT_THAT(message_of({.vertex_count = 3, .triangles = {{0, 1, 2}}, .uvs = {{0, 0}}, .triangle_uvs = {}}),
              HasSubstr("1 texture coordinates, but 0 triangles"));
  // Texture triangles without coordinates.
  EXPECT_THAT(
      message_of({.vertex_count = 3, .triangles = {{0, 1, 2}}, .uvs = {}, .triangle_uvs = {{0, 0, 0}}}),
      HasSubstr("0 texture coordinates, but 1 triangles"));
  // A texture coordinate beyond the last, and a negative one.
  for (const std::int32_t uv : {1, -1}) {
    EXPECT_THAT(
        message_of(
            {.vertex_count = 3, .triangles = {{0, 1, 2}}, .uvs = {{0, 0}}, .triangle_uvs = {{0, uv, 0}}}),
        HasSubstr("refers to texture coordinate " + std::to_string(uv)));
  }
}

TEST(FirstDifference, IsEmptyForTheSameSurfaceWhateverItsTextureCoordinates) {
  Topology a = *test::sheet(2).topology;
  const Topology b = a;
  EXPECT_EQ(first_difference(a, b, "a", "b"), "");
  a.uvs = {{0, 0}};
  a.triangle_uvs.assign(a.triangles.size(), {0, 0, 0});
  EXPECT_EQ(first_difference(a, b, "a", "b"), "");
}

TEST(FirstDifference, NamesTheFirstThatIsFound) {
  const Topology a{.vertex_count = 6, .triangles = {{0, 1, 2}, {3, 4, 5}, {0, 2, 3}}};
  // Vertex count.
  Topology b = a;
  b.vertex_count = 7;
  EXPECT_EQ(first_difference(a, b, "a", "b"), "a has 6 vertices, b has 7");
  // Winding of one triangle, and a later difference that is not named.
  b = a;
  b.triangles[1] = {3, 5, 4};
  b.triangles[2] = {0, 2, 4};
  EXPECT_EQ(first_difference(a, b, "a", "b"), "triangle 1 is (3, 4, 5) in a and (3, 5, 4) in b");
  // One triangle more.
  b = a;
  b.triangles.pop_back();
  EXPECT_EQ(first_difference(a, b, "a", "b"), "a has 3 triangles, b has 2");
}

TEST(Triangulate, FansOutFromTheFirstCorner) {
  EXPECT_THAT(triangulate({7, 8, 9, 0, 1, 2, 3, 4, 5, 6, 2, 3}, {3, 5, 4}),
              ElementsAre(Triangle{7, 8, 9}, Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4},
                          Triangle{5, 6, 2}, Triangle{5, 2, 3}));
  EXPECT_TRUE(triangulate({}, {}).empty());
}

TEST(Triangulate, OfAConvexPolygonKeepsItsAreaAndSide) {
  const std::int32_t n = 9;
  Positions positions(n, 3);
  std::vector<std::int32_t> corners;
  for (std::int32_t k = 0; k < n; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / n;
    positions.row(k) = Eigen::RowVector3d(std::sin(angle), 0.0, std::cos(angle)).cast<float>();
    corners.push_back(k);
  }
  const Topology topology{.vertex_count = n, .triangles = triangulate(corners, {n})};
  EXPECT_EQ(topology.triangles.size(), static_cast<std::size_t>(n - 2));
  EXPECT_NEAR(surface_area(topology, view(positions)), 0.5 * n * std::sin(2.0 * std::numbers::pi / n), 1e-6);
  EXPECT_GT(vertex_normals(topology, view(positions)).col(1).minCoeff(), 0.999F);
}

TEST(Triangulate, RefusesPolygonsThatDoNotFit) {
  // Too few corners for a polygon.
  EXPECT_THAT(
      [] {
        triangulate({0, 1, 2, 0, 1}, {3, 2});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("polygon 1 has 2 corners")));
  // A negative size.
  EXPECT_THROW(triangulate({0, 1, 2}, {-3}), InvalidArgument);
  // Fewer corners than the sizes say, and more.
  EXPECT_THAT(
      [] {
        triangulate({0, 1, 2}, {4});
      },
      ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("3 polygon corners"), HasSubstr("have 4"))));
  EXPECT_THROW(triangulate({0, 1, 2, 3}, {3}), InvalidArgument);
}

TEST(ConnectedComponents, OfAWholeSurfaceAreOne) {
  const ConnectedComponents components = connected_components(*test::sphere(2).topology);
  EXPECT_EQ(components.count, 1);
  EXPECT_THAT(components.of_vertex, testing::Each(0));
}

TEST(ConnectedComponents, AreNumberedInOrderOfTheirFirstVertex) {
  // {0, 5, 2, 4} through a shared vertex, {1} alone, {3, 6, 7}.
  const Topology topology{.vertex_count = 8, .triangles = {{7, 6, 3}, {5, 4, 2}, {0, 5, 2}}};
  const ConnectedComponents components = connected_components(topology);
  EXPECT_EQ(components.count, 3);
  EXPECT_THAT(components.of_vertex, ElementsAre(0, 1, 0, 2, 0, 0, 2, 2));
}

TEST(ConnectedComponents, DoNotDependOnTheOrderOfTriangles) {
  Topology topology = *test::sheet(5).topology;
  const std::int32_t n = topology.vertex_count;
  for (std::size_t t = 0, count = topology.triangles.size(); t < count; ++t) {
    const auto [a, b, c] = topology.triangles[t];
    topology.triangles.push_back({a + n, b + n, c + n});
  }
  topology.vertex_count = 2 * n;
  const ConnectedComponents components = connected_components(topology);
  EXPECT_EQ(components.count, 2);
  std::ranges::reverse(topology.triangles);
  EXPECT_EQ(connected_components(topology).of_vertex, components.of_vertex);
}

}  // namespace
}  // namespace reprise
