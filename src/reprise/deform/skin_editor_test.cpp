// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/skin_editor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/deform/skinning_test_support.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class SkinEditorTest : public testing::TestWithParam<Skinning> {
 protected:
  SkinEditorTest() {
    for (Eigen::Index v = 0; v < surface_.markup.reference.rows(); ++v) {
      const float y = surface_.markup.reference(v, 1);
      surface_.markup.joint_of_vertex[static_cast<std::size_t>(v)] = y < 0.0F ? 0 : 1;
    }
    weights_ = std::make_shared<const SkinWeights>(skin_weights(surface_.topology, surface_.markup));
    editor_ = std::make_unique<SkinEditor>(weights_, skeleton(), PoseFitOptions{.skinning = GetParam()});
  }
  const Skeleton& skeleton() const { return surface_.markup.skeleton; }
  const Positions& reference() const { return surface_.markup.reference; }

  // Every seventh vertex where `target` has it.
  static std::vector<PositionConstraint> asked(const Positions& target) {
    std::vector<PositionConstraint> constraints;
    for (std::int32_t v = 0; v < target.rows(); v += 7) {
      constraints.push_back({v, target.row(v).transpose().cast<double>()});
    }
    return constraints;
  }

  test::MarkedSurface surface_ = test::tube(31);
  std::shared_ptr<const SkinWeights> weights_;
  std::unique_ptr<SkinEditor> editor_;
};

TEST_P(SkinEditorTest, TargetsAtTheFramesOwnPlacesGiveTheFrameBack) {
  const SkeletonPose pose = rest_pose(skeleton());
  editor_->set_frame(test::view(reference()), &pose);
  EXPECT_EQ(editor_->positions(), reference().cast<double>());
  const DeformReport report = editor_->deform(asked(reference()));
  EXPECT_EQ(report.solved_parts, 0);
  EXPECT_EQ(editor_->positions(), reference().cast<double>());
}

TEST_P(SkinEditorTest, FindsThePoseThatTargetsWereSkinnedWith) {
  const SkeletonPose rest = rest_pose(skeleton());
  const Quaterniond bend(Eigen::AngleAxisd(0.7, Vector3d::UnitX()));
  const SkeletonPose bent =
      pose_from_rotations(skeleton(), {Quaterniond::Identity(), bend}, skeleton().joints[0].rest_position);
  const Positions target = test::skinned(*weights_, skeleton(), reference(), rest, bent, GetParam());
  editor_->set_frame(test::view(reference()), &rest);
  const DeformReport report = editor_->deform(asked(target));
  EXPECT_EQ(report.solved_parts, 1);
  EXPECT_LT((editor_->positions() - target.cast<double>()).rowwise().norm().maxCoeff(), 0.002);
  EXPECT_LT(editor_->pose().rotation[1].angularDistance(bend), 0.01);
  double largest = 0.0;
  for (const PositionConstraint& constraint : asked(target)) {
    largest = std::max(largest,
                       (editor_->positions().row(constraint.vertex).transpose() - constraint.target).norm());
  }
  EXPECT_EQ(report.largest_residual, largest);
}

TEST_P(SkinEditorTest, WhatWasAskedBeforeDoesNotMatter) {
  const SkeletonPose rest = rest_pose(skeleton());
  const Positions moved = test::moved(reference(), Quaterniond::Identity(), {0.1, 0.0, 0.2});
  editor_->set_frame(test::view(reference()), &rest);
  editor_->deform(asked(moved));
  const Coordinates first = editor_->positions();
  EXPECT_LT((first - moved.cast<double>()).rowwise().norm().maxCoeff(), 1e-5) << "a rigid motion is one";
  std::vector<PositionConstraint> other = asked(moved);
  other.resize(3);
  other[1].target.y() += 0.4;
  editor_->deform(other);
  EXPECT_NE(editor_->positions(), first);
  editor_->deform(asked(moved));
  EXPECT_EQ(editor_->positions(), first);
}

TEST_P(SkinEditorTest, RefusesWhatItCannotWorkWith) {
  const SkeletonPose rest = rest_pose(skeleton());
  EXPECT_THROW(SkinEditor(nullptr, skeleton()), InvalidArgument);
  EXPECT_THROW(SkinEditor(weights_, Skeleton()), InvalidArgument);
  EXPECT_THROW(editor_->deform(asked(reference())), InvalidArgument) << "no frame yet";
  EXPECT_THROW(editor_->set_frame(test::view(reference()), nullptr), InvalidArgument);
  EXPECT_THROW(editor_->set_frame(PositionsView(reference().data(), 5, 3), &rest), InvalidArgument);
  Positions broken = reference();
  broken(3, 1) = NAN;
  EXPECT_THROW(editor_->set_frame(test::view(broken), &rest), InvalidArgument);
  const SkeletonPose headless{.rotation = {Quaterniond::Identity()}, .position = {Vector3d::Zero()}};
  EXPECT_THROW(editor_->set_frame(test::view(reference()), &headless), InvalidArgument);
  editor_->set_frame(test::view(reference()), &rest);
  EXPECT_THROW(editor_->deform({}), InvalidArgument);
  EXPECT_THROW(editor_->deform(std::vector<PositionConstraint>{{-1, Vector3d::Zero()}}), InvalidArgument);
}

INSTANTIATE_TEST_SUITE_P(Skinning, SkinEditorTest,
                         testing::Values(Skinning::linear, Skinning::dual_quaternion),
                         [](const auto& skinning) {
                           return skinning.param == Skinning::linear ? "Linear" : "DualQuaternion";
                         });

}  // namespace
}  // namespace reprise
