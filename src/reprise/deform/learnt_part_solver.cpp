// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/learnt_part_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "reprise/deform/part_alignment.h"
#include "reprise/math/nearest_rotation.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A column of 3n numbers as n x 3 coordinates.
using ConstCoordinatesMap = Eigen::Map<const Coordinates>;
using CoordinatesMap = Eigen::Map<Coordinates>;

double dot(const Matrix3d& a, const Matrix3d& b) {
  return a.cwiseProduct(b).sum();
}

Matrix3d cross_matrix(const Vector3d& w) {
  Matrix3d m;
  m << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return m;
}

Matrix3d rotation_about(const Vector3d& w) {
  const double angle = w.norm();
  if (!(angle > 0.0)) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

}  // namespace

// Limits of the change r; both hold 0.
struct LearntPartSolver::Box {
  VectorXd least, greatest;
  bool is_bounded = false;
  bool holds(const VectorXd& r) const {
    return !is_bounded || ((r.array() >= least.array()).all() && (r.array() <= greatest.array()).all());
  }
};

// The problem in r and Q alone.
struct LearntPartSolver::Reduced {
  Matrix3d B_0 = Matrix3d::Zero();
  std::vector<Matrix3d> B;
  VectorXd h;  // with the prior's preference

  VectorXd linear(const Matrix3d& Q) const {
    VectorXd b = -h;
    for (std::size_t k = 0; k < B.size(); ++k) b[static_cast<Eigen::Index>(k)] += dot(B[k], Q);
    return b;
  }
  Matrix3d pull(const VectorXd& r) const {
    Matrix3d sum = B_0;
    for (std::size_t k = 0; k < B.size(); ++k) sum += r[static_cast<Eigen::Index>(k)] * B[k];
    return sum;
  }
};

LearntPartSolver::LearntPartSolver(const PartHierarchy::Part& part, const Positions& whole_reference,
                                   const LearntPart& learnt, const PartEditorOptions& options)
    : options_(&options),
      reference_(rows_of(PositionsView(whole_reference.data(), whole_reference.rows(), 3), part.vertices)),
      laplacian_(part_laplacian(part, reference_)),
      mean_(learnt.mean.cast<double>()),
      basis_(learnt.basis.cast<double>()),
      turning_(*part.topology),
      least_(learnt.least),
      greatest_(learnt.greatest) {
  const Eigen::SparseMatrix<double>& L = laplacian_.matrix();
  LtL_ = L.transpose() * L;
  const Eigen::Index n = laplacian_.vertex_count();
  const Eigen::Index l = basis_.cols();
  EtE_ = basis_.transpose() * basis_;
  LtE_.resize(3 * n, l);
  const Eigen::SparseMatrix<double> L_of_vertices = L.topRows(n);
  for (Eigen::Index k = 0; k < l; ++k) {
    CoordinatesMap(LtE_.col(k).data(), n, 3) =
        L_of_vertices.transpose() * ConstCoordinatesMap(basis_.col(k).data(), n, 3);
  }
  shapes_ = laplacian_.displacements(basis_);
  // Probabilistic PCA: what the basis leaves out is noise of this variance in each of the other directions.
  const auto others = static_cast<double>(std::max<Eigen::Index>(1, 3 * n - basis_.cols()));
  const double noise = learnt.discarded_variance / others;
  prior_ = VectorXd::Zero(l);
  for (Eigen::Index k = 0; k < basis_.cols(); ++k) {
    const double variance = learnt.deviations[k] * learnt.deviations[k];
    // The last term keeps the problem definite where a component moves nothing that is constrained.
    prior_[k] = (options.prior * noise) / std::max(variance, 1e-30) + 1e-9;
  }
}

LearntPartSolver::Frame LearntPartSolver::frame(const Coordinates& positions) const {
  Frame result;
  const Alignment alignment = align(positions, reference_);
  result.world_from_reference = alignment.rotation.transpose();
  result.aligned = alignment.apply(positions);
  result.delta = laplacian_(result.aligned);
  const Eigen::Map<const VectorXd> flat(result.delta.data(), basis_.rows());
  result.Et_delta = basis_.transpose() * flat;
  result.coefficients = result.Et_delta - basis_.transpose() * mean_;
  result.Lt_delta = laplacian_.matrix().transpose() * result.delta;
  result.squared_delta = result.delta.squaredNorm();
  return result;
}

LearntPartSolver::Factorization LearntPartSolver::factorize(std::vector<PartConstraint> constraints) const {
  Factorization result;
  Eigen::SparseMatrix<double> A = LtL_;
  for (const PartConstraint& constraint : constraints)
    A.coeffRef(constraint.local, constraint.local) += constraint.squared_weight;
  result.A = SparseCholesky(A);
  result.constraints = std::move(constraints);

  // All components at once: 3 l right-hand sides in neighbouring columns.
  const Eigen::Index n = laplacian_.vertex_count();
  const Eigen::Index l = basis_.cols();
  result.Z.resize(3 * n, l);
  for (Eigen::Index k = 0; k < l; ++k) {
    Coordinates z = ConstCoordinatesMap(LtE_.col(k).data(), n, 3);
    result.A.solve_in_place(z);
    CoordinatesMap(result.Z.col(k).data(), n, 3) = z;
  }
  result.S = EtE_ - LtE_.transpose() * result.Z;
  result.S = (0.5 * (result.S + result.S.transpose())).eval();
  result.S.diagonal() += prior_;
  result.S_factor.compute(result.S);
  return result;
}

LearntPartSolver::Prepared LearntPartSolver::prepare(const Factorization& factorization,
                                                     const Frame& frame) const {
  Prepared result;
  result.X = frame.Lt_delta;
  factorization.A.solve_in_place(result.X);
  const Eigen::Map<const VectorXd> flat(result.X.data(), result.X.size());
  result.h = frame.Et_delta - LtE_.transpose() * flat;
  return result;
}

LearntPartSolver::Box LearntPartSolver::box(const Frame& frame) const {
  Box result;
  result.is_bounded = options_->beyond_range >= 0.0;
  if (!result.is_bounded) return result;
  const VectorXd beyond = options_->beyond_range * (greatest_ - least_);
  result.least = (least_ - beyond - frame.coefficients).cwiseMin(0.0);
  result.greatest = (greatest_ + beyond - frame.coefficients).cwiseMax(0.0);
  return result;
}

// r with r^T S r - 2 b^T r least within the box, by coordinate descent from the given r. The components that
// do not stand at a limit, ascending.
std::vector<Eigen::Index> LearntPartSolver::solve_within(const MatrixXd& S, const VectorXd& b, const Box& box,
                                                         VectorXd& r) {
  constexpr int most_sweeps = 200;
  constexpr double tolerance = 1e-10;  // of a component's range
  r = r.cwiseMax(box.least).cwiseMin(box.greatest);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double largest = 0.0;
    for (Eigen::Index k = 0; k < r.size(); ++k) {
      const double free = r[k] + (b[k] - S.col(k).dot(r)) / S(k, k);
      const double next = std::clamp(free, box.least[k], box.greatest[k]);
      const double range = box.greatest[k] - box.least[k];
      if (range > 0.0) largest = std::max(largest, std::abs(next - r[k]) / range);
      r[k] = next;
    }
    if (largest < tolerance) break;
  }
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < r.size(); ++k) {
    if (r[k] > box.least[k] && r[k] < box.greatest[k]) free.push_back(k);
  }
  return free;
}

// Newton's step for Q with the free components of r eliminated, as a rotation vector in Q's own frame; none
// where the problem is not convex, or the quadratic says little so far away.
std::optional<Vector3d> LearntPartSolver::newton_step(const Factorization& factorization,
                                                      const Reduced& reduced, const Matrix3d& Q,
                                                      const Matrix3d& pull,
                                                      const std::vector<Eigen::Index>& free) {
  std::array<Matrix3d, 3> turns;
  MatrixXd K(static_cast<Eigen::Index>(free.size()), 3);
  Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    turns[static_cast<std::size_t>(i)] = cross_matrix(Vector3d::Unit(i));
    const Matrix3d derivative = Q * turns[static_cast<std::size_t>(i)];
    gradient[i] = -2.0 * dot(pull, derivative);
    for (std::size_t k = 0; k < free.size(); ++k)
      K(static_cast<Eigen::Index>(k), i) = dot(reduced.B[static_cast<std::size_t>(free[k])], derivative);
  }
  Matrix3d hessian = Matrix3d::Zero();
  if (static_cast<Eigen::Index>(free.size()) == factorization.S.cols()) {
    hessian -= 2.0 * K.transpose() * factorization.S_factor.solve(K);
  } else if (!free.empty()) {
    hessian -= 2.0 * K.transpose() * factorization.S(free, free).llt().solve(K);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      hessian(static_cast<int>(i), static_cast<int>(j)) -=
          dot(pull, Q * (turns[i] * turns[j] + turns[j] * turns[i]));
    }
  }
  const Eigen::LLT<Matrix3d> factor(hessian);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Vector3d step = -factor.solve(gradient);
  constexpr double longest_step = 0.3;  // radians
  if (!step.allFinite() || step.norm() > longest_step) return std::nullopt;
  return step;
}

LearntPartSolver::Solution LearntPartSolver::solve(const Factorization& factorization, const Frame& frame,
                                                   const Prepared& prepared,
                                                   std::span<const Vector3d> targets, const Matrix3d& turn,
                                                   const VectorXd& preferred) const {
  const Eigen::Index n = laplacian_.vertex_count();
  const Eigen::Index l = basis_.cols();
  const std::vector<PartConstraint>& constraints = factorization.constraints;

  // Translations are eliminated with x; about the constraints' centroid the numbers are small, and a single
  // constraint turns nothing.
  Vector3d origin = Vector3d::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    origin += constraints[i].squared_weight * targets[i];
    total += constraints[i].squared_weight;
  }
  origin /= total;

  Reduced reduced{.B = std::vector<Matrix3d>(static_cast<std::size_t>(l), Matrix3d::Zero()), .h = prepared.h};
  if (preferred.size() > 0) reduced.h -= prior_.cwiseProduct(preferred);
  Coordinates x = Coordinates::Zero(n, 3);
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Eigen::Index v = constraints[i].local;
    const Vector3d pull = constraints[i].squared_weight * (targets[i] - origin);
    x.row(v) += pull.transpose();
    reduced.B_0 += pull * prepared.X.row(v);
    for (Eigen::Index k = 0; k < l; ++k) {
      reduced.B[static_cast<std::size_t>(k)] +=
          pull * Eigen::Map<const Eigen::RowVector3d>(&factorization.Z(3 * v, k));
    }
  }
  // Decides where the constraints leave the turn of the part open.
  constexpr double keep = 1e-9;
  reduced.B_0 += (keep * frame.squared_delta + 1e-20) * turn * frame.world_from_reference;

  const Box limits = box(frame);
  Solution solution{.changes = VectorXd::Zero(l)};
  VectorXd& r = solution.changes;
  Matrix3d Q = nearest_rotation(reduced.B_0);
  if (l > 0) solution.iterations = minimise(factorization, reduced, limits, Q, r);

  factorization.A.solve_in_place(x);  // the constraints' part, in the world
  const auto in_reference = [&] {
    Coordinates positions = prepared.X + x * Q;
    if (l > 0) Eigen::Map<VectorXd>(positions.data(), positions.size()) += factorization.Z * r;
    return positions;
  };
  Coordinates positions = in_reference();
  std::vector<Eigen::Quaterniond> rotations(static_cast<std::size_t>(n), Eigen::Quaterniond::Identity());
  Coordinates correction;
  constexpr int most_passes = 12;
  for (int pass = 0; pass < most_passes && turn_along(frame, positions, r, rotations, correction); ++pass) {
    // delta_s + correction in the place of delta_s.
    Coordinates moved = laplacian_.matrix().transpose() * correction;
    factorization.A.solve_in_place(moved);
    Reduced turned = reduced;
    if (l > 0) {
      turned.h += basis_.transpose() * Eigen::Map<const VectorXd>(correction.data(), basis_.rows()) -
                  LtE_.transpose() * Eigen::Map<const VectorXd>(moved.data(), moved.size());
    }
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      turned.B_0 += constraints[i].squared_weight * (targets[i] - origin) * moved.row(constraints[i].local);
    }
    if (l > 0) {
      solution.iterations += minimise(factorization, turned, limits, Q, r);
    } else {
      Q = nearest_rotation(turned.B_0);
    }
    const Coordinates before = positions;
    positions = in_reference() + moved;
    constexpr double tolerance = 1e-4;  // metres
    if ((positions - before).rowwise().squaredNorm().maxCoeff() < tolerance * tolerance) break;
  }
  solution.positions = (positions * Q.transpose()).rowwise() + origin.transpose();
  solution.world_from_reference = Q;
  return solution;
}

int LearntPartSolver::minimise(const Factorization& factorization, const Reduced& reduced, const Box& limits,
                               Matrix3d& Q, VectorXd& r) const {
  const Eigen::Index l = basis_.cols();
  std::vector<Eigen::Index> free(static_cast<std::size_t>(l));
  const auto best_changes = [&](const Matrix3d& rotation) {
    const VectorXd b = reduced.linear(rotation);
    const VectorXd unlimited = factorization.S_factor.solve(b);
    if (limits.holds(unlimited)) {
      r = unlimited;
      free.resize(static_cast<std::size_t>(l));
      std::iota(free.begin(), free.end(), Eigen::Index{0});
    } else {
      free = solve_within(factorization.S, b, limits, r);
    }
  };
  const auto energy = [&](const Matrix3d& rotation) {
    return r.dot(factorization.S * r) - 2.0 * r.dot(reduced.linear(rotation)) -
           2.0 * dot(reduced.B_0, rotation);
  };
  constexpr int most_iterations = 100;
  constexpr double tolerance = 1e-10;  // radians
  best_changes(Q);
  double least = energy(Q);
  int iteration = 1;
  for (; iteration <= most_iterations; ++iteration) {
    const Matrix3d pull = reduced.pull(r);
    const std::optional<Vector3d> step = newton_step(factorization, reduced, Q, pull, free);
    Matrix3d next = step ? Matrix3d(Q * rotation_about(*step)) : nearest_rotation(pull);
    best_changes(next);
    double reached = energy(next);
    if (step && reached > least) {
      // The best rotation for the last r never makes it worse.
      next = nearest_rotation(pull);
      best_changes(next);
      reached = energy(next);
    }
    const double turned = (next - Q).norm();
    Q = next;
    const bool is_lower = reached < least;
    least = std::min(least, reached);
    if (turned < tolerance || !is_lower) break;
  }
  return iteration;
}

bool LearntPartSolver::turn_along(const Frame& frame, const Coordinates& positions, const VectorXd& r,
                                  std::vector<Eigen::Quaterniond>& rotations, Coordinates& correction) const {
  const Eigen::Index n = laplacian_.vertex_count();
  if (!(options_->free_turn < std::numbers::pi)) return false;
  Coordinates shape = frame.aligned;
  Coordinates delta = frame.delta.topRows(n);
  if (basis_.cols() > 0) {
    Eigen::Map<VectorXd>(shape.data(), 3 * n) += shapes_ * r;
    Eigen::Map<VectorXd>(delta.data(), 3 * n) += basis_ * r;
  }
  turning_.update(shape, positions, rotations);
  bool any = false;
  correction.setZero(laplacian_.rows(), 3);
  for (Eigen::Index v = 0; v < n; ++v) {
    const Eigen::AngleAxisd turned(rotations[static_cast<std::size_t>(v)]);
    const double beyond = turned.angle() - options_->free_turn;
    if (!(beyond > 0.0)) continue;
    any = true;
    const Matrix3d along = Eigen::AngleAxisd(beyond, turned.axis()).toRotationMatrix();
    correction.row(v) = delta.row(v) * (along - Matrix3d::Identity()).transpose();
  }
  return any;
}

}  // namespace reprise
