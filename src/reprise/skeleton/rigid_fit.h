// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Least-squares rigid motions between corresponding points (Kabsch 1976), and a robust one that cloth and
// vertices near a bending joint do not pull along.

#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace reprise::skeleton {

struct RigidFit {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d rest_centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double variance = 0.0;                              // weighted mean squared residual, m^2
  double mass = 0.0;                                  // sum of the final weights
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  // weighted, of the rest points; for its uncertainty

  Eigen::Vector3d carry(const Eigen::Vector3d& rest) const {
    return centroid + rotation * (rest - rest_centroid);
  }
  // Variance (m^2, up to a factor that all fits share) with which the fit places a point: small residuals,
  // much surface and a point amidst it make it small.
  double variance_at(const Eigen::Vector3d& rest) const;
};

// The rigid motion that takes `rest` to `points` with the least weighted sum of squared residuals; a proper
// rotation even for mirrored points. As many points as weights, weights >= 0 with a positive sum.
RigidFit fit_rigid(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> points,
                   std::span<const double> weights);

// The same, iteratively reweighted: residuals far beyond the middle one count little (Geman and McClure).
// Ends when a round moves the points by less than `close` metres, root mean square, and after six rounds.
RigidFit fit_rigid_robustly(std::span<const Eigen::Vector3d> rest, std::span<const Eigen::Vector3d> points,
                            std::span<const double> weights, double close = 0.0);

// Whether the points fix a rotation: they do not lie on a line.
bool fixes_rotation(std::span<const Eigen::Vector3d> rest, std::span<const double> weights);

}  // namespace reprise::skeleton
