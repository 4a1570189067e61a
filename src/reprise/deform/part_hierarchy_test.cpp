// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_hierarchy.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/database/body_parts.h"
#include "reprise/deform/part_hierarchy_test_support.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

using part_test::around;
using part_test::expect_laws;
using part_test::hierarchy;
using part_test::rings;
using part_test::split;
using part_test::steepest;
using part_test::tube;
using part_test::view;
using part_test::weight;

TEST(PartHierarchy, TheWholeBodyIsOnePart) {
  const test::Shape shape = test::sphere(2);
  const PartHierarchy parts = hierarchy(shape, {whole_body_part(shape.topology->vertex_count)});
  expect_laws(shape, parts);
  const PartHierarchy::Part& body = parts.part(0);
  EXPECT_EQ(body.topology, shape.topology);
  EXPECT_THAT(body.frontier, IsEmpty());
  EXPECT_THAT(body.loose, IsEmpty());
  for (int v = 0; v < parts.vertex_count(); ++v) EXPECT_EQ(weight(parts, v, 0), 1.0);
}

TEST(PartHierarchy, TwoPartsAreInterpolatedLinearly) {
  const test::Shape shape = tube(61);
  const PartHierarchy parts = hierarchy(shape, {rings("torso", -1, 0, 35), rings("arm", 0, 20, 60)});
  expect_laws(shape, parts);
  for (int v = 0; v < parts.vertex_count(); ++v) {
    const double arm = std::clamp((v / around - 19) / 17.0, 0.0, 1.0);  // rings 19 and 36 are outside
    EXPECT_NEAR(weight(parts, v, 1), arm, 1e-5);
  }
  ASSERT_EQ(parts.part(1).frontier.size(), 16U * around);
  for (const PartHierarchy::FrontierVertex& shared : parts.part(1).frontier) {
    EXPECT_NEAR(shared.parent_share, 1.0 - (shared.vertex / around - 19) / 17.0, 1e-5);
  }
  EXPECT_EQ(parts.main_part(22 * around), 0);
  EXPECT_EQ(parts.main_part(33 * around), 1);
  EXPECT_EQ(parts.part_idx("arm"), 1);
}

TEST(PartHierarchy, RecombinationFollowsTheWeights) {
  const test::Shape shape = tube(61);
  const PartHierarchy parts = hierarchy(shape, {rings("torso", -1, 0, 35), rings("arm", 0, 20, 60)});
  const Coordinates whole = shape.positions.cast<double>();
  std::vector<Coordinates> positions = split(parts, whole);
  const Eigen::RowVector3d step(0.3, -0.1, 0.2);
  positions[1].rowwise() += step;
  Coordinates out;
  parts.recombine(positions, out);
  for (int v = 0; v < parts.vertex_count(); ++v) {
    const double arm = std::clamp((v / around - 19) / 17.0, 0.0, 1.0);
    EXPECT_LT((out.row(v) - whole.row(v) - arm * step).norm(), 1e-5);
  }
  // Some rows only.
  Coordinates some = Coordinates::Zero(parts.vertex_count(), 3);
  const std::vector<std::int32_t> vertices = {7, 25 * around, 60 * around};
  parts.recombine(positions, vertices, some);
  for (int v = 0; v < parts.vertex_count(); ++v) {
    const bool is_asked = std::ranges::count(vertices, v) > 0;
    EXPECT_EQ(some.row(v), is_asked ? out.row(v) : Eigen::RowVector3d::Zero().eval());
  }
}

TEST(PartHierarchy, LevelsAndDescendants) {
  const test::Shape shape = tube(101);
  const PartHierarchy parts =
      hierarchy(shape, {rings("torso", -1, 30, 60), rings("upper_arm", 0, 50, 75), rings("thigh", 0, 10, 40),
                        rings("forearm", 1, 70, 90), rings("shin", 2, 0, 15), rings("hand", 3, 85, 100)});
  expect_laws(shape, parts);
  EXPECT_THAT(parts.levels(),
              ElementsAre(ElementsAre(0), ElementsAre(1, 2), ElementsAre(3, 4), ElementsAre(5)));
  EXPECT_THAT(parts.descendants(0), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(parts.descendants(1), ElementsAre(3, 5));
  EXPECT_THAT(parts.descendants(5), IsEmpty());
  EXPECT_THAT(parts.part(1).children, ElementsAre(3));
  // The least overlap has 6 rings: its weights turn by 1 / 7 over a centimetre, and none faster.
  EXPECT_NEAR(steepest(shape, parts), 100.0 / 7.0, 0.01);
}

TEST(PartHierarchy, AChildInsideItsParentWinsBeyondItsBorder) {
  const test::Shape shape = tube(101);
  // The whole body above an arm, above a hand.
  const PartHierarchy parts = hierarchy(
      shape,
      {whole_body_part(shape.topology->vertex_count), rings("arm", 0, 40, 85), rings("hand", 1, 76, 100)},
      {.takeover = 0.155});
  expect_laws(shape, parts);
  for (int v = 0; v < parts.vertex_count(); ++v) {
    const int ring = v / around;
    // The body ends at ring 55, 16 rings beyond ring 39; it does not come back where the arm hands on to the
    // hand.
    const double body = std::clamp((55 - ring) / 16.0, 0.0, 1.0);
    const double hand = std::clamp((ring - 75) / 11.0, 0.0, 1.0);
    EXPECT_NEAR(weight(parts, v, 0), body, 1e-5) << ring;
    EXPECT_NEAR(weight(parts, v, 1), 1.0 - body - hand, 1e-5) << ring;
  }
  for (const PartHierarchy::FrontierVertex& shared : parts.part(1).frontier) {
    EXPECT_NEAR(shared.parent_share, std::clamp((55 - shared.vertex / around) / 16.0, 0.0, 1.0), 1e-5);
  }
  // A child thinner than that wins from half its depth on.
  const PartHierarchy thin =
      hierarchy(shape, {whole_body_part(shape.topology->vertex_count), rings("sleeve", 0, 40, 50)},
                {.takeover = 0.155});
  expect_laws(shape, thin);
  EXPECT_EQ(weight(thin, 45 * around, 1), 1.0);
  EXPECT_GT(weight(thin, 41 * around, 0), 0.2);
}

TEST(PartHierarchy, ChildrenThatCoverTheirParentLeaveItNoSay) {
  const test::Shape shape = tube(101);
  const PartHierarchy parts = hierarchy(shape, {whole_body_part(shape.topology->vertex_count),
                                                rings("torso", 0, 0, 60), rings("arm", 0, 45, 100)});
  expect_laws(shape, parts);
  for (int v = 0; v < parts.vertex_count(); ++v) {
    EXPECT_EQ(weight(parts, v, 0), 0.0);
    EXPECT_NEAR(weight(parts, v, 2), std::clamp((v / around - 44) / 17.0, 0.0, 1.0), 1e-5);
  }
  // Still it holds them where they end.
  for (const int p : {1, 2}) {
    double largest = 0.0;
    for (const auto& shared : parts.part(p).frontier) largest = std::max(largest, shared.parent_share);
    EXPECT_GT(largest, 0.9);
  }
  // A child that is all of its parent follows it everywhere and replaces it.
  BodyPart twin = whole_body_part(shape.topology->vertex_count);
  twin.name = "twin";
  twin.parent = 0;
  const PartHierarchy twins = hierarchy(shape, {whole_body_part(shape.topology->vertex_count), twin});
  expect_laws(shape, twins);
  for (int v = 0; v < twins.vertex_count(); ++v) EXPECT_EQ(weight(twins, v, 1), 1.0);
  for (const auto& shared : twins.part(1).frontier) EXPECT_EQ(shared.parent_share, 1.0);
}

// A sheet as a skirt: the torso above, a leg to each side below, all three in the middle.
std::vector<BodyPart> skirt(int cells) {
  std::vector<BodyPart> parts = {{.name = "torso", .parent = -1, .vertices = {}},
                                 {.name = "left_leg", .parent = 0, .vertices = {}},
                                 {.name = "right_leg", .parent = 0, .vertices = {}}};
  const int third = cells / 3;
  for (int v = 0; v < (cells + 1) * (cells + 1); ++v) {
    const int row = v / (cells + 1);
    const int column = v % (cells + 1);
    if (row >= third) parts[0].vertices.push_back(v);
    if (row <= 2 * third && column >= third) parts[1].vertices.push_back(v);
    if (row <= 2 * third && column <= 2 * third) parts[2].vertices.push_back(v);
  }
  return parts;
}

TEST(PartHierarchy, ThreePartsMeetWithoutASeam) {
  for (const int cells : {12, 24, 48, 96}) {
    const test::Shape shape = test::sheet(cells);
    const PartHierarchy parts = hierarchy(shape, skirt(cells));
    if (cells < 96) expect_laws(shape, parts);
    const int middle = cells / 2 * (cells + 1) + cells / 2;
    ASSERT_EQ(parts.shares(middle).size(), 3U);
    // Each of the three distances changes by no more than the length e of an edge, and their sum is no less
    // than an overlap wide, 1 / 3 m: a weight changes by 4 e / (1 / 3) at most, however small the triangles.
    EXPECT_LT(steepest(shape, parts), 12.0) << cells;
  }
}

TEST(PartHierarchy, AnySurfaceWillDo) {
  // A tube; a button that floats beside it, within both parts; a third sheet on an edge; an unused vertex.
  test::Shape shape = tube(41);
  const auto topology = std::make_shared<Topology>(*shape.topology);
  const int n = topology->vertex_count;
  topology->vertex_count = n + 5;
  topology->triangles.push_back({n, n + 1, n + 2});
  topology->triangles.push_back({30 * around, 31 * around, n + 3});
  shape.topology = topology;
  shape.positions.conservativeResize(n + 5, 3);
  shape.positions.row(n) << 0.06F, 0.30F, 0.0F;
  shape.positions.row(n + 1) << 0.07F, 0.30F, 0.0F;
  shape.positions.row(n + 2) << 0.07F, 0.31F, 0.0F;
  shape.positions.row(n + 3) << 0.09F, 0.3F, 0.0F;
  shape.positions.row(n + 4) << 0.0F, 0.0F, 0.0F;
  std::vector<BodyPart> bodies = {rings("torso", -1, 0, 20), rings("arm", 0, 10, 40)};
  for (int v = n; v < n + 4; ++v) bodies[1].vertices.push_back(v);
  bodies[0].vertices.push_back(n + 4);
  const PartHierarchy parts = hierarchy(shape, bodies);
  expect_laws(shape, parts);
  ASSERT_EQ(parts.part(1).loose.size(), 1U);
  const PartHierarchy::LooseComponent& button = parts.part(1).loose[0];
  EXPECT_THAT(button.vertices,
              ElementsAre(parts.part(1).local(n), parts.part(1).local(n + 1), parts.part(1).local(n + 2)));
  EXPECT_EQ(parts.part(1).vertices[static_cast<std::size_t>(button.carrier)], 30 * around);
  ASSERT_EQ(parts.part(0).loose.size(), 1U);
  EXPECT_THAT(parts.part(0).loose[0].vertices, ElementsAre(parts.part(0).local(n + 4)));
  EXPECT_EQ(weight(parts, n + 4, 0), 1.0);
}

TEST(PartHierarchy, KeepsTheCornersOfItsTrianglesOnly) {
  const test::Shape shape = tube(41);
  std::vector<BodyPart> bodies = {rings("torso", -1, 0, 20), rings("arm", 0, 10, 40)};
  bodies[0].vertices.push_back(40 * around + 3);  // far out, alone
  const PartHierarchy parts = hierarchy(shape, bodies);
  expect_laws(shape, parts);
  EXPECT_EQ(parts.part(0).local(40 * around + 3), -1);
  EXPECT_EQ(parts.part(0).vertices.size(), 21U * around);
}

TEST(PartHierarchy, BadPartsAreRefused) {
  const test::Shape shape = tube(41);
  const auto expect_refused = [&](const std::vector<BodyPart>& parts, const std::string& what) {
    EXPECT_THAT([&] { hierarchy(shape, parts); }, ThrowsMessage<InvalidArgument>(HasSubstr(what)));
  };
  const BodyPart torso = rings("torso", -1, 0, 20);
  // No part.
  expect_refused({}, "no part is given");
  // An index out of range, a parent that is none.
  expect_refused({rings("torso", -1, 0, 41)}, "'torso' holds vertex 492, but there are 492");
  expect_refused({torso, rings("arm", 1, 10, 40)}, "'arm' has the parent 1");
  // Vertices in no part.
  expect_refused({torso, rings("arm", 0, 10, 38)},
                 "24 of 492 vertices are in no part, the first is vertex 468");
  // Triangles inside of no part.
  expect_refused({torso, rings("arm", 0, 21, 40)},
                 "24 of 960 triangles are inside of no part, the first is triangle 480 (240, 252, 241)");
  // A part without triangles.
  BodyPart dots{.name = "dots", .parent = 0, .vertices = {0, 30, 60}};
  expect_refused({torso, rings("arm", 0, 10, 40), dots}, "part 'dots' holds no triangle");
  // A part that does not overlap its parent, but another.
  expect_refused({torso, rings("arm", 0, 10, 30), rings("hand", 0, 25, 40)},
                 "'hand' does not overlap its parent 'torso'");
  // A frontier that cannot hold the part: two vertices, vertices in one line.
  BodyPart corner = rings("arm", 0, 20, 40);
  std::erase_if(corner.vertices, [](std::int32_t v) { return v < 21 * around && v % around > 1; });
  expect_refused({torso, corner, rings("whole", 0, 0, 40)},
                 "'arm' shares 2 vertices with its parent 'torso'");
  const test::Shape sheet = test::sheet(8);
  std::vector<BodyPart> halves = {{.name = "front", .parent = -1, .vertices = {}},
                                  {.name = "back", .parent = 0, .vertices = {}}};
  for (int v = 0; v < 81; ++v) {
    if (v / 9 <= 4) halves[0].vertices.push_back(v);
    if (v / 9 >= 4) halves[1].vertices.push_back(v);
  }
  EXPECT_THAT([&] { hierarchy(sheet, halves); },
              ThrowsMessage<InvalidArgument>(HasSubstr("'back' shares 9 vertices with its parent 'front'")));
  // References that do not fit.
  const BodyPart whole = whole_body_part(492);
  EXPECT_THROW(PartHierarchy(shape.topology, view(sheet.positions), {whole}), InvalidArgument);
  Positions broken = shape.positions;
  broken(17, 1) = NAN;
  EXPECT_THAT([&] { PartHierarchy(shape.topology, view(broken), {whole}); },
              ThrowsMessage<InvalidArgument>(HasSubstr("vertex 17")));
  EXPECT_THROW(PartHierarchy(nullptr, view(shape.positions), {whole}), InvalidArgument);
  EXPECT_THROW(hierarchy(shape, {whole}, {.takeover = 0.0}), InvalidArgument);
  // Positions that do not fit; an unknown name.
  const PartHierarchy parts = hierarchy(shape, {torso, rings("arm", 0, 10, 40)});
  Coordinates out;
  EXPECT_THROW(parts.recombine(std::vector<Coordinates>(1), out), InvalidArgument);
  EXPECT_THAT(
      [&] { parts.recombine(std::vector<Coordinates>(2), out); },
      ThrowsMessage<InvalidArgument>(HasSubstr("0 positions are given for part 'torso'; expected 252")));
  EXPECT_THAT([&] { (void)parts.part_idx("torsi"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("did you mean 'torso'")));
}

}  // namespace
}  // namespace reprise
