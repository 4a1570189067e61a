// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Surfaces to edit: closed, open, in pieces, non-manifold, full of slivers; and what became of them.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "reprise/deform/part_hierarchy.h"
#include "reprise/deform/position_constraint.h"
#include "support/shapes.h"

namespace reprise::edit_test {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

inline PositionsView view(const Positions& positions) {
  return {positions.data(), positions.rows(), 3};
}

template <typename Map>
inline Positions mapped(const Positions& positions, const Map& map) {
  Positions result(positions.rows(), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const Vector3d p = positions.row(v).cast<double>().transpose();
    result.row(v) = Vector3d(map(p)).cast<float>().transpose();
  }
  return result;
}

// A bar of 2 m along x.
inline test::Shape bar(int levels = 3) {
  test::Shape shape = test::sphere(levels);
  shape.positions = mapped(shape.positions, [](const Vector3d& p) -> Vector3d {
    return {p.x(), 0.15 * (p.y() - 1.0), 0.15 * p.z()};
  });
  return shape;
}

inline test::Shape join(const test::Shape& a, const test::Shape& b) {
  Topology topology = *a.topology;
  for (Triangle triangle : b.topology->triangles) {
    for (std::int32_t& v : triangle) v += a.topology->vertex_count;
    topology.triangles.push_back(triangle);
  }
  topology.vertex_count += b.topology->vertex_count;
  Positions positions(topology.vertex_count, 3);
  positions << a.positions, b.positions;
  return {std::make_shared<const Topology>(std::move(topology)), positions};
}

// A ball, a smaller cloth and a vertex without triangles.
inline test::Shape pieces() {
  const test::Shape vertex = {std::make_shared<const Topology>(Topology{.vertex_count = 1}),
                              Positions(Eigen::RowVector3f(0.5F, 2.5F, 0.3F))};
  return join(join(test::sphere(3), test::sheet(8)), vertex);
}

// Sheets that share an edge loop: three triangles at each of its edges.
inline test::Shape non_manifold() {
  test::Shape shape = test::sheet(8);
  Topology topology = *shape.topology;
  const std::int32_t n = topology.vertex_count;
  // Another copy stands on the row of vertices at the front.
  Positions positions(2 * n, 3);
  positions << shape.positions, mapped(shape.positions, [](const Vector3d& p) -> Vector3d {
    return {p.x(), p.z() + 0.5, p.y()};
  });
  const auto joined = [&](std::int32_t v) {
    for (std::int32_t w = 0; w < n; ++w) {
      if ((positions.row(w) - (positions.row(v) - Eigen::RowVector3f(0.0F, 0.5F, 0.0F))).norm() < 1e-6F)
        return w;
    }
    return v;
  };
  for (const Triangle& triangle : shape.topology->triangles)
    topology.triangles.push_back({joined(triangle[0] + n), joined(triangle[1] + n), joined(triangle[2] + n)});
  topology.vertex_count = 2 * n;
  return {std::make_shared<const Topology>(std::move(topology)), positions};
}

// A third of the vertices moved nearly, and some wholly, onto a neighbour.
inline test::Shape slivers() {
  test::Shape shape = test::sphere(3);
  std::mt19937 random(7);
  for (std::size_t t = 0; t < shape.topology->triangles.size(); t += 9) {
    const Triangle& triangle = shape.topology->triangles[t];
    const float share = std::array{0.9F, 0.999F, 0.99999F, 1.0F}[random() % 4];
    shape.positions.row(triangle[0]) +=
        (share * (shape.positions.row(triangle[1]) - shape.positions.row(triangle[0]))).eval();
  }
  return shape;
}

struct Case {
  std::string name;
  test::Shape shape;
};
inline std::vector<Case> all_cases() {
  return {
      {"closed", test::sphere(3)}, {"open", test::sheet(12)},        {"body", test::body()}, {"bar", bar()},
      {"pieces", pieces()},        {"non-manifold", non_manifold()}, {"slivers", slivers()}};
}

// A frame that differs from the reference: bent, twisted, stretched.
inline Positions posed(const Positions& reference) {
  return mapped(reference, [](const Vector3d& p) -> Vector3d {
    const Vector3d q(1.1 * p.x() + 0.1 * std::sin(2.0 * p.y()), p.y(), p.z() + 0.1 * p.x() * p.x());
    return AngleAxisd(0.5 * p.y(), Vector3d(0.2, 1.0, 0.1).normalized()) * q;
  });
}

template <typename Map>
std::vector<PositionConstraint> every(int step, const Positions& frame, const Map& map) {
  std::vector<PositionConstraint> constraints;
  for (std::int32_t v = 0; v < frame.rows(); v += step) {
    constraints.push_back({.vertex = v,
                           .target = map(Vector3d(frame.row(v).cast<double>().transpose())),
                           .weight = 1.0 + 0.5 * (v % 3)});
  }
  return constraints;
}

inline double largest_distance(const Coordinates& a, const Coordinates& b) {
  return std::sqrt((a - b).rowwise().squaredNorm().maxCoeff());
}

inline Coordinates moved(const Positions& frame, const Matrix3d& Q, const Vector3d& t) {
  return (frame.cast<double>() * Q.transpose()).rowwise() + t.transpose();
}

// Quantile of edge length over that in the frame.
inline double stretch(const Topology& topology, const Positions& frame, const Coordinates& positions,
                      double quantile) {
  std::vector<double> ratios;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      const double before = (frame.row(a) - frame.row(b)).cast<double>().norm();
      if (before > 1e-6) ratios.push_back((positions.row(a) - positions.row(b)).norm() / before);
    }
  }
  std::ranges::sort(ratios);
  return ratios[static_cast<std::size_t>(quantile * static_cast<double>(ratios.size() - 1))];
}

inline double volume(const Topology& topology, const Coordinates& x) {
  double sum = 0.0;
  for (const Triangle& t : topology.triangles) sum += x.row(t[0]).dot(x.row(t[1]).cross(x.row(t[2]))) / 6.0;
  return sum;
}

}  // namespace reprise::edit_test
