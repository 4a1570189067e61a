// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/math/dual_quaternion.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class DualQuaternions : public testing::Test {
 protected:
  double number() { return std::normal_distribution<double>()(random_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Quaterniond rotation() { return Quaterniond(number(), number(), number(), number()).normalized(); }

 private:
  std::mt19937_64 random_{7};
};

TEST_F(DualQuaternions, CarryPointsAsTheMotionDoes) {
  for (int i = 0; i < 100; ++i) {
    const Quaterniond R = rotation();
    const Vector3d t = vector(), x = vector();
    const DualQuaternion d = dual_quaternion(R, t);
    EXPECT_NEAR((carry(d, x) - (R * x + t)).norm(), 0.0, 1e-13);
    // A multiple stands for the same motion, minus one included.
    EXPECT_NEAR((carry(-3.7 * d, x) - (R * x + t)).norm(), 0.0, 1e-13);
  }
}

TEST_F(DualQuaternions, MeansOfOneMotionAreThatMotion) {
  for (int i = 0; i < 100; ++i) {
    const DualQuaternion d = dual_quaternion(rotation(), vector());
    DualQuaternionSum sum(0.6, d);
    sum.add(0.4, -d);  // the other quaternion of the same rotation
    EXPECT_NEAR((sum.sum() - d).norm(), 0.0, 1e-14);
  }
}

TEST_F(DualQuaternions, MeansAreRigidAndMoveAlong) {
  for (int i = 0; i < 100; ++i) {
    const Quaterniond R1 = rotation(), R2 = rotation(), Q = rotation();
    const Vector3d t1 = vector(), t2 = vector(), s = vector();
    const auto mean = [](const Quaterniond& A, const Vector3d& a, const Quaterniond& B, const Vector3d& b) {
      DualQuaternionSum sum(0.7, dual_quaternion(A, a));
      sum.add(0.3, dual_quaternion(B, b));
      return sum.sum();
    };
    const Vector3d x = vector(), y = vector();
    const DualQuaternion both = mean(R1, t1, R2, t2);
    EXPECT_NEAR((carry(both, x) - carry(both, y)).norm(), (x - y).norm(), 1e-12);
    // Everything moved rigidly afterwards: the mean moves along.
    const DualQuaternion moved = mean(Q * R1, Q * t1 + s, Q * R2, Q * t2 + s);
    EXPECT_NEAR((carry(moved, x) - (Q * carry(both, x) + s)).norm(), 0.0, 1e-11);
  }
}

TEST_F(DualQuaternions, MeansOfTwoTurnsAboutOneAxisTurnAboutIt) {
  // Equal shares of turns by 0 and `angle` about an axis through `center`: the turn by half of it.
  for (const double angle : {0.3, 1.5, 3.0}) {
    const Vector3d axis = vector().normalized(), center = vector();
    const Quaterniond R(Eigen::AngleAxisd(angle, axis));
    DualQuaternionSum sum(0.5, dual_quaternion(Quaterniond::Identity(), Vector3d::Zero()));
    sum.add(0.5, dual_quaternion(R, center - R * center));
    const Vector3d x = vector();
    const Quaterniond half(Eigen::AngleAxisd(0.5 * angle, axis));
    EXPECT_NEAR((carry(sum.sum(), x) - (half * (x - center) + center)).norm(), 0.0, 1e-12) << angle;
  }
}

}  // namespace
}  // namespace reprise
