// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Averages of values at vertices along a surface.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/linalg/sparse_cholesky.h"
#include "reprise/mesh/topology.h"

namespace reprise {

// Heat that flows along the surface until it has spread, by its second moment, like a disc of the given
// radius: dc/dt = -M^-1 L c with the cotangent Laplacian L, for t = radius^2 / 8 in four implicit steps of
// one factorisation. Nothing flows between parts that are near in space but not along the surface.
class SurfaceSmoother {
 public:
  using Values = SparseCholesky::RowMajorMatrix;

  // `radius`: metres, positive. Throws `InvalidArgument` unless `points` has one finite entry per vertex.
  SurfaceSmoother(const Topology& topology, std::span<const Eigen::Vector3d> points, double radius);

  // `values`: one row a vertex. Constants stay, area-weighted means too, and no value leaves the range of
  // those given. Const and thread-safe.
  void smooth(Values& values) const;

 private:
  Eigen::VectorXd masses_;
  SparseCholesky step_;
};

}  // namespace reprise
