// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/render/camera.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using test::moved;
using test::walk;

constexpr CameraMode all_modes[] = {CameraMode::follow, CameraMode::orbit, CameraMode::fixed,
                                    CameraMode::front, CameraMode::side};

MeshSequence painted(MeshSequence sequence, Color color) {
  sequence.set_colors(std::vector<Color>(sequence.vertex_count(), color));
  return sequence;
}

MeshSequence ball(Color color) {
  const test::Shape shape = test::sphere(4);
  MeshSequence sequence("ball", shape.topology, 1, 25.0);
  sequence.frame(0) = shape.positions;
  return painted(std::move(sequence), color);
}

const std::uint8_t* pixel(const Image& image, int x, int y) {
  return image.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                 static_cast<std::size_t>(x));
}

bool is_red(const std::uint8_t* rgb) {
  return rgb[0] > rgb[1] + 40 && rgb[0] > rgb[2] + 40;
}

struct Box {
  int left = std::numeric_limits<int>::max();
  int right = -1;
  int top = std::numeric_limits<int>::max();
  int bottom = -1;
};

Box red_box(const Image& image) {
  Box box;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!is_red(pixel(image, x, y))) continue;
      box.left = std::min(box.left, x);
      box.right = std::max(box.right, x);
      box.top = std::min(box.top, y);
      box.bottom = std::max(box.bottom, y);
    }
  }
  return box;
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
  return sum / static_cast<double>(a.rgb.size());
}

constexpr RenderOptions small = {.width = 320, .height = 180};

TEST(SequenceRenderer, ARedBallIsRedInTheMiddleAndNowhereNearTheCorners) {
  const MeshSequence sequence = ball({200, 20, 20});
  SequenceRenderer renderer(sequence, small);
  const Image image = renderer.draw(0);
  ASSERT_EQ(image.rgb.size(), 320U * 180U * 3U);
  EXPECT_TRUE(is_red(pixel(image, 160, 90)));
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(319, 0), std::pair(0, 179), std::pair(319, 179)}) {
    EXPECT_FALSE(is_red(pixel(image, x, y))) << x << ", " << y;
    EXPECT_GT(int{pixel(image, x, y)[1]}, 150) << "the studio is pale";
  }
}

TEST(SequenceRenderer, TheSideTowardsTheKeyLightIsBrighter) {
  const MeshSequence sequence = ball({220, 220, 220});
  RenderOptions options = small;
  options.floor = false;
  const Image image = SequenceRenderer(sequence, options).draw(0);
  // The light stands above the camera's left shoulder.
  EXPECT_GT(int{pixel(image, 160 - 30, 90 - 30)[1]}, int{pixel(image, 160 + 30, 90 + 30)[1]} + 40);
}

TEST(SequenceRenderer, TheShadowFallsOnTheFloorAwayFromTheLight) {
  const MeshSequence sequence = ball({220, 220, 220});
  RenderOptions options = small;
  options.camera_pitch_degrees = 35.0;
  const Image with_shadow = SequenceRenderer(sequence, options).draw(0);
  int darker_right = 0;
  int darker_left = 0;
  for (int y = 60; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      const bool dark = pixel(with_shadow, x, y)[1] < 185;
      if (x > 240) darker_right += dark ? 1 : 0;
      if (x < 80) darker_left += dark ? 1 : 0;
    }
  }
  EXPECT_GT(darker_right, 100);
  EXPECT_LT(darker_left, 20);
}

TEST(SequenceRenderer, EveryCameraKeepsTheWholeCharacterInsideWithMarginInEveryFrame) {
  const MeshSequence clip = painted(walk("walk", 50), {230, 10, 10});
  for (const CameraMode mode : all_modes) {
    RenderOptions options = small;
    options.camera = mode;
    options.floor = false;
    SequenceRenderer renderer(clip, options);
    for (std::size_t f = 0; f < clip.frame_count(); f += 7) {
      const Box box = red_box(renderer.draw(f));
      ASSERT_GE(box.right, 0) << "frame " << f << " mode " << static_cast<int>(mode);
      EXPECT_GE(box.left, 320 * 0.05);
      EXPECT_LE(box.right, 320 * 0.95);
      EXPECT_GE(box.top, 180 * 0.1);
      EXPECT_LE(box.bottom, 180 * 0.9);
    }
  }
}

TEST(SequenceRenderer, AFollowedCharacterFillsMostOfTheHeight) {
  const MeshSequence clip = painted(walk("walk", 40), {230, 10, 10});
  const Box box = red_box(SequenceRenderer(clip, small).draw(20));
  EXPECT_GT(box.bottom - box.top, 180 * 0.55);
  EXPECT_LT(box.bottom - box.top, 180 * 0.8);
}

TEST(SequenceRenderer, AFollowedCharacterLooksTheSameWhereverItIsOnTheGround) {
  const MeshSequence clip = painted(walk("walk", 30), {90, 140, 200});
  // Whole metres: the grid falls on itself.
  const MeshSequence elsewhere = moved(clip, {.yaw = 0.0, .translation = {7.0, -12.0}}, "elsewhere");
  SequenceRenderer here(clip, small);
  SequenceRenderer there(elsewhere, small);
  for (const std::size_t f : {0U, 13U, 29U}) EXPECT_LT(mean_difference(here.draw(f), there.draw(f)), 0.5);
  EXPECT_GT(mean_difference(here.draw(0), here.draw(10)), 0.5) << "motion can be seen";
}

TEST(SequenceRenderer, AnOpenSurfaceIsLitFromBothSides) {
  const test::Shape shape = test::sheet(8);
  for (const double pitch : {60.0, -60.0}) {
    MeshSequence sheet("sheet", shape.topology, 1, 25.0);
    sheet.frame(0) = shape.positions;
    sheet.set_colors(std::vector<Color>(sheet.vertex_count(), Color{220, 20, 20}));
    RenderOptions options = small;
    options.camera_pitch_degrees = pitch;
    EXPECT_TRUE(is_red(pixel(SequenceRenderer(sheet, options).draw(0), 160, 90))) << pitch;
  }
}

// The same surface with other triangles, in the same place.
MeshSequence rebuilt(const MeshSequence& sequence, const std::vector<Triangle>& triangles) {
  Topology topology = *sequence.topology();
  topology.triangles = triangles;
  MeshSequence result(sequence.name(), std::make_shared<const Topology>(std::move(topology)), 1, 25.0);
  result.frame(0) = sequence.frame(0);
  return painted(std::move(result), {220, 20, 20});
}

TEST(SequenceRenderer, AClosedSurfaceLooksTheSameAsWithAHiddenTriangleMissing) {
  const MeshSequence closed = ball({220, 20, 20});
  const Image reference = SequenceRenderer(closed, small).draw(0);
  ASSERT_TRUE(is_red(pixel(reference, 160, 90)));

  std::vector<Triangle> triangles = closed.topology()->triangles;
  // Behind the ball as the camera sees it: (sin 35, 0, cos 35) points to the camera.
  const auto hidden = std::find_if(triangles.begin(), triangles.end(), [&](const Triangle& t) {
    const Eigen::Vector3f p = closed.frame(0).row(t[0]);
    return p.x() < -0.4F && p.z() < -0.6F && std::abs(p.y() - 1.0F) < 0.2F;
  });
  ASSERT_NE(hidden, triangles.end());
  triangles.erase(hidden);
  EXPECT_LT(mean_difference(SequenceRenderer(rebuilt(closed, triangles), small).draw(0), reference), 0.05)
      << "open: both sides are drawn";
}

TEST(SequenceRenderer, AnOpenSurfaceBesideAClosedOneIsStillSeenFromInside) {
  const MeshSequence closed = ball({220, 20, 20});
  Topology topology = *closed.topology();
  const std::int32_t first = topology.vertex_count;
  topology.vertex_count += 3;
  topology.triangles.insert(topology.triangles.begin(), Triangle{first, first + 2, first + 1});
  MeshSequence sequence("both", std::make_shared<const Topology>(std::move(topology)), 1, 25.0);
  sequence.frame(0).topRows(first) = closed.frame(0);
  // Before the ball, its back to the camera at +Z.
  sequence.frame(0).bottomRows(3) << -1.0F, 0.2F, 1.5F, 1.0F, 0.2F, 1.5F, 0.0F, 1.9F, 1.5F;
  std::vector<Color> colors(sequence.vertex_count(), Color{60, 60, 60});
  std::fill(colors.end() - 3, colors.end(), Color{220, 20, 20});
  sequence.set_colors(colors);
  RenderOptions options = small;
  options.camera = CameraMode::front;
  EXPECT_TRUE(is_red(pixel(SequenceRenderer(sequence, options).draw(0), 160, 90)));
}

TEST(SequenceRenderer, TheShadowIsWholeHoweverSmallThePartOfTheFloorThatIsLookedAt) {
  // A speck, hidden inside of the ball in frame 0 and far to its side in frame 1, stretches what may be in
  // shadow; the camera stands still.
  const test::Shape shape = test::sphere(4);
  Topology topology = *shape.topology;
  const std::int32_t first = topology.vertex_count;
  topology.vertex_count += 3;
  topology.triangles.push_back({first, first + 1, first + 2});
  MeshSequence sequence("ball and speck", std::make_shared<const Topology>(std::move(topology)), 2, 25.0);
  for (std::size_t f = 0; f < 2; ++f) {
    sequence.frame(f).topRows(first) = shape.positions;
    const float x = f == 0 ? 0.0F : 2.0F;
    sequence.frame(f).bottomRows(3) << x, 1.0F, 0.0F, x + 1e-3F, 1.0F, 0.0F, x, 1.001F, 0.0F;
  }
  for (const double pitch : {12.0, 35.0, 85.0}) {
    RenderOptions options = small;
    options.camera = CameraMode::fixed;
    options.camera_pitch_degrees = pitch;
    SequenceRenderer renderer(sequence, options);
    EXPECT_LT(mean_difference(renderer.draw(0), renderer.draw(1)), 0.02) << pitch;
  }
}

TEST(SequenceRenderer, ThreadsDrawTheSamePicturesEachWithItsOwnRenderer) {
  const MeshSequence clip = walk("walk", 8);
  SequenceRenderer reference(clip, small);
  std::vector<Image> images(8);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 2; ++t) {
    threads.emplace_back([&, t] {
      SequenceRenderer renderer(clip, small);
      for (std::size_t f = t; f < 8; f += 2) images[f] = renderer.draw(f);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t f = 0; f < 8; ++f) EXPECT_EQ(images[f].rgb, reference.draw(f).rgb) << f;
}

TEST(SequenceRenderer, OneFrameWithBrokenCoordinatesDoesNotSpoilTheOthers) {
  MeshSequence clip = painted(walk("walk", 12), {230, 10, 10});
  clip.frame(5).setConstant(std::numeric_limits<float>::quiet_NaN());
  SequenceRenderer renderer(clip, small);
  EXPECT_EQ(red_box(renderer.draw(5)).right, -1);
  EXPECT_GE(red_box(renderer.draw(6)).right, 0);
}

TEST(SequenceRenderer, RefusesWhatCannotBeDrawn) {
  const MeshSequence clip = walk("walk", 3);
  const auto with = [&](auto change) {
    RenderOptions options = small;
    change(options);
    return [&clip, options] { SequenceRenderer renderer(clip, options); };
  };
  EXPECT_THROW(with([](RenderOptions& o) { o.width = 0; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.height = -4; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.width = 1 << 20; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.samples = 0; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.samples = 1000; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.field_of_view_degrees = 180.0; })(), InvalidArgument);
  EXPECT_THROW(with([](RenderOptions& o) { o.camera_pitch_degrees = NAN; })(), InvalidArgument);
  const MeshSequence empty("empty", clip.topology(), 0, 25.0);
  EXPECT_THROW(SequenceRenderer(empty, small), InvalidArgument);
  EXPECT_THROW(SequenceRenderer(clip, small).draw(3), InvalidArgument);
}

TEST(SmoothTrajectory, KeepsStraightUniformMotionAndDampsSteps) {
  std::vector<Eigen::Vector2d> line;
  std::vector<Eigen::Vector2d> zigzag;
  for (int i = 0; i < 40; ++i) {
    line.emplace_back(0.1 * i, -0.3 * i);
    zigzag.emplace_back(0.0, i % 2 == 0 ? 1.0 : -1.0);
  }
  const auto smooth_line = smooth_trajectory(line, 5.0);
  for (std::size_t i = 0; i < line.size(); ++i) EXPECT_LT((smooth_line[i] - line[i]).norm(), 1e-9) << i;
  const auto smooth_zigzag = smooth_trajectory(zigzag, 5.0);
  for (std::size_t i = 10; i < 30; ++i) EXPECT_LT(smooth_zigzag[i].norm(), 0.05) << i;
}

}  // namespace
}  // namespace reprise
