// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/gradient_field.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/gradient_kernel.h"

namespace reprise {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

// Edges [e1 e2] of a reference triangle from its first corner, laid in the plane. `fallback_length`: edge of
// the equilateral triangle that stands in for one whose corners coincide.
Eigen::Matrix2d planar_edges(const Corners& corners, double min_aspect, double fallback_length) {
  // The longest edge from corner a to b lies on the x axis, the apex above it.
  std::size_t a = 0;
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = (corners[(k + 1) % 3] - corners[k]).norm();
    if (length > longest) {
      longest = length;
      a = k;
    }
  }
  std::array<Eigen::Vector2d, 3> flat;
  flat[a].setZero();
  if (longest > 0.0) {
    const Eigen::Vector3d along = (corners[(a + 1) % 3] - corners[a]) / longest;
    const Eigen::Vector3d to_apex = corners[(a + 2) % 3] - corners[a];
    const double foot = along.dot(to_apex);
    const double altitude = along.cross(to_apex).norm();
    flat[(a + 1) % 3] = {longest, 0.0};
    flat[(a + 2) % 3] = {foot, std::max(altitude, min_aspect * longest)};
  } else {
    flat[(a + 1) % 3] = {fallback_length, 0.0};
    flat[(a + 2) % 3] = {0.5 * fallback_length, std::sqrt(0.75) * fallback_length};
  }
  Eigen::Matrix2d edges;
  edges << flat[1] - flat[0], flat[2] - flat[0];
  return edges;
}

}  // namespace

TriangleGradient GradientKernel::degenerate(const Triangle& triangle, const Eigen::Vector3d& e1,
                                            const Eigen::Vector3d& e2, const Eigen::Matrix2d& inverse_edges) {
  if (!normals_) normals_ = vertex_normals(*poisson_.topology_, positions_);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const std::int32_t v : triangle) normal += normals_->row(v).cast<double>().transpose();

  const std::array<Eigen::Vector3d, 3> edges = {e1, e2, e2 - e1};
  Eigen::Vector3d tangent = *std::max_element(edges.begin(), edges.end(), [](const auto& p, const auto& q) {
    return p.squaredNorm() < q.squaredNorm();
  });
  if (tangent.norm() > 0.0) {
    tangent.normalize();
    normal -= normal.dot(tangent) * tangent;
    if (normal.norm() > 1e-3) {
      normal.normalize();
    } else {
      normal = tangent.unitOrthogonal();
    }
  } else {
    if (normal.norm() > 1e-3) {
      normal.normalize();
    } else {
      normal = Eigen::Vector3d::UnitY();
    }
    tangent = normal.unitOrthogonal();
  }
  Eigen::Matrix<double, 3, 2> frame;
  frame << tangent, normal.cross(tangent);
  Eigen::Matrix<double, 3, 2> F;
  F << e1, e2;
  return polar(frame.transpose() * F * inverse_edges, tangent, normal);
}

PoissonReconstruction::PoissonReconstruction(TopologyPtr topology, const PositionsView& reference,
                                             double min_aspect)
    : topology_(std::move(topology)) {
  if (topology_ == nullptr || topology_->triangles.empty()) {
    throw InvalidArgument("Poisson reconstruction needs a topology with triangles");
  }
  validate(*topology_);
  check_rows("reference", reference.rows());
  if (!(min_aspect > 0.0 && min_aspect <= 0.8)) {
    throw InvalidArgument(fmt::format("min_aspect must lie in (0, 0.8], found {}", min_aspect));
  }
  for (Eigen::Index v = 0; v < reference.rows(); ++v) {
    if (!reference.row(v).allFinite()) {
      throw InvalidArgument(fmt::format("vertex {} of the reference is not finite", v));
    }
  }
  components_ = connected_components(*topology_);
  component_sizes_ = Eigen::VectorXd::Zero(components_.count);
  for (const std::int32_t component : components_.of_vertex) component_sizes_[component] += 1.0;

  const double mean_edge = mean_edge_length(*topology_, reference);
  const double fallback_length = mean_edge > 0.0 ? mean_edge : 1.0;
  reference_triangles_.reserve(topology_->triangles.size());
  for (const Triangle& triangle : topology_->triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = reference.row(triangle[k]).cast<double>().transpose();
    const Eigen::Matrix2d edges = planar_edges(corners, min_aspect, fallback_length);
    reference_triangles_.push_back({edges.inverse(), 0.5 * edges.determinant()});
  }

  // The first vertex of each component is held at the origin by a spring. A right-hand side G^T A F sums to
  // zero over a component, so the spring carries no force and bends nothing, and no unknown has to be
  // renumbered.
  Eigen::SparseMatrix<double> held = laplacian();
  std::vector<char> has_spring(static_cast<std::size_t>(components_.count), 0);
  for (std::int32_t v = 0; v < topology_->vertex_count; ++v) {
    const auto component = static_cast<std::size_t>(components_.of_vertex[static_cast<std::size_t>(v)]);
    if (std::exchange(has_spring[component], 1)) continue;
    double& diagonal = held.coeffRef(v, v);
    diagonal += diagonal > 0.0 ? diagonal : 1.0;
  }
  L_ = SparseCholesky(held);
}

Eigen::Matrix3d PoissonReconstruction::element_laplacian(std::size_t triangle_idx) const {
  const ReferenceTriangle& flat = reference_triangles_.at(triangle_idx);
  // Gradients of the three hat functions (LPBM Eq. 1), one a row.
  Eigen::Matrix<double, 3, 2> G;
  G.bottomRows<2>() = flat.inverse_edges;
  G.row(0) = -flat.inverse_edges.colwise().sum();
  return flat.area * G * G.transpose();
}

Eigen::SparseMatrix<double> PoissonReconstruction::laplacian() const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * topology_->triangles.size());
  for (std::size_t t = 0; t < reference_triangles_.size(); ++t) {
    const Triangle& triangle = topology_->triangles[t];
    const Eigen::Matrix3d element = element_laplacian(t);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        entries.emplace_back(triangle[static_cast<std::size_t>(i)], triangle[static_cast<std::size_t>(j)],
                             element(i, j));
      }
    }
  }
  Eigen::SparseMatrix<double> L(topology_->vertex_count, topology_->vertex_count);
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

GradientField PoissonReconstruction::gradients(const PositionsView& positions) const {
  check_rows("positions", positions.rows());
  GradientKernel kernel(*this, positions);
  GradientField field(topology_->triangles.size());
  for (std::size_t t = 0; t < field.size(); ++t) field[t] = kernel(t);
  return field;
}

Eigen::MatrixX3d PoissonReconstruction::reconstruct(const GradientField& field,
                                                    const Eigen::MatrixX3d& component_centroids) const {
  if (field.size() != topology_->triangles.size()) {
    throw InvalidArgument(fmt::format("gradient field has {} triangles, the topology {}", field.size(),
                                      topology_->triangles.size()));
  }
  if (component_centroids.rows() != components_.count) {
    throw InvalidArgument(fmt::format("{} centroids are given for {} connected components",
                                      component_centroids.rows(), components_.count));
  }
  Coordinates x = Coordinates::Zero(topology_->vertex_count, 3);
  for (std::size_t t = 0; t < field.size(); ++t)
    add_divergence(t, deformation_gradient(field[t].R, field[t].S), x);
  solve_in_place(x, component_centroids);
  return x;
}

Eigen::MatrixX3d PoissonReconstruction::component_centroids(const PositionsView& positions) const {
  check_rows("positions", positions.rows());
  Coordinates sums = Coordinates::Zero(components_.count, 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    sums.row(components_.of_vertex[static_cast<std::size_t>(v)]) += positions.row(v).cast<double>();
  }
  return component_sizes_.cwiseInverse().asDiagonal() * sums;
}

void PoissonReconstruction::check_rows(const char* name, Eigen::Index rows) const {
  if (rows != topology_->vertex_count) {
    throw InvalidArgument(
        fmt::format("{} has {} vertices, the topology {}", name, rows, topology_->vertex_count));
  }
}

void PoissonReconstruction::add_divergence(std::size_t triangle_idx, const Eigen::Matrix<double, 3, 2>& F,
                                           Coordinates& b) const {
  const Triangle& triangle = topology_->triangles[triangle_idx];
  const ReferenceTriangle& flat = reference_triangles_[triangle_idx];
  const Eigen::Matrix<double, 3, 2> force = F * (flat.area * flat.inverse_edges.transpose());
  b.row(triangle[0]) -= (force.col(0) + force.col(1)).transpose();
  b.row(triangle[1]) += force.col(0).transpose();
  b.row(triangle[2]) += force.col(1).transpose();
}

void PoissonReconstruction::solve_in_place(Coordinates& b,
                                           const Eigen::MatrixX3d& component_centroids) const {
  L_.solve_in_place(b);
  Coordinates offsets = Coordinates::Zero(components_.count, 3);
  for (Eigen::Index v = 0; v < b.rows(); ++v) {
    offsets.row(components_.of_vertex[static_cast<std::size_t>(v)]) += b.row(v);
  }
  offsets = component_centroids - component_sizes_.cwiseInverse().asDiagonal() * offsets;
  for (Eigen::Index v = 0; v < b.rows(); ++v) {
    b.row(v) += offsets.row(components_.of_vertex[static_cast<std::size_t>(v)]);
  }
}

}  // namespace reprise
