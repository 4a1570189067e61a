// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/surface/capture_surface.h"

#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/mesh/halfedges.h"
#include "reprise/mesh/remesh.h"
#include "reprise/synthetic/body/makehuman.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Making a surface takes seconds: one serves all tests of a process.
struct Performer {
  Performer() : body(load_costume("fashion1"), {}), surface(body, {.vertices = 2500, .texture_size = 1024}) {}

  DressedBody body;
  CaptureSurface surface;
};

const Performer& performer() {
  static const Performer made;
  return made;
}

TriangleMesh mesh_of(const CaptureSurface& surface) {
  TriangleMesh mesh{.points = {}, .triangles = surface.topology()->triangles};
  for (Eigen::Index v = 0; v < surface.rest().rows(); ++v)
    mesh.points.emplace_back(surface.rest().row(v).cast<double>().transpose());
  return mesh;
}

std::vector<Points> rest_points(const DressedBody& body) {
  std::vector<Points> points;
  for (const BodyLayer& layer : body.layers()) points.push_back(layer.points);
  return points;
}

// Mean colour of the vertices within `radius` of a place.
Eigen::Vector3d color_near(const CaptureSurface& surface, const Eigen::Vector3d& place, double radius) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (Eigen::Index v = 0; v < surface.rest().rows(); ++v) {
    if ((surface.rest().row(v).cast<double>().transpose() - place).norm() > radius) continue;
    const Color& color = surface.colors()[static_cast<std::size_t>(v)];
    sum += Eigen::Vector3d(color[0], color[1], color[2]);
    ++count;
  }
  EXPECT_GT(count, 0.0);
  return sum / count;
}

TEST(CaptureSurface, IsOneClosedSurfaceOfEvenTriangles) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const CaptureSurface& surface = performer().surface;
  const TriangleMesh mesh = mesh_of(surface);
  EXPECT_NEAR(static_cast<double>(mesh.points.size()), 2500.0, 25.0);
  EXPECT_NO_THROW(Halfedges(static_cast<std::int32_t>(mesh.points.size()), mesh.triangles));
  EXPECT_EQ(connected_components(*surface.topology()).count, 1);
  EXPECT_EQ(genus(mesh), 0);
  EXPECT_LT(edge_length_variation(mesh), 0.35);
  double volume = 0.0;
  Eigen::AlignedBox3d box;
  for (const Triangle& t : mesh.triangles)
    volume += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]])) / 6.0;
  for (const Eigen::Vector3d& p : mesh.points) box.extend(p);
  // A slender person of 1.6 m has some 50 litres; the space under her skirt and her hair come on top.
  EXPECT_GT(volume, 0.045);
  EXPECT_LT(volume, 0.12);
  EXPECT_NEAR(box.min().y(), 0.0, 0.01);
  EXPECT_NEAR(box.max().y(), 1.62, 0.03);
}

TEST(CaptureSurface, TurnsNoTriangleOverAtRest) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const TriangleMesh mesh = mesh_of(performer().surface);
  std::vector<Eigen::Vector3d> normals(mesh.points.size(), Eigen::Vector3d::Zero());
  const auto area = [&](const Triangle& t) -> Eigen::Vector3d {
    return (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
  };
  for (const Triangle& t : mesh.triangles) {
    for (const std::int32_t v : t) normals[v] += area(t);
  }
  for (const Triangle& t : mesh.triangles)
    EXPECT_GT(area(t).dot(normals[t[0]] + normals[t[1]] + normals[t[2]]), 0.0);
}

TEST(CaptureSurface, LiesOnTheLayersItIsBoundTo) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  int far = 0, bound = 0, membranes = 0;
  std::map<int, ClosestPointTree> trees;
  for (Eigen::Index v = 0; v < surface.rest().rows(); ++v) {
    const int l = surface.layer_of_vertex()[static_cast<std::size_t>(v)];
    if (l == CaptureSurface::membrane) {
      ++membranes;
      // Only the hem is closed off.
      EXPECT_NEAR(surface.rest()(v, 1), 0.5, 0.06);
      EXPECT_EQ(surface.joint_of_vertex()[static_cast<std::size_t>(v)], -1);
      continue;
    }
    const BodyLayer& layer = body.layers()[static_cast<std::size_t>(l)];
    if (layer.kind == BodyLayer::Kind::hair) continue;  // a volume about its cards
    if (!trees.contains(l)) {
      std::vector<Eigen::Vector3d> points;
      for (Eigen::Index i = 0; i < layer.points.rows(); ++i)
        points.emplace_back(layer.points.row(i).transpose());
      trees.emplace(l, ClosestPointTree(points, layer.triangles));
    }
    ++bound;
    const auto near = trees.at(l).closest(surface.rest().row(v).cast<double>().transpose());
    // Balanced triangles lie up to 3 mm outside, smoothing rounds creases.
    if (near->distance > 0.006) ++far;
  }
  EXPECT_GT(membranes, 20);
  EXPECT_GT(bound, 1500);
  EXPECT_LT(far, bound / 40);
}

TEST(CaptureSurface, OfTheRestLayersIsTheRestSurface) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  const Positions posed = surface.pose(rest_points(body));
  EXPECT_LT((posed - surface.rest()).cwiseAbs().maxCoeff(), 1e-6F);
}

TEST(CaptureSurface, MovesRigidlyWithItsLayers) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(0.3, 1.0, -0.4).normalized()).toRotationMatrix();
  const Eigen::RowVector3d shift(2.0, -0.3, 1.0);
  std::vector<Points> moved = rest_points(body);
  for (Points& points : moved) points = ((points * turn.transpose()).rowwise() + shift).eval();
  const Points expected = (surface.rest().cast<double>() * turn.transpose()).rowwise() + shift;
  EXPECT_LT((surface.pose(moved).cast<double>() - expected).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(CaptureSurface, FollowsTheJointsWhereTheBodyIsTight) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  const Skeleton& skeleton = body.skeleton();
  std::set<int> used;
  for (std::size_t v = 0; v < surface.joint_of_vertex().size(); ++v) {
    const int joint = surface.joint_of_vertex()[v];
    ASSERT_GE(joint, -1);
    ASSERT_LT(joint, skeleton.size());
    if (joint < 0) continue;
    used.insert(joint);
    const Eigen::Vector3d p = surface.rest().row(static_cast<Eigen::Index>(v)).cast<double>().transpose();
    EXPECT_LT((p - skeleton.joints[joint].rest_position).norm(), 0.6) << skeleton.joints[joint].name;
  }
  for (const char* name : {"head", "left_hand", "right_hand", "left_forearm", "right_shin", "left_foot"})
    EXPECT_TRUE(used.contains(skeleton.joint_idx(name))) << name;
}

TEST(CaptureSurface, ShowsTheColorsOfItsLayers) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  const Skeleton& skeleton = body.skeleton();
  const Eigen::Vector3d head = skeleton.joints[skeleton.joint_idx("head")].rest_position;
  const Eigen::Vector3d cheek = color_near(surface, head + Eigen::Vector3d(0.035, 0.0, 0.09), 0.03);
  const Eigen::Vector3d crown = color_near(surface, head + Eigen::Vector3d(0.0, 0.14, -0.04), 0.05);
  const Eigen::Vector3d hand =
      color_near(surface, skeleton.joints[skeleton.joint_idx("left_hand")].rest_position, 0.05);
  // Skin is light and warm, hair is darker, and hand and face are of one person.
  EXPECT_GT(cheek.mean(), crown.mean() + 30.0);
  EXPECT_GT(cheek[0], cheek[2] + 10.0);
  EXPECT_LT((cheek - hand).norm(), 70.0);
  // The dress is blue with light dots: its skirt is bluer than any skin.
  const Eigen::Vector3d skirt = color_near(surface, Eigen::Vector3d(0.0, 0.75, 0.13), 0.1);
  EXPECT_GT(skirt[2] - skirt[0], cheek[2] - cheek[0] + 40.0);
}

TEST(CaptureSurface, HasAnAtlasThatFits) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const Topology& topology = *performer().surface.topology();
  ASSERT_TRUE(topology.texture);
  EXPECT_EQ(topology.texture->width, 1024);
  EXPECT_EQ(topology.triangle_uvs.size(), topology.triangles.size());
  double used = 0.0;
  for (const Triangle& t : topology.triangle_uvs) {
    const auto at = [&](int k) { return Eigen::Vector2d(topology.uvs[t[k]][0], topology.uvs[t[k]][1]); };
    const Eigen::Vector2d u = at(1) - at(0), v = at(2) - at(0);
    EXPECT_GT(u.x() * v.y() - u.y() * v.x(), 0.0);
    used += 0.5 * (u.x() * v.y() - u.y() * v.x());
  }
  EXPECT_GT(used, 0.35);
}

TEST(CaptureSurface, RefusesWhatItCannotDo) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto& [body, surface] = performer();
  for (const int vertices : {999, 50001}) {
    EXPECT_THAT([&] { CaptureSurface(body, {.vertices = vertices}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("vertices: expected 1000 to 50000")));
  }
  for (const int size : {128, 1000, 16384}) {
    EXPECT_THAT([&] { CaptureSurface(body, {.texture_size = size}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("texture_size: expected a power of two")));
  }
  std::vector<Points> points = rest_points(body);
  points.back().conservativeResize(points.back().rows() - 1, 3);
  EXPECT_THAT([&] { surface.pose(points); },
              ThrowsMessage<InvalidArgument>(HasSubstr("layer_points of layer")));
  points.pop_back();
  EXPECT_THAT([&] { surface.pose(points); }, ThrowsMessage<InvalidArgument>(HasSubstr("layers, found")));
}

}  // namespace
}  // namespace reprise
