// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Principal components of the rows of a matrix that is never held as a whole (HSSMG Eq. 33, 34; LPBM Eq. 5).

#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace reprise {

struct PrincipalComponentsOptions {
  double kept_variance = 0.95;       // share of the variance that the components explain, 0 to 1
  Eigen::Index most_components = 0;  // no more than this many; 0: no limit
  // Share of the variance that may be dropped on the way when there are more than 256 rows; 0: none, and
  // memory grows with the rows. Never more than `kept_variance` leaves out.
  double streamed_loss = 0.001;
};

// row = mean + basis * coefficients + what is left out; variances are means over the rows (sums over their
// entries), so total - explained is the mean squared error of the reduced rows.
struct PrincipalComponents {
  Eigen::VectorXd mean;        // D
  Eigen::MatrixXd basis;       // D x l, orthonormal; the entry of largest magnitude of a column is positive
  Eigen::VectorXd deviations;  // l standard deviations of the coefficients, descending
  double explained_variance = 0.0;
  double total_variance = 0.0;
  std::size_t row_count = 0;

  // In [0, 1]; 1 if there is no variance.
  double explained_share() const;
};

// Takes one row after the other. Blocks of rows are merged into the components so far, with the move of the
// mean as one more row (Ross et al. 2008), by Householder QR and the singular values of its factor: no Gram
// matrix, so small and repeated rows keep their digits. Memory is O(D (components + block)); the time of a
// merge is that of a QR of that size. Deterministic; one thread.
//
// Up to 256 rows, or with `streamed_loss` 0, this is the singular value decomposition of the centred matrix.
// Else the scatter matrix C of all rows = C' + E, where C' is the one that is kept, E is positive
// semi-definite and trace E <= streamed_loss * trace C. Hence every variance is too small by at most
// `streamed_loss` of the total, the basis explains at least what is stated, and there are no more components
// than the decomposition of the whole matrix has for `kept_variance + streamed_loss`.
class PrincipalComponentsBuilder {
 public:
  // Throws `InvalidArgument` for shares outside [0, 1] or a negative number of components.
  explicit PrincipalComponentsBuilder(const PrincipalComponentsOptions& options = {});

  // `row`: D entries, D > 0, as many as the first row has. Throws `InvalidArgument` naming the row (from 0)
  // if it has another length or if its squares are not finite; it is then not added.
  void add(const Eigen::Ref<const Eigen::VectorXd>& row);
  std::size_t row_count() const { return row_count_; }

  // Components of the rows so far: none if there is one row, or if rows differ by rounding only. More rows
  // may follow. Throws `InvalidArgument` if there is no row.
  PrincipalComponents finish();

 private:
  void merge(double loss);

  PrincipalComponentsOptions options_;
  std::size_t row_count_ = 0;
  Eigen::VectorXd origin_;  // the first row: everything below is relative to it, so that equal rows are zero
  double row_squares_ = 0.0;  // sum of the squared lengths of rows as given
  // Leading columns: directions times singular values, `rank_` of them; then the rows that are not merged
  // yet.
  Eigen::MatrixXd columns_;
  Eigen::Index rank_ = 0;
  Eigen::Index pending_ = 0;
  Eigen::VectorXd mean_;  // of the merged rows
  double merged_rows_ = 0.0;
  double total_squares_ = 0.0;  // of the merged rows about their mean
  double dropped_squares_ = 0.0;
};

}  // namespace reprise
