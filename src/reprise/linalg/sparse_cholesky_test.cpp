// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/linalg/sparse_cholesky.h"

#include <csignal>
#include <random>
#include <thread>
#include <vector>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using ::testing::HasSubstr;

// Laplacian of a grid of n x n points plus `shift` on the diagonal.
Sparse grid_laplacian(int n, double shift) {
  const Eigen::Index size = Eigen::Index{n} * n;
  Sparse A(size, size);
  std::vector<Eigen::Triplet<double>> entries;
  const auto link = [&](int a, int b) {
    entries.insert(entries.end(), {{a, a, 1.0}, {b, b, 1.0}, {a, b, -1.0}, {b, a, -1.0}});
  };
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const int v = row * n + column;
      entries.emplace_back(v, v, shift);
      if (column + 1 < n) link(v, v + 1);
      if (row + 1 < n) link(v, v + n);
    }
  }
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(generator); });
}

void count_nothing(int /*signal_number*/) {}

TEST(SparseCholesky, FactorisationsInSeveralThreadsLeaveTheHandlersOfSignalsAlone) {
  const auto before = std::signal(SIGTERM, count_nothing);
  const Sparse A = grid_laplacian(30, 0.01);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 25; ++i) EXPECT_EQ(SparseCholesky(A).size(), 900);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::signal(SIGTERM, before), count_nothing);
}

TEST(SparseCholesky, SolutionSatisfiesTheSystemForAnyNumberOfColumns) {
  const Sparse A = grid_laplacian(60, 0.01);
  const SparseCholesky cholesky(A);
  EXPECT_EQ(cholesky.size(), 3600);
  EXPECT_GE(cholesky.factor_nonzeros(), (A.nonZeros() + 3600) / 2);
  for (const Eigen::Index columns : {0, 1, 2, 3, 4, 5, 9}) {
    const Eigen::MatrixXd b = random_matrix(3600, columns, 1);
    const Eigen::MatrixXd x = cholesky.solve(b);
    ASSERT_EQ(x.cols(), columns);
    if (columns > 0) {
      EXPECT_LT((A * x - b).cwiseAbs().maxCoeff(), 1e-11) << columns << " columns";
    }
  }
}

TEST(SparseCholesky, AgreesWithADenseFactorisationOnMatricesOfAnyDensity) {
  for (const int n : {1, 2, 7, 40}) {
    for (const double density : {0.0, 0.1, 0.5, 1.0}) {
      const Eigen::MatrixXd random = random_matrix(n, n, static_cast<unsigned>(n));
      const Eigen::MatrixXd kept = (random_matrix(n, n, 5).array().abs() < density).select(random, 0.0);
      const Eigen::MatrixXd A = kept * kept.transpose() + Eigen::MatrixXd::Identity(n, n);
      const Eigen::MatrixXd b = random_matrix(n, 3, 9);
      const Eigen::MatrixXd expected = A.llt().solve(b);
      EXPECT_LT((SparseCholesky(A.sparseView()).solve(b) - expected).cwiseAbs().maxCoeff(), 1e-11)
          << n << " rows, density " << density;
    }
  }
}

TEST(SparseCholesky, ReadsOnlyTheLowerTriangle) {
  const Sparse A = grid_laplacian(12, 0.1);
  const Sparse lower = A.triangularView<Eigen::Lower>();
  const Eigen::MatrixXd b = random_matrix(A.rows(), 3, 2);
  EXPECT_EQ(SparseCholesky(A).solve(b), SparseCholesky(lower).solve(b));
}

TEST(SparseCholesky, SolvingInPlaceGivesTheSameBitsAsSolving) {
  const SparseCholesky cholesky(grid_laplacian(30, 0.1));
  const Eigen::MatrixXd b = random_matrix(900, 3, 3);
  SparseCholesky::RowMajorMatrix x = b;
  cholesky.solve_in_place(x);
  EXPECT_EQ(Eigen::MatrixXd(x), cholesky.solve(b));
}

TEST(SparseCholesky, ThreadsShareOneFactorisation) {
  const SparseCholesky cholesky(grid_laplacian(50, 0.02));
  std::vector<Eigen::MatrixXd> expected;
  for (unsigned seed = 0; seed < 8; ++seed) expected.push_back(cholesky.solve(random_matrix(2500, 3, seed)));
  std::vector<int> wrong(8, 0);
  {
    std::vector<std::jthread> threads;
    for (unsigned seed = 0; seed < 8; ++seed) {
      threads.emplace_back([&, seed] {
        for (int repeat = 0; repeat < 20; ++repeat) {
          wrong[seed] += cholesky.solve(random_matrix(2500, 3, seed)) == expected[seed] ? 0 : 1;
        }
      });
    }
  }
  EXPECT_THAT(wrong, ::testing::Each(0));
}

TEST(SparseCholesky, MovingKeepsTheFactorisation) {
  SparseCholesky first(grid_laplacian(5, 1.0));
  const Eigen::MatrixXd b = random_matrix(25, 1, 4);
  const Eigen::MatrixXd expected = first.solve(b);
  const SparseCholesky second = std::move(first);
  EXPECT_EQ(second.solve(b), expected);
  EXPECT_EQ(SparseCholesky().size(), 0);
}

TEST(SparseCholesky, InvalidMatricesAreNamed) {
  const auto message = [](const Sparse& A) -> std::string {
    try {
      const SparseCholesky cholesky(A);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "accepted";
  };
  {  // not square
    EXPECT_THAT(message(Sparse(3, 4)), HasSubstr("3 x 4"));
  }
  {  // indefinite: row 17 alone is at fault
    Sparse A = grid_laplacian(10, 1.0);
    A.coeffRef(17, 17) = -2.0;
    EXPECT_THAT(message(A), HasSubstr("not positive definite"));
    Sparse D(40, 40);
    D.setIdentity();
    D.coeffRef(17, 17) = -1.0;
    EXPECT_THAT(message(D), HasSubstr("row 17 "));
  }
  {  // an empty row
    Sparse A(3, 3);
    A.coeffRef(0, 0) = A.coeffRef(2, 2) = 1.0;
    EXPECT_THAT(message(A), HasSubstr("row 1 "));
  }
  {  // singular: constants are in the null space
    EXPECT_THAT(message(grid_laplacian(40, 0.0)), HasSubstr("not positive definite"));
  }
  {  // not finite
    Sparse A = grid_laplacian(3, 1.0);
    A.coeffRef(4, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(message(A), HasSubstr("(4, 2)"));
  }
  {  // wrong right-hand side
    const SparseCholesky cholesky(grid_laplacian(3, 1.0));
    EXPECT_THROW(cholesky.solve(Eigen::MatrixXd::Zero(8, 3)), InvalidArgument);
  }
}

}  // namespace
}  // namespace reprise
