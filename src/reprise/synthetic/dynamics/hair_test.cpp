// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/hair.h"

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

constexpr double rate = 25.0;
constexpr double pi = std::numbers::pi;
constexpr int columns = 25, rows = 24, cards = 2;
constexpr double head_radius = 0.1, head_height = 1.5, neck_radius = 0.05;

// A head on a neck, with two layers of cards that hang down behind: 40 cm, in half a circle.
struct Head {
  Head() {
    test::TestSurface head = test::leg(head_radius, 0.001);
    head.points.col(1).array() += head_height;
    test::TestSurface neck = test::leg(neck_radius, 0.5);
    neck.points.col(1).array() += head_height - 0.05;
    const test::TestSurface both = head + neck;
    body.kind = BodyLayer::Kind::skin;
    body.points = both.points;
    body.triangles = both.triangles;
    hair.kind = BodyLayer::Kind::hair;
    test::TestSurface all;
    for (int card = 0; card < cards; ++card) {
      test::TestSurface sheet = test::cloth_sheet(columns, rows, 1.0, 0.4);
      for (Eigen::Index i = 0; i < sheet.points.rows(); ++i) {
        const double angle = pi * sheet.points(i, 0), radius = head_radius + 0.01 + 0.012 * card;
        sheet.points.row(i) << radius * std::cos(angle), head_height + sheet.points(i, 1),
            -radius * std::sin(angle);
        hair.freedom.push_back(std::clamp((static_cast<double>(i / columns) - 1.0) / 5.0, 0.0, 1.0));
      }
      all = all + sheet;
    }
    hair.points = all.points;
    hair.triangles = all.triangles;
  }
  BodyLayer body, hair;
};

using Dance = std::function<Isometry3d(double seconds)>;

std::vector<Points> play(const Dance& dance, int frames, double wind = 0.0) {
  const Head head;
  LayerPlayer player({head.body, head.hair}, {.wind = wind}, rate);
  const auto skinned = [&](int frame) {
    return std::vector<Points>{test::moved(head.body.points, dance(frame / rate)),
                               test::moved(head.hair.points, dance(frame / rate))};
  };
  std::vector<Points> result;
  player.start(skinned(0));
  for (int frame = 0; frame < frames; ++frame) {
    player.advance(skinned(frame + 1));
    result.push_back(player.points()[1]);
  }
  return result;
}

Isometry3d yaw(double angle) {
  return test::turn_about(Vector3d::UnitY(), angle);
}
Isometry3d still(double) {
  return yaw(0.0);
}
// A quarter turn within 0.4 s from t = 1.
Isometry3d quarter_turn(double t) {
  const double part = std::clamp((t - 1.0) / 0.4, 0.0, 1.0);
  return yaw(0.5 * pi * part * part * (3.0 - 2.0 * part));
}

// Mean angle by which the tips are turned against the skin, radians.
double tip_turn(const Points& hair, const Isometry3d& skin) {
  const Points local = test::moved(hair, skin.inverse());
  const Points rest = Head().hair.points;
  double sum = 0.0;
  for (int card = 1; card <= cards; ++card)
    for (int i = 0; i < columns; ++i) {
      const Eigen::Index v = Eigen::Index{card} * columns * rows - columns + i;
      sum +=
          std::remainder(std::atan2(local(v, 0), local(v, 2)) - std::atan2(rest(v, 0), rest(v, 2)), 2.0 * pi);
    }
  return sum / (cards * columns);
}

TEST(Hair, HangsAsItWasCombedAndRests) {
  const std::vector<Points> hair = play(still, 125);
  EXPECT_LT((hair[124] - Head().hair.points).rowwise().norm().maxCoeff(), 0.03);
  EXPECT_LT((hair[124] - hair[123]).rowwise().norm().maxCoeff() * rate, 0.01);
}

TEST(Hair, LagsBehindTheHeadAndComesBack) {
  const std::vector<Points> hair = play(quarter_turn, 150);
  double behind = 0.0, ahead = 0.0;
  for (std::size_t f = 25; f < 40; ++f)
    behind = std::min(behind, tip_turn(hair[f], quarter_turn(static_cast<double>(f) / rate)));
  for (std::size_t f = 40; f < 60; ++f)
    ahead = std::max(ahead, tip_turn(hair[f], quarter_turn(static_cast<double>(f) / rate)));
  EXPECT_LT(behind, -0.2);
  EXPECT_GT(ahead, 0.01);
  EXPECT_NEAR(tip_turn(hair[149], quarter_turn(6.0)), tip_turn(hair[20], still(0.0)), 0.06);
}

TEST(Hair, NeighboursStayNeighbours) {
  const Head head;
  for (const Points& hair : play([](double t) { return yaw(2.5 * std::sin(4.0 * t)); }, 75)) {
    for (const Triangle& t : head.hair.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Index a = t[k], b = t[(k + 1) % 3];
        const double rest = (head.hair.points.row(a) - head.hair.points.row(b)).norm();
        ASSERT_LT((hair.row(a) - hair.row(b)).norm(), 1.8 * rest);
      }
    }
  }
}

TEST(Hair, RootsStayOnTheScalpAndTheRestOffTheHead) {
  const auto shake = [](double t) { return yaw(1.5 * std::sin(6.0 * t)); };
  const std::vector<Points> hair = play(shake, 60);
  const Points rest = Head().hair.points;
  for (std::size_t f = 0; f < hair.size(); ++f) {
    const Points skinned = test::moved(rest, shake(static_cast<double>(f) / rate));
    EXPECT_LT((hair[f] - skinned).topRows(2 * columns).cwiseAbs().maxCoeff(), 1e-12);
    const Points local = hair[f].rowwise() - Eigen::RowVector3d(0.0, head_height, 0.0);
    EXPECT_GT(local.rowwise().norm().minCoeff(), head_radius - 0.01);
    for (Eigen::Index v = 0; v < local.rows(); ++v) {
      if (local(v, 1) < -head_radius) {
        EXPECT_GT(std::hypot(local(v, 0), local(v, 2)), neck_radius - 0.01);
      }
    }
  }
}

TEST(Hair, ShortHairStays) {
  Head head;
  std::fill(head.hair.freedom.begin(), head.hair.freedom.end(), 0.0);
  LayerPlayer player({head.body, head.hair}, {}, rate);
  EXPECT_TRUE(player.simulated().empty());
}

TEST(Hair, BlowsInTheWindAsItDoesInARun) {
  // Still air and a run along -X, or standing in a wind along +X: the same, once both are steady.
  const auto run = [](double t) { return test::turn_about(Vector3d::UnitY(), 0.0, {-2.0 * t, 0.0, 0.0}); };
  const std::vector<Points> running = play(run, 120), standing = play(still, 120, 2.0);
  const Points local = test::moved(running.back(), run(119.0 / rate).inverse());
  EXPECT_LT((local - standing.back()).rowwise().norm().maxCoeff(), 0.03);  // friction remembers the start
  EXPECT_GT((standing.back() - play(still, 120).back()).bottomRows(columns).col(0).mean(), 0.05);
}

TEST(Hair, SameBytesOnEveryRunAndNumberOfThreads) {
  const std::vector<Points> many = play(quarter_turn, 40);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Points> one = play(quarter_turn, 40);
  for (std::size_t f = 0; f < many.size(); ++f) EXPECT_EQ(many[f], one[f]);
}

}  // namespace
}  // namespace reprise::dynamics
