// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/linalg/principal_components.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr Eigen::Index least_block = 256;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

void check_share(double share, const char* name) {
  if (!(share >= 0.0 && share <= 1.0)) {
    throw InvalidArgument(fmt::format("{} is {}: expected a share from 0 to 1", name, share));
  }
}

// The largest rank below which the squares of the singular values (descending) sum up to at most `budget`.
Eigen::Index rank_within(const Eigen::VectorXd& singular_values, double floor, double budget) {
  Eigen::Index rank = singular_values.size();
  while (rank > 0) {
    const double value = singular_values[rank - 1];
    budget -= value * value;
    if (value > floor && budget < 0.0) break;
    --rank;
  }
  return rank;
}

void point_largest_entry_up(Eigen::Ref<Eigen::VectorXd> column) {
  Eigen::Index largest = 0;
  column.cwiseAbs().maxCoeff(&largest);
  if (column[largest] < 0.0) column = -column;
}

}  // namespace

double PrincipalComponents::explained_share() const {
  return total_variance > 0.0 ? explained_variance / total_variance : 1.0;
}

PrincipalComponentsBuilder::PrincipalComponentsBuilder(const PrincipalComponentsOptions& options)
    : options_(options) {
  check_share(options.kept_variance, "the variance to keep");
  check_share(options.streamed_loss, "the variance that streaming may lose");
  if (options.most_components < 0) {
    throw InvalidArgument(fmt::format(
        "the greatest number of components is {}: expected 0 (no limit) or more", options.most_components));
  }
}

void PrincipalComponentsBuilder::add(const Eigen::Ref<const Eigen::VectorXd>& row) {
  if (row.size() == 0) throw InvalidArgument(fmt::format("row {} has no entries", row_count_));
  if (row_count_ > 0 && row.size() != origin_.size()) {
    throw InvalidArgument(fmt::format("row {} has {} entries: expected {}, as many as the first row",
                                      row_count_, row.size(), origin_.size()));
  }
  const double squares = row.squaredNorm();
  if (!std::isfinite(squares)) {
    throw InvalidArgument(
        fmt::format("row {} holds a number that is not finite, or too large to be squared", row_count_));
  }
  if (row_count_ == 0) {
    origin_ = row;
    mean_ = Eigen::VectorXd::Zero(row.size());
    columns_.resize(row.size(), least_block + 1);
  }
  columns_.col(rank_ + pending_) = row - origin_;
  ++pending_;
  ++row_count_;
  row_squares_ += squares;
  if (rank_ + pending_ + 1 == columns_.cols()) {
    merge(std::min(options_.streamed_loss, 1.0 - options_.kept_variance));
  }
}

void PrincipalComponentsBuilder::merge(double loss) {
  auto block = columns_.middleCols(rank_, pending_);
  const Eigen::VectorXd block_mean = block.rowwise().mean();
  block.colwise() -= block_mean;
  // Scatter of the union: that of both sides and of their means, n m / (n + m) d d^T.
  const double rows = static_cast<double>(pending_);
  const Eigen::VectorXd move = block_mean - mean_;
  const double together = merged_rows_ + rows;
  Eigen::Index used = rank_ + pending_;
  total_squares_ += block.squaredNorm();
  if (merged_rows_ > 0.0) {
    columns_.col(used) = std::sqrt(merged_rows_ * rows / together) * move;
    total_squares_ += columns_.col(used).squaredNorm();
    ++used;
  }
  mean_ += (rows / together) * move;
  merged_rows_ = together;
  pending_ = 0;

  const Eigen::Index size = columns_.rows();
  Eigen::Ref<Eigen::MatrixXd> matrix = columns_.leftCols(used);
  Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(matrix);  // in place
  const Eigen::Index height = std::min(size, used);
  const Eigen::MatrixXd R = matrix.topRows(height).triangularView<Eigen::Upper>();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(R, Eigen::ComputeThinU);
  const Eigen::VectorXd& values = svd.singularValues();
  // What rounding alone makes of rows of this length, and of directions beside the first.
  const double floor =
      epsilon * std::max(16.0 * std::sqrt(row_squares_), static_cast<double>(used) * values[0]);
  rank_ = rank_within(values, floor, loss * total_squares_ - dropped_squares_);
  dropped_squares_ += values.tail(values.size() - rank_).squaredNorm();

  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(size, rank_);
  scaled.topRows(height) = svd.matrixU().leftCols(rank_) * values.head(rank_).asDiagonal();
  scaled.applyOnTheLeft(qr.householderQ());
  columns_.resize(size, rank_ + std::max(least_block, rank_) + 1);
  columns_.leftCols(rank_) = scaled;
}

PrincipalComponents PrincipalComponentsBuilder::finish() {
  if (row_count_ == 0) throw InvalidArgument("principal components need at least one row");
  if (pending_ > 0) merge(0.0);
  const auto rows = static_cast<double>(row_count_);
  PrincipalComponents result{
      .mean = origin_ + mean_, .total_variance = total_squares_ / rows, .row_count = row_count_};
  const Eigen::Index most = options_.most_components > 0 ? std::min(options_.most_components, rank_) : rank_;
  // Everything means everything: a sum can round to the total before its last terms.
  const double wanted = options_.kept_variance < 1.0 ? options_.kept_variance * total_squares_
                                                     : std::numeric_limits<double>::infinity();
  Eigen::Index count = 0;
  double explained = 0.0;
  while (count < most && explained < wanted) explained += columns_.col(count++).squaredNorm();
  result.explained_variance = std::min(explained, total_squares_) / rows;
  result.basis = columns_.leftCols(count);
  result.deviations = result.basis.colwise().norm().transpose();
  for (Eigen::Index k = 0; k < count; ++k) {
    result.basis.col(k) /= result.deviations[k];
    point_largest_entry_up(result.basis.col(k));
  }
  result.deviations /= std::sqrt(rows);
  return result;
}

}  // namespace reprise
