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

// The least vertex of each set of vertices that the entries of A join.
std::vector<Eigen::Index> first_vertices_of_components(const Eigen::SparseMatrix<double>& A) {
  std::vector<Eigen::Index> first;
  std::vector<char> is_reached(static_cast<std::size_t>(A.cols()), 0);
  std::vector<Eigen::Index> open;
  for (Eigen::Index start = 0; start < A.cols(); ++start) {
    if (is_reached[static_cast<std::size_t>(start)] != 0) continue;
    first.push_back(start);
    is_reached[static_cast<std::size_t>(start)] = 1;
    open.assign(1, start);
    while (!open.empty()) {
      const Eigen::Index v = open.back();
      open.pop_back();
      for (Eigen::SparseMatrix<double>::InnerIterator entry(A, v); entry; ++entry) {
        char& reached = is_reached[static_cast<std::size_t>(entry.row())];
        if (reached == 0) open.push_back(entry.row());
        reached = 1;
      }
    }
  }
  return first;
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
  // What A is solved for sums to zero over a component, so that the spring of its held vertex carries
  // nothing.
  Eigen::SparseMatrix<double> A = matrix_.transpose() * matrix_;
  for (const Eigen::Index v : first_vertices_of_components(A)) {
    double& diagonal = A.coeffRef(v, v);
    diagonal += diagonal > 0.0 ? diagonal : 1.0;
  }
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
