// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/rigid_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "reprise/math/nearest_rotation.h"

namespace reprise::skeleton {
namespace {

struct Centred {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double mass = 0.0;
};

Centred weighted_centroid(std::span<const Eigen::Vector3d> points, std::span<const double> weights) {
  Centred sum;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sum.centroid += weights[i] * points[i];
    sum.mass += weights[i];
  }
  sum.centroid /= sum.mass;
  return sum;
}

Eigen::Matrix3d weighted_scatter(std::span<const Eigen::Vector3d> points, std::span<const double> weights,
                                 const Eigen::Vector3d& centroid) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = points[i] - centroid;
    scatter += weights[i] * d * d.transpose();
  }
  return scatter;
}

// Root mean square of how far the points lie apart, as two fits carry them.
double moved(const RigidFit& before, const RigidFit& after) {
  const Eigen::Matrix3d turn = after.rotation - before.rotation;
  return std::sqrt((after.centroid - before.carry(after.rest_centroid)).squaredNorm() +
                   (turn * after.scatter * turn.transpose()).trace() / after.mass);
}

}  // namespace

double RigidFit::variance_at(const Eigen::Vector3d& rest) const {
  // A small turn w moves the points by w x d: its normal matrix is tr(S) I - S, and the point at d from the
  // centroid moves by w x d in turn.
  const Eigen::Matrix3d turning = scatter.trace() * Eigen::Matrix3d::Identity() - scatter;
  const Eigen::Vector3d d = rest - rest_centroid;
  Eigen::Matrix3d cross;
  cross << 0.0, -d.z(), d.y(), d.z(), 0.0, -d.x(), -d.y(), d.x(), 0.0;
  const Eigen::Matrix3d turned = cross * turning.inverse() * cross.transpose();
  return variance * (3.0 / mass + turned.trace());
}

RigidFit fit_rigid(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> points,
                   std::span<const double> weights) {
  const auto [rest_centroid, mass] = weighted_centroid(rest, weights);
  const Eigen::Vector3d centroid = weighted_centroid(points, weights).centroid;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    covariance += weights[i] * (points[i] - centroid) * (rest[i] - rest_centroid).transpose();
  }
  RigidFit fit{.rotation = nearest_rotation(covariance),
               .rest_centroid = rest_centroid,
               .centroid = centroid,
               .mass = mass,
               .scatter = weighted_scatter(rest, weights, rest_centroid)};
  double squares = 0.0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    squares += weights[i] * (points[i] - fit.carry(rest[i])).squaredNorm();
  }
  fit.variance = squares / mass;
  return fit;
}

RigidFit fit_rigid_robustly(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> points,
                            std::span<const double> weights, double close) {
  constexpr int iterations = 6;
  constexpr double least_scale = 1e-6;  // metres: exact data has residuals of rounding only
  RigidFit fit = fit_rigid(rest, points, weights);
  std::vector<double> squared(rest.size());
  std::vector<double> sorted(rest.size());
  std::vector<double> reweighted(rest.size());
  for (int i = 0; i < iterations; ++i) {
    for (std::size_t v = 0; v < rest.size(); ++v) {
      squared[v] = (points[v] - fit.carry(rest[v])).squaredNorm();
    }
    sorted = squared;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double scale = std::max(4.0 * *middle, least_scale * least_scale);  // twice the median residual
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const double influence = scale / (scale + squared[v]);
      reweighted[v] = weights[v] * influence * influence;
    }
    const RigidFit before = fit;
    fit = fit_rigid(rest, points, reweighted);
    if (moved(before, fit) < close) break;
  }
  return fit;
}

bool fixes_rotation(std::span<const Eigen::Vector3d> rest, std::span<const double> weights) {
  const Centred centred = weighted_centroid(rest, weights);
  if (!(centred.mass > 0.0)) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      weighted_scatter(rest, weights, centred.centroid), Eigen::EigenvaluesOnly);
  constexpr double least_ratio = 1e-3;  // of squared extents: a rod 30 times as long as thick
  return eigen.eigenvalues()[1] > least_ratio * eigen.eigenvalues()[2];
}

}  // namespace reprise::skeleton
