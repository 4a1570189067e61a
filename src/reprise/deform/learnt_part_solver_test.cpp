// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/learnt_part_solver.h"

#include <gtest/gtest.h>

#include "reprise/core/random.h"
#include "reprise/deform/learnt_figure_test_support.h"
#include "reprise/deform/part_alignment.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A leg of the figure with everything that LearntPartSolver eliminates written out: dense, in x, y, z of all
// vertices and r, for a given rotation.
class WrittenOut {
 public:
  explicit WrittenOut(double beyond_range)
      : options_{.prior = 0.7, .beyond_range = beyond_range, .free_turn = 10.0},
        hierarchy_(test::small_figure().topology(), view(), test::small_figure().markup()->parts),
        part_(&hierarchy_.part(hierarchy_.part_idx("left_leg"))),
        learnt_(&test::figure_parts().parts[static_cast<std::size_t>(hierarchy_.part_idx("left_leg"))]),
        solver_(*part_, test::figure_parts().reference, *learnt_, options_),
        reference_(rows_of(view(), part_->vertices)),
        laplacian_(part_laplacian(*part_, reference_)) {
    const MeshSequence& clip = test::small_figure().clip(1);
    source_ = rows_of(clip.frame(4), part_->vertices);
    const Coordinates wanted = rows_of(clip.frame(20), part_->vertices);
    for (std::int32_t v = 0; v < wanted.rows(); v += 9) {
      constraints_.push_back({.local = v, .squared_weight = 100.0 + v});
      targets_.emplace_back(wanted.row(v).transpose());
    }
  }

  LearntPartSolver::Solution solve() const {
    const auto frame = solver_.frame(source_);
    const auto factorization = solver_.factorize(constraints_);
    return solver_.solve(factorization, frame, solver_.prepare(factorization, frame), targets_,
                         Matrix3d::Identity(), {});
  }

  // The least energy over x and r under a rotation, by the normal equations of everything at once.
  double least_energy(const Matrix3d& Q, VectorXd* x_and_r = nullptr) const {
    const Eigen::Index n = source_.rows();
    const Eigen::Index l = learnt_->basis.cols();
    const MatrixXd L = MatrixXd(laplacian_.matrix());
    const Coordinates delta = laplacian_(align(source_, reference_).apply(source_));
    const Eigen::Index rows = 3 * L.rows();
    MatrixXd J = MatrixXd::Zero(rows + 3 * static_cast<Eigen::Index>(constraints_.size()) + l, 3 * n + l);
    VectorXd b = VectorXd::Zero(J.rows());
    // x is laid out vertex by vertex, like the basis.
    for (Eigen::Index i = 0; i < L.rows(); ++i) {
      for (Eigen::Index v = 0; v < n; ++v) J.block<3, 3>(3 * i, 3 * v) = L(i, v) * Matrix3d::Identity();
      b.segment<3>(3 * i) = Q * delta.row(i).transpose();
      if (i >= n) continue;
      for (Eigen::Index k = 0; k < l; ++k) {
        J.block<3, 1>(3 * i, 3 * n + k) = -(Q * learnt_->basis.col(k).segment<3>(3 * i).cast<double>());
      }
    }
    for (std::size_t c = 0; c < constraints_.size(); ++c) {
      const Eigen::Index row = rows + 3 * static_cast<Eigen::Index>(c);
      const double weight = std::sqrt(constraints_[c].squared_weight);
      J.block<3, 3>(row, 3 * constraints_[c].local) = weight * Matrix3d::Identity();
      b.segment<3>(row) = weight * targets_[c];
    }
    const auto others = static_cast<double>(3 * n - l);
    for (Eigen::Index k = 0; k < l; ++k) {
      const double variance = learnt_->deviations[k] * learnt_->deviations[k];
      J(J.rows() - l + k, 3 * n + k) =
          std::sqrt(options_.prior * learnt_->discarded_variance / others / variance + 1e-9);
    }
    const VectorXd best = (J.transpose() * J).ldlt().solve(J.transpose() * b);
    if (x_and_r != nullptr) *x_and_r = best;
    return (J * best - b).squaredNorm();
  }

  const LearntPart& learnt() const { return *learnt_; }
  const LearntPartSolver& solver() const { return solver_; }
  const Coordinates& source() const { return source_; }

 private:
  static PositionsView view() {
    const Positions& reference = test::figure_parts().reference;
    return {reference.data(), reference.rows(), 3};
  }

  PartEditorOptions options_;
  PartHierarchy hierarchy_;
  const PartHierarchy::Part* part_;
  const LearntPart* learnt_;
  LearntPartSolver solver_;
  Coordinates reference_;
  SurfaceLaplacian laplacian_;
  Coordinates source_;
  std::vector<PartConstraint> constraints_;
  std::vector<Vector3d> targets_;
};

TEST(LearntPartSolver, IsTheOptimumOfAllUnknownsAtOnce) {
  const WrittenOut problem(-1.0);
  const LearntPartSolver::Solution solution = problem.solve();
  VectorXd x_and_r;
  const double least = problem.least_energy(solution.world_from_reference, &x_and_r);

  const Eigen::Index size = solution.positions.size();
  const Eigen::Map<const VectorXd> x(solution.positions.data(), size);
  EXPECT_LT((x - x_and_r.head(size)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_LT((solution.changes - x_and_r.tail(solution.changes.size())).lpNorm<Eigen::Infinity>(),
            1e-5 * solution.changes.norm());
  EXPECT_GT(solution.changes.norm(), 0.1);  // the problem has something to solve

  // No rotation nearby is better, with x and r solved anew.
  for (int axis = 0; axis < 3; ++axis) {
    for (const double angle : {-0.2, -1e-2, 1e-2, 0.2}) {
      const Matrix3d turned =
          solution.world_from_reference * Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
      EXPECT_GT(problem.least_energy(turned), least);
    }
  }
}

TEST(SurfaceLaplacian, DisplacementsHaveTheLaplacianCoordinatesAskedFor) {
  const PerformanceDatabase& figure = test::small_figure();
  const Positions& rest = figure.markup()->reference;
  const SurfaceLaplacian laplacian(figure.topology(), PositionsView(rest.data(), rest.rows(), 3));
  const Coordinates moved = figure.clip(1).frame(20).cast<double>() - rest.cast<double>();
  const Coordinates delta = laplacian(moved);
  const MatrixXd found = laplacian.displacements(Eigen::Map<const VectorXd>(delta.data(), delta.size()));
  Coordinates difference = Eigen::Map<const Coordinates>(found.data(), moved.rows(), 3) - moved;
  difference.rowwise() -= difference.row(0).eval();  // a translation has no Laplacian coordinates
  EXPECT_LT(difference.rowwise().norm().maxCoeff(), 1e-6);
}

TEST(LearntPartSolver, CoefficientsStayWithinTheirLimits) {
  const WrittenOut free(-1.0);
  const WrittenOut limited(0.0);
  const VectorXd at_rest = limited.solver().frame(limited.source()).coefficients;
  const VectorXd range = limited.learnt().greatest - limited.learnt().least;
  const auto excess = [&](const VectorXd& changes) {
    const VectorXd reached = at_rest + changes;
    const VectorXd least = limited.learnt().least.cwiseMin(at_rest);
    const VectorXd greatest = limited.learnt().greatest.cwiseMax(at_rest);
    return (least - reached).cwiseMax(reached - greatest).cwiseQuotient(range).maxCoeff();
  };
  EXPECT_GT(excess(free.solve().changes), 1e-3);  // else the limits are not tested
  EXPECT_LT(excess(limited.solve().changes), 1e-12);
}

TEST(LearntPartSolver, PreferredCoefficientsDrawTheResult) {
  const WrittenOut problem(-1.0);
  const auto& solver = problem.solver();
  const auto frame = solver.frame(problem.source());
  const auto factorization = solver.factorize({{.local = 0, .squared_weight = 1.0}});
  const auto prepared = solver.prepare(factorization, frame);
  const std::vector<Vector3d> targets = {problem.source().row(0).transpose()};
  const VectorXd preferred = VectorXd::LinSpaced(solver.component_count(), -0.1, 0.1);
  // One constraint that stays asks nothing of the shape: the prior alone decides.
  const auto solution =
      solver.solve(factorization, frame, prepared, targets, Matrix3d::Identity(), preferred);
  EXPECT_LT((solution.changes - preferred).norm(), 1e-6);
}

}  // namespace
}  // namespace reprise
