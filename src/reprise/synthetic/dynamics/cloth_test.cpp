// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/cloth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/synthetic/dynamics/dynamics_test_support.h"
#include "reprise/synthetic/dynamics/layer_player.h"

namespace reprise::dynamics {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr double rate = 25.0;
constexpr int around = 48, along = 20;
constexpr double waist = 0.18, hem = 0.30, skirt_length = 0.45, hip_height = 0.9;
constexpr double leg_radius = 0.08, leg_length = 0.7;

// Legs that hang from hips and swing, under a skirt that hangs from a waist.
struct Dancer {
  // `full`: fullness at the hem.
  explicit Dancer(double full = 1.0) {
    leg = test::leg(leg_radius, leg_length);
    const test::TestSurface cone = test::tube(around, along, [](double angle, double part) {
      const double r = waist + (hem - waist) * part;
      return Eigen::RowVector3d(r * std::cos(angle), hip_height + 0.1 - skirt_length * part,
                                -r * std::sin(angle));
    });
    skirt.kind = BodyLayer::Kind::garment;
    skirt.points = cone.points;
    skirt.triangles = cone.triangles;
    skirt.freedom.assign(static_cast<std::size_t>(around) * along, 1.0);
    std::fill_n(skirt.freedom.begin(), around, 0.0);
    if (full != 1.0) {
      for (int i = 0; i < around * along; ++i)
        skirt.fullness.push_back(1.0 + (full - 1.0) * std::min(1.0, 1.5 * (i / around) / along));
    }
    body.kind = BodyLayer::Kind::skin;
    body.triangles = (leg + leg).triangles;
    body.points = legs(0.0, Isometry3d::Identity());
  }
  static Isometry3d hip(int side, double swing, const Isometry3d& place) {
    return place * test::turn_about(Vector3d::UnitX(), side == 0 ? swing : -swing,
                                    {side == 0 ? 0.085 : -0.085, hip_height, 0.0});
  }
  Points legs(double swing, const Isometry3d& place) const {
    test::TestSurface both = leg;
    both.points = test::moved(leg.points, hip(0, swing, place));
    test::TestSurface right = leg;
    right.points = test::moved(leg.points, hip(1, swing, place));
    return (both + right).points;
  }
  // How deep the skirt is in the legs, metres.
  static double penetration(const Points& cloth, double swing, const Isometry3d& place) {
    double deepest = 0.0;
    for (int side = 0; side < 2; ++side) {
      const Points local = test::moved(cloth, hip(side, swing, place).inverse());
      for (Eigen::Index i = 0; i < local.rows(); ++i) {
        Vector3d p = local.row(i);
        p.y() -= std::clamp(p.y(), -leg_length, 0.0);
        deepest = std::max(deepest, leg_radius - p.norm());
      }
    }
    return deepest;
  }

  test::TestSurface leg;
  BodyLayer body, skirt;
};

struct Pose {
  double swing = 0.0;
  Isometry3d place = Isometry3d::Identity();
};
using Dance = std::function<Pose(double seconds)>;

struct Played {
  std::vector<Points> skirt;
  std::vector<Strain> strain;
  std::vector<double> penetration;
  double deepest() const { return *std::max_element(penetration.begin(), penetration.end()); }
};

Played play(const Dance& dance, int frames, const DynamicsOptions& options = {}, double full = 1.0) {
  const Dancer dancer(full);
  LayerPlayer player({dancer.body, dancer.skirt}, options, rate);
  const auto skinned = [&](int frame) {
    const Pose pose = dance(frame / rate);
    return std::vector<Points>{dancer.legs(pose.swing, pose.place),
                               test::moved(dancer.skirt.points, pose.place)};
  };
  Played played;
  player.start(skinned(0));
  for (int frame = 0; frame < frames; ++frame) {
    player.advance(skinned(frame + 1));
    played.skirt.push_back(player.points()[1]);
    played.strain.push_back(strain(player.simulated()[0].soft->particles()));
    const Pose pose = dance(frame / rate);
    played.penetration.push_back(Dancer::penetration(played.skirt.back(), pose.swing, pose.place));
  }
  return played;
}

double hem_radius(const Points& skirt) {
  const auto hem_points = skirt.bottomRows(around);
  return (hem_points.col(0).array().square() + hem_points.col(2).array().square()).sqrt().mean();
}

// Mean angle by which the hem is turned against the waist, radians.
double hem_turn(const Points& skirt) {
  double sum = 0.0;
  for (int i = 0; i < around; ++i) {
    const Eigen::Index low = skirt.rows() - around + i;
    sum += std::remainder(std::atan2(-skirt(low, 2), skirt(low, 0)) - std::atan2(-skirt(i, 2), skirt(i, 0)),
                          2.0 * pi);
  }
  return sum / around;
}

Pose turned(double yaw, double swing = 0.0) {
  return {swing, test::turn_about(Vector3d::UnitY(), yaw)};
}

// Two turns within two seconds from t = 1, smoothly.
double twirl_yaw(double t) {
  return 4.0 * pi * (0.5 - 0.5 * std::cos(pi * std::clamp((t - 1.0) / 2.0, 0.0, 1.0)));
}

TEST(Cloth, RestStaysAtRest) {
  const Played played = play([](double) { return Pose{}; }, 150);
  const double speed = (played.skirt[149] - played.skirt[148]).rowwise().norm().maxCoeff() * rate;
  EXPECT_LT(speed, 0.01);
  EXPECT_EQ(played.deepest(), 0.0);
}

TEST(Cloth, HangingClothHardlyStretches) {
  const Played played = play([](double) { return Pose{}; }, 50);
  EXPECT_LT(played.strain.back().mean, 0.015);
  EXPECT_LT(played.strain.back().greatest, 0.04);
}

TEST(Cloth, TwirlFlaresAndTheHemGoesOnTurning) {
  const Played played =
      play([](double t) { return turned(twirl_yaw(t), 0.35 * std::sin(6.0 * t) * std::exp(-t)); }, 125);
  EXPECT_LT(played.deepest(), 0.01);
  for (const Strain& s : played.strain) {
    EXPECT_LT(s.mean, 0.05);
    EXPECT_LT(s.greatest, 0.25);
  }
  // At full speed (t = 2) it stands wider than before, up to what is cut.
  EXPECT_GT(hem_radius(played.skirt[50]), 1.05 * hem_radius(played.skirt[24]));
  EXPECT_LT(hem_radius(played.skirt[50]), 1.05 * hem);
  // Speeding up it stays behind, and goes on when the body stops at t = 3.
  EXPECT_LT(hem_turn(played.skirt[37]), -0.05);
  double furthest = -1.0;
  for (std::size_t f = 65; f < 90; ++f) furthest = std::max(furthest, hem_turn(played.skirt[f]));
  EXPECT_GT(furthest, 0.10);
}

// Far faster than any dancer: nothing blows up, nothing stays inside.
TEST(Cloth, ViolentKicksAreSurvived) {
  const Played played = play(
      [](double t) {
        const double calm = std::clamp(2.0 - t, 0.0, 1.0);
        return turned(3.0 * calm * std::sin(9.0 * t), 0.9 * calm * std::sin(14.0 * t));
      },
      75);
  EXPECT_LT(played.deepest(), BodyCollider::deepest);
  EXPECT_LT(played.penetration.back(), 0.001);
  for (const Points& skirt : played.skirt) {
    ASSERT_TRUE(skirt.allFinite());
    for (Eigen::Index i = 0; i < skirt.rows(); ++i)
      ASSERT_LT((skirt.row(i) - Eigen::RowVector3d(0.0, hip_height + 0.1, 0.0)).norm(),
                1.1 * (waist + skirt_length));
  }
}

// Physics has no favourite place, direction or speed.
TEST(Cloth, SameSomewhereElseAndFacingAway) {
  const auto dance = [](double t) { return turned(0.5 * std::sin(4.0 * t), 0.3 * std::sin(5.0 * t)); };
  const Isometry3d elsewhere = test::turn_about(Vector3d::UnitY(), 2.0, {3.0, 0.0, -1.0});
  const Played here = play(dance, 12);
  const Played there = play([&](double t) { return Pose{dance(t).swing, elsewhere * dance(t).place}; }, 12);
  for (std::size_t f = 0; f < here.skirt.size(); ++f)
    EXPECT_LT((test::moved(here.skirt[f], elsewhere) - there.skirt[f]).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Cloth, SameBytesOnEveryRunAndNumberOfThreads) {
  const auto dance = [](double t) { return turned(2.0 * t * t, 0.5 * std::sin(6.0 * t)); };
  const Played many = play(dance, 20);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Played one = play(dance, 20);
  for (std::size_t f = 0; f < many.skirt.size(); ++f) EXPECT_EQ(many.skirt[f], one.skirt[f]);
}

TEST(Cloth, FreedomDecidesWhoFollowsTheSkin) {
  const test::TestSurface sheet = test::cloth_sheet(4, 4, 0.1, 0.1);
  const auto sag = [&](double freedom) {
    ParticleSystem system = make_cloth(sheet.points, sheet.triangles, std::vector<double>(16, freedom), {});
    for (int step = 0; step < 1500; ++step) system.step(0.002, sheet.points, sheet.points, nullptr, {});
    double lowest = 0.0;
    for (Eigen::Index i = 0; i < 16; ++i)
      lowest = std::max(
          lowest, (system.position[static_cast<std::size_t>(i)] - sheet.points.row(i).transpose()).norm());
    return lowest;
  };
  EXPECT_EQ(sag(0.0), 0.0);
  EXPECT_LT(sag(0.1), 0.001);
  EXPECT_GT(sag(0.4), 2.0 * sag(0.1));
  EXPECT_NEAR(sag(0.4), 9.81 / std::pow(30.0 * 0.6 / 0.4, 2.0), 1e-3);  // g / rate^2
  EXPECT_LT(sag(1.0), 0.02);                                            // held loosely rather than dropped
}

TEST(Cloth, FullnessIsCutAroundTheBodyOnly) {
  const Dancer dancer;
  const std::size_t count = dancer.skirt.freedom.size();
  const auto cut = [&](const std::vector<double>& fullness) {
    return make_cloth(dancer.skirt.points, dancer.skirt.triangles, dancer.skirt.freedom, {}, fullness);
  };
  const ParticleSystem plain = cut({}), full = cut(std::vector<double>(count, 1.5));
  ASSERT_EQ(plain.links.size(), full.links.size());
  for (const Link& link : full.links) {
    const double apart = (dancer.skirt.points.row(link.a) - dancer.skirt.points.row(link.b)).norm();
    const int ring_a = link.a / around, ring_b = link.b / around;
    const int column_a = link.a % around, column_b = link.b % around;
    if (ring_a == ring_b) {
      EXPECT_NEAR(link.length, 1.5 * apart, 1e-3 * apart);
    } else if (column_a == column_b) {
      EXPECT_NEAR(link.length, apart, 1e-3 * apart);
    } else {
      EXPECT_GT(link.length, 1.05 * apart);
    }
  }
  // More cloth weighs more.
  double plain_mass = 0.0, full_mass = 0.0;
  for (std::size_t i = static_cast<std::size_t>(around); i < count; ++i) {
    plain_mass += 1.0 / plain.inverse_mass[i];
    full_mass += 1.0 / full.inverse_mass[i];
  }
  EXPECT_NEAR(full_mass / plain_mass, 1.5, 0.01);
}

// A full skirt hangs in folds about where it lies at rest, and stands out in a steady turn as a conical
// pendulum does: tan(angle from the vertical) = speed^2 * radius / g.
TEST(Cloth, FullSkirtSwingsOutLikeAConicalPendulum) {
  constexpr double full = 1.8;
  const auto slope = [](const Points& skirt) {  // of its lower half: outward per downward
    const Points upper = skirt.middleRows((along / 2) * around, around), lower = skirt.bottomRows(around);
    const auto radius = [](const Points& p) {
      return (p.col(0).array().square() + p.col(2).array().square()).sqrt().mean();
    };
    return (radius(lower) - radius(upper)) / (upper.col(1).mean() - lower.col(1).mean());
  };
  const Played hanging = play([](double) { return Pose{}; }, 75, {}, full);
  EXPECT_LT(hem_radius(hanging.skirt.back()), 1.05 * hem);
  EXPECT_EQ(hanging.penetration.back(), 0.0);
  double before = hem_radius(hanging.skirt.back());
  for (const double speed : {4.5, 6.0}) {
    const Played turning = play(
        [&](double t) { return turned(t < 1.0 ? 0.5 * speed * t * t : speed * (t - 0.5)); }, 100, {}, full);
    const Points& skirt = turning.skirt.back();
    const Points middle = skirt.bottomRows(around * along / 2);
    const double radius = (middle.col(0).array().square() + middle.col(2).array().square()).sqrt().mean();
    const double expected = speed * speed * radius / 9.81;
    EXPECT_GT(slope(skirt), 0.6 * expected) << speed;
    EXPECT_LT(slope(skirt), 1.4 * expected) << speed;
    EXPECT_GT(hem_radius(skirt), 1.1 * before);
    before = hem_radius(skirt);
  }
}

// A gathered seam: two vertices at one place are one particle, with or without another name.
TEST(Cloth, CoincidentVerticesMoveAsOne) {
  Dancer dancer;
  const Eigen::Index last = dancer.skirt.points.rows();
  dancer.skirt.points.conservativeResize(last + 1, 3);
  dancer.skirt.points.row(last) = dancer.skirt.points.row(5 * around);
  dancer.skirt.freedom.push_back(1.0);
  dancer.skirt.triangles[5 * 2 * around] = {static_cast<std::int32_t>(last),
                                            dancer.skirt.triangles[5 * 2 * around][1],
                                            dancer.skirt.triangles[5 * 2 * around][2]};
  LayerPlayer player({dancer.body, dancer.skirt}, {}, rate);
  const std::vector<Points> rest = {dancer.body.points, dancer.skirt.points};
  player.start(rest);
  for (int frame = 0; frame < 10; ++frame) player.advance(rest);
  const Points skirt = player.points()[1];
  EXPECT_EQ(skirt.row(last), skirt.row(5 * around));
}

TEST(Cloth, WindBlowsItSideways) {
  const Played calm = play([](double) { return Pose{}; }, 40);
  const Played windy = play([](double) { return Pose{}; }, 40, {.wind = 4.0});
  EXPECT_GT((windy.skirt.back() - calm.skirt.back()).bottomRows(around).col(0).mean(), 0.01);
}

}  // namespace
}  // namespace reprise::dynamics
