// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skinning.h"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/deform/skinning_test_support.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::skinned;

constexpr auto skinnings = {Skinning::linear, Skinning::dual_quaternion};
constexpr double rounding = 1e-6;  // of float positions at about a metre

class Skins : public testing::Test {
 protected:
  double number() { return std::normal_distribution<double>()(random_); }
  Quaterniond rotation() { return Quaterniond(number(), number(), number(), number()).normalized(); }
  SkeletonPose pose() {
    return pose_from_rotations(skeleton_, {rotation(), rotation()}, {number(), number(), number()});
  }

  const test::MarkedSurface tube_ = test::tube(31);
  const Skeleton& skeleton_ = tube_.markup.skeleton;
  const Positions& reference_ = tube_.markup.reference;
  const SkinWeights weights_ = skin_weights(tube_.topology, tube_.markup);
  // Every vertex on one bone.
  const SkinWeights rigid_ = skin_weights(tube_.topology, tube_.markup, {.most_bones = 1});

 private:
  std::mt19937_64 random_{11};
};

TEST_F(Skins, StayWhereTheyAreInTheSamePose) {
  const SkeletonPose bent = pose();
  for (const Skinning skinning : skinnings) {
    EXPECT_LT(
        test::largest_distance(skinned(weights_, skeleton_, reference_, bent, bent, skinning), reference_),
        rounding);
  }
}

TEST_F(Skins, FollowTheTransformsOfTheirBones) {
  const SkeletonPose from = pose(), to = pose();
  for (const Skinning skinning : skinnings) {
    const Positions result = skinned(rigid_, skeleton_, reference_, from, to, skinning);
    for (Eigen::Index v = 0; v < result.rows(); ++v) {
      const int bone = rigid_.coeff(v, 0) > 0.5 ? 0 : 1;
      const Vector3d expected =
          to.world_from_rest(skeleton_, bone) * (from.world_from_rest(skeleton_, bone).inverse() *
                                                 Vector3d(reference_.row(v).cast<double>().transpose()));
      EXPECT_NEAR((result.row(v).cast<double>().transpose() - expected).norm(), 0.0, rounding);
    }
  }
}

TEST_F(Skins, GoOnFromAnyFrame) {
  const SkeletonPose rest = rest_pose(skeleton_), first = pose(), second = pose();
  for (const Skinning skinning : skinnings) {
    const Positions half_way = skinned(rigid_, skeleton_, reference_, rest, first, skinning);
    const Positions there = skinned(rigid_, skeleton_, half_way, first, second, skinning);
    EXPECT_LT(test::largest_distance(there, skinned(rigid_, skeleton_, reference_, rest, second, skinning)),
              4.0 * rounding);
  }
}

TEST_F(Skins, MoveRigidlyWithThePose) {
  const SkeletonPose from = pose(), to = pose();
  const Quaterniond Q = rotation();
  const Vector3d t(1.0, -2.0, 0.5);
  for (const Skinning skinning : skinnings) {
    const Positions result = skinned(weights_, skeleton_, reference_, from, to, skinning);
    EXPECT_LT(test::largest_distance(
                  skinned(weights_, skeleton_, reference_, from, test::moved(to, Q, t), skinning),
                  test::moved(result, Q, t)),
              4.0 * rounding);
    // Source frame and pose moved together: the same result.
    EXPECT_LT(test::largest_distance(skinned(weights_, skeleton_, test::moved(reference_, Q, t),
                                             test::moved(from, Q, t), to, skinning),
                                     result),
              4.0 * rounding);
  }
}

TEST_F(Skins, AgreeWhereThereIsOneBone) {
  const SkeletonPose from = pose(), to = pose();
  EXPECT_LT(
      test::largest_distance(skinned(rigid_, skeleton_, reference_, from, to, Skinning::linear),
                             skinned(rigid_, skeleton_, reference_, from, to, Skinning::dual_quaternion)),
      rounding);
}

TEST_F(Skins, DoNotDependOnTheSignsOfQuaternions) {
  const SkeletonPose from = pose();
  SkeletonPose to = pose();
  for (const Skinning skinning : skinnings) {
    const Positions result = skinned(weights_, skeleton_, reference_, from, to, skinning);
    to.rotation[1].coeffs() *= -1.0;
    EXPECT_LT(test::largest_distance(skinned(weights_, skeleton_, reference_, from, to, skinning), result),
              rounding);
  }
}

// The candy wrapper: with shares w and 1 - w of a twist by a, linear blending shrinks the radius to
// |w + (1 - w) exp(i a)|, in the middle cos(a / 2) and nothing at half a turn; dual quaternions keep it.
TEST_F(Skins, TwistWithoutCollapseByDualQuaternionsOnly) {
  const SkeletonPose rest = rest_pose(skeleton_);
  for (const double angle : {0.5, 1.5, 3.0}) {
    SkeletonPose twisted = rest;
    twisted.rotation[1] = Quaterniond(AngleAxisd(angle, Vector3d::UnitY()));
    const Positions linear = skinned(weights_, skeleton_, reference_, rest, twisted, Skinning::linear);
    const Positions dual = skinned(weights_, skeleton_, reference_, rest, twisted, Skinning::dual_quaternion);
    const auto radius = [](const Positions& positions, Eigen::Index v) {
      return std::hypot(positions(v, 0), positions(v, 2));
    };
    double narrowest = 1.0;
    for (Eigen::Index v = 0; v < reference_.rows() - 2; ++v) {
      const double w = weights_.coeff(v, 0);
      const double shrunk = std::abs(w + (1.0 - w) * std::polar(1.0, angle)) * radius(reference_, v);
      EXPECT_NEAR(radius(linear, v), shrunk, rounding);
      EXPECT_NEAR(radius(dual, v), radius(reference_, v), rounding);
      EXPECT_NEAR(dual(v, 1), reference_(v, 1), rounding);
      narrowest = std::min(narrowest, radius(linear, v) / test::tube_radius);
    }
    EXPECT_NEAR(narrowest, std::cos(0.5 * angle), 1e-3);
  }
}

TEST_F(Skins, MayBeWrittenOverTheirSource) {
  const SkeletonPose from = pose(), to = pose();
  for (const Skinning skinning : skinnings) {
    Positions positions = reference_;
    PositionsRef here(positions.data(), positions.rows(), 3);
    skin(weights_, skeleton_, test::view(positions), from, to, skinning, here);
    EXPECT_EQ(positions, skinned(weights_, skeleton_, reference_, from, to, skinning));
  }
}

TEST_F(Skins, RefuseWhatDoesNotFit) {
  const SkeletonPose rest = rest_pose(skeleton_);
  Positions result(reference_.rows(), 3);
  const auto refusal = [&](const SkinWeights& weights, const SkeletonPose& from, const SkeletonPose& to,
                           Eigen::Index rows) -> std::string {
    try {
      skin(weights, skeleton_, test::view(reference_), from, to, Skinning::linear,
           PositionsRef(result.data(), rows, 3));
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_EQ(refusal(weights_, rest, rest, result.rows()), "");
  EXPECT_THAT(refusal(weights_, rest, rest, 5), HasSubstr("the result has 5 vertices"));
  EXPECT_THAT(refusal(SkinWeights(7, 2), rest, rest, result.rows()), HasSubstr("7 x 2"));

  SkeletonPose pose = rest;
  pose.position.pop_back();
  EXPECT_THAT(refusal(weights_, pose, rest, result.rows()),
              HasSubstr("the source pose has 2 rotations and 1"));
  pose = rest;
  pose.rotation[1].coeffs() *= 2.0;
  EXPECT_THAT(refusal(weights_, rest, pose, result.rows()), HasSubstr("joint 'upper' of the target pose"));
  pose = rest;
  pose.position[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(weights_, rest, pose, result.rows()), HasSubstr("joint 'lower'"));
}

// The figure's surface is skinned by weights of its own, which the markup does not tell: ours come near.
TEST(SkinsOfTheFigure, ComeNearItsTruth) {
  const PerformanceDatabase& figure = test::figure_database();
  const Markup& markup = *figure.markup();
  const SkinWeights weights = skin_weights(figure.topology(), markup);
  const std::size_t clip_idx = figure.clip_idx("jog");
  for (const Skinning skinning : skinnings) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t f = 0; f < figure.clip(clip_idx).frame_count(); f += 5) {
      const Positions result = skinned(weights, markup.skeleton, markup.reference, rest_pose(markup.skeleton),
                                       figure.truth(clip_idx)->poses[f], skinning);
      for (Eigen::Index v = 0; v < result.rows(); ++v) {
        if (markup.joint_of_vertex[static_cast<std::size_t>(v)] < 0) continue;
        sum += (result.row(v) - figure.clip(clip_idx).frame(f).row(v)).norm();
        ++count;
      }
    }
    EXPECT_LT(sum / count, 0.008);
  }
}

}  // namespace
}  // namespace reprise
