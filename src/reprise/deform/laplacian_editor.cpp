// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/laplacian_editor.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/turning_laplacian.h"
#include "reprise/linalg/sparse_cholesky.h"
#include "reprise/math/nearest_rotation.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

// A constrained vertex and its squared weight, 1/m^2.
struct Held {
  std::int32_t vertex = 0;
  double squared_weight = 0.0;
  bool operator==(const Held&) const = default;
};

void check_options(const LaplacianEditorOptions& options) {
  if (!(options.constraint_weight > 0.0 && std::isfinite(options.constraint_weight))) {
    throw InvalidArgument(
        fmt::format("a constraint weight of {}; expected a positive number", options.constraint_weight));
  }
  if (options.most_iterations < 1)
    throw InvalidArgument(fmt::format("{} iterations; expected one or more", options.most_iterations));
  if (!(options.tolerance >= 0.0))
    throw InvalidArgument(fmt::format("a tolerance of {} m; expected 0 or more", options.tolerance));
}

}  // namespace

struct LaplacianEditor::Impl {
  Impl(const TopologyPtr& topology, const PositionsView& reference, const LaplacianEditorOptions& wanted)
      : options(wanted), turning(topology, reference) {
    const Eigen::SparseMatrix<double>& L = turning.laplacian().matrix();
    LtL = L.transpose() * L;
  }

  std::int32_t vertex_count() const { return static_cast<std::int32_t>(turning.laplacian().vertex_count()); }
  void hold(std::vector<Held> wanted);
  void prepare_start();
  Coordinates start(const std::vector<Vector3d>& targets) const;
  // The step to the solution of Eq. 4 with triangles turned as in `x`.
  void find_step(const Coordinates& x, const std::vector<Vector3d>& targets);

  LaplacianEditorOptions options;
  TurningLaplacian turning;
  Eigen::SparseMatrix<double> LtL;

  std::vector<Held> held;  // by vertex
  SparseCholesky A;        // L^T L + W^2
  Coordinates frame;
  Coordinates positions;

  // For the start, one row a constrained vertex; empty: to be made. See `prepare_start`.
  Vector3d origin = Vector3d::Zero();
  Coordinates stiffness;

  Coordinates residual;  // kept for its memory
  Coordinates step;
};

void LaplacianEditor::Impl::hold(std::vector<Held> wanted) {
  if (wanted == held) return;
  Eigen::SparseMatrix<double> sum = LtL;
  for (const Held& one : wanted) sum.coeffRef(one.vertex, one.vertex) += one.squared_weight;
  A = SparseCholesky(sum);
  held = std::move(wanted);
  stiffness.resize(0, 3);
}

// For the surface turned as a whole, x = Q x_s + t + y, the energy of Eq. 4 after the best t and y is
// |S^1/2 (c - Q p)|^2, p the frame's places of the constrained vertices, c their targets and S = W^2 - W^2
// A^-1 W^2 the Schur complement. So the best Q is the rotation nearest to c^T S p, and S p can be kept. Many
// anchors far from a handle on a soft limb have their due weight in it.
void LaplacianEditor::Impl::prepare_start() {
  if (stiffness.rows() > 0) return;
  origin.setZero();
  double total = 0.0;
  for (const Held& one : held) {
    origin += one.squared_weight * frame.row(one.vertex).transpose();
    total += one.squared_weight;
  }
  origin /= total;
  stiffness.resize(static_cast<Eigen::Index>(held.size()), 3);
  Coordinates pull = Coordinates::Zero(frame.rows(), 3);
  for (std::size_t i = 0; i < held.size(); ++i) {
    const RowVector3d p = frame.row(held[i].vertex) - origin.transpose();
    pull.row(held[i].vertex) = held[i].squared_weight * p;
    stiffness.row(static_cast<Eigen::Index>(i)) = held[i].squared_weight * p;
  }
  A.solve_in_place(pull);
  for (std::size_t i = 0; i < held.size(); ++i)
    stiffness.row(static_cast<Eigen::Index>(i)) -= held[i].squared_weight * pull.row(held[i].vertex);
}

Coordinates LaplacianEditor::Impl::start(const std::vector<Vector3d>& targets) const {
  Vector3d centre = Vector3d::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < held.size(); ++i) {
    centre += held[i].squared_weight * targets[i];
    total += held[i].squared_weight;
  }
  centre /= total;
  Matrix3d pull = Matrix3d::Zero();
  for (std::size_t i = 0; i < held.size(); ++i)
    pull += (targets[i] - centre) * stiffness.row(static_cast<Eigen::Index>(i));
  // Turns that the targets leave open, as one of them or two do, are not made.
  constexpr double keep = 1e-9;
  constexpr double least = 1e-30;
  pull += (keep * pull.norm() + least) * Matrix3d::Identity();
  const Matrix3d Q = nearest_rotation(pull);
  Coordinates x = (frame.rowwise() - origin.transpose()) * Q.transpose();
  x.rowwise() += centre.transpose();
  return x;
}

// As a step from x, so that rounding is that of the step: A step = L^T (delta - L x) + W^2 (c - x).
void LaplacianEditor::Impl::find_step(const Coordinates& x, const std::vector<Vector3d>& targets) {
  turning.residual(x, residual);
  step.noalias() = -(turning.laplacian().matrix().transpose() * residual);
  // L knows nothing of where the surface is; rounding does, and a single weak constraint would not hold it.
  step.rowwise() -= step.colwise().mean().eval();
  for (std::size_t i = 0; i < held.size(); ++i) {
    step.row(held[i].vertex) += held[i].squared_weight * (targets[i].transpose() - x.row(held[i].vertex));
  }
  A.solve_in_place(step);
}

LaplacianEditor::LaplacianEditor(TopologyPtr topology, const PositionsView& reference,
                                 const LaplacianEditorOptions& options) {
  check_options(options);
  impl_ = std::make_unique<Impl>(topology, reference, options);
}

LaplacianEditor::~LaplacianEditor() = default;

void LaplacianEditor::set_frame(const PositionsView& frame, const SkeletonPose* /*pose*/) {
  Impl& impl = *impl_;
  check_frame(frame, impl.vertex_count());
  impl.frame = frame.cast<double>();
  impl.turning.set_frame(impl.frame);
  impl.positions = impl.frame;
  impl.stiffness.resize(0, 3);
}

DeformReport LaplacianEditor::deform(std::span<const PositionConstraint> constraints) {
  Impl& impl = *impl_;
  check_constraints(constraints, impl.vertex_count(), impl.frame);
  std::vector<PositionConstraint> sorted(constraints.begin(), constraints.end());
  std::ranges::sort(sorted, {}, &PositionConstraint::vertex);
  std::vector<Held> held;
  std::vector<Vector3d> targets;
  for (const PositionConstraint& one : sorted) {
    const double weight =
        impl.options.constraint_weight * one.weight / impl.turning.laplacian().mean_edge_length();
    held.push_back({.vertex = one.vertex, .squared_weight = weight * weight});
    targets.push_back(one.target);
  }
  impl.hold(std::move(held));
  impl.prepare_start();

  // A solution is the last places plus its step. Going on by a fixed share of the change between solutions
  // (Nesterov 1983) makes one iteration do the work of several. The share does not depend on the data, unlike
  // that of Anderson's mixing, which makes the surface flicker during a drag.
  Coordinates x = impl.start(targets);
  Coordinates solution, last_solution;
  DeformReport report{.solved_parts = 1};
  const double tolerance2 = impl.options.tolerance * impl.options.tolerance;
  while (true) {
    impl.find_step(x, targets);
    solution = x + impl.step;
    ++report.iterations;
    if (report.iterations == impl.options.most_iterations) break;
    if (impl.step.rowwise().squaredNorm().maxCoeff() < tolerance2) break;
    x = solution;
    if (report.iterations > 1) {
      constexpr double largest_share = 0.85;
      const double k = report.iterations;
      x += std::min(largest_share, (k - 1.0) / (k + 2.0)) * (solution - last_solution);
    }
    last_solution.swap(solution);
  }
  report.largest_residual = largest_residual(constraints, solution);
  impl.positions = std::move(solution);
  return report;
}

const Coordinates& LaplacianEditor::positions() const {
  return impl_->positions;
}

}  // namespace reprise
