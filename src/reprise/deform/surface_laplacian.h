// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Laplacian coordinates of a surface (LPBM III, Eq. 1 to 4).

#pragma once

#include <Eigen/SparseCore>

#include "reprise/deform/part_hierarchy.h"

namespace reprise {

// The operator M^-1/2 L: L = G^T A G is the cotangent Laplacian of a reference surface, M its lumped vertex
// areas. With M the sum of squared Laplacian coordinates approximates the integral of the squared Laplacian
// over the surface: neither PCA nor least squares favour densely meshed hands. Robust on slivers: triangles
// of the reference thinner than `min_aspect` are widened to it, so cotangents stay below 1 / min_aspect, and
// areas are held above a thousandth of their mean. Works on any triangles: open, closed, disconnected,
// non-manifold.
//
// A loose component (of a part: one that nothing can hold) has one more row a vertex, its place relative to
// its carrier, so that it goes rigidly with it.
class SurfaceLaplacian {
 public:
  // `reference`: n x 3, metres. Throws `InvalidArgument` as `PoissonReconstruction` does.
  SurfaceLaplacian(const TopologyPtr& topology, const PositionsView& reference,
                   std::span<const PartHierarchy::LooseComponent> loose = {}, double min_aspect = 0.02);

  // rows() x n.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  Eigen::Index rows() const { return matrix_.rows(); }
  Eigen::Index vertex_count() const { return matrix_.cols(); }
  double mean_edge_length() const { return mean_edge_length_; }  // metres, of the reference; 1 if it has none

  // `delta`: 3n x k, a column for n x 3 Laplacian coordinates, vertex by vertex. The displacements, laid out
  // alike, that have them in the least-squares sense; a loose component moves as its carrier does.
  // Translations stay open: one vertex of each connected component is held near 0.
  Eigen::MatrixXd displacements(const Eigen::MatrixXd& delta) const;

  // Laplacian coordinates delta = M^-1/2 L x, rows() x 3.
  Coordinates operator()(const Coordinates& positions) const;

 private:
  Eigen::SparseMatrix<double> matrix_;
  double mean_edge_length_ = 1.0;
};

}  // namespace reprise
