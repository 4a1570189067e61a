// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/sequence/motion_mix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Eigen::Quaterniond turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

// A root with two limbs of two bones each; every joint turns in its own way, faster by `speed`.
SkeletalMotion motion(double speed, std::size_t frames, double rate = 10.0) {
  SkeletalMotion result{.name = "motion", .skeleton = {}, .frames_per_second = rate, .frames = {}};
  result.skeleton.joints = {{.name = "root", .parent = -1, .rest_position = {0, 1, 0}},
                            {.name = "left", .parent = 0, .rest_position = {0.2, 1, 0}},
                            {.name = "left_end", .parent = 1, .rest_position = {0.5, 1, 0}},
                            {.name = "right", .parent = 0, .rest_position = {-0.2, 1, 0}},
                            {.name = "right_end", .parent = 3, .rest_position = {-0.5, 1, 0}}};
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = speed * static_cast<double>(f) / rate;
    const Eigen::Quaterniond root = turn(0.3 * t, Eigen::Vector3d::UnitY());
    const Eigen::Quaterniond left = root * turn(t, Eigen::Vector3d::UnitZ());
    const Eigen::Quaterniond right = root * turn(0.7 * t, Eigen::Vector3d::UnitX());
    result.frames.push_back(pose_from_rotations(result.skeleton,
                                                {root, left, left * turn(0.5 * t, Eigen::Vector3d::UnitY()),
                                                 right, right * turn(0.4 * t, Eigen::Vector3d::UnitZ())},
                                                {t, 1.0, 0.0}));
  }
  return result;
}

Eigen::Quaterniond local(const SkeletonPose& pose, std::size_t parent, std::size_t joint) {
  return pose.rotation[parent].conjugate() * pose.rotation[joint];
}

TEST(MotionMix, LimbsTurnAsInTheOtherMotionAndTheRestAsInItsOwn) {
  const SkeletalMotion body = motion(1.0, 20);
  const SkeletalMotion other = motion(-2.0, 30);
  const SkeletalMotion mixed = mix_motions(body, other, {.limbs = {"left"}, .start = 0.5});
  ASSERT_EQ(mixed.frames.size(), 20U);
  for (std::size_t f = 0; f < 20; ++f) {
    for (const std::size_t j : {0U, 3U, 4U}) {
      EXPECT_LT(mixed.frames[f].rotation[j].angularDistance(body.frames[f].rotation[j]), 1e-9);
      EXPECT_LT((mixed.frames[f].position[j] - body.frames[f].position[j]).norm(), 1e-9);
    }
    EXPECT_LT(local(mixed.frames[f], 0, 1).angularDistance(local(other.frames[f + 5], 0, 1)), 1e-6);
    EXPECT_LT(local(mixed.frames[f], 1, 2).angularDistance(local(other.frames[f + 5], 1, 2)), 1e-6);
    EXPECT_NEAR((mixed.frames[f].position[2] - mixed.frames[f].position[1]).norm(), 0.3, 1e-9);
  }
}

TEST(MotionMix, AMotionMixedWithItselfIsItself) {
  const SkeletalMotion body = motion(1.0, 12);
  const SkeletalMotion mixed = mix_motions(body, body, {.limbs = {"left", "right_end"}});
  ASSERT_EQ(mixed.frames.size(), body.frames.size());
  for (std::size_t f = 0; f < body.frames.size(); ++f) {
    for (std::size_t j = 0; j < 5; ++j)
      EXPECT_LT(mixed.frames[f].rotation[j].angularDistance(body.frames[f].rotation[j]), 1e-6);
  }
}

TEST(MotionMix, TakesTheBodysRateAndEndsWithTheShorter) {
  const SkeletalMotion mixed = mix_motions(motion(1.0, 40), motion(1.0, 41, 20.0), {.limbs = {"right"}});
  EXPECT_EQ(mixed.frames_per_second, 10.0);
  EXPECT_EQ(mixed.frames.size(), 21U);  // 41 frames at 20 Hz last 2 s
}

TEST(MotionMix, RefusesWhatItCannotMix) {
  const SkeletalMotion body = motion(1.0, 5);
  const auto mix = [&](const SkeletalMotion& other, const MotionMixOptions& options) {
    return [&body, other, options] { mix_motions(body, other, options); };
  };
  EXPECT_THAT(mix(body, {}), ThrowsMessage<InvalidArgument>(HasSubstr("at least one limb")));
  EXPECT_THAT(mix(body, {.limbs = {"root"}}), ThrowsMessage<InvalidArgument>(HasSubstr("is the root")));
  EXPECT_THAT(mix(body, {.limbs = {"lefft"}}), ThrowsMessage<InvalidArgument>(HasSubstr("'left'")));
  EXPECT_THAT(mix(body, {.limbs = {"left"}, .start = 0.5}),
              ThrowsMessage<InvalidArgument>(HasSubstr("start at 0.5")));
  EXPECT_THAT(mix(body, {.limbs = {"left"}, .start = -1.0}),
              ThrowsMessage<InvalidArgument>(HasSubstr("start at -1")));
  SkeletalMotion headless = body;
  headless.skeleton.joints[2].name = "other_end";
  EXPECT_THAT(mix(headless, {.limbs = {"left"}}), ThrowsMessage<InvalidArgument>(HasSubstr("left_end")));
  EXPECT_THROW(mix(motion(1.0, 0), {.limbs = {"left"}})(), InvalidArgument);
}

}  // namespace
}  // namespace reprise
