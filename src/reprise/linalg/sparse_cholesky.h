// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Sparse Cholesky factorisations that are kept and solved many times.

#pragma once

#include <memory>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace reprise {

// L L^T factorisation of a symmetric positive definite matrix, by CHOLMOD's simplicial (LGPL) method with a
// fill-reducing ordering. `solve` may be called from several threads at once. Moved-from objects have size 0.
class SparseCholesky {
 public:
  // One right-hand side a column, stored row by row: the layout of positions, and the fastest to solve.
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  SparseCholesky();
  // `A`: n x n, symmetric; only the lower triangle is read. Throws `InvalidArgument` if it is not square, not
  // finite or not positive definite to working precision (names the first pivot that fails by its row in
  // `A`).
  explicit SparseCholesky(const Eigen::SparseMatrix<double>& A);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  Eigen::Index size() const;
  // Entries of the factor, a measure of memory and of the time of a solve.
  Eigen::Index factor_nonzeros() const;

  // x with A x = b, for every column of `b` (n x k). Columns are solved four at a time, so that one costs as
  // much as four. Throws `InvalidArgument` if `b` does not have n rows.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  // The same with the solution written over `b`.
  void solve_in_place(Eigen::Ref<RowMajorMatrix> b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reprise
