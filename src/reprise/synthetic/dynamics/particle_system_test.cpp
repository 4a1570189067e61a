// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/particle_system.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/synthetic/dynamics/cloth.h"
#include "reprise/synthetic/dynamics/dynamics_test_support.h"

namespace reprise::dynamics {
namespace {

using Eigen::Vector3d;

constexpr double g = 9.81;
constexpr double seconds = 1.0 / 500.0;
constexpr double pi = std::numbers::pi;

ParticleSystem particles_at(const std::vector<Vector3d>& places, const std::vector<double>& masses) {
  ParticleSystem system;
  system.position = places;
  system.velocity.assign(places.size(), Vector3d::Zero());
  system.thickness.assign(places.size(), 0.0);
  for (const double mass : masses) system.inverse_mass.push_back(mass > 0.0 ? 1.0 / mass : 0.0);
  return system;
}

Points as_points(const std::vector<Vector3d>& places) {
  Points points(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = places[i];
  return points;
}

// Seconds of a whole swing of particle `watched` along `axis`, from its crossings of zero.
double period(ParticleSystem& system, const Points& targets, int watched, int axis, double duration) {
  std::vector<double> crossings;
  double before = system.position[static_cast<std::size_t>(watched)][axis];
  for (int step = 1; step * seconds < duration; ++step) {
    system.step(seconds, targets, targets, nullptr, {});
    const double now = system.position[static_cast<std::size_t>(watched)][axis];
    if ((now > 0.0) != (before > 0.0)) crossings.push_back((step - now / (now - before)) * seconds);
    before = now;
  }
  if (crossings.size() < 3) return 0.0;
  return 2.0 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

TEST(ParticleSystem, PendulumSwingsInItsPeriod) {
  constexpr double length = 0.8, amplitude = 0.1;
  const std::vector<Vector3d> places = {{0.0, 0.0, 0.0},
                                        {length * std::sin(amplitude), -length * std::cos(amplitude), 0.0}};
  ParticleSystem system = particles_at(places, {0.0, 0.02});
  system.links = {{0, 1, length, 0.0, 0.0}};
  EXPECT_NEAR(period(system, as_points(places), 1, 0, 8.0), 2.0 * pi * std::sqrt(length / g), 0.01);
}

// The lowest mode of a hanging chain: period 4 pi / j0 * sqrt(L / g), j0 = 2.4048 the first zero of the
// Bessel function J0 (Bernoulli 1732). It begins in the shape of that mode.
TEST(ParticleSystem, HangingChainSwingsInItsPeriod) {
  constexpr int count = 25;
  constexpr double length = 1.0, j0 = 2.404826;
  std::vector<Vector3d> places;
  std::vector<double> masses;
  double y = 0.0, x_before = 0.0;
  for (int i = 0; i < count; ++i) {
    const double below = length * (1.0 - static_cast<double>(i) / (count - 1));
    const double x = 0.05 * std::cyl_bessel_j(0.0, j0 * std::sqrt(below / length));
    const double link = length / (count - 1);
    if (i > 0) y -= std::sqrt(link * link - (x - x_before) * (x - x_before));
    places.emplace_back(x, y, 0.0);
    masses.push_back(i == 0 ? 0.0 : i == count - 1 ? 0.5e-3 : 1e-3);
    x_before = x;
  }
  ParticleSystem system = particles_at(places, masses);
  for (int i = 0; i + 1 < count; ++i) system.links.push_back({i, i + 1, length / (count - 1), 0.0, 0.0});
  EXPECT_NEAR(period(system, as_points(places), count - 1, 0, 6.0), 4.0 * pi / j0 * std::sqrt(length / g),
              0.05);
}

TEST(ParticleSystem, SpringHangsAndSwingsByItsCompliance) {
  constexpr double mass = 0.05, compliance = 0.1, length = 0.4;  // 4.9 cm of extension
  const std::vector<Vector3d> places = {{0.0, length + mass * g * compliance, 0.0}, {0.0, 0.01, 0.0}};
  ParticleSystem system = particles_at(places, {0.0, mass});
  system.links = {{0, 1, length, compliance, 0.0}};
  EXPECT_NEAR(period(system, as_points(places), 1, 1, 4.0), 2.0 * pi * std::sqrt(mass * compliance), 0.01);
  system.links[0].damping = 0.05;
  for (int step = 0; step < 2000; ++step)
    system.step(seconds, as_points(places), as_points(places), nullptr, {});
  EXPECT_NEAR(system.position[1].y(), 0.0,
              1e-4);  // the extension of Hooke's law, just what was left room for
}

TEST(ParticleSystem, AttachmentHoldsByItsCompliance) {
  constexpr double mass = 0.01;
  const std::vector<Vector3d> places = {{0.0, 1.0, 0.0}};
  ParticleSystem system = particles_at(places, {mass});
  system.attachments = {{0, 0.2, 0.05}};
  for (int step = 0; step < 2000; ++step)
    system.step(seconds, as_points(places), as_points(places), nullptr, {});
  EXPECT_NEAR(system.position[0].y(), 1.0 - mass * g * 0.2, 1e-5);
}

TEST(ParticleSystem, FreeFallIsThatOfGalilei) {
  ParticleSystem system = particles_at({{0.0, 0.0, 0.0}, {0.3, 0.0, 0.0}}, {0.01, 0.03});
  system.links = {{0, 1, 0.3, 0.0, 0.0}};
  const Points none = as_points(system.position);
  for (int step = 0; step < 500; ++step) system.step(seconds, none, none, nullptr, {});
  // Semi-implicit Euler falls g h t / 2 too far.
  EXPECT_NEAR(system.position[0].y(), -0.5 * g, 0.5 * g * seconds + 1e-9);
  EXPECT_NEAR(system.position[1].x() - system.position[0].x(), 0.3, 1e-9);
}

// How far momentum and angular momentum of a sheet that flaps about in empty space for 0.4 s go astray.
std::pair<double, double> momentum_errors(double step_seconds) {
  const test::TestSurface sheet = test::cloth_sheet(6, 6, 0.2, 0.2);
  ParticleSystem system =
      make_cloth(sheet.points, sheet.triangles, std::vector<double>(36, 1.0), {.drag = 0.0});
  system.attachments.clear();  // "held loosely", since nothing holds it
  system.sails.clear();
  for (std::size_t i = 0; i < system.size(); ++i) {
    const Vector3d& p = system.position[i];
    system.velocity[i] = {std::sin(9.0 * p.y()), std::cos(7.0 * p.x()), std::sin(20.0 * (p.x() + p.y()))};
  }
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < system.size(); ++i) {
      const Vector3d p = system.velocity[i] / system.inverse_mass[i];
      sum.head<3>() += p;
      sum.tail<3>() += system.position[i].cross(p);
    }
    return sum;
  };
  const Eigen::Matrix<double, 6, 1> at_first = momenta();
  const Points none = as_points(system.position);
  Surroundings space;
  space.gravity.setZero();
  for (int step = 0; step < std::lround(0.4 / step_seconds); ++step)
    system.step(step_seconds, none, none, nullptr, space);
  const Eigen::Matrix<double, 6, 1> change = momenta() - at_first;
  return {change.head<3>().norm() / at_first.head<3>().norm(),
          change.tail<3>().norm() / at_first.tail<3>().norm()};
}

// Momentum is kept exactly, angular momentum to the order of the step.
TEST(ParticleSystem, InternalForcesKeepMomentumAndAngularMomentum) {
  const auto [momentum, angular] = momentum_errors(seconds);
  EXPECT_LT(momentum, 1e-12);
  EXPECT_LT(angular, 0.1);
  EXPECT_LT(momentum_errors(seconds / 8.0).second, 0.4 * angular);
}

TEST(ParticleSystem, EnergyDoesNotGrow) {
  const test::TestSurface sheet = test::cloth_sheet(12, 12, 0.4, 0.4);
  std::vector<double> freedom(144, 1.0);
  freedom[0] = freedom[11] = 0.0;
  ParticleSystem system = make_cloth(sheet.points, sheet.triangles, freedom, {});
  // Let go from lying flat in the air: it falls, swings and flaps.
  const Points targets = as_points(system.position);
  for (Vector3d& p : system.position) p = {p.x(), 0.0, -p.y()};
  const double first = system.energy({});
  double most = first;
  for (int step = 0; step < 1500; ++step) {
    system.step(seconds, targets, targets, nullptr, {});
    most = std::max(most, system.energy({}));
  }
  const double fall = 0.18 * 0.16 * g * 0.2;  // mass times how far its middle comes down
  EXPECT_LT(most, first + 1e-3 * fall);
  EXPECT_LT(system.energy({}), first - 0.6 * fall);
}

TEST(ParticleSystem, TethersBoundTheLength) {
  const std::vector<Vector3d> places = {{0.0, 0.0, 0.0}, {0.0, -0.5, 0.0}, {0.0, -1.0, 0.0}};
  ParticleSystem system = particles_at(places, {0.0, 0.001, 5.0});
  system.links = {{0, 1, 0.5, 1e-2, 0.0}, {1, 2, 0.5, 1e-2, 0.0}};  // far too soft for 5 kg
  system.tethers = {{2, 0, 1.02}};
  for (int step = 0; step < 500; ++step) {
    system.step(seconds, as_points(places), as_points(places), nullptr, {});
    EXPECT_LE(system.position[2].norm(), 1.02 + 1e-12);
  }
}

TEST(ParticleSystem, AirSlowsAFallingSheetToItsTerminalSpeed) {
  const test::TestSurface sheet = test::cloth_sheet(8, 8, 0.4, 0.4);
  std::vector<double> freedom(64, 1.0);
  ParticleSystem system = make_cloth(sheet.points, sheet.triangles, freedom, {.drag = 0.0});
  system.attachments.clear();
  for (Vector3d& p : system.position) p = {p.x(), 0.0, -p.y()};  // flat on the air
  const Points none = as_points(system.position);
  for (int step = 0; step < 500; ++step) system.step(seconds, none, none, nullptr, {});
  double speed = 0.0;
  for (const Vector3d& v : system.velocity) speed -= v.y() / static_cast<double>(system.size());
  // Weight against half rho c v^2 a square metre.
  EXPECT_NEAR(speed, std::sqrt(0.18 * g / (0.5 * 1.2 * 1.2)), 0.12);
}

}  // namespace
}  // namespace reprise::dynamics
