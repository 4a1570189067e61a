// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/surface_laplacian.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reprise/deform/gradient_field.h"
#include "reprise/linalg/sparse_cholesky.h"

namespace reprise {
namespace {

// A third of the triangles around each vertex, m^2.
Eigen::VectorXd areas_around_vertices(const Topology& topology, const PositionsView& reference,
                                      double edge_length) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(topology.vertex_count);
  for (const Triangle& triangle : topology.triangles) {
    const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
      return reference.row(triangle[k]).cast<double>().transpose();
    };
    const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (const std::int32_t v : triangle) areas[v] += area / 3.0;
  }
  constexpr double least_share = 1e-3;
  double least = least_share * areas.mean();
  if (!(least > 0.0)) least = least_share * edge_length * edge_length;
  return areas.cwiseMax(least);
}

}  // namespace

SurfaceLaplacian::SurfaceLaplacian(const TopologyPtr& topology, const PositionsView& reference,
                                   std::span<const PartHierarchy::LooseComponent> loose, double min_aspect) {
  const Eigen::SparseMatrix<double> L = PoissonReconstruction(topology, reference, min_aspect).laplacian();
  const double edge_length = reprise::mean_edge_length(*topology, reference);
  if (edge_length > 0.0) mean_edge_length_ = edge_length;
  const Eigen::VectorXd areas = areas_around_vertices(*topology, reference, mean_edge_length_);

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(L.nonZeros()));
  for (Eigen::Index column = 0; column < L.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(L, column); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(column),
                           entry.value() / std::sqrt(areas[entry.row()]));
    }
  }
  Eigen::Index row = L.rows();
  const double stiffness = 1.0 / mean_edge_length_;  // of the order of the other entries
  for (const PartHierarchy::LooseComponent& component : loose) {
    for (const std::int32_t v : component.vertices) {
      entries.emplace_back(static_cast<int>(row), v, stiffness);
      entries.emplace_back(static_cast<int>(row), component.carrier, -stiffness);
      ++row;
    }
  }
  matrix_.resize(row, L.cols());
  matrix_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::MatrixXd SurfaceLaplacian::displacements(const Eigen::MatrixXd& delta) const {
  // Every component that is not loose has its mean held near zero by a pull too weak to bend it.
  constexpr double pull = 1e-10;
  Eigen::SparseMatrix<double> A = matrix_.transpose() * matrix_;
  const double scale = A.diagonal().mean();
  for (Eigen::Index v = 0; v < A.cols(); ++v) A.coeffRef(v, v) += pull * scale;
  const SparseCholesky factor(A);
  const Eigen::SparseMatrix<double> L = matrix_.topRows(vertex_count());
  Eigen::MatrixXd result(delta.rows(), delta.cols());
  for (Eigen::Index k = 0; k < delta.cols(); ++k) {
    Coordinates b = L.transpose() * Eigen::Map<const Coordinates>(delta.col(k).data(), vertex_count(), 3);
    factor.solve_in_place(b);
    Eigen::Map<Coordinates>(result.col(k).data(), vertex_count(), 3) = b;
  }
  return result;
}

Coordinates SurfaceLaplacian::operator()(const Coordinates& positions) const {
  return matrix_ * positions;
}

}  // namespace reprise
