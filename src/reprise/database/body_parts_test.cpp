// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/body_parts.h"

#include <algorithm>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::ThrowsMessage;

constexpr int around = 12;
constexpr int along = 101;  // rings, a centimetre apart

// A tube of 1 m along +Y: torso below 0.4 m, a stretch without labels up to 0.6 m, one arm above.
struct Tube {
  Tube() : positions(around * along, 3), joints(around * along) {
    topology.vertex_count = around * along;
    for (int ring = 0; ring < along; ++ring) {
      for (int k = 0; k < around; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / around;
        const int v = ring * around + k;
        positions.row(v) << static_cast<float>(0.05 * std::cos(angle)), static_cast<float>(0.01 * ring),
            static_cast<float>(0.05 * std::sin(angle));
        joints[static_cast<std::size_t>(v)] = ring < 40 ? 0 : ring < 60 ? -1 : ring < 80 ? 1 : 2;
        if (ring + 1 == along) continue;
        const int next = ring * around + (k + 1) % around;
        topology.triangles.push_back({v, v + around, next});
        topology.triangles.push_back({next, v + around, next + around});
      }
    }
    skeleton.joints = {{.name = "pelvis", .parent = -1, .rest_position = {0, 0, 0}},
                       {.name = "left_upper_arm", .parent = 0, .rest_position = {0, 0.6, 0}},
                       {.name = "left_forearm", .parent = 1, .rest_position = {0, 0.8, 0}}};
  }
  // Lowest and highest ring of a part.
  static std::pair<int, int> rings(const BodyPart& part) {
    return {part.vertices.front() / around, part.vertices.back() / around};
  }

  Topology topology;
  Positions positions;
  std::vector<std::int32_t> joints;
  Skeleton skeleton;
};

TEST(BodyParts, FormATreeBelowTheTorsoAndHoldEveryVertex) {
  const Tube tube;
  const auto parts = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].name, "torso");
  EXPECT_EQ(parts[0].parent, -1);
  EXPECT_EQ(parts[1].name, "left_arm");
  EXPECT_EQ(parts[1].parent, 0);
  std::set<std::int32_t> all;
  for (const BodyPart& part : parts) {
    EXPECT_TRUE(std::is_sorted(part.vertices.begin(), part.vertices.end()));
    all.insert(part.vertices.begin(), part.vertices.end());
  }
  EXPECT_EQ(static_cast<int>(all.size()), tube.topology.vertex_count);
}

TEST(BodyParts, OverlapIsLargerWhereTheSurfaceIsFree) {
  const Tube tube;
  // The border lies in the middle of the free stretch, at ring 50: 10 rings of it on either side.
  const BodyPartOptions options{.overlap = 0.05, .free_overlap = 0.05};
  const auto even = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, options);
  EXPECT_NEAR(Tube::rings(even[0]).second, 54, 1);
  EXPECT_NEAR(Tube::rings(even[1]).first, 45, 1);
  const auto wide = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints,
                               {.overlap = 0.05, .free_overlap = 0.20});
  // A quarter of the overlap is spent on 10 free rings, the rest beyond them.
  EXPECT_GE(Tube::rings(wide[0]).second, 60);
  EXPECT_LE(Tube::rings(wide[1]).first, 39);
}

TEST(BodyParts, BadLabelsAreRefused) {
  Tube tube;
  tube.joints[5] = 3;
  EXPECT_THAT([&] { body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints); },
              ::testing::ThrowsMessage<InvalidArgument>(::testing::HasSubstr("vertex 5")));
  std::fill(tube.joints.begin(), tube.joints.end(), -1);
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints), InvalidArgument);
  tube.joints.pop_back();
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints), InvalidArgument);
}

// Names and parents, in order.
std::vector<std::pair<std::string, std::string>> tree_of(const std::vector<BodyPart>& parts) {
  std::vector<std::pair<std::string, std::string>> tree;
  for (const BodyPart& part : parts)
    tree.emplace_back(part.name, part.parent < 0 ? "" : parts[static_cast<std::size_t>(part.parent)].name);
  return tree;
}

TEST(BodyParts, TwoLevelsDivideTheLimbs) {
  Tube tube;
  const auto parts = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, {.levels = 2});
  EXPECT_THAT(tree_of(parts), ElementsAre(Pair("torso", ""), Pair("left_upper_arm", "torso"),
                                          Pair("left_forearm", "left_upper_arm")));
  // The arm of one level is what the two are together.
  const auto one_level = body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints);
  std::set<std::int32_t> arm(parts[1].vertices.begin(), parts[1].vertices.end());
  arm.insert(parts[2].vertices.begin(), parts[2].vertices.end());
  EXPECT_EQ(one_level[0].vertices, parts[0].vertices);
  EXPECT_THAT(one_level[1].vertices, ElementsAreArray(arm));
  // Ring 80 is the elbow, and each reaches 8 rings across.
  EXPECT_NEAR(Tube::rings(parts[1]).second, 87, 1);
  EXPECT_NEAR(Tube::rings(parts[2]).first, 72, 1);
  // A joint that the skeleton lacks is passed over.
  tube.skeleton.joints[1].name = "left_collar";
  EXPECT_THAT(tree_of(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, {.levels = 2})),
              ElementsAre(Pair("torso", ""), Pair("left_forearm", "torso")));
  // So is a part whose joints no vertex follows.
  tube.skeleton.joints[1].name = "left_upper_arm";
  for (std::int32_t& joint : tube.joints) joint = joint == 1 ? 0 : joint;
  EXPECT_THAT(tree_of(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, {.levels = 2})),
              ElementsAre(Pair("torso", ""), Pair("left_forearm", "torso")));
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, {.levels = 3}),
               InvalidArgument);
}

TEST(BodyParts, OfAHumanSkeleton) {
  Skeleton skeleton;
  for (const char* name : {"pelvis", "neck", "left_upper_arm", "left_forearm", "left_hand", "right_upper_arm",
                           "right_forearm", "right_hand", "left_thigh", "left_shin", "left_foot", "left_toe",
                           "right_thigh", "right_shin", "right_foot"}) {
    skeleton.joints.push_back(
        {.name = name, .parent = skeleton.joints.empty() ? -1 : 0, .rest_position = {0, 0, 0}});
  }
  const auto names = [&](int levels) {
    std::vector<std::string> made;
    for (const JointPart& part : human_parts(skeleton, levels)) made.push_back(part.name);
    return made;
  };
  EXPECT_THAT(names(1), ElementsAre("torso", "head", "left_arm", "right_arm", "left_leg", "right_leg"));
  EXPECT_THAT(names(2), ElementsAre("torso", "head", "left_upper_arm", "left_forearm", "left_hand",
                                    "right_upper_arm", "right_forearm", "right_hand", "left_thigh",
                                    "left_shin", "left_foot", "right_thigh", "right_shin", "right_foot"));
}

TEST(BodyParts, AnyTreeOfJoints) {
  const Tube tube;
  const std::vector<JointPart> tail = {{.name = "horse", .parent = "", .joints = {}},
                                       {.name = "tail", .parent = "horse", .joints = {"left_forearm"}}};
  const auto parts = parts_of_joints(tube.topology, tube.positions, tube.skeleton, tube.joints, tail);
  EXPECT_THAT(tree_of(parts), ElementsAre(Pair("horse", ""), Pair("tail", "horse")));
  EXPECT_NEAR(Tube::rings(parts[1]).first, 72, 1);

  const BodyPart body = whole_body_part(tube.topology.vertex_count);
  EXPECT_EQ(body.vertices.size(), tube.joints.size());
  EXPECT_NO_THROW(validate({body}, tube.topology.vertex_count));
  EXPECT_THROW(whole_body_part(0), InvalidArgument);
}

TEST(BodyParts, BadTreesAreRefused) {
  const Tube tube;
  const auto expect_refused = [&](const std::vector<JointPart>& parts, const std::string& what) {
    EXPECT_THAT([&] { parts_of_joints(tube.topology, tube.positions, tube.skeleton, tube.joints, parts); },
                ThrowsMessage<InvalidArgument>(HasSubstr(what)));
  };
  const JointPart root{.name = "torso", .parent = "", .joints = {}};
  const auto arm = [](const std::string& name, const std::string& parent, const std::string& joint) {
    return JointPart{.name = name, .parent = parent, .joints = {joint}};
  };
  expect_refused({}, "no part is given");
  expect_refused({arm("arm", "torso", "left_upper_arm")}, "'arm' has the parent 'torso' and 1 joints");
  expect_refused({arm("torso", "", "pelvis")}, "'torso' has no parent and 1 joints");
  expect_refused({root, {.name = "arm", .parent = "torso", .joints = {}}}, "and 0 joints");
  expect_refused({root, arm("arm", "body", "left_upper_arm")}, "'arm' has the parent 'body'");
  expect_refused({root, arm("torso", "torso", "left_upper_arm")}, "two parts named 'torso'");
  expect_refused({root, arm("", "torso", "left_upper_arm")}, "part 1 has no name");
  expect_refused({root, arm("arm", "torso", "left_uper_arm")}, "did you mean 'left_upper_arm'");
  expect_refused({root, arm("a", "torso", "left_forearm"), arm("b", "a", "left_forearm")},
                 "'a' and 'b' both name the joint 'left_forearm'");
  EXPECT_THROW(body_parts(tube.topology, tube.positions, tube.skeleton, tube.joints, {.overlap = 0.0}),
               InvalidArgument);
}

}  // namespace
}  // namespace reprise
