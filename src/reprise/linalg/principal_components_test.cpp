// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/linalg/principal_components.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/SVD>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/random.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// F rows of D entries with singular values that fall like 1, decay, decay^2, ..., and a mean far from zero.
Eigen::MatrixXd rows_of(Eigen::Index count, Eigen::Index size, double decay, std::uint64_t seed = 1,
                        double mean = 3.0) {
  const RandomField field(seed);
  const Eigen::Index rank = std::min<Eigen::Index>({count, size, 60});
  const auto random = [&](Eigen::Index rows, Eigen::Index columns, std::uint64_t key) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&](Eigen::Index i, Eigen::Index j) {
      return field.branch(key).normal_pair(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j))[0];
    }));
  };
  const Eigen::VectorXd scales =
      Eigen::VectorXd::NullaryExpr(rank, [&](Eigen::Index k) { return std::pow(decay, k); });
  Eigen::MatrixXd rows = random(count, rank, 1) * scales.asDiagonal() * random(rank, size, 2);
  rows.rowwise() += mean * random(1, size, 3).row(0);
  return rows;
}

PrincipalComponents components_of(const Eigen::MatrixXd& rows, const PrincipalComponentsOptions& options) {
  PrincipalComponentsBuilder builder(options);
  for (Eigen::Index f = 0; f < rows.rows(); ++f) builder.add(rows.row(f).transpose());
  return builder.finish();
}

Eigen::MatrixXd centred(const Eigen::MatrixXd& rows) {
  return rows.rowwise() - rows.colwise().mean();
}

// Standard deviations by an independent decomposition of the whole matrix.
Eigen::VectorXd expected_deviations(const Eigen::MatrixXd& rows) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(centred(rows)).singularValues() /
         std::sqrt(static_cast<double>(rows.rows()));
}

double deviation_from_orthonormal(const Eigen::MatrixXd& basis) {
  if (basis.cols() == 0) return 0.0;
  return (basis.transpose() * basis - Eigen::MatrixXd::Identity(basis.cols(), basis.cols()))
      .cwiseAbs()
      .maxCoeff();
}

// Greatest distance of a unit vector of one span from the other.
double distance_of_spans(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(b - a * (a.transpose() * b)).singularValues()[0];
}

double mean_squared_error(const PrincipalComponents& pca, const Eigen::MatrixXd& rows) {
  const Eigen::MatrixXd differences = rows.rowwise() - pca.mean.transpose();
  return (differences - (differences * pca.basis) * pca.basis.transpose()).squaredNorm() /
         static_cast<double>(rows.rows());
}

TEST(PrincipalComponents, AreTheDecompositionOfTheWholeMatrix) {
  for (const auto& [count, size] : {std::pair{2, 50}, {7, 50}, {50, 7}, {50, 1}, {100, 300}, {200, 40}}) {
    const Eigen::MatrixXd rows = rows_of(count, size, 0.8);
    const PrincipalComponents pca = components_of(rows, {.kept_variance = 1.0});
    EXPECT_EQ(pca.row_count, static_cast<std::size_t>(count));
    EXPECT_LT((pca.mean - rows.colwise().mean().transpose()).norm(), 1e-12 * rows.norm());
    const Eigen::VectorXd expected = expected_deviations(rows);
    ASSERT_EQ(pca.deviations.size(), std::min<Eigen::Index>({count - 1, size, 60}));
    EXPECT_LT((pca.deviations - expected.head(pca.deviations.size())).cwiseAbs().maxCoeff(),
              1e-13 * expected[0]);
    EXPECT_LT(deviation_from_orthonormal(pca.basis), 1e-13);
    EXPECT_LT(mean_squared_error(pca, rows), 1e-24 * pca.total_variance);
    EXPECT_NEAR(pca.total_variance, expected.squaredNorm(), 1e-12 * pca.total_variance);
    EXPECT_NEAR(pca.explained_share(), 1.0, 1e-12);
    // Each column is the direction of its singular value, not just part of the right span.
    const Eigen::MatrixXd scores = centred(rows) * pca.basis;
    const Eigen::MatrixXd covariance = scores.transpose() * scores / static_cast<double>(count);
    const Eigen::MatrixXd diagonal = pca.deviations.array().square().matrix().asDiagonal();
    EXPECT_LT((covariance - diagonal).cwiseAbs().maxCoeff(), 1e-13 * pca.total_variance);
  }
}

TEST(PrincipalComponents, KeepAsFewAsExplainTheVariance) {
  const Eigen::MatrixXd rows = rows_of(80, 200, 0.85);
  const Eigen::VectorXd variances = expected_deviations(rows).array().square();
  for (const double kept : {0.0, 0.3, 0.5, 0.95, 0.999}) {
    const PrincipalComponents pca = components_of(rows, {.kept_variance = kept});
    EXPECT_GE(pca.explained_share(), kept);
    const Eigen::Index count = pca.basis.cols();
    EXPECT_NEAR(pca.explained_variance, variances.head(count).sum(), 1e-12 * variances.sum());
    if (count > 0) {
      EXPECT_LT(variances.head(count - 1).sum(), kept * variances.sum());
    }
    EXPECT_EQ(count == 0, kept == 0.0);
    EXPECT_EQ(pca.deviations.size(), count);
    // What is left out is what was said to be left out.
    EXPECT_NEAR(mean_squared_error(pca, rows), pca.total_variance - pca.explained_variance,
                1e-12 * pca.total_variance);
  }
  const PrincipalComponents limited = components_of(rows, {.most_components = 3});
  EXPECT_EQ(limited.basis.cols(), 3);
  EXPECT_LT(limited.explained_share(), 0.95);
}

TEST(PrincipalComponents, StreamedWithoutLossEqualTheDecompositionOfTheWholeMatrix) {
  for (const auto& [count, size] : {std::pair{257, 90}, {700, 300}, {1300, 20}}) {
    const Eigen::MatrixXd rows = rows_of(count, size, 0.8, 2, 100.0);
    const PrincipalComponents pca = components_of(rows, {.kept_variance = 0.999, .streamed_loss = 0.0});
    const Eigen::BDCSVD<Eigen::MatrixXd> svd(centred(rows), Eigen::ComputeThinV);
    const Eigen::Index kept = pca.basis.cols();
    const Eigen::VectorXd expected = svd.singularValues().head(kept) / std::sqrt(1.0 * count);
    EXPECT_LT((pca.deviations - expected).cwiseAbs().maxCoeff(), 1e-10 * expected[0]);
    EXPECT_LT(distance_of_spans(svd.matrixV().leftCols(kept), pca.basis), 1e-8);
    EXPECT_LT(deviation_from_orthonormal(pca.basis), 1e-12);
    EXPECT_NEAR(pca.total_variance, expected_deviations(rows).squaredNorm(), 1e-10 * pca.total_variance);
    EXPECT_LT((pca.mean - rows.colwise().mean().transpose()).norm(), 1e-12 * rows.row(0).norm());
  }
}

TEST(PrincipalComponents, StreamingLosesNoMoreThanItsBound) {
  const Eigen::Index count = 1100;
  const Eigen::MatrixXd rows = rows_of(count, 150, 0.96, 3);
  const Eigen::VectorXd variances = expected_deviations(rows).array().square();
  for (const double loss : {0.001, 0.02, 0.05}) {
    const PrincipalComponents pca = components_of(rows, {.streamed_loss = loss});
    const Eigen::Index kept = pca.basis.cols();
    EXPECT_GE(pca.explained_share(), 0.95);
    EXPECT_NEAR(pca.total_variance, variances.sum(), 1e-12 * variances.sum());
    for (Eigen::Index k = 0; k < kept; ++k) {
      const double variance = pca.deviations[k] * pca.deviations[k];
      EXPECT_LE(variance, variances[k] * (1.0 + 1e-12));
      EXPECT_GE(variance, variances[k] - loss * variances.sum());
    }
    // The basis explains at least what is stated.
    EXPECT_LE(mean_squared_error(pca, rows),
              pca.total_variance - pca.explained_variance + 1e-12 * pca.total_variance);
    Eigen::Index most = 0;
    for (double sum = 0.0; most < variances.size() && sum < (0.95 + loss) * variances.sum() * (1 - 1e-12);) {
      sum += variances[most++];
    }
    EXPECT_LE(kept, most);
    EXPECT_LT(deviation_from_orthonormal(pca.basis), 1e-12);
  }
  // Something was lost: the bound is put to use.
  const PrincipalComponents exact = components_of(rows, {.streamed_loss = 0.0});
  const PrincipalComponents lossy = components_of(rows, {.streamed_loss = 0.05});
  EXPECT_GT(exact.deviations[0] - lossy.deviations[0], 0.0);
  EXPECT_NEAR(components_of(rows, {.kept_variance = 1.0, .streamed_loss = 0.05}).explained_share(), 1.0,
              1e-12);
}

TEST(PrincipalComponents, OrderOfTheRowsDoesNotMatter) {
  for (const Eigen::Index count : {90, 600}) {
    const Eigen::MatrixXd rows = rows_of(count, 120, 0.7, 4);
    // Sorted rows move the mean from block to block.
    std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::sort(order, {}, [&](Eigen::Index i) { return rows(i, 0); });
    const Eigen::MatrixXd sorted = rows(order, Eigen::all);
    const PrincipalComponentsOptions options{.streamed_loss = 0.0};
    const PrincipalComponents a = components_of(rows, options);
    const PrincipalComponents b = components_of(sorted, options);
    EXPECT_LT((a.mean - b.mean).norm(), 1e-11);
    ASSERT_EQ(a.basis.cols(), b.basis.cols());
    EXPECT_LT((a.deviations - b.deviations).cwiseAbs().maxCoeff(), 1e-11 * a.deviations[0]);
    EXPECT_LT((a.basis - b.basis).cwiseAbs().maxCoeff(), 1e-9);  // signs too
  }
}

TEST(PrincipalComponents, TheSameShiftOfAllRowsMovesTheMeanOnly) {
  const Eigen::MatrixXd rows = rows_of(300, 60, 0.7, 5);
  const Eigen::RowVectorXd shift = Eigen::RowVectorXd::LinSpaced(60, -50.0, 20.0);
  const PrincipalComponents a = components_of(rows, {.streamed_loss = 0.0});
  const PrincipalComponents b = components_of(rows.rowwise() + shift, {.streamed_loss = 0.0});
  EXPECT_LT((a.mean + shift.transpose() - b.mean).norm(), 1e-11);
  ASSERT_EQ(a.basis.cols(), b.basis.cols());
  EXPECT_LT((a.basis - b.basis).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(a.total_variance, b.total_variance, 1e-11 * a.total_variance);
}

TEST(PrincipalComponents, LargestEntryOfEachColumnIsPositive) {
  const PrincipalComponents pca = components_of(rows_of(40, 30, 0.9, 6), {});
  ASSERT_GT(pca.basis.cols(), 5);
  for (Eigen::Index k = 0; k < pca.basis.cols(); ++k) {
    EXPECT_EQ(pca.basis.col(k).maxCoeff(), pca.basis.col(k).cwiseAbs().maxCoeff()) << k;
  }
}

TEST(PrincipalComponents, NearlyRepeatedRowsKeepOrthonormalColumnsAndSmallValues) {
  // Three directions of variances 1, 1e-10 and 1e-18, each row three times: a Gram matrix would lose the
  // last.
  const Eigen::MatrixXd directions =
      Eigen::HouseholderQR<Eigen::MatrixXd>(rows_of(200, 3, 1.0, 7)).householderQ() *
      Eigen::MatrixXd::Identity(200, 3);
  const Eigen::Vector3d scales(1.0, 1e-5, 1e-9);
  const Eigen::MatrixXd scores = centred(rows_of(20, 3, 1.0, 8));
  const Eigen::MatrixXd rows = (scores * scales.asDiagonal() * directions.transpose()).replicate(3, 1);
  for (const double loss : {0.0, 0.001}) {
    const PrincipalComponents pca = components_of(rows, {.kept_variance = 1.0, .streamed_loss = loss});
    ASSERT_EQ(pca.basis.cols(), 3);
    EXPECT_LT(deviation_from_orthonormal(pca.basis), 1e-13);
    const Eigen::VectorXd expected = expected_deviations(scores * scales.asDiagonal());
    for (Eigen::Index k = 0; k < 3; ++k) EXPECT_NEAR(pca.deviations[k] / expected[k], 1.0, 1e-5) << k;
    EXPECT_LT(distance_of_spans(directions, pca.basis), 1e-5);
  }
}

TEST(PrincipalComponents, RowsThatDoNotVaryHaveNoComponents) {
  const Eigen::MatrixXd one = rows_of(1, 30, 0.5);
  {  // one row
    const PrincipalComponents pca = components_of(one, {.kept_variance = 1.0});
    EXPECT_EQ(pca.basis.rows(), 30);
    EXPECT_EQ(pca.basis.cols(), 0);
    EXPECT_EQ(pca.mean, one.row(0).transpose());
    EXPECT_EQ(pca.total_variance, 0.0);
    EXPECT_EQ(pca.explained_share(), 1.0);
  }
  {  // equal rows, more than a block of them
    const PrincipalComponents pca = components_of(one.replicate(600, 1), {.kept_variance = 1.0});
    EXPECT_EQ(pca.basis.cols(), 0);
    EXPECT_EQ(pca.mean, one.row(0).transpose());
    EXPECT_EQ(pca.total_variance, 0.0);
  }
  {  // rows that differ by rounding
    Eigen::MatrixXd rows = one.replicate(10, 1);
    for (Eigen::Index f = 0; f < 10; ++f) rows.row(f) = (rows.row(f) * (1.0 + f)) / (1.0 + f);
    EXPECT_EQ(components_of(rows, {.kept_variance = 1.0}).basis.cols(), 0);
  }
}

TEST(PrincipalComponents, RowsMayFollowAfterAResult) {
  const Eigen::MatrixXd rows = rows_of(90, 40, 0.7, 10);
  PrincipalComponentsBuilder builder({.streamed_loss = 0.0});
  for (Eigen::Index f = 0; f < 30; ++f) builder.add(rows.row(f).transpose());
  const PrincipalComponents early = builder.finish();
  EXPECT_LT((early.basis - components_of(rows.topRows(30), {}).basis).cwiseAbs().maxCoeff(), 1e-15);
  for (Eigen::Index f = 30; f < 90; ++f) builder.add(rows.row(f).transpose());
  EXPECT_LT((builder.finish().basis - components_of(rows, {}).basis).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(PrincipalComponents, TheSameRowsGiveTheSameBits) {
  const Eigen::MatrixXd rows = rows_of(600, 100, 0.9, 11);
  EXPECT_EQ(components_of(rows, {}).basis, components_of(rows, {}).basis);
}

TEST(PrincipalComponents, BadInputIsNamed) {
  const auto add = [](const Eigen::VectorXd& second) {
    return [=] {
      PrincipalComponentsBuilder builder;
      builder.add(Eigen::VectorXd::Ones(4));
      builder.add(second);
    };
  };
  Eigen::VectorXd bad = Eigen::VectorXd::Ones(4);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e200}) {  // not finite, also squared
    bad[2] = value;
    EXPECT_THAT(add(bad), ThrowsMessage<InvalidArgument>(HasSubstr("row 1 ")));
  }
  // another length
  EXPECT_THAT(add(Eigen::VectorXd::Ones(3)),
              ThrowsMessage<InvalidArgument>(HasSubstr("row 1 has 3 entries")));
  // no entries
  EXPECT_THAT([] { PrincipalComponentsBuilder().add(Eigen::VectorXd()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("row 0")));
  // no rows
  EXPECT_THAT([] { PrincipalComponentsBuilder().finish(); },
              ThrowsMessage<InvalidArgument>(HasSubstr("at least one row")));
  // shares
  for (const double share : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(PrincipalComponentsBuilder({.kept_variance = share}), InvalidArgument);
    EXPECT_THROW(PrincipalComponentsBuilder({.streamed_loss = share}), InvalidArgument);
  }
  EXPECT_THROW(PrincipalComponentsBuilder({.most_components = -1}), InvalidArgument);
  {  // a refused row leaves no trace
    PrincipalComponentsBuilder builder;
    builder.add(Eigen::VectorXd::Ones(4));
    EXPECT_THROW(builder.add(bad), InvalidArgument);
    builder.add(Eigen::VectorXd::Zero(4));
    EXPECT_LT((builder.finish().basis - Eigen::VectorXd::Constant(4, 0.5)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace reprise
