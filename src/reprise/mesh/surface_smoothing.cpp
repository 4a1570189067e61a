// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/surface_smoothing.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr int step_count = 4;
// Cotangents of very flat angles would tie vertices together beyond working precision, negative ones would
// push values out of their range.
constexpr double max_cotangent = 100.0;
constexpr double least_mass = 1e-6;  // of the mean mass of a vertex

}  // namespace

SurfaceSmoother::SurfaceSmoother(const Topology& topology, std::span<const Eigen::Vector3d> points,
                                 double radius) {
  const auto vertex_count = static_cast<std::size_t>(topology.vertex_count);
  if (points.size() != vertex_count) {
    throw InvalidArgument(
        fmt::format("smoothing a surface: expected {} points, found {}", vertex_count, points.size()));
  }
  if (!(radius > 0.0) || !std::isfinite(radius)) {
    throw InvalidArgument(
        fmt::format("smoothing a surface: expected a positive radius in metres, found {}", radius));
  }
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!points[v].allFinite())
      throw InvalidArgument(fmt::format("point {}: expected finite coordinates", v));
  }
  const double time_step = radius * radius / (8.0 * step_count);
  masses_ = Eigen::VectorXd::Zero(topology.vertex_count);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = triangle[c];
      const std::int32_t i = triangle[(c + 1) % 3];
      const std::int32_t j = triangle[(c + 2) % 3];
      const Eigen::Vector3d to_i = points[static_cast<std::size_t>(i)] - points[static_cast<std::size_t>(a)];
      const Eigen::Vector3d to_j = points[static_cast<std::size_t>(j)] - points[static_cast<std::size_t>(a)];
      const double twice_area = to_i.cross(to_j).norm();
      masses_[a] += twice_area / 6.0;
      if (twice_area == 0.0) continue;
      const double weight = 0.5 * time_step * std::clamp(to_i.dot(to_j) / twice_area, 0.0, max_cotangent);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
      entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
    }
  }
  // Crumbs without area would make the matrix singular.
  const double least = masses_.sum() > 0.0 ? least_mass * masses_.mean() : 1.0;
  for (std::int32_t v = 0; v < topology.vertex_count; ++v) {
    masses_[v] = std::max(masses_[v], least);
    entries.emplace_back(v, v, masses_[v]);
  }
  Eigen::SparseMatrix<double> A(topology.vertex_count, topology.vertex_count);
  A.setFromTriplets(entries.begin(), entries.end());
  step_ = SparseCholesky(A);
}

void SurfaceSmoother::smooth(Values& values) const {
  if (values.rows() != masses_.size()) {
    throw InvalidArgument(
        fmt::format("smoothing a surface: expected {} values, found {}", masses_.size(), values.rows()));
  }
  for (int step = 0; step < step_count; ++step) {
    values = masses_.asDiagonal() * values;
    step_.solve_in_place(values);
  }
}

}  // namespace reprise
