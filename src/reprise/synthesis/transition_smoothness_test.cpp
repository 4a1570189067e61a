// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/transition_smoothness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/mesh/closest_point.h"
#include "support/shapes.h"

namespace reprise {
namespace {

constexpr double float_noise = 2e-6;  // metres: positions are floats of some metres

MeshSequence still(const std::string& name, const test::Shape& shape, std::size_t frame_count) {
  MeshSequence clip(name, shape.topology, frame_count, 25.0);
  for (std::size_t f = 0; f < frame_count; ++f) clip.frame(f) = shape.positions;
  return clip;
}

// Frames of the shape with every vertex shaken by up to `amount` metres.
MeshSequence shaken(const std::string& name, const test::Shape& shape, std::size_t frame_count, float amount,
                    unsigned seed) {
  MeshSequence clip = still(name, shape, frame_count);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> noise(-amount, amount);
  for (std::size_t f = 0; f < frame_count; ++f) {
    for (Eigen::Index v = 0; v < clip.frame(f).rows(); ++v) {
      for (int axis = 0; axis < 3; ++axis) clip.frame(f)(v, axis) += noise(random);
    }
  }
  return clip;
}

// Every vertex with every triangle, both ways.
double brute_force(const PositionsView& source, const PositionsView& target,
                   const GroundTransform& source_from_target, const Topology& topology) {
  std::vector<Eigen::Vector3d> a, b;
  for (Eigen::Index v = 0; v < source.rows(); ++v) {
    a.emplace_back(source.row(v).transpose().cast<double>());
    b.emplace_back(source_from_target * Eigen::Vector3d(target.row(v).transpose().cast<double>()));
  }
  const auto one_way = [&](const std::vector<Eigen::Vector3d>& points,
                           const std::vector<Eigen::Vector3d>& surface) {
    double largest = 0.0;
    for (const Eigen::Vector3d& point : points) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [i, j, k] : topology.triangles) {
        const Eigen::Vector3d& p = surface[static_cast<std::size_t>(i)];
        const Eigen::Vector3d& q = surface[static_cast<std::size_t>(j)];
        const Eigen::Vector3d& r = surface[static_cast<std::size_t>(k)];
        const Eigen::Vector3d w = closest_weights(point, p, q, r);
        nearest = std::min(nearest, (w[0] * p + w[1] * q + w[2] * r - point).norm());
      }
      largest = std::max(largest, nearest);
    }
    return largest;
  };
  return std::max(one_way(a, b), one_way(b, a));
}

Transition transition(std::size_t source, std::size_t target, int m, int n, int half_window,
                      const GroundTransform& source_from_target = {}) {
  return {.source_clip = source,
          .target_clip = target,
          .m = m,
          .n = n,
          .half_window = half_window,
          .source_from_target = source_from_target};
}

TEST(TransitionSmoothness, IsZeroForIdenticalFramesWhereverTheyStand) {
  const MeshSequence walk = test::walk("walk", 20);
  const GroundTransform moved_from_walk{.yaw = 1.1, .translation = {2.0, -3.0}};
  const PerformanceDatabase database = test::database_of(
      {walk, test::moved(walk, GroundTransform{}, "copy"), test::moved(walk, moved_from_walk, "moved")});
  const TransitionSmoothness same = transition_smoothness(database, transition(0, 1, 9, 9, 5));
  EXPECT_EQ(same.weighted, 0.0);
  EXPECT_EQ(same.normalized, 0.0);
  const TransitionSmoothness moved =
      transition_smoothness(database, transition(0, 2, 9, 9, 5, moved_from_walk.inverse()));
  EXPECT_LT(moved.normalized, float_noise);
}

TEST(TransitionSmoothness, OfATranslatedCopyIsTheTranslation) {
  // Up: every point of a sheet is as far from the other one. Along itself: its border is, its middle is not.
  for (const Eigen::RowVector3f& shift :
       {Eigen::RowVector3f(0.0F, 0.25F, 0.0F), Eigen::RowVector3f(0.25F, 0.0F, 0.0F)}) {
    const test::Shape sheet = test::sheet(6);
    test::Shape copy = sheet;
    copy.positions.rowwise() += shift;
    const PerformanceDatabase database = test::database_of({still("a", sheet, 30), still("b", copy, 30)});
    for (const int half_window : {1, 2, 7, 12}) {
      const TransitionSmoothness found =
          transition_smoothness(database, transition(0, 1, 14, 15, half_window));
      EXPECT_NEAR(found.normalized, 0.25, float_noise);
      EXPECT_NEAR(found.weighted, 0.25 * (half_window / 2.0) / (2.0 * half_window + 1.0), float_noise)
          << "alpha' sums to L / 2";
    }
  }
}

TEST(TransitionSmoothness, WeighsFramesByTheirDistanceFromTheCentre) {
  constexpr int half_window = 4;
  const test::Shape sheet = test::sheet(2);
  for (int k = -half_window - 1; k <= half_window + 1; ++k) {
    MeshSequence lifted = still("b", sheet, 12);
    lifted.frame(static_cast<std::size_t>(5 + k)).col(1).array() += 1.0F;
    const PerformanceDatabase database = test::database_of({still("a", sheet, 12), lifted});
    const double weight = std::max(0.0, 0.5 - std::abs(k) / (2.0 * half_window));
    const TransitionSmoothness found = transition_smoothness(database, transition(0, 1, 6, 5, half_window));
    EXPECT_NEAR(found.weighted, weight / (2.0 * half_window + 1.0), float_noise) << k;
    EXPECT_NEAR(found.normalized, weight / (half_window / 2.0), float_noise) << k;
  }
}

TEST(TransitionSmoothness, IsSymmetric) {
  const test::Shape body = test::body();
  const GroundTransform source_from_target{.yaw = 0.4, .translation = {0.2, 0.1}};
  const PerformanceDatabase database =
      test::database_of({shaken("a", body, 9, 0.05F, 1), shaken("b", body, 9, 0.1F, 2)});
  const TransitionSmoothness there =
      transition_smoothness(database, transition(0, 1, 4, 3, 3, source_from_target));
  const TransitionSmoothness back =
      transition_smoothness(database, transition(1, 0, 3, 4, 3, source_from_target.inverse()));
  EXPECT_GT(there.normalized, 0.05);
  EXPECT_NEAR(there.weighted, back.weighted, float_noise);
  EXPECT_NEAR(there.normalized, back.normalized, float_noise);
}

TEST(TransitionSmoothness, DoesNotChangeWhenBothClipsAreMoved) {
  const test::Shape body = test::body();
  const MeshSequence a = shaken("a", body, 9, 0.05F, 3);
  const MeshSequence b = shaken("b", body, 9, 0.05F, 4);
  const GroundTransform a_from_b{.yaw = -0.3, .translation = {0.1, 0.0}};
  const GroundTransform moved_from_a{.yaw = 2.0, .translation = {1.0, -2.0}};
  const GroundTransform moved_from_b{.yaw = -1.2, .translation = {0.5, 1.5}};
  const PerformanceDatabase database = test::database_of(
      {a, b, test::moved(a, moved_from_a, "moved a"), test::moved(b, moved_from_b, "moved b")});
  const TransitionSmoothness before = transition_smoothness(database, transition(0, 1, 4, 4, 4, a_from_b));
  const TransitionSmoothness after = transition_smoothness(
      database, transition(2, 3, 4, 4, 4, moved_from_a * a_from_b * moved_from_b.inverse()));
  EXPECT_NEAR(before.weighted, after.weighted, float_noise);
  EXPECT_NEAR(before.normalized, after.normalized, float_noise);
}

TEST(HausdorffDistance, EqualsBruteForce) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const test::Shape shape = seed % 2 == 0 ? test::sphere(1) : test::sheet(5);
    // From frames that hardly differ, where most vertices are skipped, to frames that have nothing in common.
    const float amount = std::ldexp(1.0F, -static_cast<int>(seed) / 2);
    const MeshSequence clip = shaken("clip", shape, 2, amount, seed);
    const GroundTransform source_from_target{.yaw = 0.1 * seed, .translation = {0.05 * seed, -0.02 * seed}};
    const double expected = brute_force(clip.frame(0), clip.frame(1), source_from_target, *shape.topology);
    EXPECT_GT(expected, 0.0);
    EXPECT_NEAR(hausdorff_distance(clip.frame(0), clip.frame(1), source_from_target, *shape.topology),
                expected, 1e-12)
        << seed;
  }
}

TEST(HausdorffDistance, IgnoresVerticesThatAreNotOnTheSurface) {
  const test::Shape sheet = test::sheet(2);
  Topology topology = *sheet.topology;
  ++topology.vertex_count;
  Positions positions(sheet.positions.rows() + 1, 3);
  positions << sheet.positions, Eigen::RowVector3f(0.0F, 9.0F, 0.0F);
  Positions lower = positions;
  lower.col(1).array() -= 0.5F;
  const auto view = [](const Positions& p) { return PositionsView(p.data(), p.rows(), 3); };
  EXPECT_EQ(hausdorff_distance(view(positions), view(positions), {}, topology), 0.0);
  EXPECT_EQ(hausdorff_distance(view(positions), view(lower), {}, topology), 0.5);
}

TEST(TransitionSmoothness, RefusesWhatIsNoTransition) {
  const PerformanceDatabase database = test::database_of({test::walk("a", 10), test::walk("b", 8)});
  EXPECT_THROW(transition_smoothness(database, transition(0, 2, 5, 4, 2)), InvalidArgument) << "no such clip";
  EXPECT_THROW(transition_smoothness(database, transition(0, 1, 5, 4, 0)), InvalidArgument) << "no window";
  EXPECT_THROW(transition_smoothness(database, transition(0, 1, 1, 4, 2)), InvalidArgument) << "before a";
  EXPECT_THROW(transition_smoothness(database, transition(0, 1, 5, 6, 2)), InvalidArgument) << "after b";
  EXPECT_NO_THROW(transition_smoothness(database, transition(0, 1, 7, 5, 2)));
  const MeshSequence& a = database.clip(0);
  EXPECT_THROW(hausdorff_distance(a.frame(0), a.frame(1), {}, Topology{.vertex_count = 8}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
