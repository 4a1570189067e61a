// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/part_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::ThrowsMessage;

BodyPart part(const std::string& name, std::vector<std::int32_t> vertices) {
  return {.name = name, .parent = 7, .vertices = std::move(vertices)};  // the parent is not read
}

// Names and parents, in order.
std::vector<std::pair<std::string, std::string>> tree_of(const std::vector<BodyPart>& parts) {
  std::vector<std::pair<std::string, std::string>> tree;
  for (const BodyPart& each : parts)
    tree.emplace_back(each.name, each.parent < 0 ? "" : parts[static_cast<std::size_t>(each.parent)].name);
  return tree;
}

// A chain hand - forearm - arm - torso, and a leg that shares more with the torso than with the arm.
std::vector<BodyPart> body() {
  return {part("hand", {0, 1, 2, 3}), part("forearm", {2, 3, 4, 5, 6}), part("arm", {5, 6, 7, 8, 9, 30}),
          part("leg", {20, 21, 22, 30}), part("torso", {8, 9, 10, 20, 21, 22})};
}

TEST(PartTree, FollowsTheSharedVertices) {
  EXPECT_THAT(tree_of(derive_hierarchy(body(), 4)),
              ElementsAre(Pair("torso", ""), Pair("arm", "torso"), Pair("forearm", "arm"),
                          Pair("hand", "forearm"), Pair("leg", "torso")));
  // Another root turns the tree; what is joined to what stays.
  EXPECT_THAT(tree_of(derive_hierarchy(body(), 0)),
              ElementsAre(Pair("hand", ""), Pair("forearm", "hand"), Pair("arm", "forearm"),
                          Pair("torso", "arm"), Pair("leg", "torso")));
  for (int root = 0; root < 5; ++root) {
    const std::vector<BodyPart> parts = derive_hierarchy(body(), root);
    EXPECT_NO_THROW(validate(parts, 31));
    for (const BodyPart& each : parts) {
      const std::vector<BodyPart> given = body();
      EXPECT_THAT(given, ::testing::Contains(::testing::Field(&BodyPart::vertices, each.vertices)));
    }
  }
  EXPECT_THAT(tree_of(derive_hierarchy({part("body", {0})}, 0)), ElementsAre(Pair("body", "")));
}

TEST(PartTree, LegsUnderOneSkirtHangOnTheTorso) {
  // The legs share four vertices with each other, three with the torso; the shin one with the torso, which
  // is no reason to hang there.
  const std::vector<BodyPart> skirt = {part("torso", {0, 1, 2, 3, 9}), part("left_thigh", {1, 2, 3, 4, 5, 6}),
                                       part("right_thigh", {2, 3, 4, 9, 20, 21}),
                                       part("left_shin", {3, 4, 5, 6, 10}), part("left_foot", {10, 11})};
  EXPECT_THAT(tree_of(derive_hierarchy(skirt, 0)),
              ElementsAre(Pair("torso", ""), Pair("left_thigh", "torso"), Pair("right_thigh", "torso"),
                          Pair("left_shin", "left_thigh"), Pair("left_foot", "left_shin")));
}

TEST(PartTree, ReachesPartsThatShareLittleWithIt) {
  // Each ear shares most with the other.
  EXPECT_THAT(tree_of(derive_hierarchy({part("head", {0, 1, 2, 3}), part("left_ear", {3, 5, 6, 7, 8}),
                                        part("right_ear", {5, 6, 7, 8})},
                                       0)),
              ElementsAre(Pair("head", ""), Pair("left_ear", "head"), Pair("right_ear", "left_ear")));
}

TEST(PartTree, OfEqualOverlapsTheFirstWins) {
  // Each shares one vertex with each: all hang on the root, in the given order.
  EXPECT_THAT(tree_of(derive_hierarchy({part("a", {0, 1}), part("b", {0, 2}), part("c", {0, 3})}, 1)),
              ElementsAre(Pair("b", ""), Pair("a", "b"), Pair("c", "b")));
  // c could hang on a or b, which it meets equally.
  EXPECT_THAT(tree_of(derive_hierarchy({part("a", {0, 1, 5}), part("b", {1, 2, 6}), part("c", {5, 6})}, 0)),
              ElementsAre(Pair("a", ""), Pair("b", "a"), Pair("c", "a")));
}

TEST(PartTree, BadPartsAreRefused) {
  const auto expect_refused = [](std::vector<BodyPart> parts, int root, const std::string& what) {
    EXPECT_THAT([&] { derive_hierarchy(parts, root); }, ThrowsMessage<InvalidArgument>(HasSubstr(what)));
  };
  // A root out of range.
  expect_refused(body(), 5, "root part 5 is out of range: there are 5 parts");
  expect_refused(body(), -1, "root part -1");
  expect_refused({}, 0, "there are 0 parts");
  // A part alone.
  std::vector<BodyPart> parts = body();
  parts.push_back(part("hat", {40}));
  expect_refused(parts, 4, "part 'hat' shares no vertex with any other part");
  // Groups.
  parts.push_back(part("feather", {40, 41}));
  expect_refused(parts, 4,
                 "in one of 'hand', 'forearm', 'arm', 'leg', 'torso' and in one of 'hat', 'feather'");
  // What `validate` refuses.
  expect_refused({part("a", {0}), part("a", {0})}, 0, "two parts named 'a'");
  expect_refused({part("a", {0}), part("b", {})}, 0, "'b' holds no vertex");
  expect_refused({part("a", {1, 0}), part("b", {0})}, 0, "expected ascending vertices");
}

}  // namespace
}  // namespace reprise
