// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/velocity_error.h"

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/mocap/mocap_test_support.h"

namespace reprise {
namespace {

// The figure's walk as its own target: all joints, in another place, twice as large.
RetargetedMotion target_of(const SkeletalMotion& motion, const GroundTransform& world_from_source,
                           double scale) {
  RetargetedMotion target{.motion = motion, .scale = scale, .world_from_source = world_from_source};
  const GroundTransform source_from_world = world_from_source.inverse();
  for (int j = 0; j < motion.skeleton.size(); ++j) target.source_joints.push_back(j);
  for (const SkeletonPose& pose : motion.frames) {
    Eigen::MatrixX3d& joints = target.source_positions.emplace_back(motion.skeleton.size(), 3);
    for (int j = 0; j < motion.skeleton.size(); ++j) {
      joints.row(j) = (source_from_world * pose.position[static_cast<std::size_t>(j)]).transpose() / scale;
    }
  }
  return target;
}

const SkeletalMotion& walk() {
  return test::figure_motions()[test::figure_performer().clip_idx("walk")];
}

TEST(VelocityError, OfTheTargetItselfIsNone) {
  const RetargetedMotion target = target_of(walk(), {.yaw = 1.0, .translation = {2.0, 3.0}}, 0.5);
  const VelocityError error = velocity_error(walk().frames, target, VelocityScale::legs);
  EXPECT_LT(error.mean, 1e-12);
  EXPECT_LT(error.deviation, 1e-12);
}

TEST(VelocityError, WithoutScaleCountsTheDifferenceOfSize) {
  const RetargetedMotion target = target_of(walk(), {}, 0.5);
  // The source is twice as large, so the result lacks its own velocity once more.
  const VelocityError error = velocity_error(walk().frames, target, VelocityScale::none);
  double speed = 0.0;
  for (std::size_t f = 1; f < walk().frames.size(); ++f) {
    for (std::size_t j = 0; j < walk().frames[f].position.size(); ++j) {
      speed += (walk().frames[f].position[j] - walk().frames[f - 1].position[j]).norm();
    }
  }
  speed /= static_cast<double>((walk().frames.size() - 1) * walk().frames.front().position.size());
  EXPECT_NEAR(error.mean, speed, 1e-12);
}

TEST(VelocityError, ForgivesAnotherHeadingAndPlace) {
  const RetargetedMotion target = target_of(walk(), {}, 1.0);
  std::vector<SkeletonPose> elsewhere;
  for (const SkeletonPose& pose : walk().frames) {
    elsewhere.push_back(moved({.ground = {.yaw = -2.5, .translation = {1.0, 5.0}}}, pose));
  }
  EXPECT_LT(velocity_error(elsewhere, target, VelocityScale::legs).mean, 1e-9);
}

TEST(VelocityError, IsWhatOneJointDiffersBy) {
  RetargetedMotion target = target_of(walk(), {}, 1.0);
  // Only the first joint is compared, and its source moves 3 cm a frame faster along X.
  target.source_joints = {0};
  for (std::size_t f = 0; f < target.source_positions.size(); ++f) {
    target.source_positions[f] = target.source_positions[f].topRows(1).eval();
    target.source_positions[f](0, 0) += 0.03 * static_cast<double>(f);
  }
  const VelocityError error = velocity_error(walk().frames, target, VelocityScale::legs);
  EXPECT_NEAR(error.mean, 0.03, 1e-9);
  EXPECT_NEAR(error.deviation, 0.0, 1e-9);
  ASSERT_EQ(error.per_joint.size(), 1U);
  EXPECT_NEAR(error.per_joint[0], 0.03, 1e-9);
}

TEST(VelocityError, RefusesMotionsThatDoNotFit) {
  const RetargetedMotion target = target_of(walk(), {}, 1.0);
  std::vector<SkeletonPose> shorter(walk().frames.begin(), walk().frames.end() - 1);
  EXPECT_THROW(static_cast<void>(velocity_error(shorter, target, VelocityScale::legs)), InvalidArgument);
  std::vector<SkeletonPose> fewer = walk().frames;
  fewer[3].position.pop_back();
  EXPECT_THROW(static_cast<void>(velocity_error(fewer, target, VelocityScale::legs)), InvalidArgument);
}

}  // namespace
}  // namespace reprise
