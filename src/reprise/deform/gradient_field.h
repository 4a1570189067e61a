// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Gradient-field representation of a surface (LPBM III): one deformation gradient per triangle with respect
// to one reference, and the Poisson system that links them back together.

#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "reprise/linalg/sparse_cholesky.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// Deformation gradient F = R S of one triangle against its reference triangle: R the rotation from the
// reference triangle's tangent frame to the world (its third axis is the normal), S the symmetric in-plane
// stretch (2 x 2: xx, xy, yy). The normal direction is unstretched, so the polar factors have a closed form
// and stay defined for slivers.
struct TriangleGradient {
  Eigen::Quaterniond R;
  Eigen::Vector3d S;
};
using GradientField = std::vector<TriangleGradient>;  // one per triangle

// The one kept factorisation of L = G^T A G, shared by every frame and every blend of a performer. L is
// positive semi-definite; one vertex of each connected component is held to make it definite, and each
// component is then translated to the wanted centroid. Immutable after construction; all methods are
// thread-safe.
class PoissonReconstruction {
 public:
  // `reference`: N x 3 on `topology`. Any frame will do; triangles of the reference thinner than `min_aspect`
  // (altitude over longest edge, in (0, 0.8]) are widened to it, since a reference triangle only parametrises
  // gradients and may have any shape. Throws `InvalidArgument` if the topology has no triangles, shapes do
  // not fit or a coordinate is not finite.
  PoissonReconstruction(TopologyPtr topology, const PositionsView& reference, double min_aspect = 0.02);

  const TopologyPtr& topology() const { return topology_; }

  // Gradients of a frame against the reference, by 2 x 2 polar decomposition. A triangle without area takes
  // the normal of its neighbourhood; gradients of finite positions are finite.
  GradientField gradients(const PositionsView& positions) const;

  // Positions whose gradients are nearest to `field` in the area-weighted least-squares sense, each connected
  // component with its vertex centroid at the row of `component_centroids` (C x 3). Result N x 3.
  Eigen::MatrixX3d reconstruct(const GradientField& field, const Eigen::MatrixX3d& component_centroids) const;

  // L = G^T A G, N x N, positive semi-definite, both triangles stored: the cotangent Laplacian of the
  // (widened) reference.
  Eigen::SparseMatrix<double> laplacian() const;

  // The share of one triangle in L: A G G^T of its three hat functions, 3 x 3 by corner. Rows add up to 0.
  Eigen::Matrix3d element_laplacian(std::size_t triangle_idx) const;

  // Vertex centroids of the connected components, C x 3. An unreferenced vertex is a component of its own.
  Eigen::MatrixX3d component_centroids(const PositionsView& positions) const;

 private:
  friend class GradientKernel;
  friend void blend_frames(const PoissonReconstruction&, const PositionsView&, const PositionsView&, double,
                           PositionsRef);

  // Row-major, so that the three coordinates of a vertex are scattered and solved side by side.
  using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  struct ReferenceTriangle {
    Eigen::Matrix2d inverse_edges;  // [e1 e2]^-1 in the tangent frame, 1/m
    double area;                    // m^2
  };

  void check_rows(const char* name, Eigen::Index rows) const;
  // Adds A F of one triangle to the right-hand side G^T A F.
  void add_divergence(std::size_t triangle_idx, const Eigen::Matrix<double, 3, 2>& F, Coordinates& b) const;
  // From right-hand side to positions.
  void solve_in_place(Coordinates& b, const Eigen::MatrixX3d& component_centroids) const;

  TopologyPtr topology_;
  ConnectedComponents components_;
  Eigen::VectorXd component_sizes_;  // vertices per component
  std::vector<ReferenceTriangle> reference_triangles_;
  SparseCholesky L_;
};

}  // namespace reprise
