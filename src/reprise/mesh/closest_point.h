// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Closest points and ray hits on a triangle mesh.

#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "reprise/mesh/topology.h"

namespace reprise {

// A triangle mesh in double precision, while it is being worked on.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<Triangle> triangles;
};

// A place on a mesh: points[corner 0] * weights[0] + ... of one triangle.
struct SurfacePoint {
  std::int32_t triangle = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  // not negative, sum 1
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0.0;  // to the point asked for
};

// One crossing of a ray: at origin + t * direction.
struct RayHit {
  std::int32_t triangle = -1;
  double t = 0.0;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  bool front = false;  // the ray meets the outside of the triangle
};

// Box tree over the triangles. Queries are const and may run in several threads; of several equally near
// triangles the one with the lowest index is given.
class ClosestPointTree {
 public:
  // Throws `InvalidArgument` for a triangle with an index out of range or a point that is not finite.
  ClosestPointTree(std::vector<Eigen::Vector3d> points, std::vector<Triangle> triangles);

  // Nothing if no triangle is nearer than `max_distance`. With `facing`, only triangles whose normal makes
  // less than a right angle with it count: the other side of something thin is never found.
  std::optional<SurfacePoint> closest(const Eigen::Vector3d& query,
                                      double max_distance = std::numeric_limits<double>::infinity(),
                                      const Eigen::Vector3d* facing = nullptr) const;

  // Fills `hits` with all crossings of the ray with 0 <= t <= max_t, nearest first. `direction` need not be
  // of unit length.
  void hits(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_t,
            std::vector<RayHit>& hits) const;

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  // Unit normal of a triangle, zero if it has no area.
  const Eigen::Vector3d& normal(std::int32_t triangle) const { return normals_[triangle]; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    std::int32_t begin = 0;  // of `order_`
    std::int32_t end = 0;
    std::int32_t second = 0;  // the first child follows its parent; 0: a leaf
  };
  void build(std::int32_t begin, std::int32_t end);

  std::vector<Eigen::Vector3d> points_;
  std::vector<Triangle> triangles_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<std::int32_t> order_;
  std::vector<Eigen::Vector3d> centers_;
  std::vector<Node> nodes_;
};

// Weights of the point of triangle abc nearest to `query`.
Eigen::Vector3d closest_weights(const Eigen::Vector3d& query, const Eigen::Vector3d& a,
                                const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace reprise
