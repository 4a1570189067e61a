// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/retarget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/bvh.h"
#include "reprise/retarget/foot_shape.h"
#include "reprise/retarget/retarget_test_support.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::bowing;
using test::joint;
using test::side_name;
using test::standing_woman;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Where the source's joints are in the result's world.
Vector3d in_world(const RetargetedMotion& result, std::size_t frame, std::size_t i, bool scaled = true) {
  const Vector3d position = result.source_positions[frame].row(static_cast<Eigen::Index>(i)).transpose();
  return result.world_from_source * Vector3d((scaled ? result.scale : 1.0) * position);
}

TEST(RetargetMotion, OntoTheSameSkeletonNothingChanges) {
  const Skeleton woman = standing_woman();
  const SkeletalMotion motion = bowing(woman, 60, 25.0);
  const StandingFigure figure(woman, {});
  const RetargetedMotion result = retarget_motion(motion, figure, {.plant_feet = false});
  EXPECT_EQ(result.motion.name, "bowing");
  EXPECT_EQ(result.motion.skeleton.joints[5].name, woman.joints[5].name);
  ASSERT_EQ(result.motion.frames.size(), 60U);
  ASSERT_EQ(result.contacts.size(), 60U);
  ASSERT_EQ(result.source_positions.size(), 60U);
  EXPECT_NEAR(result.scale, 1.0, 1e-12);
  EXPECT_EQ(result.left_out, 0U);
  ASSERT_EQ(result.source_joints.size(), woman.joints.size());
  const Vector3d start(motion.frames[0].position[0].x(), 0.0, motion.frames[0].position[0].z());
  for (std::size_t f = 0; f < 60; ++f) {
    EXPECT_THAT(result.contacts[f], ElementsAre(true, true)) << f;
    for (std::size_t j = 0; j < woman.joints.size(); ++j) {
      EXPECT_LT(result.motion.frames[f].rotation[j].angularDistance(motion.frames[f].rotation[j]), 1e-6);
      EXPECT_LT((result.motion.frames[f].position[j] + start - motion.frames[f].position[j]).norm(), 1e-6);
      EXPECT_EQ(result.source_joints[j], static_cast<int>(j));
      EXPECT_LT((in_world(result, f, j) - result.motion.frames[f].position[j]).norm(), 1e-6);
    }
  }
}

// Where a motion was captured, on what scale, and which axis is up, does not show in the result; scale and
// place are said.
TEST(RetargetMotion, PlaceHeadingScaleAndUpAxisDoNotMatter) {
  const Skeleton woman = standing_woman();
  const SkeletalMotion motion = bowing(woman, 30, 25.0);
  const StandingFigure figure(woman, {});
  const RetargetedMotion expected = retarget_motion(motion, figure);
  const auto expect_same = [&](const SkeletalMotion& other, double scale) {
    const RetargetedMotion result = retarget_motion(other, figure);
    ASSERT_EQ(result.motion.frames.size(), expected.motion.frames.size());
    EXPECT_EQ(result.contacts, expected.contacts);
    EXPECT_NEAR(result.scale, 1.0 / scale, 1e-9);
    for (std::size_t f = 0; f < result.motion.frames.size(); ++f) {
      EXPECT_LT(test::greatest_distance(result.motion.frames[f], expected.motion.frames[f]), 1e-6) << f;
      for (std::size_t i = 0; i < result.source_joints.size(); ++i) {
        EXPECT_LT((in_world(result, f, i) - in_world(expected, f, i)).norm(), 1e-6);
      }
    }
  };
  expect_same(test::moved(motion, Quaterniond(AngleAxisd(2.0, Vector3d::UnitY())), 1.0, {3.0, 0.7, -5.0}),
              1.0);
  expect_same(test::moved(motion, Quaterniond::Identity(), 5.5, Vector3d::Zero()), 5.5);
  SkeletalMotion z_up = motion;
  const Quaterniond up(AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()));
  for (Joint& j : z_up.skeleton.joints) j.rest_position = up * j.rest_position;
  for (SkeletonPose& pose : z_up.frames) {
    for (Vector3d& position : pose.position) position = up * position;
    for (Quaterniond& rotation : pose.rotation) rotation = up * rotation * up.conjugate();
  }
  expect_same(z_up, 1.0);
}

// A character is what it is, wherever and in whichever pose its markup was made.
TEST(RetargetMotion, TheCharactersRestPoseDoesNotMatter) {
  const Skeleton woman = standing_woman();
  const SkeletalMotion motion = bowing(woman, 50, 25.0);
  const RetargetedMotion expected = retarget_motion(motion, StandingFigure(woman, {}));
  // Standing elsewhere, turned: the same but for the feet, which then point ahead by their joints.
  const SkeletalMotion turned = test::rebased(
      test::moved(motion, Quaterniond(AngleAxisd(-1.6, Vector3d::UnitY())), 1.0, {1.0, 0.0, 2.0}), 0);
  const SkeletalMotion bent = test::rebased(motion, 20);
  for (const SkeletalMotion& character : {turned, bent}) {
    const StandingFigure figure(character.skeleton, std::vector<SkeletalMotion>{character});
    const RetargetedMotion result = retarget_motion(motion, figure);
    EXPECT_NEAR(result.scale, 1.0, 1e-6);
    for (std::size_t f = 0; f < result.motion.frames.size(); ++f) {
      for (std::size_t j = 0; j < woman.joints.size(); ++j) {
        EXPECT_LT((result.motion.frames[f].position[j] - expected.motion.frames[f].position[j]).norm(), 0.05)
            << woman.joints[j].name << " " << f;
      }
    }
  }
}

TEST(RetargetMotion, JointsMayBeMissing) {
  const Skeleton woman = standing_woman();
  const SkeletalMotion motion = bowing(woman, 20, 25.0);
  const StandingFigure figure(woman, {});
  const RetargetedMotion whole = retarget_motion(motion, figure, {.plant_feet = false});
  const auto without = [&](const std::vector<std::string>& left_out) {
    JointMap map{"some", {}, {}, {}};
    for (const Joint& j : woman.joints) {
      const bool is_out =
          std::ranges::any_of(left_out, [&](const std::string& end) { return j.name.ends_with(end); });
      if (!is_out) map.joints[j.name] = j.name;
    }
    return map;
  };
  const std::vector<std::vector<std::string>> cases = {
      {"spine", "neck", "toe", "collar"}, {"hand"}, {"head", "neck"}, {"chest", "spine", "collar", "neck"}};
  for (const std::vector<std::string>& left_out : cases) {
    SCOPED_TRACE(left_out.front());
    const JointMap map = without(left_out);
    const RetargetedMotion result = retarget_motion(motion, figure, {.joint_map = map, .plant_feet = false});
    EXPECT_EQ(result.map.missing.size(), woman.joints.size() - map.joints.size());
    EXPECT_EQ(result.source_joints.size(), map.joints.size());
    for (const char* name : {"pelvis", "left_upper_arm", "right_forearm", "left_shin", "right_foot"}) {
      const std::size_t j = joint(woman, name);
      EXPECT_LT(result.motion.frames[15].rotation[j].angularDistance(whole.motion.frames[15].rotation[j]),
                1e-6)
          << name;
    }
  }
  EXPECT_THAT(
      [&] {
        retarget_motion(motion, figure, {.joint_map = without({"head", "chest"})});
      },
      ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("head or chest"))));
}

TEST(RetargetMotionErrors, WhatIsNoMotion) {
  const Skeleton woman = standing_woman();
  const StandingFigure figure(woman, {});
  SkeletalMotion motion = bowing(woman, 10, 25.0);
  for (const double rate : {0.0, -25.0, 1e9, std::nan("")}) {
    EXPECT_THAT([&] { retarget_motion(motion, figure, {.frames_per_second = rate}); },
                ThrowsMessage<InvalidArgument>(HasSubstr("cannot retarget to")));
  }
  EXPECT_THAT(
      [&] {
        retarget_motion({"none", woman, 25.0, {}}, figure);
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("'none' has no frames")));
  for (const double rate : {0.0, std::numeric_limits<double>::infinity()}) {
    SkeletalMotion timeless = motion;
    timeless.frames_per_second = rate;
    EXPECT_THAT([&] { retarget_motion(timeless, figure); },
                ThrowsMessage<InvalidArgument>(HasSubstr("expected a positive, finite rate")));
  }
  motion.frames[3].position[2].x() = std::nan("");
  EXPECT_THAT([&] { retarget_motion(motion, figure); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame 3")));
  motion = bowing(woman, 10, 25.0);
  for (Joint& j : motion.skeleton.joints) j.rest_position.setZero();
  EXPECT_THAT([&] { retarget_motion(motion, figure); },
              ThrowsMessage<InvalidArgument>(HasSubstr("check the joint map")));
  Skeleton chair;
  chair.joints = {{"seat", -1, {0, 0.5, 0}}, {"back", 0, {0, 1, 0}}};
  EXPECT_THAT(
      [&] {
        retarget_motion({"chair", chair, 25.0, {rest_pose(chair)}}, figure);
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("motion 'chair': no joint map fits")));
}

// Greatest horizontal speed, m/s, of the point a foot stands on, heel or ball, over frames in contact.
double foot_drift(const RetargetedMotion& result, const StandingFigure& figure) {
  double greatest = 0.0;
  for (std::size_t f = 0; f + 1 < result.motion.frames.size(); ++f) {
    const SkeletonPose now = figure.standing_pose(result.motion.frames[f]);
    const SkeletonPose then = figure.standing_pose(result.motion.frames[f + 1]);
    for (std::size_t side = 0; side < 2; ++side) {
      if (!result.contacts[f][side] || !result.contacts[f + 1][side]) continue;
      const retargeting::FootShape shape = retargeting::foot_shape(figure.standing(), static_cast<int>(side));
      const auto speed = [&](const std::string& name, const Vector3d& point) {
        const int j = figure.standing().joint_idx(side_name(side) + name);
        Vector3d way = then.world_from_rest(figure.standing(), j) * point -
                       now.world_from_rest(figure.standing(), j) * point;
        way.y() = 0.0;
        return way.norm() * result.motion.frames_per_second;
      };
      greatest = std::max(greatest, std::min(speed("foot", shape.heel), speed("toe", shape.ball)));
    }
  }
  return greatest;
}

// Walks and runs on a body whose markup was made in mid-stride: bones keep their lengths, feet that stand
// stand still on the ground, whether or not the path is scaled.
TEST(RetargetMotionRealMotions, FeetStandStillOnACharacterMarkedInMidStride) {
  REPRISE_REQUIRE_DATA();
  const Skeleton woman = standing_woman();
  const StandingFigure truth(woman, {});
  const RetargetedMotion walk = retarget_motion(test::cmu_trial("08_01"), truth);
  std::size_t widest = 0;
  const auto stride = [&](std::size_t f) {
    const SkeletonPose& pose = walk.motion.frames[f];
    return (pose.position[joint(woman, "left_foot")] - pose.position[joint(woman, "right_foot")]).norm();
  };
  for (std::size_t f = 0; f < walk.motion.frames.size(); ++f) {
    if (stride(f) > stride(widest)) widest = f;
  }
  const SkeletalMotion seen = test::rebased(walk.motion, widest);
  const StandingFigure figure(seen.skeleton, std::vector<SkeletalMotion>{seen});
  ASSERT_FALSE(figure.rest_pose_stands());
  for (const char* trial : {"07_01", "09_01", "16_35"}) {
    SCOPED_TRACE(trial);
    const SkeletalMotion source = test::cmu_trial(trial);
    const RetargetedMotion expected = retarget_motion(source, truth);
    for (const bool scale_path : {true, false}) {
      SCOPED_TRACE(scale_path);
      const RetargetedMotion result = retarget_motion(source, figure, {.scale_path = scale_path});
      EXPECT_LT(foot_drift(result, figure), 0.008);
      double lowest = 1.0;
      for (const SkeletonPose& pose : result.motion.frames) {
        EXPECT_LT(test::greatest_distance(
                      pose, pose_from_rotations(seen.skeleton, pose.rotation, pose.position[0])),
                  1e-9);
        for (const char* name : {"left_foot", "right_foot"}) {
          lowest = std::min(lowest, pose.position[joint(woman, name)].y());
        }
      }
      EXPECT_NEAR(lowest, 0.069, 0.02);
      // The hips follow the source's, scaled by leg length or not at all.
      for (std::size_t f = 0; f < result.motion.frames.size(); ++f) {
        Vector3d way = Vector3d::Zero();
        for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
          const std::size_t j = joint(woman, side_name(side) + "thigh");
          way += 0.5 * (result.motion.frames[f].position[j] - in_world(result, f, j, scale_path));
        }
        // They go along with feet that are planted, whose steps need not be as long as these legs'.
        EXPECT_LT(std::hypot(way.x(), way.z()), scale_path ? 0.02 : 0.05) << f;
      }
      if (!scale_path) continue;
      double distance = 0.0;
      for (std::size_t f = 0; f < result.motion.frames.size(); ++f) {
        for (const char* name : {"head", "left_hand", "right_hand", "left_shin", "left_foot", "right_foot"}) {
          const std::size_t j = joint(woman, name);
          distance = std::max(
              distance, (result.motion.frames[f].position[j] - expected.motion.frames[f].position[j]).norm());
        }
      }
      EXPECT_LT(distance, 0.1);
    }
  }
}

// The person that was captured, doing what it did: only the place and the feet's planting change.
TEST(RetargetMotionRealMotions, OntoTheCapturedPersonItself) {
  REPRISE_REQUIRE_DATA();
  const SkeletalMotion source = test::cmu_trial("07_01");
  const StandingFigure figure(source.skeleton, {});
  EXPECT_TRUE(figure.rest_pose_stands());  // a T-pose about the origin, legs apart
  const RetargetedMotion result =
      retarget_motion(source, figure, {.frames_per_second = 120.0, .plant_feet = false});
  ASSERT_EQ(result.motion.frames.size(), source.frames.size());
  EXPECT_NEAR(result.scale, 1.0, 1e-6);
  const Quaterniond turn(result.world_from_source.rotation());
  for (std::size_t f = 0; f < source.frames.size(); f += 10) {
    for (const auto& [body, own] : figure.map().joints) {
      if (body.ends_with("hand") || body.ends_with("foot") || body.ends_with("toe")) continue;
      const std::size_t j = joint(source.skeleton, own);
      const Quaterniond expected = turn * source.frames[f].rotation[j];
      EXPECT_LT(result.motion.frames[f].rotation[j].angularDistance(expected), 0.01) << own << " " << f;
    }
  }
}

// What a converter put before the motion is left out and counted.
TEST(RetargetMotionRealMotions, TPosesOfConvertersAreLeftOut) {
  REPRISE_REQUIRE_DATA();
  const StandingFigure figure(standing_woman(), {});
  const std::filesystem::path cmu = test::data_folder() / "cmu";
  EXPECT_EQ(retarget_motion(read_bvh(cmu / "bvh" / "07_01.bvh"), figure).left_out, 1U);
  EXPECT_EQ(retarget_motion(test::cmu_trial("07_01"), figure).left_out, 0U);
}

}  // namespace
}  // namespace reprise
