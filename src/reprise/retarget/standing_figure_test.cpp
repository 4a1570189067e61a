// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/standing_figure.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/retarget/retarget_test_support.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::bowing;
using test::joint;
using test::rebased;
using test::standing_woman;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double radians_per_degree = std::numbers::pi / 180.0;

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// What a standing skeleton is: upright, facing +Z, ankles over feet that point ahead, knees straight.
void expect_stands(const Skeleton& standing, double ankle_height, double tolerance) {
  const auto at = [&](const std::string& name) {
    return standing.joints[joint(standing, name)].rest_position;
  };
  const Vector3d hips = 0.5 * (at("left_thigh") + at("right_thigh"));
  EXPECT_LT(angle_between(at("neck") - hips, Vector3d::UnitY()), 4.0 * radians_per_degree);
  EXPECT_LT(angle_between(at("left_thigh") - at("right_thigh"), Vector3d::UnitX()), 5.0 * radians_per_degree);
  for (const std::string side : {"left_", "right_"}) {
    EXPECT_NEAR(at(side + "foot").y(), ankle_height, tolerance) << side;
    const Vector3d foot = at(side + "toe") - at(side + "foot");
    EXPECT_GT(foot.z(), 0.08) << side;
    EXPECT_LT(std::abs(foot.x()), 0.2 * foot.z()) << side;
    EXPECT_LT(angle_between(at(side + "shin") - at(side + "thigh"), at(side + "foot") - at(side + "shin")),
              12.0 * radians_per_degree)
        << side;
  }
}

TEST(StandingFigure, ARestPoseThatStandsIsTakenAsItIs) {
  const Skeleton woman = standing_woman();
  const StandingFigure figure(woman, {});
  EXPECT_TRUE(figure.rest_pose_stands());
  ASSERT_EQ(figure.standing().size(), woman.size());
  for (std::size_t j = 0; j < woman.joints.size(); ++j) {
    EXPECT_EQ(figure.standing().joints[j].name, woman.joints[j].name);
    EXPECT_EQ(figure.standing().joints[j].parent, woman.joints[j].parent);
    EXPECT_EQ(figure.standing().joints[j].rest_position, woman.joints[j].rest_position);
  }
  for (const SkeletonPose& pose : bowing(woman, 20, 25.0).frames) {
    EXPECT_LT(test::greatest_distance(figure.own_pose(pose), pose), 1e-7);
    EXPECT_LT(test::greatest_distance(figure.standing_pose(pose), pose), 1e-7);
  }
}

// Turned, away from the origin, with other joints between and around: the same standing figure.
TEST(StandingFigure, PlaceHeadingAndOtherJointsDoNotMatter) {
  const Skeleton woman = standing_woman();
  const Quaterniond turn(AngleAxisd(-1.5, Vector3d::UnitY()));
  Skeleton other;
  other.joints.push_back({"world", -1, {0.3, 0.0, 5.0}});
  for (const Joint& own : woman.joints) {
    const std::string parent =
        own.parent < 0 ? "world" : woman.joints[static_cast<std::size_t>(own.parent)].name;
    const Vector3d position = turn * own.rest_position + Vector3d(1.1, 0.0, -0.4);
    int above = other.joint_idx(parent);
    if (own.name == "left_shin") {
      other.joints.push_back({"left_thigh_twist", above, position + Vector3d(0.0, 0.2, 0.0)});
      above = other.size() - 1;
    }
    other.joints.push_back({own.name, above, position});
  }
  const StandingFigure figure(other, {});
  EXPECT_TRUE(figure.rest_pose_stands());
  const Vector3d pelvis = woman.joints[0].rest_position;
  for (std::size_t j = 0; j < woman.joints.size(); ++j) {
    if (woman.joints[j].name.ends_with("toe")) continue;  // feet are turned to point ahead
    const Vector3d expected = woman.joints[j].rest_position - Vector3d(pelvis.x(), 0.0, pelvis.z());
    EXPECT_LT((figure.standing().joints[j].rest_position - expected).norm(), 0.005) << woman.joints[j].name;
  }
  expect_stands(figure.standing(), 0.069, 1e-6);
  // Every joint that stands for a body joint is where the standing figure has it, the others go along, and
  // the way back is the way there.
  for (const SkeletonPose& pose : bowing(figure.standing(), 20, 25.0).frames) {
    const SkeletonPose own = figure.own_pose(pose);
    for (std::size_t j = 0; j < woman.joints.size(); ++j) {
      EXPECT_LT((own.position[joint(other, woman.joints[j].name)] - pose.position[j]).norm(), 1e-9);
    }
    EXPECT_LT(own.rotation[joint(other, "left_thigh_twist")].angularDistance(
                  own.rotation[joint(other, "left_thigh")]),
              1e-6);
    EXPECT_LT(test::greatest_distance(figure.standing_pose(own), pose), 1e-6);
  }
}

// Marked on a frame in the middle of a movement: what straight and flat is comes from the motion.
TEST(StandingFigure, IsFoundInMotionsWhenTheRestPoseDoesNotStand) {
  const Skeleton woman = standing_woman();
  const SkeletalMotion truth = bowing(woman, 200, 25.0);
  // Deep in a bow, seen from the side.
  std::size_t deepest = 0;
  for (std::size_t f = 0; f < truth.frames.size(); ++f) {
    if (truth.frames[f].position[0].y() + 0.05 * truth.frames[f].rotation[joint(woman, "chest")].x() <
        truth.frames[deepest].position[0].y() +
            0.05 * truth.frames[deepest].rotation[joint(woman, "chest")].x()) {
      deepest = f;
    }
  }
  const Quaterniond turn(AngleAxisd(2.0, Vector3d::UnitY()));
  const SkeletalMotion seen = rebased(test::moved(truth, turn, 1.0, {3.0, 0.0, 1.0}), deepest);
  const StandingFigure figure(seen.skeleton, std::vector<SkeletalMotion>{seen});
  ASSERT_FALSE(figure.rest_pose_stands());
  expect_stands(figure.standing(), 0.069, 0.003);
  // Bones have their lengths.
  for (std::size_t j = 1; j < woman.joints.size(); ++j) {
    const auto p = static_cast<std::size_t>(woman.joints[j].parent);
    const Skeleton& standing = figure.standing();
    EXPECT_NEAR((standing.joints[j].rest_position - standing.joints[p].rest_position).norm(),
                (woman.joints[j].rest_position - woman.joints[p].rest_position).norm(), 1e-9)
        << woman.joints[j].name;
  }
  // Its poses are those of the body whose rest pose is known, but for what "standing" leaves open: how bent
  // knees and elbows are, and where arms hang, at rest.
  for (const std::size_t f : {std::size_t{0}, std::size_t{50}, std::size_t{120}, std::size_t{199}}) {
    const SkeletonPose pose = figure.standing_pose(seen.frames[f]);
    for (const char* name : {"pelvis", "spine", "chest", "neck", "left_collar", "head", "left_foot",
                             "right_foot", "left_toe", "right_toe"}) {
      const std::size_t j = joint(woman, name);
      const Quaterniond expected = turn * truth.frames[f].rotation[j];
      const bool is_foot = std::string(name).ends_with("foot") || std::string(name).ends_with("toe");
      // Feet point ahead at rest; the woman's are turned in by 10 degrees.
      EXPECT_LT(pose.rotation[j].angularDistance(expected) / radians_per_degree, is_foot ? 12.0 : 8.0)
          << name << " " << f;
    }
    // The knee bends about the standing figure's X.
    for (const std::string side : {"left_", "right_"}) {
      const auto at = [&](const std::string& name) { return pose.position[joint(woman, side + name)]; };
      const Vector3d hinge = (at("shin") - at("thigh")).cross(at("foot") - at("shin"));
      const Vector3d own_axis = pose.rotation[joint(woman, side + "thigh")] * Vector3d::UnitX();
      if (hinge.norm() > 0.03) {
        EXPECT_LT(angle_between(hinge, own_axis), 10.0 * radians_per_degree);
      }
    }
    EXPECT_LT(test::greatest_distance(figure.own_pose(pose), seen.frames[f]), 1e-6);
  }
}

TEST(StandingFigure, SolesThatTheSurfaceShowsAreTheGround) {
  const Skeleton woman = standing_woman();
  Skeleton raised = woman;
  for (Joint& joint : raised.joints) joint.rest_position.y() += 0.03;
  const StandingFigure figure(raised, {}, "the woman", std::array<double, 2>{0.03, 0.03});
  for (const char* joint : {"left_foot", "right_foot", "left_toe", "head"}) {
    const auto j = static_cast<std::size_t>(woman.joint_idx(joint));
    EXPECT_NEAR(figure.standing().joints[j].rest_position.y(), woman.joints[j].rest_position.y(), 1e-9)
        << joint;
  }
  // Marked on uneven ground: both ankles stand as high over their own soles.
  const StandingFigure uneven(woman, {}, "the woman", std::array<double, 2>{0.0, 0.025});
  const auto left = static_cast<std::size_t>(woman.joint_idx("left_foot"));
  const auto right = static_cast<std::size_t>(woman.joint_idx("right_foot"));
  EXPECT_NEAR(uneven.standing().joints[left].rest_position.y(), woman.joints[left].rest_position.y(), 1e-3);
  EXPECT_NEAR(uneven.standing().joints[right].rest_position.y(),
              woman.joints[right].rest_position.y() - 0.025, 1e-3);
}

TEST(StandingFigure, JointsThatTheCharacterLacksStandWhereTheyWouldBe) {
  const Skeleton woman = standing_woman();
  Skeleton plain;
  std::vector<int> now;
  for (const Joint& own : woman.joints) {
    const int parent = own.parent < 0 ? -1 : now[static_cast<std::size_t>(own.parent)];
    const bool left_out = own.name == "spine" || own.name == "neck" || own.name.ends_with("collar") ||
                          own.name.ends_with("toe") || own.name.ends_with("hand");
    now.push_back(left_out ? parent : plain.size());
    if (!left_out) plain.joints.push_back({own.name, parent, own.rest_position});
  }
  const StandingFigure figure(plain, {});
  EXPECT_THAT(figure.map().missing, ::testing::SizeIs(8));
  for (std::size_t j = 0; j < woman.joints.size(); ++j) {
    // How an elbow is bent at rest cannot be known without a hand.
    const double near = woman.joints[j].name.ends_with("hand") ? 0.15 : 0.1;
    EXPECT_LT((figure.standing().joints[j].rest_position - woman.joints[j].rest_position).norm(), near)
        << woman.joints[j].name;
  }
  // What it has goes where the whole body's goes.
  for (const SkeletonPose& pose : bowing(woman, 20, 25.0).frames) {
    const SkeletonPose own = figure.own_pose(pose);
    for (const char* name : {"pelvis", "left_shin", "right_foot"}) {
      EXPECT_LT((own.position[joint(plain, name)] - pose.position[joint(woman, name)]).norm(), 1e-9) << name;
    }
  }
}

TEST(StandingFigureErrors, SayWhatIsMissing) {
  const SkeletalMotion seen = rebased(bowing(standing_woman(), 100, 25.0), 30);
  EXPECT_THAT([&] { StandingFigure(seen.skeleton, {}, "ama"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("ama: the rest pose does not stand on both feet")));
  // Feet that never stand still: the whole motion on a moving platform.
  SkeletalMotion sliding = seen;
  for (std::size_t f = 0; f < sliding.frames.size(); ++f) {
    for (Vector3d& position : sliding.frames[f].position) position.x() += 0.1 * static_cast<double>(f);
  }
  EXPECT_THAT([&] { StandingFigure(sliding.skeleton, std::vector<SkeletalMotion>{sliding}, "ama"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("foot never stands still")));
  // Poses of another skeleton.
  SkeletalMotion other = seen;
  other.frames[3].position.pop_back();
  EXPECT_THAT([&] { StandingFigure(other.skeleton, std::vector<SkeletalMotion>{other}, "ama"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("frame 3 is no pose")));
  // No person.
  Skeleton chair;
  chair.joints = {{"seat", -1, {0, 0.5, 0}}, {"back", 0, {0, 1, 0}}};
  EXPECT_THAT([&] { StandingFigure(chair, {}, "the chair"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("the chair: no joint map fits")));
}

}  // namespace
}  // namespace reprise
