// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_editor.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/deform/learnt_figure_test_support.h"

namespace reprise {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

PositionsView frame_of(const std::string& clip, std::size_t frame_idx) {
  const PerformanceDatabase& figure = test::small_figure();
  return figure.clip(figure.clip_idx(clip)).frame(frame_idx);
}

double largest_distance(const Coordinates& a, const Coordinates& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

class EveryLearntModel : public ::testing::TestWithParam<const char*> {
 protected:
  std::shared_ptr<const PartModel> model(const PartEditorOptions& options = {}) const {
    return test::part_model(std::string(GetParam()) == "part" ? test::figure_parts() : test::figure_whole(),
                            options);
  }
};
INSTANTIATE_TEST_SUITE_P(Models, EveryLearntModel, ::testing::Values("part", "whole"));

TEST_P(EveryLearntModel, NoDragIsTheFrameItself) {
  PartEditor editor(model());
  const PositionsView frame = frame_of("walk", 7);
  editor.set_frame(frame);
  editor.deform(test::every_vertex(frame, 20));
  EXPECT_EQ(largest_distance(editor.positions(), frame.cast<double>()), 0.0);

  // One constraint moved by next to nothing has all parts it touches solved.
  auto constraints = test::every_vertex(frame, 20);
  for (PositionConstraint& constraint : constraints) constraint.target.x() += 1e-12;
  EXPECT_GT(editor.deform(constraints).solved_parts, 0);
  EXPECT_LT(largest_distance(editor.positions(), frame.cast<double>()), 1e-6);
}

TEST_P(EveryLearntModel, RigidMotionsOfAllConstraintsMoveTheSurfaceRigidly) {
  PartEditor editor(model());
  const PositionsView frame = frame_of("wave", 30);
  editor.set_frame(frame);
  for (const double angle : {0.4, 2.0, 3.1}) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(angle, Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
    const Vector3d t(3.0, -1.0, 2.0);
    for (const std::int32_t step : {12, 60}) {
      auto constraints = test::every_vertex(frame, step);
      for (PositionConstraint& constraint : constraints) constraint.target = R * constraint.target + t;
      const DeformReport report = editor.deform(constraints);
      const Coordinates moved = (frame.cast<double>() * R.transpose()).rowwise() + t.transpose();
      EXPECT_LT(largest_distance(editor.positions(), moved), 1e-6) << angle;
      EXPECT_LT(report.largest_residual, 1e-6);
    }
  }
}

TEST_P(EveryLearntModel, OneConstraintTakesTheSurfaceAlong) {
  PartEditor editor(model());
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  const Markup& markup = *test::small_figure().markup();
  const std::int32_t v = markup.vertices_of_joint(markup.skeleton.joint_idx("chest")).front();
  const Vector3d move(0.1, 0.2, -0.3);
  const Vector3d place = frame.row(v).transpose().cast<double>();
  editor.deform(std::vector<PositionConstraint>{{.vertex = v, .target = place + move}});
  // The whole body goes along, or the torso and what hangs on it.
  const Coordinates moved = frame.cast<double>().rowwise() + move.transpose();
  EXPECT_LT(largest_distance(editor.positions(), moved), 1e-6);
}

TEST_P(EveryLearntModel, WhatWasAskedBeforeDoesNotMatter) {
  const PositionsView frame = frame_of("walk", 3);
  const auto first = test::drag_joint("left_foot", {0.0, 0.15, 0.1}, frame);
  auto second = test::every_vertex(frame_of("walk", 12), 30);

  PartEditor fresh(model());
  fresh.set_frame(frame);
  fresh.deform(first);
  const Coordinates expected = fresh.positions();

  PartEditor used(model());
  used.set_frame(frame_of("jog", 5));
  used.deform(second);
  used.set_frame(frame);
  used.deform(second);
  used.deform(first);
  EXPECT_EQ(largest_distance(used.positions(), expected), 0.0);
}

TEST_P(EveryLearntModel, FarTargetsGiveFinitePlaces) {
  PartEditor editor(model());
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  for (const double far : {1.0, 1e3, 1e9}) {
    editor.deform(test::drag_joint("right_hand", Vector3d(far, -2.0 * far, far), frame));
    EXPECT_TRUE(editor.positions().allFinite()) << far;
  }
}

TEST_P(EveryLearntModel, ReproducesAnotherFrameFromAFewVertices) {
  PartEditor editor(model());
  const PositionsView wanted = frame_of("walk", 20);
  editor.set_frame(frame_of("stand", 0));
  editor.deform(test::every_vertex(wanted, static_cast<std::int32_t>(wanted.rows() / 40)));
  const Coordinates truth = wanted.cast<double>();
  EXPECT_LT((editor.positions() - truth).rowwise().norm().mean(), 0.01);
}

TEST(PartEditor, PartsThatAreNotAskedStayToTheLastBit) {
  const auto model = test::part_model(test::figure_parts());
  const PartHierarchy& hierarchy = model->hierarchy();
  PartEditor editor(model);
  const PositionsView frame = frame_of("stand", 10);
  editor.set_frame(frame);
  const DeformReport report = editor.deform(test::drag_joint("left_hand", {0.05, 0.1, 0.1}, frame));
  EXPECT_EQ(report.solved_parts, 1);
  const PartHierarchy::Part& arm = hierarchy.part(hierarchy.part_idx("left_arm"));
  std::size_t moved = 0;
  for (std::int32_t v = 0; v < hierarchy.vertex_count(); ++v) {
    const bool stays = editor.positions().row(v) == frame.row(v).cast<double>();
    if (arm.local(v) < 0) {
      EXPECT_TRUE(stays) << v;
    }
    if (!stays) ++moved;
  }
  EXPECT_GT(moved, arm.vertices.size() / 2);
}

TEST(PartEditor, AParentTakesItsChildrenAlong) {
  const auto model = test::part_model(test::figure_parts());
  PartEditor editor(model);
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  // The torso is turned as a whole: arms, head and legs turn with it.
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix();
  std::vector<PositionConstraint> constraints;
  const PartHierarchy& hierarchy = model->hierarchy();
  for (std::int32_t v = 0; v < hierarchy.vertex_count(); ++v) {
    if (hierarchy.main_part(v) == 0)
      constraints.push_back({.vertex = v, .target = R * frame.row(v).transpose().cast<double>()});
  }
  EXPECT_EQ(editor.deform(constraints).solved_parts, 6);
  const Coordinates turned = frame.cast<double>() * R.transpose();
  EXPECT_LT(largest_distance(editor.positions(), turned), 1e-6);
}

TEST(PartEditor, FrontiersAreNoWorseThanTheInsideOfParts) {
  const auto model = test::part_model(test::figure_parts());
  const PartHierarchy& hierarchy = model->hierarchy();
  PartEditor editor(model);
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  for (const char* joint : {"left_hand", "right_hand", "left_foot", "right_foot"}) {
    editor.deform(test::drag_joint(joint, {0.02, 0.06, 0.08}, frame));
    double at_frontier = 0.0;
    double inside = 0.0;
    for (const Triangle& triangle : hierarchy.topology()->triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = triangle[k];
        const std::int32_t b = triangle[(k + 1) % 3];
        const double stretch = (editor.positions().row(a) - editor.positions().row(b)).norm() /
                               (frame.row(a) - frame.row(b)).cast<double>().norm();
        const bool is_shared = hierarchy.shares(a).size() > 1 || hierarchy.shares(b).size() > 1;
        double& largest = is_shared ? at_frontier : inside;
        largest = std::max(largest, stretch);
      }
    }
    EXPECT_LT(at_frontier, 1.05 * inside) << joint;
  }
}

// Of a closed surface, m^3.
double volume(const Topology& topology, const Coordinates& positions) {
  double sum = 0.0;
  for (const Triangle& triangle : topology.triangles) {
    const Vector3d a = positions.row(triangle[0]).transpose();
    const Vector3d b = positions.row(triangle[1]).transpose();
    const Vector3d c = positions.row(triangle[2]).transpose();
    sum += a.dot(b.cross(c)) / 6.0;
  }
  return sum;
}

TEST(PartEditor, ARaisedArmKeepsItsVolume) {
  const PositionsView frame = frame_of("stand", 0);
  const Topology& topology = *test::small_figure().topology();
  const double at_rest = volume(topology, frame.cast<double>());
  const auto change = [&](double free_turn) {
    PartEditor editor(test::part_model(test::figure_parts(), {.free_turn = free_turn}));
    editor.set_frame(frame);
    editor.deform(test::drag_joint("left_hand", {0.3, 0.6, 0.1}, frame));
    return std::abs(volume(topology, editor.positions()) - at_rest);
  };
  // Without turning along, the arm collapses: no example of the left arm shows it raised.
  EXPECT_LT(change(PartEditorOptions{}.free_turn), 0.5 * change(std::numbers::pi));
}

TEST(PartEditor, ConstraintsThatMakeNoSenseAreRefused) {
  PartEditor editor(test::part_model(test::figure_parts()));
  const std::vector<PositionConstraint> one = {{.vertex = 0, .target = Vector3d::Zero()}};
  EXPECT_THAT([&] { editor.deform(one); }, ThrowsMessage<InvalidArgument>(HasSubstr("frame")));
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  EXPECT_THAT([&] { editor.deform({}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("nothing is constrained")));
  const auto refuses = [&](std::vector<PositionConstraint> constraints, const std::string& what) {
    EXPECT_THAT([&] { editor.deform(constraints); }, ThrowsMessage<InvalidArgument>(HasSubstr(what)));
  };
  refuses({{.vertex = 1 << 20, .target = Vector3d::Zero()}}, "1048576");
  refuses({{.vertex = 3, .target = Vector3d::Zero()}, {.vertex = 3, .target = Vector3d::Ones()}}, "3");
  refuses({{.vertex = 3, .target = Vector3d(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0)}}, "3");
  EXPECT_EQ(largest_distance(editor.positions(), frame.cast<double>()), 0.0);

  Positions broken = frame;
  broken(5, 1) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { editor.set_frame(PositionsView(broken.data(), broken.rows(), 3)); },
              ThrowsMessage<InvalidArgument>(HasSubstr("vertex 5")));
  EXPECT_THROW(editor.prefer({Eigen::VectorXd::Zero(1)}), InvalidArgument);
}

TEST(PartEditor, AllVerticesMayBeConstrained) {
  PartEditor editor(test::part_model(test::figure_parts()));
  const PositionsView wanted = frame_of("jog", 10);
  editor.set_frame(frame_of("stand", 0));
  editor.deform(test::every_vertex(wanted, 1));
  const Coordinates truth = wanted.cast<double>();
  EXPECT_LT((editor.positions() - truth).rowwise().norm().mean(), 0.002);
}

TEST(Learning, PartsWithoutExamplesAreRefused) {
  const PerformanceDatabase& figure = test::small_figure();
  const std::vector<BodyPart>& parts = figure.markup()->parts;
  std::vector<std::vector<FrameId>> examples(parts.size(), {FrameId{}});
  examples[2].clear();
  EXPECT_THAT([&] { learn_model(figure, figure.markup()->reference, parts, examples); },
              ThrowsMessage<InvalidArgument>(HasSubstr(parts[2].name)));
}

TEST(Learning, OneExampleIsARigidPart) {
  const PerformanceDatabase& figure = test::small_figure();
  const std::vector<BodyPart>& parts = figure.markup()->parts;
  const std::vector<std::vector<FrameId>> examples(parts.size(), {FrameId{}});
  const LearntModel model = learn_model(figure, figure.markup()->reference, parts, examples);
  EXPECT_EQ(model.parts[1].component_count(), 0);
  PartEditor editor(test::part_model(model));
  const PositionsView frame = frame_of("stand", 0);
  editor.set_frame(frame);
  editor.deform(test::drag_joint("left_hand", {0.0, 0.02, 0.0}, frame));
  EXPECT_TRUE(editor.positions().allFinite());
}

TEST(Learning, KeepsTheVarianceItIsAskedFor) {
  const std::vector<BodyPart>& parts = test::small_figure().markup()->parts;
  for (const double kept : {0.5, 0.95, 0.99}) {
    for (const LearntPart& part : test::learn_figure(parts, kept, 20).parts) {
      EXPECT_LE(part.discarded_variance, (1.0 - kept) * part.total_variance * (1.0 + 1e-9)) << part.part.name;
      const Eigen::MatrixXd basis = part.basis.cast<double>();
      EXPECT_LT((basis.transpose() * basis - Eigen::MatrixXd::Identity(basis.cols(), basis.cols()))
                    .lpNorm<Eigen::Infinity>(),
                1e-5);
    }
  }
}

}  // namespace
}  // namespace reprise
