// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/skeleton_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/skeleton/skeleton_test_support.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double degree = std::numbers::pi / 180.0;

SkeletalMotion follow(const SkeletonFollower& follower, const MeshSequence& clip) {
  SkeletalMotion motion{.name = clip.name(), .skeleton = follower.skeleton()};
  for (std::size_t f = 0; f < clip.frame_count(); ++f) motion.frames.push_back(follower.pose(clip.frame(f)));
  return motion;
}

void remove_label(Markup& markup, const std::string& joint) {
  std::ranges::replace(markup.joint_of_vertex, markup.skeleton.joint_idx(joint), -1);
}

// Every fourth vertex slides over its bone.
MeshSequence with_sliding_cloth(MeshSequence clip) {
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    PositionsRef frame = clip.frame(f);
    for (Eigen::Index v = 0; v < frame.rows(); v += 4) {
      frame(v, 0) += 0.05F + 0.03F * std::sin(static_cast<float>(f));
    }
  }
  return clip;
}

TEST(SkeletonFollower, IsExactOnRigidPieces) {
  const std::vector<SkeletonPose> truth = test::leg_poses(40);
  const MeshSequence clip = test::leg_clip(truth);
  const SkeletonFollower follower({clip}, test::leg_markup());
  const PoseDifference difference = pose_difference(follow(follower, clip), truth);
  EXPECT_LT(*std::ranges::max_element(difference.max_distance), 2e-6);
  EXPECT_LT(*std::ranges::max_element(difference.max_angle), 1e-4);
  EXPECT_LT(*std::ranges::max_element(follower.residuals()), 2e-6);
}

TEST(SkeletonFollower, FindsInEveryFrameWhatExtractionFindsInTheClip) {
  const PerformanceDatabase figure = make_figure({.voxel_size = 0.05});
  const SkeletonFollower follower(figure.clips(), *figure.markup());
  for (std::size_t c = 0; c < figure.clips().size(); ++c) {
    const std::vector<SkeletonPose>& truth = figure.truth(c)->poses;
    const SkeletalMotion followed = follow(follower, figure.clip(c));
    const SkeletalMotion extracted = extract_skeleton(figure.clip(c), *figure.markup());
    const PoseDifference to_truth = pose_difference(followed, truth);
    const PoseDifference extracted_to_truth = pose_difference(extracted, truth);
    EXPECT_LT(to_truth.distance, 1.1 * extracted_to_truth.distance) << figure.clip(c).name();
    EXPECT_LT(to_truth.angle, 1.1 * extracted_to_truth.angle) << figure.clip(c).name();
    EXPECT_LT(to_truth.distance, 0.001) << figure.clip(c).name();
    EXPECT_LT(to_truth.angle, 1.0 * degree) << figure.clip(c).name();
    const PoseDifference to_extracted = pose_difference(followed, extracted.frames);
    EXPECT_LT(*std::ranges::max_element(to_extracted.max_distance), 0.001) << figure.clip(c).name();
  }
}

TEST(SkeletonFollower, TurnsAndMovesWithTheSurface) {
  Markup markup = test::leg_markup();
  remove_label(markup, "left_thigh");  // inferred bones, too
  remove_label(markup, "left_toe");
  const MeshSequence clip = with_sliding_cloth(test::leg_clip(test::leg_poses(10)));
  const SkeletonFollower follower({clip}, markup);
  const Eigen::Isometry3d moved_from_world =
      Eigen::Translation3d(3.0, -1.0, 2.0) *
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    const PositionsView frame = clip.frame(f);
    Positions moved(frame.rows(), 3);
    for (Eigen::Index v = 0; v < frame.rows(); ++v) {
      moved.row(v) = (moved_from_world * frame.row(v).transpose().cast<double>()).transpose().cast<float>();
    }
    const SkeletonPose here = follower.pose(frame);
    const SkeletonPose there = follower.pose(PositionsView(moved.data(), moved.rows(), 3));
    for (std::size_t j = 0; j < here.position.size(); ++j) {
      EXPECT_LT((there.position[j] - moved_from_world * here.position[j]).norm(), 1e-5);
      EXPECT_LT(there.rotation[j].angularDistance(Eigen::Quaterniond(moved_from_world.rotation()) *
                                                  here.rotation[j]),
                1e-4);
    }
  }
}

TEST(SkeletonFollower, LearnsWhichVerticesSlideAndWhichHaveNoBone) {
  Markup markup = test::leg_markup();
  remove_label(markup, "left_toe");
  const std::vector<SkeletonPose> truth = test::leg_poses(30);
  const MeshSequence clip = with_sliding_cloth(test::leg_clip(truth));
  const SkeletonFollower follower({clip}, markup);
  for (std::size_t v = 0; v < clip.vertex_count(); ++v) {
    const double residual = follower.residuals()[v];
    if (markup.joint_of_vertex[v] < 0) {
      EXPECT_EQ(residual, std::numeric_limits<double>::infinity());
    } else if (v % 4 == 0) {
      EXPECT_GT(residual, 0.04);
      EXPECT_LT(residual, 0.06);
    } else {
      EXPECT_LT(residual, 0.003);
    }
  }
  // A frame that the clips do not have: all cloth lies elsewhere.
  MeshSequence other = test::leg_clip(truth);
  for (std::size_t f = 0; f < other.frame_count(); ++f) {
    PositionsRef frame = other.frame(f);
    for (Eigen::Index v = 0; v < frame.rows(); v += 4) frame(v, 2) -= 0.06F;
  }
  const SkeletonPose found = follower.pose(std::as_const(other).frame(7));
  const SkeletonPose& expected = truth[7];
  for (std::size_t j = 0; j + 1 < expected.position.size(); ++j) {
    EXPECT_LT((found.position[j] - expected.position[j]).norm(), 0.001) << j;
  }
}

TEST(SkeletonFollower, CentroidsAreThoseOfTheExtraction) {
  const MeshSequence clip = test::leg_clip(test::leg_poses(3));
  const SkeletonExtractionOptions options{.position = SkeletonExtractionOptions::JointPosition::centroid};
  const SkeletonFollower follower({clip}, test::leg_markup(), options);
  const SkeletalMotion extracted = extract_skeleton(clip, test::leg_markup(), options);
  for (std::size_t j = 0; j < extracted.skeleton.joints.size(); ++j) {
    EXPECT_EQ(follower.skeleton().joints[j].rest_position, extracted.skeleton.joints[j].rest_position);
    EXPECT_EQ(follower.pose(clip.frame(1)).position[j], extracted.frames[1].position[j]);
  }
}

TEST(SkeletonFollower, SaysWhatItCannotWorkWith) {
  const MeshSequence clip = test::leg_clip(test::leg_poses(2));
  Markup markup = test::leg_markup();
  EXPECT_THAT([&] { SkeletonFollower({}, markup); },
              ThrowsMessage<InvalidArgument>(HasSubstr("there is no clip")));
  const SkeletonFollower follower({clip}, markup);
  const Positions few = Positions::Zero(7, 3);
  EXPECT_THAT([&] { (void)follower.pose(PositionsView(few.data(), few.rows(), 3)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("a frame of 7 vertices")));
  std::ranges::fill(markup.joint_of_vertex, -1);
  EXPECT_THAT([&] { SkeletonFollower({clip}, markup); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no bone can be followed")));
}

}  // namespace
}  // namespace reprise
