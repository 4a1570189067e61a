// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skin_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/deform/skinning_test_support.h"

namespace reprise {
namespace {

using Eigen::Vector3d;
using test::MarkedSurface;

SkinWeights weights_of(const MarkedSurface& surface, const SkinWeightOptions& options = {}) {
  SkinWeights weights = skin_weights(surface.topology, surface.markup, options);
  EXPECT_NO_THROW(validate(weights, surface.topology->vertex_count, surface.markup.skeleton.size()));
  return weights;
}

int most_bones(const SkinWeights& weights) {
  int most = 0;
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    int count = 0;
    for (SkinWeights::InnerIterator it(weights, v); it; ++it) count += it.value() > 0.0 ? 1 : 0;
    most = std::max(most, count);
  }
  return most;
}

TEST(SkinWeights, ArePartitionsOfUnityWithFewBones) {
  const PerformanceDatabase& figure = test::figure_database();
  const MarkedSurface surface{figure.topology(), *figure.markup()};
  EXPECT_EQ(most_bones(weights_of(surface)), 4);
  EXPECT_EQ(most_bones(weights_of(surface, {.most_bones = 2})), 2);
  EXPECT_EQ(most_bones(weights_of(surface, {.most_bones = 1})), 1);
  EXPECT_GT(most_bones(weights_of(surface, {.most_bones = 0})), 6);
}

// On a long tube the heat depends on the height alone and d is the radius: -w'' + (w - p) c / d^2 = 0, so
// that the other bone's share is exp(-|y| sqrt(c) / d) / 2.
TEST(SkinWeights, FallOffAsHeatDoes) {
  const MarkedSurface tube = test::tube();
  for (const double heat : {1.0, 4.0}) {
    const SkinWeights weights = weights_of(tube, {.heat = heat});
    double largest = 0.0;
    for (Eigen::Index v = 0; v < weights.rows() - 2; ++v) {
      const double y = tube.markup.reference(v, 1);
      const double other = 0.5 * std::exp(-std::abs(y) * std::sqrt(heat) / test::tube_radius);
      largest = std::max(largest, std::abs(weights.coeff(v, y < 0.0 ? 1 : 0) - other));
    }
    EXPECT_LT(largest, 0.015) << heat;
  }
}

TEST(SkinWeights, FarFromAJointBelongToOneBone) {
  const MarkedSurface tube = test::tube();
  const SkinWeights weights = weights_of(tube);
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double y = tube.markup.reference(v, 1);
    if (std::abs(y) > 0.7) {
      EXPECT_GT(weights.coeff(v, y < 0.0 ? 0 : 1), 0.999) << y;
    }
  }
}

TEST(SkinWeights, AreMirroredOnAMirroredSurface) {
  constexpr int rings = 61;
  const MarkedSurface tube = test::tube(rings);
  const auto mirror = [&](int v) {
    if (v >= rings * test::tube_segments) return v ^ 1;  // the poles, whose first index is even
    return (rings - 1 - v / test::tube_segments) * test::tube_segments + v % test::tube_segments;
  };
  const SkinWeights weights = weights_of(tube);
  for (int v = 0; v < weights.rows(); ++v) {
    ASSERT_NEAR(tube.markup.reference(v, 1), -tube.markup.reference(mirror(v), 1), 1e-6);
    EXPECT_NEAR(weights.coeff(v, 0), weights.coeff(mirror(v), 1), 1e-5);
  }
}

TEST(SkinWeights, TrustLabelsMoreThanNearness) {
  MarkedSurface tube = test::tube();
  for (std::size_t v = 0; v < tube.markup.joint_of_vertex.size(); ++v) {
    tube.markup.joint_of_vertex[v] = tube.markup.reference(static_cast<Eigen::Index>(v), 1) < 0.0F ? 1 : 0;
  }
  const SkinWeights weights = weights_of(tube);
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double y = tube.markup.reference(v, 1);
    if (std::abs(y) < 0.3) continue;
    EXPECT_GT(weights.coeff(v, y < 0.0 ? 1 : 0), weights.coeff(v, y < 0.0 ? 0 : 1)) << y;
  }
}

// Two tubes side by side, the right one thin: many vertices of the left one are nearer to the right one's
// bone.
TEST(SkinWeights, DoNotHeatThroughTheSurface) {
  Topology topology;
  MarkedSurface surface;
  test::add_tube(topology, surface.markup.reference, 0.2, -1.0, 1.0, 31);
  const std::int32_t left_count = topology.vertex_count;
  test::add_tube(topology, surface.markup.reference, 0.02, -1.0, 1.0, 61, {0.25, 0.0, 0.0});
  surface.topology = std::make_shared<const Topology>(topology);
  surface.markup.joint_of_vertex.assign(static_cast<std::size_t>(topology.vertex_count), -1);
  surface.markup.skeleton.joints = {{.name = "left", .parent = -1, .rest_position = {0, -1, 0}},
                                    {.name = "left_end", .parent = 0, .rest_position = {0, 1, 0}},
                                    {.name = "right", .parent = -1, .rest_position = {0.25, -1, 0}},
                                    {.name = "right_end", .parent = 2, .rest_position = {0.25, 1, 0}}};
  const SkinWeights weights = weights_of(surface);
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double own = v < left_count ? weights.coeff(v, 0) + weights.coeff(v, 1)
                                      : weights.coeff(v, 2) + weights.coeff(v, 3);
    EXPECT_NEAR(own, 1.0, 1e-12) << v;
  }
}

TEST(SkinWeights, ReachPiecesThatSeeNoBoneAndVerticesOfNoTriangle) {
  MarkedSurface tube = test::tube();
  Topology topology = *tube.topology;
  const std::int32_t body_count = topology.vertex_count;
  test::add_tube(topology, tube.markup.reference, 0.05, 0.8, 1.0, 5, {0.5, 0.0, 0.0});
  topology.vertex_count += 1;
  tube.markup.reference.conservativeResize(topology.vertex_count, 3);
  tube.markup.reference.bottomRows<1>() << 3.0F, -0.5F, 0.0F;
  tube.topology = std::make_shared<const Topology>(topology);
  tube.markup.joint_of_vertex.resize(static_cast<std::size_t>(topology.vertex_count), -1);
  const SkinWeights weights = weights_of(tube);
  for (Eigen::Index v = body_count; v + 1 < weights.rows(); ++v) EXPECT_NEAR(weights.coeff(v, 1), 1.0, 1e-12);
  EXPECT_NEAR(weights.coeff(weights.rows() - 1, 0), 1.0, 1e-12);
}

TEST(SkinWeights, VaryAcrossFreeClothFromBoneToBone) {
  // The figure's tunic hangs free below the belt.
  const PerformanceDatabase& figure = test::figure_database();
  const Markup& markup = *figure.markup();
  const SkinWeights weights = weights_of({figure.topology(), markup});
  const int left = markup.skeleton.joint_idx("left_thigh"), right = markup.skeleton.joint_idx("right_thigh");
  int counted = 0;
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    if (markup.joint_of_vertex[static_cast<std::size_t>(v)] >= 0) continue;
    const double x = markup.reference(v, 0);
    if (std::abs(x) > 0.15) {
      EXPECT_GT(weights.coeff(v, x > 0.0 ? left : right), 0.5) << x;
      ++counted;
    } else if (std::abs(x) < 0.02) {
      EXPECT_NEAR(weights.coeff(v, left), weights.coeff(v, right), 0.3) << x;
      ++counted;
    }
  }
  EXPECT_GT(counted, 30);
}

TEST(SkinWeights, NeedNoLengthOfABone) {
  MarkedSurface tube = test::tube();
  auto& joints = tube.markup.skeleton.joints;
  // Three joints in one place, one of them without children or vertices.
  joints.push_back({.name = "twin", .parent = 1, .rest_position = {0, 0, 0}});
  joints.push_back({.name = "end", .parent = 2, .rest_position = {0, 1, 0}});
  weights_of(tube);
  joints.resize(1);
  const SkinWeights alone = weights_of(tube);
  EXPECT_EQ(alone.nonZeros(), alone.rows());
  EXPECT_NEAR(alone.sum(), static_cast<double>(alone.rows()), 1e-9);
}

TEST(SkinWeights, StayBetweenZeroAndOneOnSlivers) {
  MarkedSurface tube = test::tube();
  // Every fourth ring nearly onto its neighbour, every fifth vertex onto the next one.
  for (Eigen::Index v = test::tube_segments; v < tube.markup.reference.rows() - 2; ++v) {
    if (v / test::tube_segments % 4 == 0) {
      tube.markup.reference(v, 1) = tube.markup.reference(v - test::tube_segments, 1) + 1e-6F;
    }
    if (v % 5 == 0) tube.markup.reference.row(v) = tube.markup.reference.row(v - 1);
  }
  for (const int count : {0, 4}) {
    const SkinWeights weights = weights_of(tube, {.most_bones = count});
    EXPECT_GE(weights.coeffs().minCoeff(), 0.0);
    EXPECT_LE(weights.coeffs().maxCoeff(), 1.0 + 1e-12);
  }
}

TEST(SkinWeights, AreTheSameOnAnyNumberOfThreads) {
  const PerformanceDatabase& figure = test::figure_database();
  const SkinWeights many = skin_weights(figure.topology(), *figure.markup());
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const SkinWeights one = skin_weights(figure.topology(), *figure.markup());
  ASSERT_EQ(many.nonZeros(), one.nonZeros());
  EXPECT_TRUE(std::equal(many.valuePtr(), many.valuePtr() + many.nonZeros(), one.valuePtr()));
  EXPECT_TRUE(std::equal(many.innerIndexPtr(), many.innerIndexPtr() + many.nonZeros(), one.innerIndexPtr()));
}

TEST(SkinWeights, RefuseWhatDoesNotFit) {
  const MarkedSurface tube = test::tube(11);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(skin_weights(nullptr, tube.markup), InvalidArgument);
  EXPECT_THROW(skin_weights(tube.topology, tube.markup, {.heat = 0.0}), InvalidArgument);
  EXPECT_THROW(skin_weights(tube.topology, tube.markup, {.heat = nan}), InvalidArgument);
  EXPECT_THROW(skin_weights(tube.topology, tube.markup, {.most_bones = -1}), InvalidArgument);

  Markup markup = tube.markup;
  markup.skeleton.joints.clear();
  EXPECT_THROW(skin_weights(tube.topology, markup), InvalidArgument);

  markup = tube.markup;
  markup.joint_of_vertex.front() = 2;
  EXPECT_THROW(skin_weights(tube.topology, markup), InvalidArgument);

  markup = tube.markup;
  markup.reference.conservativeResize(5, 3);
  EXPECT_THROW(skin_weights(tube.topology, markup), InvalidArgument);
}

TEST(SkinWeights, AreValidatedByShapeSignAndSum) {
  using testing::HasSubstr;
  const auto refusal = [](const SkinWeights& weights) -> std::string {
    try {
      validate(weights, 2, 2);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  SkinWeights weights(2, 2);
  weights.insert(0, 0) = 1.0;
  EXPECT_THAT(refusal(weights), HasSubstr("vertex 1 sum to 0"));
  weights.insert(1, 0) = 1.5;
  weights.insert(1, 1) = -0.5;
  EXPECT_THAT(refusal(weights), HasSubstr("vertex 1 for joint 1 is -0.5"));
  weights.coeffRef(1, 0) = 0.25;
  weights.coeffRef(1, 1) = 0.75;
  EXPECT_EQ(refusal(weights), "");
  EXPECT_THAT(refusal(SkinWeights(3, 2)), HasSubstr("3 x 2; expected 2 vertices x 2 joints"));
}

}  // namespace
}  // namespace reprise
