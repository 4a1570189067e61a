// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/skeleton_metric.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/similarity/vertex_metric.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int joint_count = 7;

// Poses of unrelated random joints: the metric asks nothing of bones.
SkeletalMotion random_motion(std::size_t frame_count, unsigned seed) {
  SkeletalMotion motion{.name = "motion"};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  for (int j = 0; j < joint_count; ++j) {
    motion.skeleton.joints.push_back(
        {.name = "joint" + std::to_string(j), .rest_position = Eigen::Vector3d::Zero()});
  }
  for (std::size_t f = 0; f < frame_count; ++f) {
    SkeletonPose pose = rest_pose(motion.skeleton);
    for (Eigen::Vector3d& p : pose.position) p = {coordinate(random), coordinate(random), coordinate(random)};
    motion.frames.push_back(std::move(pose));
  }
  return motion;
}

SkeletalMotion moved(SkeletalMotion motion, const GroundTransform& transform) {
  for (SkeletonPose& pose : motion.frames) {
    for (Eigen::Vector3d& p : pose.position) p = transform * p;
  }
  return motion;
}

class SkeletonDissimilarity : public ::testing::Test {
 protected:
  SkeletonDissimilarity() {
    database_.add(test::walk("a", 5));
    database_.add(test::walk("b", 4));
  }

  PerformanceDatabase database_;
  std::vector<SkeletalMotion> motions_ = {random_motion(5, 1), random_motion(4, 2)};
};

TEST_F(SkeletonDissimilarity, IsTheAlignedDistanceOfTheJoints) {
  const DissimilarityMatrix matrix = skeleton_dissimilarity(database_, motions_);
  EXPECT_EQ(matrix.metric(), "skeleton");
  EXPECT_EQ(matrix.frame_count(), 9U);
  EXPECT_EQ(matrix.exact_count(), matrix.pair_count());
  for (std::size_t m = 0; m < 5; ++m) {
    for (std::size_t n = 0; n < 4; ++n) {
      Positions a(joint_count, 3), b(joint_count, 3);
      for (std::size_t j = 0; j < joint_count; ++j) {
        a.row(static_cast<Eigen::Index>(j)) = motions_[0].frames[m].position[j].transpose().cast<float>();
        b.row(static_cast<Eigen::Index>(j)) = motions_[1].frames[n].position[j].transpose().cast<float>();
      }
      const GroundAlignment direct = align_on_ground({a.data(), joint_count, 3}, {b.data(), joint_count, 3});
      EXPECT_NEAR(matrix.value(m, 5 + n), direct.rms_distance, 1e-6);
      EXPECT_NEAR(wrap_angle(matrix.yaw(m, 5 + n) - direct.a_from_b.yaw), 0.0, 1e-5);
    }
  }
}

TEST_F(SkeletonDissimilarity, CountsJointsEqually) {
  // The same pose with one joint lifted: no yaw or shift makes up for a height.
  SkeletonPose lifted = motions_[0].frames[0];
  lifted.position[3].y() += 0.25;
  motions_[1].frames[0] = lifted;
  EXPECT_NEAR(skeleton_dissimilarity(database_, motions_).value(0, 5), 0.25 / std::sqrt(joint_count), 1e-6);
}

TEST_F(SkeletonDissimilarity, DoesNotChangeWhenAClipMovesOnTheGround) {
  const GroundTransform motion{.yaw = 2.1, .translation = {3.0, -4.0}};
  const DissimilarityMatrix before = skeleton_dissimilarity(database_, motions_);
  motions_[1] = moved(motions_[1], motion);
  const DissimilarityMatrix after = skeleton_dissimilarity(database_, motions_);
  for (std::size_t a = 0; a < 5; ++a) {
    for (std::size_t b = 5; b < 9; ++b) {
      EXPECT_NEAR(before.value(a, b), after.value(a, b), 2e-6);
      EXPECT_NEAR(wrap_angle(before.yaw(a, b) - (after.yaw(a, b) + motion.yaw)), 0.0, 1e-5);
    }
  }
}

TEST_F(SkeletonDissimilarity, RefusesMotionsOfOtherClips) {
  const auto compare = [&] { skeleton_dissimilarity(database_, motions_); };
  motions_[1].frames.pop_back();
  EXPECT_THAT(compare, ThrowsMessage<InvalidArgument>(HasSubstr("clip 'b' has 3 poses, the clip 4 frames")));
  motions_.pop_back();
  EXPECT_THAT(compare, ThrowsMessage<InvalidArgument>(HasSubstr("1 skeletal motions")));
  motions_.push_back(random_motion(4, 2));
  motions_[1].frames[2].position.pop_back();
  EXPECT_THAT(compare, ThrowsMessage<InvalidArgument>(HasSubstr("b:2 has 6 joints, expected 7")));
}

}  // namespace
}  // namespace reprise
