// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/vertex_turning.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

std::vector<Quaterniond> at_rest(Eigen::Index n) {
  return std::vector<Quaterniond>(static_cast<std::size_t>(n), Quaterniond::Identity());
}

TEST(VertexTurning, FindsTheTurnOfARigidMotion) {
  const test::Shape ball = test::sphere(2);
  const Coordinates from = ball.positions.cast<double>();
  const VertexTurning turning(*ball.topology);
  for (const double angle : {0.1, 1.0, 2.5}) {
    const Quaterniond truth(Eigen::AngleAxisd(angle, Vector3d(0.3, -1.0, 0.4).normalized()));
    const Coordinates to =
        (from * truth.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
    std::vector<Quaterniond> found = at_rest(from.rows());
    // One call may stop short of a far turn; the next goes on from there.
    for (int call = 0; call < 5; ++call) turning.update(from, to, found);
    for (const Quaterniond& q : found) EXPECT_LT(q.angularDistance(truth), 5e-3) << angle;
  }
}

TEST(VertexTurning, NothingMovedNothingTurns) {
  const test::Shape ball = test::sphere(1);
  const Coordinates places = ball.positions.cast<double>();
  std::vector<Quaterniond> found = at_rest(places.rows());
  VertexTurning(*ball.topology).update(places, places, found);
  for (const Quaterniond& q : found) EXPECT_EQ(q.coeffs(), Quaterniond::Identity().coeffs());
}

TEST(VertexTurning, FlatMirroredAndCollapsedPlacesGiveRotations) {
  const test::Shape ball = test::sphere(1);
  const Coordinates from = ball.positions.cast<double>();
  const VertexTurning turning(*ball.topology);
  for (const double squash : {0.0, -1.0}) {
    Coordinates to = from;
    to.col(1) *= squash;
    std::vector<Quaterniond> found = at_rest(from.rows());
    turning.update(from, to, found);
    turning.update(from, Coordinates::Zero(from.rows(), 3), found);
    for (const Quaterniond& q : found) EXPECT_NEAR(q.norm(), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace reprise
