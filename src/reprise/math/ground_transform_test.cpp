// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/math/ground_transform.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace reprise {
namespace {

using std::numbers::pi;

constexpr double rounding = 1e-12;

class GroundTransforms : public testing::Test {
 protected:
  double number(double limit) { return std::uniform_real_distribution<double>(-limit, limit)(random_); }
  GroundTransform transform() { return {.yaw = number(pi), .translation = {number(5.0), number(5.0)}}; }
  Eigen::Vector3d point() { return {number(3.0), number(3.0), number(3.0)}; }

 private:
  std::mt19937_64 random_{20};
};

void expect_equal(const GroundTransform& a, const GroundTransform& b) {
  EXPECT_NEAR(wrap_angle(a.yaw - b.yaw), 0.0, rounding);
  EXPECT_LT((a.translation - b.translation).norm(), rounding);
}

TEST_F(GroundTransforms, PositiveYawTurnsForwardTowardsX) {
  const GroundTransform quarter{.yaw = pi / 2};
  EXPECT_LT((quarter * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(), rounding);
  EXPECT_LT((quarter * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 0, -1)).norm(), rounding);
}

TEST_F(GroundTransforms, DefaultIsTheIdentity) {
  const Eigen::Vector3d p = point();
  EXPECT_EQ(GroundTransform() * p, p);
}

TEST_F(GroundTransforms, ProductIsOneTransformAfterTheOther) {
  for (int repeat = 0; repeat < 100; ++repeat) {
    const GroundTransform c_from_b = transform();
    const GroundTransform b_from_a = transform();
    const Eigen::Vector3d p = point();
    EXPECT_LT(((c_from_b * b_from_a) * p - c_from_b * (b_from_a * p)).norm(), rounding);
  }
}

TEST_F(GroundTransforms, ProductIsAssociative) {
  for (int repeat = 0; repeat < 100; ++repeat) {
    const GroundTransform a = transform();
    const GroundTransform b = transform();
    const GroundTransform c = transform();
    expect_equal((a * b) * c, a * (b * c));
  }
}

TEST_F(GroundTransforms, InverseUndoesFromBothSides) {
  for (int repeat = 0; repeat < 100; ++repeat) {
    const GroundTransform b_from_a = transform();
    expect_equal(b_from_a * b_from_a.inverse(), GroundTransform());
    expect_equal(b_from_a.inverse() * b_from_a, GroundTransform());
    const Eigen::Vector3d p = point();
    EXPECT_LT((b_from_a.inverse() * (b_from_a * p) - p).norm(), rounding);
  }
}

TEST_F(GroundTransforms, KeepsDistancesHeightsAndHandedness) {
  for (int repeat = 0; repeat < 100; ++repeat) {
    const GroundTransform b_from_a = transform();
    const Eigen::Vector3d p = point();
    const Eigen::Vector3d q = point();
    EXPECT_NEAR((b_from_a * p - b_from_a * q).norm(), (p - q).norm(), rounding);
    EXPECT_EQ((b_from_a * p).y(), p.y());
    EXPECT_NEAR(b_from_a.rotation().determinant(), 1.0, rounding);
  }
}

TEST_F(GroundTransforms, MovesGroundPointsAsItMovesSpace) {
  for (int repeat = 0; repeat < 100; ++repeat) {
    const GroundTransform b_from_a = transform();
    const Eigen::Vector3d p = point();
    const Eigen::Vector2d on_ground = b_from_a * Eigen::Vector2d(p.x(), p.z());
    const Eigen::Vector3d in_space = b_from_a * p;
    EXPECT_LT((on_ground - Eigen::Vector2d(in_space.x(), in_space.z())).norm(), rounding);
  }
}

TEST(WrapAngle, LiesInTheHalfOpenTurnAndKeepsTheDirection) {
  for (double angle = -20.0; angle < 20.0; angle += 0.01) {
    const double wrapped = wrap_angle(angle);
    EXPECT_GT(wrapped, -pi);
    EXPECT_LE(wrapped, pi);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), rounding);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), rounding);
  }
}

TEST(WrapAngle, HalfATurnIsPositiveFromBothSides) {
  EXPECT_EQ(wrap_angle(pi), pi);
  EXPECT_EQ(wrap_angle(-pi), pi);
  EXPECT_EQ((GroundTransform{.yaw = -pi} * GroundTransform()).yaw, pi);
}

}  // namespace
}  // namespace reprise
