// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/uv_atlas.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <Eigen/SVD>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TriangleMesh mesh_of(const test::Shape& shape) {
  TriangleMesh mesh{.points = {}, .triangles = shape.topology->triangles};
  for (Eigen::Index i = 0; i < shape.positions.rows(); ++i)
    mesh.points.emplace_back(shape.positions.row(i).cast<double>().transpose());
  return mesh;
}

Eigen::Vector2d uv(const UvAtlas& atlas, std::size_t t, int k) {
  const auto& p = atlas.uvs[atlas.triangle_uvs[t][k]];
  return {p[0], p[1]};
}

// Singular values of the map from the surface to the square, of one triangle: largest, smallest.
Eigen::Vector2d stretch(const TriangleMesh& mesh, const UvAtlas& atlas, std::size_t t) {
  const Triangle& c = mesh.triangles[t];
  const Eigen::Vector3d ab = mesh.points[c[1]] - mesh.points[c[0]],
                        ac = mesh.points[c[2]] - mesh.points[c[0]];
  Eigen::Matrix2d flat, mapped;
  flat << ab.norm(), ab.dot(ac) / ab.norm(), 0.0, ab.cross(ac).norm() / ab.norm();
  mapped << uv(atlas, t, 1) - uv(atlas, t, 0), uv(atlas, t, 2) - uv(atlas, t, 0);
  return (mapped * flat.inverse()).eval().jacobiSvd().singularValues();
}

// Counts triangles at the centres of size x size pixels.
std::vector<std::vector<int>> owners(const UvAtlas& atlas, int size) {
  std::vector<std::vector<int>> result(static_cast<std::size_t>(size) * size);
  for (std::size_t t = 0; t < atlas.triangle_uvs.size(); ++t) {
    const Eigen::Vector2d a = size * uv(atlas, t, 0), b = size * uv(atlas, t, 1), c = size * uv(atlas, t, 2);
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()); ++y) {
      for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()); ++x) {
        const Eigen::Vector2d p(x + 0.5, y + 0.5);
        const auto side = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
          return (to - from).x() * (p - from).y() - (to - from).y() * (p - from).x();
        };
        // Strictly inside by a margin that covers the rounding of float coordinates.
        if (std::min({side(a, b), side(b, c), side(c, a)}) > 1e-3)
          result[static_cast<std::size_t>(y) * size + x].push_back(static_cast<int>(t));
      }
    }
  }
  return result;
}

class AtlasOf : public ::testing::TestWithParam<const char*> {
 protected:
  TriangleMesh mesh() const {
    return mesh_of(std::string(GetParam()) == "body" ? test::body() : test::sphere(4));
  }
};

TEST_P(AtlasOf, CoversEveryTriangleOnceWithBoundedStretch) {
  const TriangleMesh mesh = this->mesh();
  const UvAtlas atlas = make_uv_atlas(mesh, {.texture_size = 512});
  ASSERT_EQ(atlas.triangle_uvs.size(), mesh.triangles.size());
  EXPECT_LE(atlas.chart_count, 14);
  EXPECT_GE(atlas.chart_count, 2);
  for (const auto& p : atlas.uvs) {
    EXPECT_GE(std::min(p[0], p[1]), 0.0F);
    EXPECT_LE(std::max(p[0], p[1]), 1.0F);
  }
  double area = 0.0, surface = 0.0;
  std::vector<double> scales;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d p = uv(atlas, t, 1) - uv(atlas, t, 0), q = uv(atlas, t, 2) - uv(atlas, t, 0);
    const double twice = p.x() * q.y() - p.y() * q.x();
    EXPECT_GT(twice, 0.0) << t;
    area += 0.5 * twice;
    const Triangle& c = mesh.triangles[t];
    surface +=
        0.5 * (mesh.points[c[1]] - mesh.points[c[0]]).cross(mesh.points[c[2]] - mesh.points[c[0]]).norm();
  }
  EXPECT_GT(area, 0.45) << "of the square is used";
  const double scale = std::sqrt(area / surface);
  double squares = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d s = stretch(mesh, atlas, t) / scale;
    EXPECT_LT(s[0], 2.5) << t;
    EXPECT_GT(s[1], 0.3) << t;
    squares += (s - Eigen::Vector2d::Ones()).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / (2.0 * static_cast<double>(mesh.triangles.size()))), 0.25);
}

TEST_P(AtlasOf, DoesNotOverlapAndKeepsTheGutter) {
  const TriangleMesh mesh = this->mesh();
  constexpr int size = 512, gutter = 6;
  const UvAtlas atlas = make_uv_atlas(mesh, {.texture_size = size, .gutter = gutter});
  const auto pixels = owners(atlas, size);
  int used = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const auto& here = pixels[static_cast<std::size_t>(y) * size + x];
      ASSERT_LE(here.size(), 1U) << x << ' ' << y;
      if (here.empty()) continue;
      ++used;
      for (int d = 1; d < gutter - 1; ++d) {
        for (const auto& [i, j] : {std::pair(x + d, y), std::pair(x, y + d)}) {
          if (i >= size || j >= size) continue;
          const auto& there = pixels[static_cast<std::size_t>(j) * size + i];
          if (!there.empty()) {
            ASSERT_EQ(atlas.chart_of_triangle[there[0]], atlas.chart_of_triangle[here[0]]);
          }
        }
      }
    }
  }
  EXPECT_GT(used, 0.4 * size * size);
}

INSTANTIATE_TEST_SUITE_P(UvAtlas, AtlasOf, ::testing::Values("sphere", "body"));

TEST(UvAtlas, KeepsChartsToTheirGroupAndGivesThemTheirDensity) {
  const TriangleMesh mesh = mesh_of(test::sphere(4));
  UvAtlasOptions options{.texture_size = 512};
  for (const Triangle& t : mesh.triangles)
    options.group_of_triangle.push_back(mesh.points[t[0]].z() > 0.5 ? 1 : 0);
  options.density = {1.0, 3.0};
  const UvAtlas atlas = make_uv_atlas(mesh, options);
  std::set<int> charts[2];
  double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int group = options.group_of_triangle[t];
    charts[group].insert(atlas.chart_of_triangle[t]);
    sum[group] += stretch(mesh, atlas, t).mean();
    ++count[group];
  }
  for (const int chart : charts[1]) EXPECT_FALSE(charts[0].contains(chart));
  EXPECT_EQ(charts[1].size(), 1U);
  EXPECT_NEAR((sum[1] / count[1]) / (sum[0] / count[0]), 3.0, 0.3);
}

TEST(UvAtlas, IsTheSameEveryTime) {
  const TriangleMesh mesh = mesh_of(test::body());
  EXPECT_EQ(make_uv_atlas(mesh, {}).uvs, make_uv_atlas(mesh, {}).uvs);
}

TEST(UvAtlas, RefusesOptionsOutOfRange) {
  const TriangleMesh mesh = mesh_of(test::sphere(1));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.texture_size = 8}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("texture_size")));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.gutter = -1}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("gutter")));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.max_angle_degrees = 90.0}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("max_angle_degrees")));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.group_of_triangle = {0}}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("group_of_triangle: expected 32 entries")));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.group_of_triangle = std::vector<int>(32, 1), .density = {1.0}}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("group 1")));
  EXPECT_THAT([&] { make_uv_atlas(mesh, {.density = {0.0}}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("density")));
  EXPECT_THAT(
      [] {
        make_uv_atlas({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 1}}}, {});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("triangle 0: expected one with an area")));
}

}  // namespace
}  // namespace reprise
