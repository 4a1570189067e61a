// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/body_collider.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "reprise/synthetic/dynamics/dynamics_test_support.h"

namespace reprise::dynamics {
namespace {

using Eigen::Vector3d;
using test::TestSurface;

constexpr double radius = 0.08, length = 0.7;

// Of the capsule that `test::leg` approximates.
double capsule_distance(const Vector3d& p) {
  return (p - Vector3d(0.0, std::clamp(p.y(), -length, 0.0), 0.0)).norm() - radius;
}

class Leg : public ::testing::Test {
 protected:
  Leg() : leg_(test::leg(radius, length)), collider_(leg_.triangles, leg_.points.rows()) {
    collider_.move(leg_.points);
    collider_.prepare_search(Vector3d(-0.2, -1.0, -0.2), Vector3d(0.2, 0.2, 0.2), 0.03);
  }
  Touch touch(const Vector3d& p) {
    std::int32_t triangle = collider_.find(p)[0];
    return triangle < 0 ? Touch{} : collider_.touch(p, triangle);
  }

  TestSurface leg_;
  BodyCollider collider_;
};

// Particles round about the surface, up to 2.5 cm to either side.
std::vector<Vector3d> particles(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.025, 0.025), along(-length, 0.0), angle(0.0, 6.28);
  std::vector<Vector3d> result;
  for (int i = 0; i < count; ++i) {
    const double r = radius + off(random), a = angle(random);
    result.emplace_back(r * std::cos(a), along(random), r * std::sin(a));
  }
  return result;
}

TEST_F(Leg, DistanceAndNormalAreThoseOfTheCapsule) {
  const double chord = radius * (1.0 - std::cos(std::numbers::pi / 24.0));  // the facets lie that far inside
  for (const Vector3d& p : particles(2000)) {
    const Touch t = touch(p);
    ASSERT_TRUE(t.valid);
    EXPECT_NEAR(t.distance, capsule_distance(p), 1.1 * chord);
    const Vector3d outward = Vector3d(p.x(), 0.0, p.z()).normalized();
    EXPECT_GT(t.normal.dot(outward), std::cos(std::numbers::pi / 20.0));
  }
}

TEST_F(Leg, NothingIsFoundBeyondTheRadius) {
  EXPECT_EQ(collider_.find({radius + 0.031, -0.3, 0.0}), no_candidates);
  EXPECT_NE(collider_.find({radius + 0.028, -0.3, 0.0}), no_candidates);
}

TEST_F(Leg, GuessChangesNothing) {
  std::mt19937 random(6);
  std::uniform_int_distribution<std::int32_t> any(0, static_cast<std::int32_t>(leg_.triangles.size()) - 1);
  for (const Vector3d& p : particles(500)) EXPECT_EQ(collider_.find(p), collider_.find(p, any(random)));
}

// Once found, the surface is followed without searching again: here half around the leg.
TEST_F(Leg, WalkFollowsAParticle) {
  std::int32_t triangle = collider_.find({radius + 0.01, -0.35, 0.0})[0];
  ASSERT_GE(triangle, 0);
  for (int step = 0; step <= 100; ++step) {
    const double angle = std::numbers::pi * step / 100.0;
    const Vector3d p((radius + 0.01) * std::cos(angle), -0.35 - 0.002 * step,
                     (radius + 0.01) * std::sin(angle));
    std::int32_t searched = collider_.find(p)[0];
    EXPECT_NEAR(collider_.touch(p, triangle).distance, collider_.touch(p, searched).distance, 1e-9);
  }
}

TEST_F(Leg, SurfaceMovementIsSeen) {
  const Vector3d shift(0.003, -0.001, 0.002);
  collider_.move(test::moved(leg_.points, test::turn_about(Vector3d::UnitY(), 0.0, shift)));
  std::int32_t triangle = collider_.find({radius, -0.3, 0.0})[0];
  EXPECT_LT((collider_.touch(Vector3d(radius, -0.3, 0.0), triangle).movement - shift).norm(), 1e-12);
}

TEST_F(Leg, DeepInsideIsGivenUp) {
  std::int32_t triangle = collider_.find({radius - 0.02, -0.3, 0.0})[0];
  EXPECT_TRUE(collider_.touch(Vector3d(radius - 0.02, -0.3, 0.0), triangle).valid);
  EXPECT_FALSE(collider_.touch(Vector3d(0.02, -0.3, 0.0), triangle).valid);
}

TEST(BodyCollider, BetweenTwoLegsBothAreFound) {
  TestSurface legs = test::leg(radius, length);
  const TestSurface other = legs;
  legs.points.col(0).array() -= radius + 0.012;
  TestSurface right = other;
  right.points.col(0).array() += radius + 0.012;
  legs = legs + right;
  BodyCollider collider(legs.triangles, legs.points.rows());
  collider.move(legs.points);
  collider.prepare_search(Vector3d(-0.2, -1.0, -0.2), Vector3d(0.2, 0.2, 0.2), 0.03);
  const Vector3d p(0.003, -0.3, 0.0);
  Candidates found = collider.find(p);
  ASSERT_GE(found[0], 0);
  ASSERT_GE(found[1], 0);
  EXPECT_EQ(found[2], -1);
  const Touch first = collider.touch(p, found[0]), second = collider.touch(p, found[1]);
  EXPECT_GT(first.distance, 0.0);
  EXPECT_GT(second.distance, first.distance);
  EXPECT_LT(first.normal.dot(second.normal), -0.9);
}

// A particle on one side of something thin must not be held by the other side.
TEST(BodyCollider, FarWallOfSomethingThinIsIgnored) {
  const TestSurface finger = test::leg(0.008, 0.1);
  BodyCollider collider(finger.triangles, finger.points.rows());
  collider.move(finger.points);
  collider.prepare_search(Vector3d(-0.2, -0.2, -0.2), Vector3d(0.2, 0.2, 0.2), 0.03);
  for (const double off : {-0.012, -0.009, -0.006, 0.006, 0.009, 0.012}) {
    const Vector3d p(off, -0.05, 0.0);
    Candidates found = collider.find(p);
    ASSERT_GE(found[0], 0);
    EXPECT_NEAR(collider.touch(p, found[0]).distance, std::abs(off) - 0.008, 2e-4);
    EXPECT_EQ(found[1], -1);
  }
}

TEST(BodyCollider, OpenEdgesHoldNothing) {
  const TestSurface sheet = test::cloth_sheet(8, 8, 0.1, 0.1);
  BodyCollider collider(sheet.triangles, sheet.points.rows());
  collider.move(sheet.points);
  collider.prepare_search(Vector3d(-0.1, -0.2, -0.1), Vector3d(0.2, 0.1, 0.1), 0.03);
  const Vector3d over(0.052, -0.049, 0.01), beside(0.11, -0.05, 0.01);
  std::int32_t triangle = collider.find(over)[0];
  const Touch touch = collider.touch(over, triangle);
  ASSERT_TRUE(touch.valid);
  EXPECT_NEAR(touch.distance, 0.01, 1e-12);
  triangle = collider.find(beside)[0];
  EXPECT_TRUE(triangle < 0 || !collider.touch(beside, triangle).valid);
}

// A shoe around an ankle: its rim is nearer than the ankle, which must be found all the same.
TEST(BodyCollider, RimOfAShoeDoesNotHideTheAnkle) {
  const TestSurface shoe = test::tube(24, 6, [](double angle, double part) {
    return Eigen::RowVector3d(0.06 * std::cos(angle), -0.3 - 0.1 * part, -0.06 * std::sin(angle));
  });
  const TestSurface both = test::leg(0.045, length) + shoe;
  BodyCollider collider(both.triangles, both.points.rows());
  collider.move(both.points);
  collider.prepare_search(Vector3d(-0.2, -1.0, -0.2), Vector3d(0.2, 0.2, 0.2), 0.03);
  const Vector3d p(0.058, -0.295, 0.0);
  std::int32_t triangle = collider.find(p)[0];
  ASSERT_GE(triangle, 0);
  const Touch touch = collider.touch(p, triangle);
  ASSERT_TRUE(touch.valid);
  EXPECT_NEAR(touch.distance, 0.013, 5e-4);
}

}  // namespace
}  // namespace reprise::dynamics
