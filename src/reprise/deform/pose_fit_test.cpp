// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/pose_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/deform/posed_vertices.h"
#include "reprise/deform/skinning_test_support.h"

namespace reprise {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;
using Constraints = std::vector<PositionConstraint>;

constexpr auto skinnings = {Skinning::linear, Skinning::dual_quaternion};

Quaterniond turn(double radians, const Vector3d& axis) {
  return Quaterniond(Eigen::AngleAxisd(radians, axis));
}

// A frame of the figure's walk is fitted to other poses.
class PoseFits : public testing::Test {
 protected:
  PoseFits() {
    for (Eigen::Index v = 0; v < source_.rows(); v += 29) {
      if (markup_.joint_of_vertex[static_cast<std::size_t>(v)] >= 0) {
        spread_.push_back(static_cast<std::int32_t>(v));
      }
    }
  }

  SkeletonPose truth(const char* clip, std::size_t frame_idx) const {
    return figure_.truth(figure_.clip_idx(clip))->poses.at(frame_idx);
  }
  Positions posed(const SkeletonPose& pose, Skinning skinning) const {
    return test::skinned(weights_, skeleton_, source_, source_pose_, pose, skinning);
  }
  static Constraints on(const std::vector<std::int32_t>& vertices, const Positions& positions) {
    Constraints result;
    for (const std::int32_t v : vertices) {
      result.push_back({.vertex = v, .target = positions.row(v).cast<double>().transpose()});
    }
    return result;
  }
  std::vector<std::int32_t> of_joints(const std::vector<std::string>& joints, std::size_t stride) const {
    std::vector<std::int32_t> result;
    for (const std::string& joint : joints) {
      const auto all = markup_.vertices_of_joint(skeleton_.joint_idx(joint));
      for (std::size_t i = 0; i < all.size(); i += stride) result.push_back(all[i]);
    }
    return result;
  }
  PoseFit fit(const Constraints& constraints, const PoseFitOptions& options = {}) const {
    return fit_pose(weights_, skeleton_, test::view(source_), source_pose_, constraints, options);
  }
  static double mean_distance(const Positions& a, const Positions& b) {
    return (a - b).rowwise().norm().cast<double>().mean();
  }
  // Of a joint against its parent.
  Quaterniond local(const SkeletonPose& pose, const std::string& joint) const {
    const int j = skeleton_.joint_idx(joint);
    const auto p = static_cast<std::size_t>(skeleton_.joints[static_cast<std::size_t>(j)].parent);
    return pose.rotation[p].conjugate() * pose.rotation[static_cast<std::size_t>(j)];
  }
  static void expect_same(const SkeletonPose& a, const SkeletonPose& b) {
    for (std::size_t j = 0; j < a.rotation.size(); ++j) {
      EXPECT_EQ(a.rotation[j].coeffs(), b.rotation[j].coeffs());
      EXPECT_EQ(a.position[j], b.position[j]);
    }
  }

  const PerformanceDatabase& figure_ = test::figure_database();
  const Markup& markup_ = *figure_.markup();
  const Skeleton& skeleton_ = markup_.skeleton;
  const Positions source_ = figure_.clip(figure_.clip_idx("walk")).frame(5);
  const SkeletonPose source_pose_ = truth("walk", 5);
  const SkinWeights weights_ = skin_weights(figure_.topology(), markup_);
  std::vector<std::int32_t> spread_;  // all over the body
};

TEST_F(PoseFits, AreTheSourcePoseWithoutConstraints) {
  const PoseFit result = fit({});
  expect_same(result.pose, source_pose_);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.residual, 0.0);
}

TEST_F(PoseFits, AreTheSourcePoseWhereConstraintsAreMet) {
  for (const Skinning skinning : skinnings) {
    const PoseFit result = fit(on(spread_, source_), {.skinning = skinning});
    expect_same(result.pose, source_pose_);
    EXPECT_LT(result.residual, 1e-9);
  }
}

TEST_F(PoseFits, FindPosesFromSomeVertices) {
  for (const Skinning skinning : skinnings) {
    for (const auto& [clip, frame_idx] : {std::pair{"jog", 20}, {"wave", 30}, {"walk_curve", 60}}) {
      const Positions target = posed(truth(clip, static_cast<std::size_t>(frame_idx)), skinning);
      const Constraints constraints = on(spread_, target);
      ASSERT_GT(constraints.size(), 30U);
      const PoseFit stiff = fit(constraints, {.skinning = skinning});
      EXPECT_TRUE(stiff.converged);
      EXPECT_LT(mean_distance(posed(stiff.pose, skinning), target), 0.004) << clip;
      const PoseFit exact = fit(constraints, {.skinning = skinning, .pull = 1e-5});
      EXPECT_LT(exact.residual, 1e-6) << clip;
      EXPECT_LT(test::largest_distance(posed(exact.pose, skinning), target), 1e-4) << clip;
    }
  }
}

TEST_F(PoseFits, KeepTheLengthsOfTheSourcesBones) {
  SkeletonPose stretched = source_pose_;
  const int hand = skeleton_.joint_idx("left_hand");
  stretched.position[static_cast<std::size_t>(hand)] += Vector3d(0.02, -0.01, 0.03);
  const Positions target = posed(truth("jog", 20), Skinning::linear);
  const PoseFit result = fit_pose(weights_, skeleton_, test::view(source_), stretched, on(spread_, target));
  for (int j = 1; j < skeleton_.size(); ++j) {
    const auto child = static_cast<std::size_t>(j);
    const auto parent = static_cast<std::size_t>(skeleton_.joints[child].parent);
    EXPECT_NEAR((result.pose.position[child] - result.pose.position[parent]).norm(),
                (stretched.position[child] - stretched.position[parent]).norm(), 1e-12);
  }
}

TEST_F(PoseFits, LeaveJointsAloneThatNothingSpeaksOf) {
  // The right arm moves, everything else is held where it is; the left arm is not mentioned.
  SkeletonPose goal = source_pose_;
  const int shoulder = skeleton_.joint_idx("right_upper_arm");
  const Vector3d pivot = goal.position[static_cast<std::size_t>(shoulder)];
  const Quaterniond lift = turn(-0.7, Vector3d::UnitZ());
  for (const char* joint : {"right_upper_arm", "right_forearm", "right_hand"}) {
    const auto j = static_cast<std::size_t>(skeleton_.joint_idx(joint));
    goal.rotation[j] = lift * goal.rotation[j];
    goal.position[j] = pivot + lift * (goal.position[j] - pivot);
  }
  const std::vector<std::int32_t> vertices =
      of_joints({"right_forearm", "right_hand", "pelvis", "chest", "head", "left_foot", "right_foot"}, 8);
  const PoseFit result = fit(on(vertices, posed(goal, Skinning::linear)), {.pull = 1e-3});
  const auto difference = [&](const SkeletonPose& pose, const char* joint) {
    return local(result.pose, joint).angularDistance(local(pose, joint));
  };
  EXPECT_LT(difference(source_pose_, "left_forearm"), 1e-7);
  EXPECT_LT(difference(source_pose_, "left_hand"), 1e-7);
  // Vertices of chest and feet follow these a little.
  EXPECT_LT(difference(source_pose_, "left_upper_arm"), 1e-3);
  EXPECT_LT(difference(source_pose_, "left_toe"), 1e-3);
  EXPECT_LT(difference(goal, "right_upper_arm"), 1e-3);
}

TEST_F(PoseFits, MoveRigidlyWithTheirTargets) {
  const Positions target = posed(truth("jog", 20), Skinning::linear);
  const Quaterniond Q = Quaterniond(0.3, -0.8, 0.4, 0.2).normalized();
  const Vector3d t(1.0, 2.0, -3.0);
  for (const Skinning skinning : skinnings) {
    Constraints constraints = on(spread_, target);
    // Not met exactly, too.
    for (std::size_t i = 0; i < constraints.size(); i += 3) constraints[i].target.x() += 0.05;
    const PoseFit here = fit(constraints, {.skinning = skinning});
    for (PositionConstraint& constraint : constraints) constraint.target = Q * constraint.target + t;
    const PoseFit there = fit(constraints, {.skinning = skinning});
    const SkeletonPose expected = test::moved(here.pose, Q, t);
    for (std::size_t j = 0; j < expected.rotation.size(); ++j) {
      EXPECT_LT(there.pose.rotation[j].angularDistance(expected.rotation[j]), 1e-6);
      EXPECT_LT((there.pose.position[j] - expected.position[j]).norm(), 1e-6);
    }
  }
}

TEST_F(PoseFits, MoveAsAWholeByOneConstraint) {
  const std::int32_t vertex = of_joints({"head"}, 1).front();
  const Vector3d shift(0.3, -0.2, 5.0);
  const PoseFit result =
      fit({{.vertex = vertex, .target = source_.row(vertex).cast<double>().transpose() + shift}});
  const SkeletonPose expected = test::moved(source_pose_, Quaterniond::Identity(), shift);
  for (std::size_t j = 0; j < expected.rotation.size(); ++j) {
    EXPECT_LT(result.pose.rotation[j].angularDistance(expected.rotation[j]), 1e-6);
    EXPECT_LT((result.pose.position[j] - expected.position[j]).norm(), 1e-6);
  }
}

TEST_F(PoseFits, StretchStraightToTargetsOutOfReach) {
  const Vector3d away = Vector3d(1.0, 0.4, 0.3).normalized();
  for (const Skinning skinning : skinnings) {
    for (const double distance : {2.0, 100.0, 1e6}) {
      // A body held so that it stands however far the target.
      Constraints constraints =
          on(of_joints({"pelvis", "spine", "head", "left_foot", "right_foot"}, 4), source_);
      for (PositionConstraint& constraint : constraints) constraint.weight = 10.0 * std::sqrt(distance);
      const std::int32_t tip = of_joints({"left_hand"}, 1).back();
      const auto shoulder = static_cast<std::size_t>(skeleton_.joint_idx("left_upper_arm"));
      constraints.push_back({.vertex = tip, .target = source_pose_.position[shoulder] + distance * away});
      const PoseFit result = fit(constraints, {.skinning = skinning});
      for (std::size_t j = 0; j < result.pose.rotation.size(); ++j) {
        ASSERT_TRUE(result.pose.rotation[j].coeffs().allFinite() && result.pose.position[j].allFinite());
      }
      const Vector3d end = posed(result.pose, skinning).row(tip).cast<double>().transpose();
      const auto joint = [&](const char* name) {
        return result.pose.position[static_cast<std::size_t>(skeleton_.joint_idx(name))];
      };
      const Vector3d begin = joint("left_upper_arm"), elbow = joint("left_forearm"),
                     wrist = joint("left_hand");
      const double longest = (elbow - begin).norm() + (wrist - elbow).norm() + (end - wrist).norm();
      // The tip follows the forearm a little, too, so that quite straight is not quite the nearest.
      EXPECT_GT((end - begin).norm(), 0.99 * longest) << distance;
      EXPECT_GT((end - begin).normalized().dot(away), std::cos(0.07)) << distance;
    }
  }
}

TEST_F(PoseFits, AreFiniteForTargetsThatNoFloatingPointNumberSquares) {
  Constraints constraints = on(spread_, source_);
  constraints.front().target = {1e300, 0.0, 0.0};
  const PoseFit result = fit(constraints);
  EXPECT_FALSE(result.converged);
  expect_same(result.pose, source_pose_);
}

TEST_F(PoseFits, MeetContradictionsInTheMiddleByWeight) {
  // Two neighbours are asked to be 20 cm apart in opposite directions; the whole surface is free to follow.
  const Triangle& triangle = figure_.topology()->triangles.front();
  const auto place = [&](std::size_t k) -> Vector3d {
    return source_.row(triangle[k]).cast<double>().transpose();
  };
  for (const double weight : {1.0, 3.0}) {
    const PoseFit result =
        fit({{.vertex = triangle[0], .target = place(0) + Vector3d(0, 0.1, 0), .weight = weight},
             {.vertex = triangle[1], .target = place(1) - Vector3d(0, 0.1, 0), .weight = 1.0}},
            {.pull = 10.0});
    const Positions positions = posed(result.pose, Skinning::linear);
    const auto moved = [&](std::size_t k) -> Vector3d {
      return positions.row(triangle[k]).cast<double>().transpose() - place(k);
    };
    // The mean of the pair, by squared weights, is met.
    const double share = weight * weight / (weight * weight + 1.0);
    const Vector3d mean = share * moved(0) + (1.0 - share) * moved(1);
    EXPECT_LT((mean - Vector3d(0, 0.1 * (2.0 * share - 1.0), 0)).norm(), 1e-3);
  }
}

TEST_F(PoseFits, TakeAllVerticesAsConstraints) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(source_.rows()));
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<std::int32_t>(v);
  const Positions target = posed(truth("jog", 20), Skinning::linear);
  const PoseFit result = fit(on(all, target), {.pull = 1e-5});
  EXPECT_LT(test::largest_distance(posed(result.pose, Skinning::linear), target), 1e-4);
}

TEST_F(PoseFits, RefuseWhatDoesNotFit) {
  const auto refusal = [&](const Constraints& constraints, const PoseFitOptions& options) -> std::string {
    try {
      fit(constraints, options);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({{.vertex = -1}}, {}), HasSubstr("vertex -1"));
  EXPECT_THAT(refusal({}, {.pull = 0.0}), HasSubstr("pull"));
  EXPECT_THAT(refusal({}, {.most_iterations = 0}), HasSubstr("most_iterations"));
  EXPECT_THAT(refusal({}, {.tolerance = std::numeric_limits<double>::quiet_NaN()}), HasSubstr("tolerance"));
  EXPECT_THROW(fit_pose(SkinWeights(3, 2), skeleton_, test::view(source_), source_pose_, {}),
               InvalidArgument);
  EXPECT_THROW(fit_pose(weights_, skeleton_, test::view(source_), {}, {}), InvalidArgument);
}

// Two tubes with a skeleton each: every root moves on its own.
TEST(PoseFitsOfTwoSkeletons, MoveEachByItsOwnConstraints) {
  Topology topology;
  Markup markup;
  test::add_tube(topology, markup.reference, 0.1, -1.0, 1.0, 31);
  const std::int32_t left_count = topology.vertex_count;
  test::add_tube(topology, markup.reference, 0.1, -1.0, 1.0, 31, {1.0, 0.0, 0.0});
  markup.joint_of_vertex.assign(static_cast<std::size_t>(topology.vertex_count), -1);
  markup.skeleton.joints = {{.name = "left", .parent = -1, .rest_position = {0, -1, 0}},
                            {.name = "left_top", .parent = 0, .rest_position = {0, 0, 0}},
                            {.name = "right", .parent = -1, .rest_position = {1, -1, 0}},
                            {.name = "right_top", .parent = 2, .rest_position = {1, 0, 0}}};
  const SkinWeights weights = skin_weights(std::make_shared<const Topology>(topology), markup);
  SkeletonPose target = rest_pose(markup.skeleton);
  target.rotation[2] = turn(0.5, Vector3d::UnitZ());
  target.position[2] += Vector3d(0.5, 0.0, 0.2);
  target.rotation[3] = turn(1.0, Vector3d::UnitX()) * target.rotation[2];
  target.position[3] = target.position[2] + target.rotation[2] * Vector3d(0, 1, 0);
  const Positions positions = test::skinned(weights, markup.skeleton, markup.reference,
                                            rest_pose(markup.skeleton), target, Skinning::linear);
  Constraints constraints;
  for (std::int32_t v = 0; v < topology.vertex_count; v += 37) {
    constraints.push_back({.vertex = v, .target = positions.row(v).cast<double>().transpose()});
  }
  ASSERT_LT(constraints.front().vertex, left_count);
  const PoseFit result = fit_pose(weights, markup.skeleton, test::view(markup.reference),
                                  rest_pose(markup.skeleton), constraints, {.pull = 1e-5});
  for (std::size_t j = 0; j < target.rotation.size(); ++j) {
    EXPECT_LT(result.pose.rotation[j].angularDistance(target.rotation[j]), 1e-4) << j;
    EXPECT_LT((result.pose.position[j] - target.position[j]).norm(), 1e-4) << j;
  }
}

// The analytic derivatives against central differences.
TEST_F(PoseFits, KnowHowVerticesMove) {
  const SkeletonPose pose = truth("jog", 20);
  constexpr double step = 1e-5;
  for (const Skinning skinning : skinnings) {
    const PosedVertices vertices(weights_, skeleton_, test::view(source_), source_pose_, spread_, skinning);
    std::vector<std::vector<PosedVertices::Motion>> motions;
    vertices.derivatives(pose, motions);
    for (int j = 0; j < skeleton_.size(); ++j) {
      // The joint and all below it.
      std::vector<bool> moves(static_cast<std::size_t>(skeleton_.size()), false);
      for (int k = j; k < skeleton_.size(); ++k) {
        const int parent = skeleton_.joints[static_cast<std::size_t>(k)].parent;
        moves[static_cast<std::size_t>(k)] =
            k == j || (parent >= 0 && moves[static_cast<std::size_t>(parent)]);
      }
      for (int axis = 0; axis < 6; ++axis) {
        const auto places = [&](double by) {
          const bool is_turn = axis < 3;
          const Quaterniond q = is_turn ? turn(by, Vector3d::Unit(axis)) : Quaterniond::Identity();
          const Vector3d shift = is_turn ? Vector3d::Zero() : Vector3d(by * Vector3d::Unit(axis - 3));
          SkeletonPose changed = pose;
          const Vector3d pivot = pose.position[static_cast<std::size_t>(j)];
          for (std::size_t k = 0; k < moves.size(); ++k) {
            if (!moves[k]) continue;
            changed.rotation[k] = q * pose.rotation[k];
            changed.position[k] = q * (pose.position[k] - pivot) + pivot + shift;
          }
          return vertices.positions(changed);
        };
        const std::vector<Vector3d> plus = places(step), minus = places(-step);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
          const auto& joints = vertices.joints(i);
          const auto found = std::find(joints.begin(), joints.end(), j);
          Vector3d analytic = Vector3d::Zero();
          if (found != joints.end()) {
            const PosedVertices::Motion& motion =
                motions[i][static_cast<std::size_t>(found - joints.begin())];
            analytic = axis < 3 ? motion.turn.col(axis) : motion.shift.col(axis - 3);
          }
          EXPECT_LT(((plus[i] - minus[i]) / (2.0 * step) - analytic).norm(), 1e-8) << j << " " << axis;
        }
      }
    }
  }
}

}  // namespace
}  // namespace reprise
