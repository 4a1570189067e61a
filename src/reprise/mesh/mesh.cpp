// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/mesh.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

void check_shape(const Topology& topology, const PositionsView& positions) {
  if (positions.rows() != topology.vertex_count) {
    throw InvalidArgument(fmt::format("positions of {} vertices do not fit a topology of {} vertices",
                                      positions.rows(), topology.vertex_count));
  }
}

// Twice the area times the unit normal.
Eigen::Vector3d area_vector(const Triangle& triangle, const PositionsView& positions) {
  const Eigen::Vector3d a = positions.row(triangle[0]).cast<double>();
  const Eigen::Vector3d b = positions.row(triangle[1]).cast<double>();
  const Eigen::Vector3d c = positions.row(triangle[2]).cast<double>();
  return (b - a).cross(c - a);
}

}  // namespace

Positions vertex_normals(const Topology& topology, const PositionsView& positions) {
  check_shape(topology, positions);
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> sum =
      Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>::Zero(topology.vertex_count, 3);
  for (const Triangle& triangle : topology.triangles) {
    const Eigen::RowVector3d normal = area_vector(triangle, positions).transpose();
    for (const std::int32_t v : triangle) sum.row(v) += normal;
  }
  // Row by row: this leaves zero rows as they are, where rowwise().normalize() would divide by zero.
  for (Eigen::Index v = 0; v < sum.rows(); ++v) sum.row(v).stableNormalize();
  return sum.cast<float>();
}

double surface_area(const Topology& topology, const PositionsView& positions) {
  check_shape(topology, positions);
  double area = 0.0;
  for (const Triangle& triangle : topology.triangles) area += 0.5 * area_vector(triangle, positions).norm();
  return area;
}

double mean_edge_length(const Topology& topology, const PositionsView& positions) {
  check_shape(topology, positions);
  if (topology.triangles.empty()) return 0.0;
  double sum = 0.0;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k)
      sum += (positions.row(triangle[k]) - positions.row(triangle[(k + 1) % 3])).cast<double>().norm();
  }
  return sum / (3.0 * static_cast<double>(topology.triangles.size()));
}

std::string degeneracy(const Topology& topology, const PositionsView& positions) {
  check_shape(topology, positions);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!positions.row(v).allFinite()) {
      return fmt::format("vertex {} is ({}, {}, {}): expected finite coordinates", v, positions(v, 0),
                         positions(v, 1), positions(v, 2));
    }
  }
  if (!(surface_area(topology, positions) > 0.0)) return "all triangles have zero area";
  return {};
}

}  // namespace reprise
