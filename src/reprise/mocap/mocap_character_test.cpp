// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/mocap_character.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/mocap/mocap_test_support.h"
#include "reprise/mocap/velocity_error.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

using testing::HasSubstr;

const SurfaceMotionGraph& figure_graph() {
  static const SurfaceMotionGraph graph = [] {
    const DissimilarityMatrix matrix = vertex_dissimilarity(test::figure_performer());
    return build_graph(test::figure_performer(), "vertex",
                       find_transitions(test::figure_performer(), matrix));
  }();
  return graph;
}

const MocapCharacter& figure_character() {
  static const MocapCharacter character(test::figure_performer(), figure_graph());
  return character;
}

// A clip's own skeleton as a query, standing elsewhere and facing another way.
SkeletalMotion query_of(const std::string& clip, double yaw = 1.2) {
  SkeletalMotion query = test::figure_motions()[test::figure_performer().clip_idx(clip)];
  for (SkeletonPose& pose : query.frames)
    pose = moved({.ground = {.yaw = yaw, .translation = {4.0, -2.0}}}, pose);
  return query;
}

// Both arms turned out by half a radian.
SkeletonPose with_spread_arms(const Skeleton& skeleton, const SkeletonPose& pose) {
  std::vector<Eigen::Quaterniond> rotations = pose.rotation;
  for (const std::string side : {"left_", "right_"}) {
    const auto chest = static_cast<std::size_t>(skeleton.joint_idx("chest"));
    const Eigen::Vector3d ahead = pose.rotation[chest] * Eigen::Vector3d::UnitZ();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(side == "left_" ? 0.5 : -0.5, ahead));
    for (const char* bone : {"upper_arm", "forearm", "hand"}) {
      if (const auto joint = skeleton.find(side + bone)) {
        Eigen::Quaterniond& rotation = rotations[static_cast<std::size_t>(*joint)];
        rotation = (turn * rotation).normalized();
      }
    }
  }
  return pose_from_rotations(skeleton, rotations, pose.position[0]);
}

MocapPlan best_plan(const SkeletalMotion& query, const MocapOptions& options) {
  auto plans = figure_character().plan(query, options);
  EXPECT_TRUE(plans.has_value());
  return plans->front();
}

TEST(MocapCharacter, GivesBackAClipThatItsOwnSkeletonAsksFor) {
  MocapOptions options;
  options.retargeting.plant_feet = false;
  const MocapPlan plan = best_plan(query_of("walk"), options);
  const MeshSequence& clip = test::figure_performer().clip(test::figure_performer().clip_idx("walk"));
  ASSERT_EQ(plan.times.size(), clip.frame_count());
  EXPECT_EQ(plan.retrieval.repeats + plan.retrieval.skips, 0);
  const MeshSequence animation = figure_character().animate(plan, options);
  double farthest = 0.0;
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    const GroundAlignment alignment = align_on_ground(clip.frame(f), animation.frame(f));
    farthest = std::max(farthest, alignment.rms_distance);
  }
  EXPECT_LT(farthest, 0.004);
  std::vector<SkeletonPose> poses;
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    poses.push_back(figure_character().follower().pose(animation.frame(f)));
  }
  // 0.3 cm a frame is the paper's figure for walks.
  EXPECT_LT(velocity_error(poses, plan.target, VelocityScale::legs).mean, 0.0015);
}

TEST(MocapCharacter, DrivesNearerToTheQueryThanRetrievalComes) {
  // A walk with the arms spread, which no clip has.
  SkeletalMotion query = query_of("walk");
  for (SkeletonPose& pose : query.frames) pose = with_spread_arms(query.skeleton, pose);
  MocapOptions options;
  const MocapPlan plan = best_plan(query, options);
  const auto error = [&](DriveModel model) {
    options.model = model;
    double sum = 0.0;
    std::size_t f = 0;
    figure_character().animate(plan, options, [&](const Mesh& mesh, const FrameOrigin& /*origin*/) {
      const SkeletonPose found =
          figure_character().follower().pose(PositionsView(mesh.positions.data(), mesh.positions.rows(), 3));
      const SkeletonPose& target = plan.target.motion.frames[f++];
      const SkeletonPose placed = moved(nearest_upright(found, target), found);
      for (std::size_t j = 0; j < placed.position.size(); ++j) {
        sum += (placed.position[j] - target.position[j]).norm() / static_cast<double>(placed.position.size());
      }
    });
    return sum / static_cast<double>(f);
  };
  const double retrieved = error(DriveModel::none);
  const double driven = error(DriveModel::part);
  EXPECT_GT(retrieved, 0.03);  // metres, a joint
  EXPECT_LT(driven, 0.2 * retrieved);
}

TEST(MocapCharacter, AnUndrivenMotionBeginsWhereTheQueryDoesAndIsMovedAsAWhole) {
  MocapOptions options;
  options.model = DriveModel::none;
  const MocapPlan plan = best_plan(query_of("walk"), options);
  const MeshSequence animation = figure_character().animate(plan, options);
  const MeshSequence& clip = test::figure_performer().clip(test::figure_performer().clip_idx("walk"));
  const GroundTransform first = align_on_ground(animation.frame(0), clip.frame(0)).a_from_b;
  for (std::size_t f = 0; f < clip.frame_count(); f += 7) {
    Positions expected(clip.frame(f).rows(), 3);
    transform_positions(first, clip.frame(f), PositionsRef(expected.data(), expected.rows(), 3));
    EXPECT_LT((expected - animation.frame(f)).rowwise().norm().maxCoeff(), 1e-4) << f;
  }
  const SkeletonPose start = figure_character().follower().pose(animation.frame(0));
  EXPECT_LT((start.position[0] - plan.target.motion.frames[0].position[0]).norm(), 0.05);
}

TEST(MocapCharacter, MakesTheSameFramesWithAnyNumberOfThreads) {
  const MocapOptions options;
  const auto made = [&] {
    return figure_character().animate(best_plan(query_of("walk_curve"), options), options);
  };
  const MeshSequence many = made();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(made().data(), many.data());
}

TEST(MocapCharacter, TellsWhereItCameFrom) {
  const MocapOptions options{.name = "asked"};
  const MocapPlan plan = best_plan(query_of("jog"), options);
  const MeshSequence animation = figure_character().animate(plan, options);
  EXPECT_EQ(animation.name(), "asked");
  ASSERT_EQ(animation.origins().size(), animation.frame_count());
  EXPECT_EQ(animation.origins()[5].clip, "jog");
  EXPECT_TRUE(animation.has_colors());
  EXPECT_FALSE(animation.has_colors_per_frame());
}

TEST(MocapCharacter, SaysWhereNothingIsNearEnough) {
  MocapOptions options;
  options.retrieval.threshold = 1e-4;
  SkeletalMotion query = query_of("walk");
  query.frames_per_second *= 1.3;
  const auto plans = figure_character().plan(query, options);
  ASSERT_FALSE(plans.has_value());
  EXPECT_THAT(plans.error().reason, HasSubstr("threshold"));
}

TEST(MocapCharacter, SaysWhatADatabaseLacks) {
  const auto message = [](const PerformanceDatabase& database,
                          const SurfaceMotionGraph& graph) -> std::string {
    try {
      const MocapCharacter character(database, graph);
      const MocapOptions options;
      const auto plans = character.plan(query_of("walk"), options);
      static_cast<void>(character.animate(plans->front(), options));
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  PerformanceDatabase unmarked = test::figure_performer();
  unmarked.set_markup(std::nullopt);
  EXPECT_THAT(message(unmarked, figure_graph()), HasSubstr("reprise markup"));
  EXPECT_THAT(message(test::small_figure(), figure_graph()), HasSubstr("reprise model learn"));
  SurfaceMotionGraph other = figure_graph();
  other.database_hash = "another";
  EXPECT_THAT(message(test::figure_performer(), other), HasSubstr("graph"));
}

}  // namespace
}  // namespace reprise
