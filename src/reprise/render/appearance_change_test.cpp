// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/appearance_change.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

MeshSequence still(const test::Shape& shape, const std::vector<Color>& colors) {
  MeshSequence clip("still", shape.topology, 1, 25.0);
  clip.frame(0) = shape.positions;
  clip.set_colors(colors);
  return clip;
}

std::vector<Color> one_color(const test::Shape& shape, Color color) {
  return std::vector<Color>(static_cast<std::size_t>(shape.topology->vertex_count), color);
}

AppearanceChange change_between(const MeshSequence& a, const MeshSequence& b,
                                const GroundTransform& a_from_b = {}) {
  const FrameViewer viewer(a);
  return viewer.change(viewer.look(a, 0), viewer.look(b, 0, a_from_b));
}

TEST(AppearanceChange, IsZeroForTheSameFrameAndSymmetric) {
  const test::Shape shape = test::body();
  const MeshSequence red = still(shape, one_color(shape, {200, 30, 30}));
  MeshSequence other = still(shape, one_color(shape, {190, 200, 30}));
  other.frame(0).col(1) *= 1.2F;
  EXPECT_EQ(change_between(red, red).total(), 0.0);
  const AppearanceChange there = change_between(red, other);
  const AppearanceChange back = change_between(other, red);
  EXPECT_GT(there.outline, 0.02);
  EXPECT_GT(there.color, 0.5);
  EXPECT_EQ(there.outline, back.outline);
  EXPECT_EQ(there.color, back.color);
}

TEST(AppearanceChange, CoversTheAreaOfASphere) {
  const test::Shape shape = test::sphere(5);
  const MeshSequence clip = still(shape, one_color(shape, {90, 90, 90}));
  const FrameViewer viewer(clip);
  for (const FrameViews::View& view : viewer.look(clip, 0).views) {
    const auto covered = static_cast<double>(view.covered_count);
    EXPECT_NEAR(covered * 0.015 * 0.015, std::numbers::pi, 0.02) << "m^2 of a unit disc";
  }
}

// The upper half of a ball is another colour: half of what is seen, from every side.
TEST(AppearanceChange, CountsTheShareThatChangedItsColor) {
  const test::Shape shape = test::sphere(5);
  std::vector<Color> colors = one_color(shape, {90, 90, 90});
  const MeshSequence grey = still(shape, colors);
  for (std::size_t v = 0; v < colors.size(); ++v) {
    if (shape.positions(static_cast<Eigen::Index>(v), 1) > 1.0F) colors[v] = {200, 30, 30};
  }
  const AppearanceChange change = change_between(grey, still(shape, colors));
  EXPECT_EQ(change.outline, 0.0);
  // Both pictures count their upper halves; grey below is within reach of what is just above.
  EXPECT_NEAR(change.color, 0.5, 0.03);
  std::vector<Color> hardly = one_color(shape, {92, 90, 90});
  EXPECT_EQ(change_between(grey, still(shape, hardly)).total(), 0.0) << "no eye sees that";
}

TEST(AppearanceChange, WhatMovesWithinReachHasNotChangedAndBeyondItHas) {
  const test::Shape shape = test::body();
  const MeshSequence clip = still(shape, one_color(shape, {90, 90, 90}));
  const GroundTransform near{.yaw = 0.0, .translation = {0.015, 0.015}};
  const GroundTransform far{.yaw = 0.0, .translation = {0.3, 0.0}};
  EXPECT_EQ(change_between(clip, clip, near).total(), 0.0);
  EXPECT_GT(change_between(clip, clip, far).outline, 0.1);
}

// A frame that was moved on the ground, put back by the transform, looks as it did.
TEST(AppearanceChange, PlacesTheTargetOntoTheSource) {
  const test::Shape shape = test::body();
  const MeshSequence clip = still(shape, one_color(shape, {90, 90, 90}));
  const GroundTransform moved_from_clip{.yaw = 1.1, .translation = {3.0, -2.0}};
  const MeshSequence moved = test::moved(clip, moved_from_clip, "moved");
  EXPECT_EQ(change_between(clip, moved, moved_from_clip.inverse()).total(), 0.0);
}

TEST(AppearanceChange, DecidesEarlyAsItWouldLate) {
  const test::Shape shape = test::body();
  const MeshSequence clip = still(shape, one_color(shape, {90, 90, 90}));
  const FrameViewer viewer(clip);
  const FrameViews here = viewer.look(clip, 0);
  for (const double distance : {0.0, 0.05, 0.1, 0.4}) {
    const FrameViews there = viewer.look(clip, 0, {.yaw = 0.0, .translation = {distance, 0.0}});
    const double change = viewer.change(here, there).total();
    for (const double share : {1e-6, 0.9 * change, 1.1 * change, 0.5}) {
      EXPECT_EQ(viewer.is_less(here, there, share), change < share) << change << " " << share;
    }
  }
}

TEST(AppearanceChange, ReadsTheTextureWithItsFirstRowAbove) {
  // A square facing +Z, textured red above and green below.
  auto topology = std::make_shared<Topology>();
  topology->vertex_count = 4;
  topology->triangles = {{0, 1, 2}, {0, 2, 3}};
  topology->uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  topology->triangle_uvs = topology->triangles;
  auto image = std::make_shared<Image>(Image{.width = 64, .height = 64});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const std::array<std::uint8_t, 3> color =
          y < 32 ? std::array<std::uint8_t, 3>{255, 0, 0} : std::array<std::uint8_t, 3>{0, 255, 0};
      image->rgb.insert(image->rgb.end(), color.begin(), color.end());
    }
  }
  topology->texture = image;
  MeshSequence clip("square", topology, 1, 25.0);
  clip.frame(0) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  const FrameViews views = FrameViewer(clip).look(clip, 0);
  const FrameViews::View& front = views.views[0];
  const std::size_t column = static_cast<std::size_t>(front.width / 2);
  const auto lab = [&](int row) {
    return front.lab[static_cast<std::size_t>(row) * static_cast<std::size_t>(front.width) + column];
  };
  // CIE L*a*b* of the sRGB primaries.
  EXPECT_NEAR(lab(front.height - 12)[0], 53.24, 0.3);
  EXPECT_NEAR(lab(front.height - 12)[1], 80.09, 0.5);
  EXPECT_NEAR(lab(12)[0], 87.73, 0.3);
  EXPECT_NEAR(lab(12)[2], 83.18, 0.5);
}

TEST(AppearanceChange, RefusesWhatItCannotShow) {
  const test::Shape shape = test::body();
  const MeshSequence clip = still(shape, one_color(shape, {90, 90, 90}));
  EXPECT_THROW(FrameViewer(clip, {.pixel_size = 0.0}), InvalidArgument);
  EXPECT_THROW(FrameViewer(clip, {.reach = -1.0}), InvalidArgument);
  EXPECT_THROW(FrameViewer(clip, {.color_difference = NAN}), InvalidArgument);
  const FrameViewer viewer(clip);
  MeshSequence broken = clip;
  broken.frame(0)(0, 0) = NAN;
  EXPECT_THROW(viewer.look(broken, 0), InvalidArgument);
  broken.frame(0)(0, 0) = 1e7F;
  EXPECT_THROW(viewer.look(broken, 0), InvalidArgument);
  const test::Shape other = test::sphere(2);
  EXPECT_THROW(viewer.look(still(other, one_color(other, {1, 1, 1})), 0), InvalidArgument);
}

}  // namespace
}  // namespace reprise
