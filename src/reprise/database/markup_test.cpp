// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/markup.h"

#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

// Five vertices, two bones.
Markup markup() {
  Markup made;
  made.skeleton.joints = {{.name = "hip", .parent = -1, .rest_position = {0, 1, 0}},
                          {.name = "knee", .parent = 0, .rest_position = {0, 0.5, 0}}};
  made.reference = Positions::Zero(5, 3);
  made.joint_of_vertex = {0, 1, -1, 0, 1};
  made.parts = {{.name = "torso", .parent = -1, .vertices = {0, 2, 3}},
                {.name = "leg", .parent = 0, .vertices = {1, 3, 4}}};
  made.layers = {"skin", "shirt"};
  made.layer_of_vertex = {0, 1, 1, 0, 0};
  return made;
}

TEST(Markup, KnowsTheVerticesOfAJoint) {
  EXPECT_THAT(markup().vertices_of_joint(0), ElementsAre(0, 3));
  EXPECT_THAT(markup().vertices_of_joint(1), ElementsAre(1, 4));
  EXPECT_THAT(markup().vertices_of_joint(-1), ElementsAre(2));
  EXPECT_THAT(markup().vertices_of_joint(7), IsEmpty());
}

TEST(Markup, PartsAndLayersAreOptional) {
  EXPECT_NO_THROW(validate(markup(), 5));
  Markup bare = markup();
  bare.parts.clear();
  bare.layers.clear();
  bare.layer_of_vertex.clear();
  EXPECT_NO_THROW(validate(bare, 5));
}

TEST(Markup, SaysWhatDoesNotFit) {
  const auto expect_refused = [](const std::function<void(Markup&)>& spoil, const std::string& message) {
    Markup spoilt = markup();
    spoil(spoilt);
    EXPECT_THAT([&] { validate(spoilt, 5); }, ThrowsMessage<InvalidArgument>(HasSubstr(message)));
  };
  // No joints.
  expect_refused([](Markup& m) { m.skeleton.joints.clear(); }, "has no joint");
  // A skeleton that is none.
  expect_refused([](Markup& m) { m.skeleton.joints[1].name = "hip"; }, "hip");
  // Counts.
  expect_refused([](Markup& m) { m.reference = Positions::Zero(4, 3); }, "has 4 vertices; expected 5");
  expect_refused([](Markup& m) { m.joint_of_vertex.pop_back(); }, "labels 4 vertices");
  expect_refused([](Markup& m) { m.layer_of_vertex.pop_back(); }, "4 vertices have a layer");
  expect_refused([](Markup& m) { m.layer_of_vertex.clear(); }, "2 layers are named, but 0");
  expect_refused([](Markup& m) { m.layers.clear(); }, "0 layers are named, but 5");
  // A reference that is nowhere.
  expect_refused([](Markup& m) { m.reference(3, 1) = std::numeric_limits<float>::quiet_NaN(); }, "vertex 3");
  // Labels without a joint.
  expect_refused([](Markup& m) { m.joint_of_vertex[2] = 2; }, "vertex 2 is labelled with joint 2");
  expect_refused([](Markup& m) { m.joint_of_vertex[2] = -2; }, "vertex 2 is labelled with joint -2");
  expect_refused([](Markup& m) { m.layer_of_vertex[4] = 2; }, "vertex 4 has the layer 2");
  // Names.
  expect_refused([](Markup& m) { m.parts[1].name.clear(); }, "part 1 has no name");
  expect_refused([](Markup& m) { m.parts[1].name = "torso"; }, "two parts named 'torso'");
  expect_refused([](Markup& m) { m.layers[1].clear(); }, "a layer has no name");
  expect_refused([](Markup& m) { m.layers[1] = "skin"; }, "two layers named 'skin'");
  // Parts that are no tree.
  expect_refused([](Markup& m) { m.parts[1].parent = 1; }, "part 'leg' has the parent 1");
  expect_refused([](Markup& m) { m.parts[1].parent = -1; }, "part 'leg' lacks a parent");
  expect_refused([](Markup& m) { m.parts[0].parent = 1; }, "part 'torso' has the parent 1");
  // Vertices of parts.
  expect_refused([](Markup& m) { m.parts[1].vertices.clear(); }, "part 'leg' holds no vertex");
  expect_refused([](Markup& m) { m.parts[1].vertices = {1, 5}; }, "part 'leg' holds vertex 5");
  expect_refused([](Markup& m) { m.parts[1].vertices = {-1, 1}; }, "part 'leg' holds vertex -1");
  expect_refused([](Markup& m) { m.parts[1].vertices = {3, 1}; }, "holds vertex 1 after 3");
  expect_refused([](Markup& m) { m.parts[1].vertices = {3, 3}; }, "holds vertex 3 after 3");
}

TEST(ClipTruth, SaysWhatDoesNotFit) {
  const Skeleton skeleton = markup().skeleton;
  const SkeletonPose pose{.rotation = {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(0, 1, 0, 0)},
                          .position = {{0, 1, 0}, {0, 0.5, 0}}};
  const ClipTruth truth{.poses = {pose, pose}, .contacts = {{true, false}, {false, false}}};
  EXPECT_NO_THROW(validate(truth, skeleton, 2));
  const auto expect_refused = [&](const std::function<void(ClipTruth&)>& spoil, const std::string& message) {
    ClipTruth spoilt = truth;
    spoil(spoilt);
    EXPECT_THAT([&] { validate(spoilt, skeleton, 2); }, ThrowsMessage<InvalidArgument>(HasSubstr(message)));
  };
  expect_refused([](ClipTruth& t) { t.poses.pop_back(); }, "1 poses and 2 contact entries; expected 2");
  expect_refused([](ClipTruth& t) { t.contacts.pop_back(); }, "2 poses and 1 contact entries; expected 2");
  expect_refused([](ClipTruth& t) { t.poses[1].rotation.pop_back(); }, "frame 1 has 1 rotations");
  expect_refused([](ClipTruth& t) { t.poses[1].position.pop_back(); }, "frame 1 has 2 rotations and 1 pos");
  expect_refused([](ClipTruth& t) { t.poses[1].position[0].x() = NAN; }, "frame 1 has no finite position");
  expect_refused([](ClipTruth& t) { t.poses[0].rotation[1].w() = 0.5; }, "for joint 'knee'");
  expect_refused([](ClipTruth& t) { t.poses[0].rotation[1].w() = NAN; }, "for joint 'knee'");
}

}  // namespace
}  // namespace reprise
