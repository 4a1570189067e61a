// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/dressed_body.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/body/makehuman.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;

// Fitting takes a second: each costume once.
const DressedBody& dressed(const std::string& costume) {
  static std::map<std::string, DressedBody> bodies;
  const auto found = bodies.find(costume);
  if (found != bodies.end()) return found->second;
  return bodies.emplace(costume, DressedBody(load_costume(costume), {})).first->second;
}

// The joint and all below it turned about the joint.
SkeletonPose turned(const Skeleton& skeleton, const std::string& joint, const Quaterniond& turn) {
  const int turned_idx = skeleton.joint_idx(joint);
  std::vector<Quaterniond> rotations(static_cast<std::size_t>(skeleton.size()), Quaterniond::Identity());
  for (int j = 0; j < skeleton.size(); ++j) {
    for (int above = j; above >= 0; above = skeleton.joints[static_cast<std::size_t>(above)].parent) {
      if (above == turned_idx) rotations[static_cast<std::size_t>(j)] = turn;
    }
  }
  return pose_from_rotations(skeleton, rotations, skeleton.joints.front().rest_position);
}

TEST(DressedBody, LayersAreSoundMeshesStandingOnTheGround) {
  REPRISE_REQUIRE_MAKEHUMAN();
  for (const std::string& name : builtin_costume_names()) {
    SCOPED_TRACE(name);
    const DressedBody& body = dressed(name);
    std::map<BodyLayer::Kind, int> kinds;
    double lowest = 1e9, highest = -1e9;
    for (const BodyLayer& layer : body.layers()) {
      SCOPED_TRACE(layer.name);
      ++kinds[layer.kind];
      Topology topology{static_cast<std::int32_t>(layer.points.rows()), layer.triangles, layer.uvs,
                        layer.triangle_uvs, std::make_shared<Image>(layer.texture)};
      EXPECT_NO_THROW(validate(topology));
      EXPECT_TRUE(layer.points.allFinite());
      const auto count = static_cast<std::size_t>(layer.points.rows());
      const std::size_t pixels = layer.texture.rgb.size() / 3;
      EXPECT_TRUE(layer.alpha.empty() || layer.alpha.size() == pixels);
      EXPECT_TRUE(layer.hidden.empty() || layer.hidden.size() == layer.triangles.size());
      EXPECT_TRUE(layer.freedom.empty() || layer.freedom.size() == count);
      for (const double freedom : layer.freedom) ASSERT_TRUE(freedom >= 0.0 && freedom <= 1.0) << freedom;
      std::vector<bool> used(count, false);
      for (const Triangle& t : layer.triangles) {
        for (const std::int32_t corner : t) used[static_cast<std::size_t>(corner)] = true;
      }
      EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "vertices without a triangle";
      lowest = std::min(lowest, layer.points.col(1).minCoeff());
      highest = std::max(highest, layer.points.col(1).maxCoeff());
      if (layer.kind == BodyLayer::Kind::shoes) {
        EXPECT_NEAR(layer.points.col(1).minCoeff(), 0.0, 5e-5);  // the package's weights have five digits
      }
    }
    EXPECT_EQ(kinds[BodyLayer::Kind::skin], 1);
    EXPECT_EQ(kinds[BodyLayer::Kind::hair], 1);
    EXPECT_EQ(kinds[BodyLayer::Kind::shoes], 1);
    EXPECT_GE(kinds[BodyLayer::Kind::garment], 1);
    EXPECT_GE(lowest, -0.002);
    EXPECT_GT(highest, 1.5);
    EXPECT_LT(highest, 1.8);
  }
}

TEST(DressedBody, OneSkeletonWithLeftOnPlusX) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const Skeleton& first = dressed("character1").skeleton();
  ASSERT_EQ(first.size(), 21);
  for (const std::string& name : builtin_costume_names()) {
    const Skeleton& skeleton = dressed(name).skeleton();
    ASSERT_EQ(skeleton.size(), first.size());
    const double sole = skeleton.joints[0].rest_position.y() - first.joints[0].rest_position.y();
    EXPECT_LT(std::abs(sole), 0.03);
    for (int j = 0; j < first.size(); ++j) {
      const Joint& joint = skeleton.joints[static_cast<std::size_t>(j)];
      const Joint& same = first.joints[static_cast<std::size_t>(j)];
      EXPECT_EQ(joint.name, same.name);
      EXPECT_LT((joint.rest_position - same.rest_position - Vector3d(0, sole, 0)).norm(), 1e-9);
      if (joint.name.starts_with("left_")) {
        const Joint& right =
            skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx("right_" + joint.name.substr(5)))];
        EXPECT_GT(joint.rest_position.x(), 0.0);
        EXPECT_LT((joint.rest_position - right.rest_position.cwiseProduct(Vector3d(-1, 1, 1))).norm(), 2e-3)
            << joint.name;
      }
    }
  }
}

TEST(DressedBody, TheRestPoseLeavesEverythingInPlace) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& body = dressed("fashion2");
  const SkeletonPose rest = rest_pose(body.skeleton());
  for (std::size_t l = 0; l < body.layers().size(); ++l) {
    EXPECT_LT((body.skin(l, rest) - body.layers()[l].points).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(DressedBody, ARigidMotionOfAllJointsMovesEverythingRigidly) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& body = dressed("fashion1");
  const Quaterniond turn(AngleAxisd(2.3, Vector3d(0.3, -0.8, 0.5).normalized()));
  const Vector3d shift(1.5, -0.3, 7.0);
  SkeletonPose pose = rest_pose(body.skeleton());
  for (std::size_t j = 0; j < pose.rotation.size(); ++j) {
    // Both quaternions of a rotation are the same pose.
    pose.rotation[j] = turn;
    if (j % 2 == 1) pose.rotation[j].coeffs() *= -1.0;
    pose.position[j] = turn * pose.position[j] + shift;
  }
  for (std::size_t l = 0; l < body.layers().size(); ++l) {
    const Points skinned = body.skin(l, pose);
    const Points& rest = body.layers()[l].points;
    double worst = 0.0;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const Vector3d expected = turn * rest.row(v).transpose() + shift;
      worst = std::max(worst, (skinned.row(v).transpose() - expected).norm());
    }
    EXPECT_LT(worst, 1e-9) << body.layers()[l].name;
  }
}

TEST(DressedBody, AnArmMovesAlone) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& body = dressed("character1");
  const Skeleton& skeleton = body.skeleton();
  const SkeletonPose pose =
      turned(skeleton, "left_forearm", Quaterniond(AngleAxisd(1.9, Vector3d(0.5, -0.3, -0.8).normalized())));
  const Points skinned = body.skin(0, pose);
  const Points& rest = body.layers()[0].points;
  const auto hand = static_cast<std::size_t>(skeleton.joint_idx("left_hand"));
  int hand_count = 0;
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const std::string& joint =
        skeleton.joints[static_cast<std::size_t>(body.dominant_joints(0)[static_cast<std::size_t>(v)])].name;
    const double moved = (skinned.row(v) - rest.row(v)).norm();
    if (!joint.starts_with("left_")) {
      ASSERT_LT(moved, 1e-3) << joint;
    }
    // Beyond the wrist the hand is stiff.
    if (joint == "left_hand" &&
        (rest.row(v).transpose() - skeleton.joints[hand].rest_position).norm() > 0.06) {
      ++hand_count;
      const Vector3d x = rest.row(v).transpose();
      const Vector3d stiff =
          pose.rotation[hand] * (x - skeleton.joints[hand].rest_position) + pose.position[hand];
      ASSERT_LT((skinned.row(v).transpose() - stiff).norm(), 0.004);
    }
  }
  EXPECT_GT(hand_count, 300);
}

TEST(DressedBody, BentAndTwistedLimbsDoNotCollapse) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& body = dressed("character1");
  const Skeleton& skeleton = body.skeleton();
  // The volume of a closed mesh as the sum of signed tetrahedra; skin has its openings only at the eyes.
  const auto volume = [&](const Points& points) {
    double sum = 0.0;
    for (const Triangle& t : body.layers()[0].triangles) {
      const Vector3d a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
      sum += a.dot(b.cross(c)) / 6.0;
    }
    return sum;
  };
  const auto direction = [&](const std::string& from, const std::string& to) {
    return Vector3d((skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx(to))].rest_position -
                     skeleton.joints[static_cast<std::size_t>(skeleton.joint_idx(from))].rest_position)
                        .normalized());
  };
  const double rest = volume(body.layers()[0].points);
  constexpr double degree = std::numbers::pi / 180.0;
  const Vector3d arm = direction("left_forearm", "left_hand");
  const std::vector<std::pair<std::string, Quaterniond>> turns = {
      {"left_forearm", Quaterniond(AngleAxisd(110 * degree, arm.cross(Vector3d::UnitZ()).normalized()))},
      {"left_hand", Quaterniond(AngleAxisd(90 * degree, arm))},
      {"left_shin", Quaterniond(AngleAxisd(110 * degree, Vector3d::UnitX()))},
      {"left_thigh", Quaterniond(AngleAxisd(-90 * degree, Vector3d::UnitX()))},
      {"chest", Quaterniond(AngleAxisd(40 * degree, Vector3d::UnitY()))},
      {"head", Quaterniond(AngleAxisd(60 * degree, Vector3d::UnitY()))},
  };
  for (const auto& [joint, turn] : turns) {
    EXPECT_NEAR(volume(body.skin(0, turned(skeleton, joint, turn))) / rest, 1.0, 0.03) << joint;
  }
}

TEST(DressedBody, SkirtsHangFromTheWaistAndHairFromTheHead) {
  REPRISE_REQUIRE_MAKEHUMAN();
  for (const std::string name : {"fashion1", "fashion2"}) {
    for (const BodyLayer& layer : dressed(name).layers()) {
      if (layer.freedom.empty()) continue;
      SCOPED_TRACE(name + " " + layer.name);
      Eigen::Index top = 0, bottom = 0;
      layer.points.col(1).maxCoeff(&top);
      layer.points.col(1).minCoeff(&bottom);
      EXPECT_EQ(layer.freedom[static_cast<std::size_t>(top)], 0.0);
      // Hair is held back a little: it is one surface with the back it lies on.
      EXPECT_GE(layer.freedom[static_cast<std::size_t>(bottom)],
                layer.kind == BodyLayer::Kind::hair ? 0.7 : 1.0);
      if (layer.kind == BodyLayer::Kind::garment) {
        ASSERT_EQ(layer.fullness.size(), layer.freedom.size());
        EXPECT_EQ(layer.fullness[static_cast<std::size_t>(top)], 1.0);
        EXPECT_GT(layer.fullness[static_cast<std::size_t>(bottom)], 1.3);
      }
    }
  }
}

TEST(DressedBody, ClothIsOutsideOfTheSkinAndHidesIt) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& body = dressed("character1");
  const BodyLayer& skin = body.layers()[0];
  // Head and hands are seen, thighs and belly under jeans and shirt are not.
  int seen_head = 0, hidden_head = 0, seen_thigh = 0, hidden_thigh = 0;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const std::string& joint = body.skeleton()
                                   .joints[static_cast<std::size_t>(body.dominant_joints(
                                       0)[static_cast<std::size_t>(skin.triangles[t][0])])]
                                   .name;
    if (joint == "head" || joint == "left_hand") ++(skin.hidden[t] ? hidden_head : seen_head);
    if (joint == "left_thigh") ++(skin.hidden[t] ? hidden_thigh : seen_thigh);
  }
  EXPECT_EQ(hidden_head, 0);
  EXPECT_GT(seen_head, 1000);
  EXPECT_GT(hidden_thigh, 10 * seen_thigh);
}

TEST(DressedBody, TheSameCostumeGivesTheSameBody) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const DressedBody& first = dressed("fashion1");
  const DressedBody second(load_costume("fashion1"), {});
  ASSERT_EQ(first.layers().size(), second.layers().size());
  for (std::size_t l = 0; l < first.layers().size(); ++l) {
    const BodyLayer& a = first.layers()[l];
    const BodyLayer& b = second.layers()[l];
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.texture, b.texture);
    EXPECT_EQ(a.freedom, b.freedom);
    EXPECT_EQ(a.hidden, b.hidden);
  }
}

TEST(DressedBody, UnknownNamesAndPosesOfOthersAreRefused) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const auto message_with = [](const std::function<void(Costume&)>& change) {
    Costume costume = load_costume("character1");
    change(costume);
    try {
      const DressedBody body(costume, {});
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message_with([](Costume& c) { c.garments[0].proxy = "Tightjean"; }), HasSubstr("'Tightjeans'"));
  EXPECT_THAT(message_with([](Costume& c) { c.hair.proxy = "long02"; }), HasSubstr("'long01'"));
  EXPECT_THAT(message_with([](Costume& c) { c.eye_color = "red"; }), HasSubstr("brown"));
  EXPECT_THAT(message_with([](Costume& c) { c.body["nowhere"] = 1.0; }), HasSubstr("'nowhere'"));
  EXPECT_THROW(dressed("character1").skin(0, SkeletonPose{}), InvalidArgument);
}

}  // namespace
}  // namespace reprise
