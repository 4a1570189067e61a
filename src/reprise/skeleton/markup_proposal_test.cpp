// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/skeleton/markup_proposal.h"

#include <algorithm>
#include <array>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/skeleton/skeleton_extraction.h"
#include "reprise/skeleton/surface_loop.h"
#include "reprise/synthetic/figure/figure.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Figure {
  Mesh mesh;
  Markup truth;
  Landmarks landmarks;
};

// The figure at rest, with landmarks where a person would put them: found from the true joints, as the
// surface point on one side of each.
const Figure& figure() {
  static const Figure made = [] {
    const PerformanceDatabase database = make_figure({.voxel_size = 0.025});
    Figure figure{.mesh = {.topology = database.topology(), .positions = database.markup()->reference},
                  .truth = *database.markup()};
    const auto nearest = [&](const Eigen::Vector3d& point) {
      Eigen::Index best = 0;
      (figure.mesh.positions.rowwise() - point.transpose().cast<float>())
          .rowwise()
          .squaredNorm()
          .minCoeff(&best);
      return static_cast<std::int32_t>(best);
    };
    // From the joint outwards until the surface is left behind.
    const auto on_side = [&](const std::string& joint, const Eigen::Vector3d& side, double reach) {
      const Skeleton& skeleton = figure.truth.skeleton;
      const int j = skeleton.joint_idx(joint);
      return nearest(skeleton.joints[static_cast<std::size_t>(j)].rest_position + reach * side);
    };
    const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
    const Eigen::Vector3d front = Eigen::Vector3d::UnitZ();
    figure.landmarks["head_top"] = nearest({0.0, 3.0, 0.0});
    figure.landmarks["neck"] = on_side("neck", -front, 0.2);
    for (const double sign : {1.0, -1.0}) {
      const std::string s = sign > 0.0 ? "left_" : "right_";
      const Eigen::Vector3d out = sign * Eigen::Vector3d::UnitX();
      figure.landmarks[s + "shoulder"] = on_side(s + "upper_arm", 0.5 * out + up, 0.1);
      figure.landmarks[s + "elbow"] = on_side(s + "forearm", -front, 0.1);
      figure.landmarks[s + "wrist"] = on_side(s + "hand", -front, 0.1);
      figure.landmarks[s + "hand"] = nearest(3.0 * (out - 2.0 * up));
      figure.landmarks[s + "hip"] = on_side(s + "thigh", out, 0.2);
      figure.landmarks[s + "knee"] = on_side(s + "shin", front, 0.2);
      figure.landmarks[s + "ankle"] = on_side(s + "foot", out, 0.1);
      figure.landmarks[s + "toe"] = nearest(0.1 * out + 3.0 * front);
    }
    // The hand's tip: farthest from the wrist along the arm.
    for (const std::string s : {"left_", "right_"}) {
      const auto joint = [&](const char* name) {
        const int j = figure.truth.skeleton.joint_idx(s + name);
        return figure.truth.skeleton.joints[static_cast<std::size_t>(j)].rest_position;
      };
      figure.landmarks[s + "hand"] =
          nearest(joint("hand") + 0.25 * (joint("hand") - joint("forearm")).normalized());
    }
    return figure;
  }();
  return made;
}

TEST(MarkupProposal, FindsTheBonesOfTheFigure) {
  const Markup proposed = propose_markup(figure().mesh, figure().landmarks);
  EXPECT_NO_THROW(validate(proposed, figure().mesh.topology->vertex_count));
  const Skeleton& truth = figure().truth.skeleton;
  for (const std::string s : {"left_", "right_"}) {
    for (const char* name : {"upper_arm", "forearm", "hand", "thigh", "shin", "foot"}) {
      const Joint& found =
          proposed.skeleton.joints[static_cast<std::size_t>(proposed.skeleton.joint_idx(s + name))];
      const Joint& expected = truth.joints[static_cast<std::size_t>(truth.joint_idx(s + name))];
      // The figure's tunic hides its hips.
      const double bound = std::string(name) == "thigh" ? 0.07 : 0.05;
      EXPECT_LT((found.rest_position - expected.rest_position).norm(), bound) << s << name;
    }
  }
  // Labels of the limbs and the head: the trunk is divided by another rule than the figure's.
  std::size_t agreed = 0;
  std::size_t counted = 0;
  for (std::size_t v = 0; v < proposed.joint_of_vertex.size(); ++v) {
    const std::int32_t label = figure().truth.joint_of_vertex[v];
    if (label < 0) continue;
    const Eigen::Vector3d point =
        figure().mesh.positions.row(static_cast<Eigen::Index>(v)).transpose().cast<double>();
    const auto is_near = [&](const Joint& joint) { return (joint.rest_position - point).norm() < 0.09; };
    if (std::ranges::any_of(truth.joints, is_near)) continue;  // away from joints
    const std::string& expected = truth.joints[static_cast<std::size_t>(label)].name;
    const std::string& found =
        proposed.skeleton.joints[static_cast<std::size_t>(proposed.joint_of_vertex[v])].name;
    const auto region = [](const std::string& name) {
      return name == "pelvis" || name == "spine" || name == "chest" ? "trunk"
             : name == "neck" || name == "head"                     ? "head"
                                                                    : name.c_str();
    };
    agreed += std::string(region(expected)) == region(found) ? 1 : 0;
    ++counted;
  }
  EXPECT_GT(counted, 500U);
  EXPECT_GT(static_cast<double>(agreed), 0.9 * static_cast<double>(counted));
  EXPECT_EQ(proposed.parts.size(), 6U);
}

// Motion shows where joints are better than the surface does.
TEST(MarkupProposal, JointsComeNearerToTheTruthWhenTheClipsAreLookedAt) {
  const PerformanceDatabase database = make_figure({.voxel_size = 0.025});
  Markup proposed = propose_markup(figure().mesh, figure().landmarks);
  const Skeleton before = proposed.skeleton;
  const std::vector<MeshSequence> clips = {database.clip(database.clip_idx("jog")),
                                           database.clip(database.clip_idx("wave"))};
  const Skeleton after = refine_joints(clips, proposed);
  const Skeleton& truth = figure().truth.skeleton;
  for (const std::string s : {"left_", "right_"}) {
    for (const char* name : {"forearm", "thigh", "shin", "foot"}) {
      const auto error = [&](const Skeleton& skeleton) {
        return (skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx(s + name))].rest_position -
                truth.joints[static_cast<std::size_t>(truth.joint_idx(s + name))].rest_position)
            .norm();
      };
      EXPECT_LT(error(after), error(before) + 0.002) << s << name;
      // The figure's tunic hides its hips.
      EXPECT_LT(error(after), std::string(name) == "thigh" ? 0.05 : 0.03) << s << name;
    }
  }
  // The truth itself stays where it is.
  const Skeleton same = refine_joints(clips, figure().truth);
  for (std::size_t j = 0; j < truth.joints.size(); ++j) {
    EXPECT_LT((same.joints[j].rest_position - truth.joints[j].rest_position).norm(), 0.005)
        << truth.joints[j].name;
  }
}

TEST(MarkupProposal, DoesNotDependOnWhereTheBodyStands) {
  const Markup here = propose_markup(figure().mesh, figure().landmarks);
  Mesh moved = figure().mesh;
  const Eigen::Isometry3d move =
      Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 1, 1).normalized());
  for (Eigen::Index v = 0; v < moved.positions.rows(); ++v) {
    const Eigen::Vector3d p = figure().mesh.positions.row(v).transpose().cast<double>();
    moved.positions.row(v) = (move * p).transpose().cast<float>();
  }
  const Markup there = propose_markup(moved, figure().landmarks);
  // Rounding may turn a loop at a tie between two ways.
  for (int j = 0; j < here.skeleton.size(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    EXPECT_LT(
        (move * here.skeleton.joints[at].rest_position - there.skeleton.joints[at].rest_position).norm(),
        0.01)
        << here.skeleton.joints[at].name;
  }
}

TEST(MarkupProposal, SaysWhatIsWrongWithLandmarks) {
  const auto with = [](const std::string& name, std::int32_t vertex) {
    Landmarks landmarks = figure().landmarks;
    landmarks[name] = vertex;
    return [landmarks] { (void)propose_markup(figure().mesh, landmarks); };
  };
  // A name that is not known, one that is missing.
  EXPECT_THAT(with("left_albow", 3),
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'left_albow'"), HasSubstr("'left_elbow'"))));
  Landmarks fewer = figure().landmarks;
  fewer.erase("neck");
  EXPECT_THAT([&] { (void)propose_markup(figure().mesh, fewer); },
              ThrowsMessage<InvalidArgument>(HasSubstr("landmarks are missing: neck")));
  // A vertex that is not there, one that is used twice.
  EXPECT_THAT(with("neck", 1000000), ThrowsMessage<InvalidArgument>(HasSubstr("vertex 1000000")));
  EXPECT_THAT(with("neck", -1), ThrowsMessage<InvalidArgument>(HasSubstr("vertex -1")));
  EXPECT_THAT(with("neck", figure().landmarks.at("head_top")),
              ThrowsMessage<InvalidArgument>(AllOf(HasSubstr("'neck'"), HasSubstr("same vertex"))));
  // A knee on the other leg.
  EXPECT_THAT(with("left_knee", figure().landmarks.at("right_ankle") + 1),
              ThrowsMessage<InvalidArgument>(HasSubstr("left_knee")));
}

// On an egg the shortest loop through a point of the equator that goes around it is the equator.
TEST(SurfaceLoop, IsTheShortestThatSeparates) {
  test::Shape sphere = test::sphere(4);
  sphere.positions.col(1) = (3.0F * sphere.positions.col(1).array() - 2.0F).matrix();
  const PositionsView positions(sphere.positions.data(), sphere.positions.rows(), 3);
  const auto nearest = [&](const Eigen::RowVector3f& point) {
    Eigen::Index best = 0;
    (sphere.positions.rowwise() - point).rowwise().squaredNorm().minCoeff(&best);
    return static_cast<std::int32_t>(best);
  };
  const std::int32_t north = nearest({0, 4, 0});
  const std::int32_t south = nearest({0, -2, 0});
  const skeleton::LoopFinder finder(*sphere.topology, positions, north, std::array{south});
  const std::vector<std::int32_t> loop = finder.loop(nearest({1, 1, 0}), 1, south);
  ASSERT_GT(loop.size(), 8U);
  double length = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    length += (sphere.positions.row(loop[i]) - sphere.positions.row(loop[(i + 1) % loop.size()])).norm();
  }
  EXPECT_LT(length, 1.1 * 2.0 * std::numbers::pi);
  EXPECT_LT((finder.centroid(loop) - Eigen::Vector3d(0, 1, 0)).norm(), 0.1);
  // It divides the sphere in two.
  const std::vector<bool> beyond = finder.beyond(loop, south);
  EXPECT_TRUE(beyond[static_cast<std::size_t>(south)]);
  EXPECT_FALSE(beyond[static_cast<std::size_t>(north)]);
  const auto count = static_cast<double>(std::ranges::count(beyond, true));
  EXPECT_NEAR(count / static_cast<double>(beyond.size()), 0.5, 0.1);
  // There is no second terminal to separate.
  EXPECT_TRUE(finder.loop(nearest({1, 1, 0}), 2, south).empty());
}

TEST(SurfaceLoop, NeedsOnePiece) {
  Topology two{.vertex_count = 6, .triangles = {{0, 1, 2}, {3, 4, 5}}};
  const Positions positions = Positions::Random(6, 3);
  EXPECT_THAT(
      [&] {
        skeleton::LoopFinder(two, PositionsView(positions.data(), 6, 3), 0,
                             std::array<std::int32_t, 2>{1, 4});
      },
      ThrowsMessage<InvalidArgument>(HasSubstr("terminal 1 (vertex 4) is not joined with vertex 0")));
}

}  // namespace
}  // namespace reprise
