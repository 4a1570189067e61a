// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// CHOLMOD as a peer of our own back-substitution.

#pragma once

#include <cstddef>

#include <Eigen/SparseCore>
#include <cholmod.h>

namespace reprise::benchmark {

// CHOLMOD factor of the lower triangle of `A`, and its solve with workspace kept between calls.
class CholmodPeer {
 public:
  CholmodPeer(const Eigen::SparseMatrix<double>& A, int mode, int ordering) : A_(A) {
    cholmod_start(&common_);
    common_.supernodal = mode;
    common_.final_ll = 1;
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    cholmod_sparse view = {};
    view.nrow = view.ncol = static_cast<std::size_t>(A_.rows());
    view.nzmax = static_cast<std::size_t>(A_.nonZeros());
    view.p = A_.outerIndexPtr();
    view.i = A_.innerIndexPtr();
    view.x = A_.valuePtr();
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = view.packed = 1;
    factor_ = cholmod_analyze(&view, &common_);
    cholmod_factorize(&view, factor_, &common_);
  }
  ~CholmodPeer() {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  CholmodPeer(const CholmodPeer&) = delete;
  CholmodPeer& operator=(const CholmodPeer&) = delete;

  Eigen::Map<Eigen::MatrixXd> solve(Eigen::MatrixXd& b) {
    cholmod_dense dense = {};
    dense.nrow = dense.d = static_cast<std::size_t>(b.rows());
    dense.ncol = static_cast<std::size_t>(b.cols());
    dense.nzmax = dense.nrow * dense.ncol;
    dense.x = b.data();
    dense.xtype = CHOLMOD_REAL;
    dense.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(CHOLMOD_A, factor_, &dense, nullptr, &x_, nullptr, &y_, &e_, &common_);
    return {static_cast<double*>(x_->x), b.rows(), b.cols()};
  }
  double factor_nonzeros() const { return common_.lnz; }

 private:
  Eigen::SparseMatrix<double> A_;
  cholmod_common common_ = {};
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* x_ = nullptr;
  cholmod_dense* y_ = nullptr;
  cholmod_dense* e_ = nullptr;
};

}  // namespace reprise::benchmark
