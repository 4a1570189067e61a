// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The rotation nearest to a matrix (orthogonal Procrustes problem).

#pragma once

#include <Eigen/Core>
#include <Eigen/SVD>

namespace reprise {

// The proper rotation R with the greatest sum over i, j of R_ij M_ij; for points p_i and q_i about their
// centroids and M = sum q_i p_i^T it is the one that takes p to q best (Kabsch 1976). Flat and mirrored sets
// of points do not make it a reflection.
inline Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  const Eigen::Vector3d signs(1.0, 1.0, (U * V.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  return U * signs.asDiagonal() * V.transpose();
}

}  // namespace reprise
