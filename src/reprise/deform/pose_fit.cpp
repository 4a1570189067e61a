// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/pose_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/pose_problem.h"

namespace reprise {
namespace {

// Constraints nearer than this to their targets are met: far below the precision of float positions.
constexpr double met = 1e-9;  // metres
// A joint turns no farther in one step: farther away the linearisation says nothing.
constexpr double longest_turn = 0.8;  // radians
constexpr double least_damping = 1e-9;
constexpr double first_damping = 1e-3;
// The pull with which joints are held at first, as a share of how much the constraints hold them, its factor
// from pass to pass, and how well a pass before the last is solved (radians, metres).
constexpr double stiffest_share = 0.03;
constexpr double softening = 0.1;
constexpr double coarse_tolerance = 1e-2;

void check(const PoseFitOptions& options) {
  if (!(options.pull > 0.0) || !std::isfinite(options.pull)) {
    throw InvalidArgument(
        fmt::format("pose fit: expected a pull that is positive and finite, found {}", options.pull));
  }
  if (options.most_iterations < 1) {
    throw InvalidArgument(
        fmt::format("pose fit: expected most_iterations of 1 or more, found {}", options.most_iterations));
  }
  if (!(options.tolerance > 0.0)) {
    throw InvalidArgument(
        fmt::format("pose fit: expected a positive tolerance, found {}", options.tolerance));
  }
}

// Improves the pose of `fit` until a step is shorter than `tolerance`; false if it takes more iterations than
// are left.
bool minimise(PoseProblem& problem, double tolerance, int most_iterations, PoseFit& fit) {
  double cost = problem.cost(fit.pose);
  double damping = first_damping, growth = 2.0;
  PoseProblem::Model model;
  problem.linearise(fit.pose, model);
  while (fit.iterations < most_iterations) {
    ++fit.iterations;
    Eigen::MatrixXd damped = model.H;
    damped.diagonal() += damping * model.scales;
    const Eigen::LLT<Eigen::MatrixXd> factor(damped);
    // Nielsen's rule: the damping follows how well the model foretold the cost.
    double gain = -1.0;
    if (factor.info() == Eigen::Success) {
      const Eigen::VectorXd step = factor.solve(-model.g);
      if (problem.longest_turn(step) <= longest_turn) {
        SkeletonPose candidate = problem.moved(fit.pose, step);
        const double candidate_cost = problem.cost(candidate);
        if (candidate_cost < cost) {
          const double foretold = step.dot(damping * model.scales.cwiseProduct(step) - model.g);
          gain = (cost - candidate_cost) / std::max(foretold, std::numeric_limits<double>::min());
          fit.pose = std::move(candidate);
          cost = candidate_cost;
        }
        if (step.norm() <= tolerance) return true;
      }
    }
    if (gain > 0.0) {
      problem.linearise(fit.pose, model);
      damping = std::max(least_damping,
                         damping * std::clamp(1.0 - std::pow(2.0 * gain - 1.0, 3.0), 1.0 / 3.0, 2.0));
      growth = 2.0;
    } else {
      damping *= growth;
      growth *= 2.0;
    }
  }
  return false;
}

}  // namespace

PoseFit fit_pose(const SkinWeights& weights, const Skeleton& skeleton, const PositionsView& source,
                 const SkeletonPose& source_pose, std::span<const PositionConstraint> constraints,
                 const PoseFitOptions& options) {
  check(options);
  validate(source_pose, skeleton, "source");
  validate(weights, static_cast<std::int32_t>(source.rows()), skeleton.size());
  validate(constraints, static_cast<std::int32_t>(source.rows()));
  const double pull2 = options.pull * options.pull;
  PoseProblem problem(weights, skeleton, source, source_pose, constraints, options.skinning, pull2);
  PoseFit fit{.pose = source_pose, .residual = problem.residual(source_pose), .converged = true};
  if (fit.residual <= met) return fit;

  fit.pose = problem.first_guess();
  fit.converged = false;
  // Squares of distances overflow: nothing can be said of targets that far.
  if (!std::isfinite(problem.cost(fit.pose))) {
    fit.pose = source_pose;
    return fit;
  }
  // A limb has many ways to its target, some wound about itself. Held stiffly at first and then less and
  // less, joints take the way that bends them least.
  PoseProblem::Model model;
  problem.linearise(fit.pose, model);
  const double stiffest = stiffest_share * problem.stiffness(model);
  for (double stiff = stiffest; stiff > pull2; stiff *= softening) {
    problem.set_pull2(stiff);
    minimise(problem, coarse_tolerance, options.most_iterations, fit);
  }
  problem.set_pull2(pull2);
  fit.converged = minimise(problem, options.tolerance, options.most_iterations, fit);
  fit.residual = problem.residual(fit.pose);
  return fit;
}

}  // namespace reprise
