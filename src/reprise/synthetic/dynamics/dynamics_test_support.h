// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Simple bodies and cloths for the tests of cloth and hair.

#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::test {

struct TestSurface {
  Points points;
  std::vector<Triangle> triangles;
};

// `around` columns and `along` rows of place(angle, part); closed around. Outside is to the left of growing
// angle when going along.
template <typename Place>
TestSurface tube(int around, int along, const Place& place) {
  TestSurface surface;
  surface.points.resize(Eigen::Index{around} * along, 3);
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i)
      surface.points.row(Eigen::Index{j} * around + i) =
          place(2.0 * std::numbers::pi * i / around, static_cast<double>(j) / (along - 1));
  for (int j = 0; j + 1 < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      surface.triangles.push_back({a, a + around, b + around});
      surface.triangles.push_back({a, b + around, b});
    }
  return surface;
}

inline TestSurface operator+(TestSurface a, const TestSurface& b) {
  const auto before = static_cast<std::int32_t>(a.points.rows());
  a.points.conservativeResize(before + b.points.rows(), 3);
  a.points.bottomRows(b.points.rows()) = b.points;
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + before, t[1] + before, t[2] + before});
  return a;
}

// A capsule from the origin down: where a leg of that length hangs from its hip.
inline TestSurface leg(double radius, double length) {
  constexpr double pi = std::numbers::pi;
  return tube(24, 40, [=](double angle, double part) {
    const double cap = pi * radius / 2.0, way = part * (2.0 * cap + length);
    double y = 0.0, r = radius;
    if (way < cap) {
      r = radius * std::sin(way / radius);
      y = radius * std::cos(way / radius);
    } else if (way < cap + length) {
      y = -(way - cap);
    } else {
      r = radius * std::cos((way - cap - length) / radius);
      y = -length - radius * std::sin((way - cap - length) / radius);
    }
    r = std::max(r, 1e-5);
    return Eigen::RowVector3d(r * std::cos(angle), y, -r * std::sin(angle));
  });
}

// A piece of cloth in the plane z = 0, hanging from y = 0; the first row is its top.
inline TestSurface cloth_sheet(int columns, int rows, double width, double height) {
  TestSurface surface;
  surface.points.resize(Eigen::Index{columns} * rows, 3);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      surface.points.row(Eigen::Index{j} * columns + i) << width * i / (columns - 1),
          -height * j / (rows - 1), 0.0;
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i, b = a + 1;
      surface.triangles.push_back({a, a + columns, b + columns});
      surface.triangles.push_back({a, b + columns, b});
    }
  return surface;
}

inline Points moved(const Points& points, const Eigen::Isometry3d& to_from) {
  return ((points * to_from.linear().transpose()).rowwise() + to_from.translation().transpose()).eval();
}

inline Eigen::Isometry3d turn_about(const Eigen::Vector3d& axis, double angle,
                                    const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  result.translation() = shift;
  return result;
}

}  // namespace reprise::test
