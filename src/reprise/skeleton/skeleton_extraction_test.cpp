// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/skeleton_extraction.h"

#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/core/random.h"
#include "reprise/skeleton/skeleton_test_support.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double degree = std::numbers::pi / 180.0;

void remove_label(Markup& markup, const std::string& joint) {
  std::ranges::replace(markup.joint_of_vertex, markup.skeleton.joint_idx(joint), -1);
}

// Independent normal noise on every coordinate.
MeshSequence noisy(const MeshSequence& clip, double sigma) {
  MeshSequence result = clip;
  const RandomField field(7);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    PositionsRef frame = result.frame(f);
    for (Eigen::Index i = 0; i < frame.size(); ++i) {
      frame.data()[i] += static_cast<float>(sigma * field.normal_pair(f, static_cast<std::uint64_t>(i))[0]);
    }
  }
  return result;
}

// The built-in figure, made once.
const PerformanceDatabase& figure() {
  static const PerformanceDatabase database = make_figure({.voxel_size = 0.03});
  return database;
}

TEST(SkeletonExtraction, IsExactOnRigidPieces) {
  const std::vector<SkeletonPose> truth = test::leg_poses(40);
  const SkeletalMotion motion = extract_skeleton(test::leg_clip(truth), test::leg_markup());
  EXPECT_EQ(motion.name, "leg");
  EXPECT_EQ(motion.frames_per_second, 25.0);
  const PoseDifference difference = pose_difference(motion, truth);
  // Positions are stored as float: 0.1 micrometres a metre.
  EXPECT_LT(*std::ranges::max_element(difference.max_distance), 2e-6);
  EXPECT_LT(*std::ranges::max_element(difference.max_angle), 1e-4);
}

TEST(SkeletonExtraction, TurnsAndMovesWithTheSurface) {
  const std::vector<SkeletonPose> poses = test::leg_poses(10);
  Markup markup = test::leg_markup();
  remove_label(markup, "left_thigh");  // inferred bones, too
  remove_label(markup, "left_shin");
  remove_label(markup, "left_toe");
  const MeshSequence clip = noisy(test::leg_clip(poses), 0.003);
  const Eigen::Isometry3d moved_from_world =
      Eigen::Translation3d(3.0, -1.0, 2.0) *
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
  MeshSequence moved = clip;
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    for (Eigen::Index v = 0; v < clip.frame(f).rows(); ++v) {
      const Eigen::Vector3d p = std::as_const(clip).frame(f).row(v).transpose().cast<double>();
      moved.frame(f).row(v) = (moved_from_world * p).transpose().cast<float>();
    }
  }
  const SkeletalMotion here = extract_skeleton(clip, markup);
  const SkeletalMotion there = extract_skeleton(moved, markup);
  std::vector<SkeletonPose> expected = here.frames;
  for (SkeletonPose& pose : expected) {
    for (Eigen::Vector3d& position : pose.position) position = moved_from_world * position;
    for (Eigen::Quaterniond& rotation : pose.rotation) {
      rotation = Eigen::Quaterniond(moved_from_world.rotation()) * rotation;
    }
  }
  const PoseDifference difference = pose_difference(there, expected);
  EXPECT_LT(*std::ranges::max_element(difference.max_distance), 1e-5);
  EXPECT_LT(*std::ranges::max_element(difference.max_angle), 1e-4);
}

TEST(SkeletonExtraction, ClothThatSlidesOverABoneDoesNotPullIt) {
  const std::vector<SkeletonPose> truth = test::leg_poses(30);
  MeshSequence clip = test::leg_clip(truth);
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    PositionsRef frame = clip.frame(f);
    for (Eigen::Index v = 0; v < frame.rows(); v += 4) {  // a quarter of each piece, all to one side
      frame(v, 0) += 0.05F + 0.03F * std::sin(static_cast<float>(f));
    }
  }
  const PoseDifference difference = pose_difference(extract_skeleton(clip, test::leg_markup()), truth);
  EXPECT_LT(*std::ranges::max_element(difference.max_distance), 0.002);
  EXPECT_LT(*std::ranges::max_element(difference.max_angle), 2.0 * degree);
}

TEST(SkeletonExtraction, FollowsTheSkinnedFigure) {
  const PerformanceDatabase& database = figure();
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const PoseDifference difference =
        pose_difference(extract_skeleton(database.clip(c), *database.markup()), database.truth(c)->poses);
    EXPECT_LT(difference.distance, 0.001) << database.clip(c).name();
    EXPECT_LT(difference.angle, 0.5 * degree) << database.clip(c).name();
  }
}

TEST(SkeletonExtraction, ErrorGrowsWithTheNoiseAndNoFaster) {
  const PerformanceDatabase& database = figure();
  const std::size_t walk = database.clip_idx("walk");
  const auto difference = [&](double sigma) {
    return pose_difference(extract_skeleton(noisy(database.clip(walk), sigma), *database.markup()),
                           database.truth(walk)->poses);
  };
  const PoseDifference half = difference(0.005);
  const PoseDifference whole = difference(0.01);
  EXPECT_LT(whole.distance, 0.01);  // less than the noise itself: many vertices decide
  EXPECT_LT(whole.angle, 5.0 * degree);
  EXPECT_GT(whole.distance, 1.5 * half.distance);
  EXPECT_LT(whole.distance, 2.5 * half.distance);
}

TEST(SkeletonExtraction, InfersHipsAndKneesUnderASkirt) {
  const PerformanceDatabase& database = figure();
  Markup markup = *database.markup();
  for (const char* side : {"left_", "right_"}) {
    for (const char* bone : {"thigh", "shin"}) remove_label(markup, std::string(side) + bone);
  }
  const std::vector<bool> followed = followed_bones(*database.topology(), markup);
  EXPECT_EQ(std::ranges::count(followed, false), 4);
  EXPECT_FALSE(followed[static_cast<std::size_t>(markup.skeleton.joint_idx("right_shin"))]);
  for (const char* name : {"walk", "jog", "start"}) {
    const std::size_t c = database.clip_idx(name);
    const std::vector<SkeletonPose>& truth = database.truth(c)->poses;
    const SkeletalMotion motion = extract_skeleton(database.clip(c), markup);
    const PoseDifference difference = pose_difference(motion, truth);
    for (const char* side : {"left_", "right_"}) {
      const auto hip = static_cast<std::size_t>(markup.skeleton.joint_idx(std::string(side) + "thigh"));
      const std::size_t knee = hip + 1;
      const std::size_t ankle = hip + 2;
      EXPECT_LT(difference.max_distance[hip], 0.01) << name;
      EXPECT_LT(difference.max_distance[ankle], 0.01) << name;
      EXPECT_LT(difference.mean_distance[knee], 0.03) << name;
      EXPECT_LT(difference.max_distance[knee], 0.06) << name;
      const auto length = [&](const SkeletonPose& pose, std::size_t a, std::size_t b) {
        return (pose.position[a] - pose.position[b]).norm();
      };
      const SkeletonPose rest = rest_pose(markup.skeleton);
      double jerk = 0.0;
      double true_jerk = 0.0;
      for (std::size_t f = 1; f + 1 < truth.size(); ++f) {
        EXPECT_NEAR(length(motion.frames[f], hip, knee), length(rest, hip, knee), 0.002) << name << f;
        EXPECT_NEAR(length(motion.frames[f], knee, ankle), length(rest, knee, ankle), 0.002) << name << f;
        const auto second = [&](const std::vector<SkeletonPose>& poses) {
          return (poses[f + 1].position[knee] - 2.0 * poses[f].position[knee] + poses[f - 1].position[knee])
              .norm();
        };
        jerk = std::max(jerk, second(motion.frames));
        true_jerk = std::max(true_jerk, second(truth));
      }
      EXPECT_LT(jerk, 2.0 * true_jerk) << name;  // it does not snap from side to side
    }
  }
}

TEST(SkeletonExtraction, CentroidsAreThoseOfTheLabelledVertices) {
  const std::vector<SkeletonPose> poses = test::leg_poses(3);
  const MeshSequence clip = test::leg_clip(poses);
  const Markup markup = test::leg_markup();
  const SkeletalMotion motion =
      extract_skeleton(clip, markup, {.position = SkeletonExtractionOptions::JointPosition::centroid});
  for (std::size_t f = 0; f < poses.size(); ++f) {
    for (int j = 0; j < markup.skeleton.size(); ++j) {
      const auto block = clip.frame(f).middleRows(j * test::piece_size, test::piece_size);
      const Eigen::Vector3d centroid = block.cast<double>().colwise().mean().transpose();
      const auto at = static_cast<std::size_t>(j);
      EXPECT_LT((motion.frames[f].position[at] - centroid).norm(), 1e-9);
      // The skeleton that comes with the poses is at rest where the centroids are at rest.
      const Eigen::Vector3d carried =
          poses[f].world_from_rest(markup.skeleton, j) * motion.skeleton.joints[at].rest_position;
      EXPECT_LT((motion.frames[f].position[at] - carried).norm(), 1e-6);
    }
  }
}

TEST(SkeletonExtraction, SaysWhatItCannotWorkWith) {
  const MeshSequence clip = test::leg_clip(test::leg_poses(2));
  const Markup markup = test::leg_markup();
  // A markup of another surface.
  Markup other = markup;
  other.joint_of_vertex.pop_back();
  EXPECT_THAT([&] { (void)extract_skeleton(clip, other); },
              ThrowsMessage<InvalidArgument>(HasSubstr("the markup does not fit clip 'leg'")));
  // No labels to stand on, or only such as lie on a line.
  other = markup;
  std::ranges::fill(other.joint_of_vertex, -1);
  EXPECT_THAT([&] { (void)extract_skeleton(clip, other); },
              ThrowsMessage<InvalidArgument>(HasSubstr("no bone can be followed")));
  for (int v = 0; v < 8; ++v) {
    other.joint_of_vertex[static_cast<std::size_t>(v)] = 0;
    other.reference.row(v) << static_cast<float>(v), 0.0F, 0.0F;
  }
  EXPECT_THAT([&] { (void)extract_skeleton(clip, other); },
              ThrowsMessage<InvalidArgument>(HasSubstr("pelvis 8")));
  // Two points fix no rotation.
  EXPECT_THAT([&] { (void)extract_skeleton(clip, markup, {.fewest_vertices = 2}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("fewest_vertices")));
}

TEST(PoseDifference, MeasuresEachJoint) {
  const Skeleton skeleton = test::leg_skeleton();
  SkeletalMotion motion{.skeleton = skeleton, .frames = {rest_pose(skeleton), rest_pose(skeleton)}};
  const std::vector<SkeletonPose> truth = motion.frames;
  motion.frames[0].position[1] += Eigen::Vector3d(0.3, 0.0, 0.4);
  motion.frames[1].rotation[2] =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()) * motion.frames[1].rotation[2];
  motion.frames[0].rotation[3].coeffs() *= -1.0;  // the same rotation
  const PoseDifference difference = pose_difference(motion, truth);
  EXPECT_THAT(difference.mean_distance, ElementsAre(0.0, testing::DoubleEq(0.25), 0.0, 0.0, 0.0));
  EXPECT_THAT(difference.max_distance, ElementsAre(0.0, testing::DoubleEq(0.5), 0.0, 0.0, 0.0));
  EXPECT_NEAR(difference.mean_angle[2], 0.1, 1e-9);
  EXPECT_NEAR(difference.max_angle[2], 0.2, 1e-9);
  EXPECT_NEAR(difference.max_angle[3], 0.0, 1e-7);
  EXPECT_NEAR(difference.distance, 0.05, 1e-12);
  EXPECT_NEAR(difference.angle, 0.02, 1e-7);
  EXPECT_THROW((void)pose_difference(motion, {truth[0]}), InvalidArgument);
  EXPECT_THROW((void)pose_difference({.skeleton = skeleton}, {}), InvalidArgument);
  EXPECT_THROW((void)pose_difference(motion, {truth[0], SkeletonPose{}}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
