// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/pose_inference.h"

#include <gtest/gtest.h>

#include "reprise/skeleton/skeleton_test_support.h"

namespace reprise::skeleton {
namespace {

// The pose of which only some bones are shown.
SkeletonPose infer_from(const Skeleton& skeleton, const SkeletonPose& pose,
                        const std::vector<bool>& is_known) {
  std::vector<std::optional<KnownBone>> known(is_known.size());
  for (std::size_t j = 0; j < is_known.size(); ++j) {
    if (is_known[j]) known[j] = {.rotation = pose.rotation[j], .position = pose.position[j]};
  }
  return PoseInference(skeleton, is_known).infer(known);
}

double error(const SkeletonPose& a, const SkeletonPose& b, std::size_t joint) {
  return (a.position[joint] - b.position[joint]).norm();
}

TEST(PoseInference, LeavesAPoseAsItIsWhereAllIsKnownOrNothingBends) {
  const Skeleton skeleton = test::leg_skeleton();
  const SkeletonPose pose = test::leg_poses(8).back();
  const SkeletonPose same = infer_from(skeleton, pose, {true, true, true, true, true});
  // The whole leg at rest in a moved body: whatever is hidden is where it was.
  SkeletonPose stiff = pose_from_rotations(
      skeleton,
      std::vector(5, Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 1, 0).normalized()))),
      {1.0, 2.0, 3.0});
  for (std::size_t j = 0; j < 5; ++j) {
    EXPECT_EQ(same.position[j], pose.position[j]);
    EXPECT_EQ(same.rotation[j].coeffs(), pose.rotation[j].coeffs());
    for (const std::vector<bool>& known : {std::vector<bool>{true, false, false, true, true},
                                           {true, true, false, true, false},
                                           {false, false, true, false, false},
                                           {true, false, false, false, true},
                                           {false, true, false, true, false}}) {
      const SkeletonPose inferred = infer_from(skeleton, stiff, known);
      EXPECT_LT(error(inferred, stiff, j), 1e-9) << j;
      EXPECT_LT(inferred.rotation[j].angularDistance(stiff.rotation[j]), 1e-7) << j;
    }
  }
}

TEST(PoseInference, BendsAHiddenKneeForwardsAndKeepsItsLengths) {
  const Skeleton skeleton = test::leg_skeleton();
  for (const SkeletonPose& pose : test::leg_poses(60)) {
    const SkeletonPose inferred = infer_from(skeleton, pose, {true, false, false, true, true});
    EXPECT_LT(error(inferred, pose, 1), 1e-9);  // the hip is where the pelvis has it
    EXPECT_LT(error(inferred, pose, 2), 0.05);
    const SkeletonPose rest = rest_pose(skeleton);
    for (const std::size_t j : {1, 2}) {
      EXPECT_NEAR((inferred.position[j + 1] - inferred.position[j]).norm(),
                  (rest.position[j + 1] - rest.position[j]).norm(), 1e-9);
    }
    // Each bone's rotation takes its rest direction to where the next joint is.
    for (const std::size_t j : {1, 2}) {
      const Eigen::Vector3d carried =
          inferred.position[j] + inferred.rotation[j] * (rest.position[j + 1] - rest.position[j]);
      EXPECT_LT((carried - inferred.position[j + 1]).norm(), 1e-9);
    }
  }
}

TEST(PoseInference, AStraightLimbBendsToWhereTheFootPoints) {
  Skeleton skeleton = test::leg_skeleton();
  for (const int j : {1, 2, 3}) {
    skeleton.joints[static_cast<std::size_t>(j)].rest_position = {0.1, 0.92 - 0.42 * (j - 1), 0.0};
  }
  skeleton.joints[4].rest_position.x() = 0.1;
  SkeletonPose pose = rest_pose(skeleton);
  for (const int j : {0, 1, 2}) pose.position[static_cast<std::size_t>(j)].y() -= 0.1;  // a squat
  const SkeletonPose inferred = infer_from(skeleton, pose, {true, false, false, true, true});
  EXPECT_GT(inferred.position[2].z(), 0.1);
  EXPECT_NEAR(inferred.position[2].x(), 0.1, 1e-9);
}

TEST(PoseInference, ALimbOutOfReachIsStraightAndChangesSteadilyThere) {
  const Skeleton skeleton = test::leg_skeleton();
  SkeletonPose pose = rest_pose(skeleton);
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int step = 0; step < 200; ++step) {
    pose.position[3].y() = 0.08 - 0.001 * step;  // the foot is pulled down
    const SkeletonPose inferred = infer_from(skeleton, pose, {true, false, false, true, true});
    EXPECT_LT(error(inferred, pose, 3), 1e-12);
    // Close to its reach a knee moves with the square root of what is left.
    if (step > 0) {
      EXPECT_LT((inferred.position[2] - before).norm(), 0.03) << step;
    }
    before = inferred.position[2];
  }
  const Eigen::Vector3d line = (pose.position[3] - pose.position[1]).normalized();
  EXPECT_LT((before - pose.position[1]).cross(line).norm(), 1e-9);
}

TEST(PoseInference, ALongChainReachesItsEndWithItsLengths) {
  Skeleton skeleton;
  for (int j = 0; j < 6; ++j) {
    skeleton.joints.push_back(
        {.name = "bone" + std::to_string(j), .parent = j - 1, .rest_position = {0, 0.2 * j, 0}});
  }
  SkeletonPose pose = rest_pose(skeleton);
  pose.position[5] = {0.3, 0.7, 0.2};
  pose.rotation[5] = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX());
  const SkeletonPose inferred = infer_from(skeleton, pose, {true, false, false, false, false, true});
  for (std::size_t j = 1; j < 5; ++j) {
    EXPECT_NEAR((inferred.position[j + 1] - inferred.position[j]).norm(), 0.2, 1e-4) << j;
  }
  EXPECT_LT((inferred.position[1] - Eigen::Vector3d(0, 0.2, 0)).norm(), 1e-12);
}

TEST(PoseInference, CarriesWhatHangsOnAKnownBone) {
  const Skeleton skeleton = test::leg_skeleton();
  const SkeletonPose pose = test::leg_poses(9).back();
  // Nothing below the foot is known: the toes stay with it. Nothing above the shin is: the body stays with
  // it.
  const SkeletonPose inferred = infer_from(skeleton, pose, {false, false, true, true, false});
  for (const auto& [joint, by] : {std::pair<std::size_t, std::size_t>{4, 3}, {0, 2}}) {
    const Eigen::Vector3d carried =
        pose.position[by] +
        pose.rotation[by] * (skeleton.joints[joint].rest_position - skeleton.joints[by].rest_position);
    EXPECT_LT((inferred.position[joint] - carried).norm(), 1e-12);
    EXPECT_LT(inferred.rotation[joint].angularDistance(pose.rotation[by]), 1e-7);
  }
}

}  // namespace
}  // namespace reprise::skeleton
