// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/rigid_fit.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "reprise/core/random.h"

namespace reprise::skeleton {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points cloud(std::size_t count, std::uint64_t seed, double size = 0.1) {
  const RandomField field(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(size * field.normal_pair(i, 0)[0], size * field.normal_pair(i, 1)[0],
                        size * field.normal_pair(i, 2)[0]);
  }
  return points;
}

Eigen::Isometry3d some_motion() {
  return Eigen::Translation3d(1.0, -2.0, 0.5) *
         Eigen::AngleAxisd(2.8, Eigen::Vector3d(0.3, -1.0, 0.4).normalized());
}

Points moved(const Points& points, const Eigen::Isometry3d& motion) {
  Points result;
  for (const Eigen::Vector3d& p : points) result.push_back(motion * p);
  return result;
}

TEST(RigidFit, FindsAMotionThatIsThere) {
  const Points rest = cloud(30, 1);
  const std::vector<double> weights(30, 0.5);
  const RigidFit fit = fit_rigid(rest, moved(rest, some_motion()), weights);
  EXPECT_LT((fit.rotation - some_motion().rotation()).norm(), 1e-12);
  const Eigen::Vector3d far(3.0, 2.0, 1.0);
  EXPECT_LT((fit.carry(far) - some_motion() * far).norm(), 1e-11);
  EXPECT_LT(fit.variance, 1e-24);
  EXPECT_NEAR(fit.mass, 15.0, 1e-12);
}

TEST(RigidFit, IsTheBestOfAllMotions) {
  const Points rest = cloud(20, 2);
  const Points points = cloud(20, 3);  // unrelated
  std::vector<double> weights;
  for (int i = 0; i < 20; ++i) weights.push_back(0.1 + i % 3);
  const RigidFit fit = fit_rigid(rest, points, weights);
  const auto cost = [&](const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Eigen::Vector3d carried = fit.centroid + shift + rotation * (rest[i] - fit.rest_centroid);
      sum += weights[i] * (points[i] - carried).squaredNorm();
    }
    return sum;
  };
  const double least = cost(fit.rotation, Eigen::Vector3d::Zero());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      EXPECT_GT(cost(Eigen::AngleAxisd(step, unit) * fit.rotation, Eigen::Vector3d::Zero()), least);
      EXPECT_GT(cost(fit.rotation, step * unit), least);
    }
  }
}

TEST(RigidFit, NeverMirrors) {
  const Points rest = cloud(30, 4);
  Points mirrored = rest;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  EXPECT_NEAR(fit_rigid(rest, mirrored, std::vector<double>(30, 1.0)).rotation.determinant(), 1.0, 1e-12);
  // A flat set of points has a mirror image of itself among its motions.
  Points flat = rest;
  for (Eigen::Vector3d& p : flat) p.z() = 0.0;
  const RigidFit fit = fit_rigid(flat, moved(flat, some_motion()), std::vector<double>(30, 1.0));
  EXPECT_LT((fit.rotation - some_motion().rotation()).norm(), 1e-10);
}

TEST(RigidFit, RobustFitPassesOverOutliers) {
  const Points rest = cloud(40, 5);
  Points points = moved(rest, some_motion());
  for (std::size_t i = 0; i < 12; ++i) points[i] += Eigen::Vector3d(0.2, 0.1, 0.0);
  const std::vector<double> weights(40, 1.0);
  const RigidFit plain = fit_rigid(rest, points, weights);
  const RigidFit robust = fit_rigid_robustly(rest, points, weights);
  const double plain_error = (plain.rotation - some_motion().rotation()).norm();
  const double robust_error = (robust.rotation - some_motion().rotation()).norm();
  EXPECT_GT(plain_error, 0.01);
  EXPECT_LT(robust_error, 0.1 * plain_error);
}

TEST(RigidFit, RobustFitMayEndWhenItHardlyMoves) {
  const Points rest = cloud(40, 5);
  Points points = moved(rest, some_motion());
  for (std::size_t i = 0; i < 12; ++i) points[i] += Eigen::Vector3d(0.2, 0.1, 0.0);
  const std::vector<double> weights(40, 1.0);
  const RigidFit full = fit_rigid_robustly(rest, points, weights);
  const auto distance = [&](double close) {
    const RigidFit fit = fit_rigid_robustly(rest, points, weights, close);
    double farthest = 0.0;
    for (const Eigen::Vector3d& p : rest)
      farthest = std::max(farthest, (fit.carry(p) - full.carry(p)).norm());
    return farthest;
  };
  EXPECT_GT(distance(1.0), 1e-3);  // one round is not enough here
  EXPECT_LT(distance(1e-4), 1e-4);
  EXPECT_EQ(distance(0.0), 0.0);
}

// Predicted spread against the spread of many noisy fits, up to the factor that all predictions share.
TEST(RigidFit, KnowsHowWellItPlacesAPoint) {
  const Points rest = cloud(25, 6);
  const std::vector<double> weights(25, 1.0);
  const Points probes = {{0, 0, 0}, {0.5, 0, 0}, {0, 0, 1.0}};
  std::vector<double> spread(probes.size(), 0.0);
  std::vector<double> predicted(probes.size(), 0.0);
  const int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    Points points = rest;
    const Points noise = cloud(25, 100 + static_cast<std::uint64_t>(trial), 0.002);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] += noise[i];
    const RigidFit fit = fit_rigid(rest, points, weights);
    for (std::size_t k = 0; k < probes.size(); ++k) {
      spread[k] += (fit.carry(probes[k]) - probes[k]).squaredNorm() / trials;
      predicted[k] += fit.variance_at(probes[k]) / trials;
    }
  }
  for (std::size_t k = 1; k < probes.size(); ++k) {
    EXPECT_NEAR((spread[k] / spread[0]) / (predicted[k] / predicted[0]), 1.0, 0.25) << k;
  }
}

TEST(RigidFit, KnowsWhetherPointsFixARotation) {
  const std::vector<double> weights(8, 1.0);
  Points points = cloud(8, 7);
  EXPECT_TRUE(fixes_rotation(points, weights));
  for (Eigen::Vector3d& p : points) p.z() = 0.0;
  EXPECT_TRUE(fixes_rotation(points, weights));
  for (Eigen::Vector3d& p : points) p.y() = 2.0 * p.x();
  EXPECT_FALSE(fixes_rotation(points, weights));
  for (Eigen::Vector3d& p : points) p = Eigen::Vector3d::Ones();
  EXPECT_FALSE(fixes_rotation(points, weights));
  EXPECT_FALSE(fixes_rotation(cloud(8, 7), std::vector<double>(8, 0.0)));
}

}  // namespace
}  // namespace reprise::skeleton
