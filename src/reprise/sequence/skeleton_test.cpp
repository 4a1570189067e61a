// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/skeleton.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// A trunk with two arms, of uneven bones.
Skeleton branching() {
  return {{{"pelvis", -1, {0.1, 1.0, -0.2}},
           {"chest", 0, {0.1, 1.4, -0.1}},
           {"left_arm", 1, {0.3, 1.3, -0.1}},
           {"left_hand", 2, {0.7, 1.0, 0.1}},
           {"right_arm", 1, {-0.2, 1.3, -0.1}}}};
}

std::vector<Eigen::Quaterniond> random_rotations(std::mt19937& random, std::size_t count) {
  std::normal_distribution<double> normal;
  std::vector<Eigen::Quaterniond> rotations;
  for (std::size_t i = 0; i < count; ++i) {
    rotations.push_back(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized());
  }
  return rotations;
}

SkeletonPose random_pose(std::mt19937& random, const Skeleton& skeleton) {
  std::normal_distribution<double> normal;
  return pose_from_rotations(skeleton, random_rotations(random, skeleton.joints.size()),
                             {normal(random), normal(random), normal(random)});
}

double greatest_distance(const SkeletonPose& a, const SkeletonPose& b) {
  double greatest = 0.0;
  for (std::size_t j = 0; j < a.rotation.size(); ++j) {
    greatest = std::max(
        {greatest, (a.position[j] - b.position[j]).norm(), a.rotation[j].angularDistance(b.rotation[j])});
  }
  return greatest;
}

TEST(Skeleton, FindsJointsAndTheirChildren) {
  const Skeleton skeleton = branching();
  EXPECT_EQ(skeleton.size(), 5);
  EXPECT_EQ(skeleton.find("left_hand"), 3);
  EXPECT_EQ(skeleton.find("tail"), std::nullopt);
  EXPECT_EQ(skeleton.joint_idx("right_arm"), 4);
  EXPECT_THAT(skeleton.children(1), ElementsAre(2, 4));
  EXPECT_THAT(skeleton.children(3), IsEmpty());
  EXPECT_THAT(skeleton.children(-1), ElementsAre(0));
}

TEST(Skeleton, OffersTheNearestNameAndListsAll) {
  EXPECT_THAT(
      [] { branching().joint_idx("left_hnad"); },
      ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("no joint 'left_hnad' (did you mean 'left_hand'?)"),
                                           HasSubstr("pelvis, chest, left_arm, left_hand, right_arm"))));
  EXPECT_THAT([] { branching().joint_idx("propeller_blade"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no joint 'propeller_blade'; its joints are")));
}

TEST(Skeleton, ValidationNamesTheJoint) {
  EXPECT_NO_THROW(validate(branching()));
  EXPECT_NO_THROW(validate(Skeleton{}));
  Skeleton skeleton = branching();
  // No name.
  skeleton.joints[2].name.clear();
  EXPECT_THAT([&] { validate(skeleton); }, ThrowsMessage<InvalidArgument>("joint 2 has no name"));
  // A name twice.
  skeleton.joints[2].name = "chest";
  EXPECT_THAT([&] { validate(skeleton); }, ThrowsMessage<InvalidArgument>("two joints are called 'chest'"));
  // A parent after its child, the joint itself, below -1, far away.
  for (const int parent : {3, 2, -2, 1000}) {
    skeleton = branching();
    skeleton.joints[2].parent = parent;
    EXPECT_THAT([&] { validate(skeleton); },
                ThrowsMessage<InvalidArgument>(
                    AllOf(HasSubstr("'left_arm' (2)"), HasSubstr(std::to_string(parent)))));
  }
  // A place that is none.
  skeleton = branching();
  skeleton.joints[4].rest_position.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { validate(skeleton); }, ThrowsMessage<InvalidArgument>(HasSubstr("'right_arm'")));
}

TEST(SkeletonPose, RestPoseIsTheIdentity) {
  const Skeleton skeleton = branching();
  const SkeletonPose rest = rest_pose(skeleton);
  for (int j = 0; j < skeleton.size(); ++j) {
    EXPECT_TRUE(rest.world_from_rest(skeleton, j).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  }
  const std::vector<Eigen::Quaterniond> none(5, Eigen::Quaterniond::Identity());
  EXPECT_LT(greatest_distance(pose_from_rotations(skeleton, none, skeleton.joints[0].rest_position), rest),
            1e-12);
}

// The joint between two bones is a point of both, so both must carry it to one place.
TEST(SkeletonPose, BonesStayConnectedAndKeepTheirLengths) {
  std::mt19937 random(1);
  const Skeleton skeleton = branching();
  for (int trial = 0; trial < 50; ++trial) {
    const SkeletonPose pose = random_pose(random, skeleton);
    for (int j = 1; j < skeleton.size(); ++j) {
      const Joint& joint = skeleton.joints[static_cast<std::size_t>(j)];
      const Eigen::Vector3d own = pose.world_from_rest(skeleton, j) * joint.rest_position;
      const Eigen::Vector3d parents = pose.world_from_rest(skeleton, joint.parent) * joint.rest_position;
      EXPECT_LT((own - parents).norm(), 1e-12);
      EXPECT_LT((own - pose.position[static_cast<std::size_t>(j)]).norm(), 1e-12);
    }
  }
}

TEST(SkeletonPose, ASecondRootKeepsItsRestOffset) {
  Skeleton skeleton = branching();
  skeleton.joints.push_back({"prop", -1, {0.5, 0.0, 0.5}});
  std::mt19937 random(2);
  const SkeletonPose pose = pose_from_rotations(skeleton, random_rotations(random, 6), {1.0, 2.0, 3.0});
  EXPECT_LT((pose.position[5] - Eigen::Vector3d(1.4, 1.0, 3.7)).norm(), 1e-12);
}

TEST(SkeletonPose, InterpolationMeetsItsEndsAndIsSymmetric) {
  std::mt19937 random(3);
  const Skeleton skeleton = branching();
  for (int trial = 0; trial < 20; ++trial) {
    const SkeletonPose a = random_pose(random, skeleton);
    const SkeletonPose b = random_pose(random, skeleton);
    EXPECT_LT(greatest_distance(interpolate(skeleton, a, b, 0.0), a), 1e-12);
    EXPECT_LT(greatest_distance(interpolate(skeleton, a, b, 1.0), b), 1e-12);
    EXPECT_LT(greatest_distance(interpolate(skeleton, a, b, 1e-7), a), 1e-5);
    EXPECT_LT(greatest_distance(interpolate(skeleton, a, b, 0.3), interpolate(skeleton, b, a, 0.7)), 1e-6);
    EXPECT_LT(greatest_distance(interpolate(skeleton, a, a, 0.3), a), 1e-7);
    // Bones keep their lengths: forward kinematics of the rotations gives the same positions.
    const SkeletonPose half = interpolate(skeleton, a, b, 0.5);
    EXPECT_LT(greatest_distance(pose_from_rotations(skeleton, half.rotation, half.position[0]), half), 1e-7);
  }
}

// A bend of the elbow stays one while the whole body turns half round: rotations are relative to the parent.
TEST(SkeletonPose, InterpolationIsRelativeToTheParent) {
  const Skeleton skeleton = branching();
  const auto posed = [&](double yaw, double bend) {
    std::vector<Eigen::Quaterniond> rotations(
        5, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY())));
    rotations[3] = rotations[3] * Eigen::AngleAxisd(bend, Eigen::Vector3d::UnitX());
    return pose_from_rotations(skeleton, rotations, {yaw, 1.0, bend});
  };
  const double turn = 0.9 * std::numbers::pi;
  EXPECT_LT(greatest_distance(interpolate(skeleton, posed(0, 0.2), posed(turn, 1.0), 0.25),
                              posed(0.25 * turn, 0.4)),
            1e-7);
}

SkeletalMotion turning(std::size_t frame_count, double frames_per_second) {
  SkeletalMotion motion{"turning", branching(), frames_per_second, {}};
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double t = static_cast<double>(f) / frames_per_second;
    const std::vector<Eigen::Quaterniond> rotations(
        5, Eigen::Quaterniond(Eigen::AngleAxisd(2.0 * t, Eigen::Vector3d::UnitY())));
    motion.frames.push_back(pose_from_rotations(motion.skeleton, rotations, {t, 1.0, 0.0}));
  }
  return motion;
}

TEST(SkeletalMotion, ResamplingAUniformMotionIsExact) {
  const SkeletalMotion motion = turning(121, 120.0);
  EXPECT_NEAR(motion.duration(), 121.0 / 120.0, 1e-12);
  for (const double rate : {25.0, 30.0, 100.0, 120.0, 240.0, 7.3}) {
    const SkeletalMotion result = resample(motion, rate);
    const SkeletalMotion expected = turning(static_cast<std::size_t>(rate + 1e-9) + 1, rate);
    EXPECT_EQ(result.frames_per_second, rate);
    EXPECT_EQ(result.name, "turning");
    ASSERT_EQ(result.frames.size(), expected.frames.size());
    for (std::size_t f = 0; f < result.frames.size(); ++f) {
      EXPECT_LT(greatest_distance(result.frames[f], expected.frames[f]), 1e-7) << rate << " frame " << f;
    }
  }
}

TEST(SkeletalMotion, ResamplingCountsFramesAsDocumented) {
  // Five frames of 120 a second are 4.8 at 25: the last is in only when it falls on a frame.
  EXPECT_EQ(resample(turning(1, 120.0), 25.0).frames.size(), 1U);
  EXPECT_EQ(resample(turning(5, 120.0), 25.0).frames.size(), 1U);
  EXPECT_EQ(resample(turning(6, 120.0), 25.0).frames.size(), 2U);
  EXPECT_EQ(resample(turning(24, 120.0), 25.0).frames.size(), 5U);
  EXPECT_EQ(resample(turning(25, 120.0), 25.0).frames.size(), 6U);
  EXPECT_EQ(resample(turning(481, 120.0), 25.0).frames.size(), 101U);
}

TEST(SkeletalMotion, RefusesWhatCannotBeResampled) {
  const SkeletalMotion motion = turning(10, 120.0);
  for (const double rate :
       {0.0, -25.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT([&] { resample(motion, rate); },
                ThrowsMessage<InvalidArgument>(HasSubstr("expected a positive, finite rate")));
  }
  // More frames than memory.
  EXPECT_THAT([&] { resample(motion, 1e12); }, ThrowsMessage<InvalidArgument>(HasSubstr("expected at most")));
  // No frames.
  EXPECT_THAT([&] { resample(turning(0, 120.0), 25.0); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'turning' has no frames")));
  // Poses of another skeleton; a weight outside.
  const Skeleton skeleton = branching();
  EXPECT_THAT([&] { interpolate(skeleton, SkeletonPose{}, rest_pose(skeleton), 0.5); },
              ThrowsMessage<InvalidArgument>(HasSubstr("0 rotations and 0 positions; expected 5")));
  EXPECT_THAT([&] { interpolate(skeleton, rest_pose(skeleton), rest_pose(skeleton), 1.5); },
              ThrowsMessage<InvalidArgument>(HasSubstr("at 1.5")));
  EXPECT_THAT([&] { pose_from_rotations(skeleton, {}, Eigen::Vector3d::Zero()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("0 rotations for a skeleton of 5 joints")));
}

}  // namespace
}  // namespace reprise
