// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/remesh.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/mesh/halfedges.h"
#include "reprise/mesh/handles.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A grid that wraps in both directions: genus 1. Triangles are slivers away from the inner equator.
TriangleMesh torus(int around, int across, double minor = 0.3) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * j / across;
      const double r = 1.0 + minor * std::cos(v);
      mesh.points.emplace_back(r * std::cos(u), minor * std::sin(v), -r * std::sin(u));
      const auto at = [&](int a, int b) { return (a % around) * across + b % across; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

// Cylinder with rounded ends, radius 1 cm, length 10 cm: as thin as a finger.
TriangleMesh finger() {
  TriangleMesh mesh;
  constexpr int around = 60, rings = 220;
  mesh.points.emplace_back(0.0, -0.05, 0.0);
  for (int i = 1; i < rings; ++i) {
    const double y = -0.05 * std::cos(std::numbers::pi * i / rings);
    const double inside = std::max(0.0, std::abs(y) - 0.04);
    const double r = std::sqrt(std::max(1e-8, 0.0001 - inside * inside));
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * std::numbers::pi * j / around;
      mesh.points.emplace_back(r * std::cos(u), y, -r * std::sin(u));
    }
  }
  mesh.points.emplace_back(0.0, 0.05, 0.0);
  const auto last = static_cast<std::int32_t>(mesh.points.size()) - 1;
  const auto at = [&](int i, int j) { return 1 + i * around + j % around; };
  for (int j = 0; j < around; ++j) {
    mesh.triangles.push_back({0, at(0, j + 1), at(0, j)});
    mesh.triangles.push_back({last, at(rings - 2, j), at(rings - 2, j + 1)});
    for (int i = 0; i + 2 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

double volume(const TriangleMesh& mesh) {
  double six = 0.0;
  for (const Triangle& t : mesh.triangles)
    six += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]]));
  return six / 6.0;
}

// Largest distance from points of a to b.
double deviation(const TriangleMesh& a, const TriangleMesh& b) {
  const ClosestPointTree tree(b.points, b.triangles);
  double worst = 0.0;
  for (const Triangle& t : a.triangles) {
    for (const Eigen::Vector3d& w :
         {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(4, 1, 1), Eigen::Vector3d(1, 1, 0)}) {
      const Eigen::Vector3d p =
          (w[0] * a.points[t[0]] + w[1] * a.points[t[1]] + w[2] * a.points[t[2]]) / w.sum();
      worst = std::max(worst, tree.closest(p)->distance);
    }
  }
  return worst;
}

void expect_closed(const TriangleMesh& mesh) {
  EXPECT_NO_THROW(Halfedges(static_cast<std::int32_t>(mesh.points.size()), mesh.triangles));
}

TEST(Halfedges, EditsKeepTheSurfaceClosed) {
  const TriangleMesh mesh = torus(12, 8);
  Halfedges edges(static_cast<std::int32_t>(mesh.points.size()), mesh.triangles);
  int splits = 0, flips = 0, collapses = 0;
  for (std::int32_t h = 0; h < 3 * 12 * 8 * 2; h += 7) {
    if (edges.is_removed(h)) continue;
    if (h % 3 == 0) {
      edges.split(h);
      ++splits;
    } else if (h % 3 == 1 && edges.can_flip(h)) {
      edges.flip(h);
      ++flips;
    } else if (edges.can_collapse(h)) {
      edges.collapse(h);
      ++collapses;
    }
  }
  EXPECT_GT(std::min({splits, flips, collapses}), 10);
  const std::vector<Triangle> triangles = edges.triangles();
  const Halfedges again(edges.vertex_count(), triangles);  // throws if it is not closed and manifold
  EXPECT_EQ(again.live_vertices(), edges.live_vertices());
  EXPECT_EQ(edges.live_vertices(), 96 + splits - collapses);
  EXPECT_EQ(triangles.size(),
            192U + 2U * static_cast<unsigned>(splits) - 2U * static_cast<unsigned>(collapses));
}

TEST(Halfedges, RefuseWhatIsNotClosed) {
  EXPECT_THAT([] { Halfedges(3, {{0, 1, 2}}); }, ThrowsMessage<InvalidArgument>(HasSubstr("edge 0-1")));
  EXPECT_THAT(
      [] {
        Halfedges(4, {{0, 1, 2}, {0, 1, 3}});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("opposite directions")));
  // Two tetrahedra that share a vertex.
  EXPECT_THAT(
      [] {
        Halfedges(7,
                  {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("vertex 0: expected one fan")));
}

// Two blocks tied by rods: each rod beyond the first makes a handle. The surface of cubes of edge 1.
TriangleMesh tied_blocks(int rods) {
  const auto solid = [&](int x, int y, int z) {
    if (x < 0 || x >= 20 || y < 0 || y >= 20 || z < 0 || z >= 6) return false;
    if (x < 6 || x >= 14) return true;
    return y % 4 == 1 && y / 4 < rods && z == 2;
  };
  TriangleMesh mesh;
  std::map<std::array<int, 3>, std::int32_t> index;
  const auto corner = [&](const std::array<int, 3>& p) {
    const auto [entry, is_new] = index.try_emplace(p, static_cast<std::int32_t>(mesh.points.size()));
    if (is_new) mesh.points.emplace_back(p[0], p[1], p[2]);
    return entry->second;
  };
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y)
      for (int z = 0; z < 6; ++z) {
        if (!solid(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beyond{x, y, z};
            beyond[axis] += side == 0 ? -1 : 1;
            if (solid(beyond[0], beyond[1], beyond[2])) continue;
            std::array<int, 3> a{x, y, z};
            a[axis] += side;
            std::array<int, 3> b = a, c = a, d = a;
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            ++b[u], ++c[u], ++c[v], ++d[v];
            if (side == 0) std::swap(b, d);
            mesh.triangles.push_back({corner(a), corner(b), corner(c)});
            mesh.triangles.push_back({corner(a), corner(c), corner(d)});
          }
      }
  return mesh;
}

TEST(WithoutHandles, CutsEveryHandleAndKeepsTheRest) {
  for (const int rods : {1, 2, 5}) {
    const TriangleMesh blocks = tied_blocks(rods);
    ASSERT_EQ(genus(blocks), rods - 1);
    const TriangleMesh mesh = without_handles(blocks);
    expect_closed(mesh);
    EXPECT_EQ(genus(mesh), 0);
    // A rod of length 8 and section 1 is cut in two, not filled up to its neighbour.
    EXPECT_NEAR(volume(mesh), volume(blocks), 0.5 * rods);
    EXPECT_LT(deviation(blocks, mesh), 1e-9);
    // In one piece still: growing over triangles reaches all.
    Topology topology{.vertex_count = static_cast<std::int32_t>(mesh.points.size()),
                      .triangles = mesh.triangles};
    EXPECT_EQ(connected_components(topology).count, 1);
  }
}

TEST(WithoutHandles, MakesASphereOfATorus) {
  const TriangleMesh mesh = without_handles(torus(60, 20));
  expect_closed(mesh);
  EXPECT_EQ(genus(mesh), 0);
  EXPECT_NEAR(volume(mesh), 2.0 * std::numbers::pi * std::numbers::pi * 0.09, 0.06);
}

TEST(VertexNormals, OfATorusPointAwayFromItsRing) {
  const TriangleMesh mesh = torus(80, 40);
  const std::vector<Eigen::Vector3d> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    Eigen::Vector3d ring = mesh.points[v];
    ring.y() = 0.0;
    ring.normalize();
    EXPECT_NEAR(normals[v].norm(), 1.0, 1e-12);
    EXPECT_GT(normals[v].dot((mesh.points[v] - ring).normalized()), 0.99);
  }
}

TEST(Remesh, OfATorusIsUniformCloseAndOfTheSameGenus) {
  const TriangleMesh dense = torus(300, 90);
  double last_deviation = 1.0;
  for (const int vertices : {300, 1200, 4800}) {
    const TriangleMesh mesh = remesh(dense, {}, {.vertices = vertices});
    EXPECT_EQ(mesh.points.size(), static_cast<std::size_t>(vertices));
    expect_closed(mesh);
    EXPECT_EQ(genus(mesh), 1);
    EXPECT_LT(edge_length_variation(mesh), 0.16) << vertices;
    // A chord of length l on a circle of radius r is l^2 / 8 r away from it: four times nearer a step.
    const double error = std::max(deviation(mesh, dense), deviation(dense, mesh));
    EXPECT_LT(error, 0.45 * last_deviation) << vertices;
    last_deviation = error;
  }
  EXPECT_LT(last_deviation, 0.004);
}

TEST(Remesh, RefinesACoarseMesh) {
  const TriangleMesh mesh = remesh(torus(24, 10), {}, {.vertices = 3000});
  EXPECT_EQ(mesh.points.size(), 3000U);
  expect_closed(mesh);
  EXPECT_EQ(genus(mesh), 1);
  EXPECT_LT(edge_length_variation(mesh), 0.2);
}

TEST(Remesh, FollowsTheSizingField) {
  const TriangleMesh dense = torus(300, 90);
  std::vector<double> size;
  for (const Eigen::Vector3d& p : dense.points) size.push_back(p.x() > 0.0 ? 0.5 : 1.0);
  const TriangleMesh mesh = remesh(dense, size, {.vertices = 2000});
  EXPECT_EQ(mesh.points.size(), 2000U);
  double fine = 0.0, coarse = 0.0;
  int fine_count = 0, coarse_count = 0;
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = mesh.points[t[k]], &b = mesh.points[t[(k + 1) % 3]];
      if (std::min(a.x(), b.x()) > 0.2) fine += (a - b).norm(), ++fine_count;
      if (std::max(a.x(), b.x()) < -0.2) coarse += (a - b).norm(), ++coarse_count;
    }
  }
  EXPECT_NEAR((fine / fine_count) / (coarse / coarse_count), 0.5, 0.06);
}

TEST(Remesh, KeepsThinPartsThick) {
  const TriangleMesh dense = finger();
  expect_closed(dense);
  const TriangleMesh mesh = remesh(dense, {}, {.vertices = 60});
  expect_closed(mesh);
  EXPECT_EQ(genus(mesh), 0);
  EXPECT_GT(volume(mesh), 0.7 * volume(dense));
  EXPECT_LT(deviation(dense, mesh), 0.004);
}

TEST(Remesh, IsTheSameEveryTime) {
  const TriangleMesh dense = torus(100, 40);
  const TriangleMesh a = remesh(dense, {}, {.vertices = 500}), b = remesh(dense, {}, {.vertices = 500});
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.points, b.points);
}

TEST(Remesh, RefusesWhatItCannotDo) {
  const TriangleMesh dense = torus(12, 8);
  EXPECT_THAT([&] { remesh(dense, {}, {.vertices = 3}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("found 3")));
  EXPECT_THAT([&] { remesh(dense, {}, {.iterations = 0}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("iterations")));
  EXPECT_THAT([&] { remesh(dense, {1.0}, {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("expected 96 values")));
  EXPECT_THAT([&] { remesh(dense, std::vector<double>(96, -1.0), {}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("relative_size of point 0")));
  TriangleMesh open = dense;
  open.triangles.pop_back();
  EXPECT_THAT([&] { remesh(open, {}, {}); }, ThrowsMessage<InvalidArgument>(HasSubstr("edge")));
}

}  // namespace
}  // namespace reprise
