// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/ground_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using test::TemporaryFolder;

// Where a colour is in a picture, above the key.
struct Spot {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  int pixels = 0;
};
Spot find_color(const Image& image, const std::array<int, 3>& color, int rows) {
  Spot spot;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x));
      const auto differs = [&](std::size_t c) { return std::abs(image.rgb[at + c] - color[c]) > 12; };
      if (differs(0) || differs(1) || differs(2)) continue;
      ++spot.pixels;
      spot.left = std::min(spot.left, x);
      spot.right = std::max(spot.right, x);
      spot.top = std::min(spot.top, y);
      spot.bottom = std::max(spot.bottom, y);
    }
  }
  return spot;
}

constexpr std::array<int, 3> first_color{0xd5, 0x5e, 0x00};
constexpr std::array<int, 3> second_color{0x00, 0x72, 0xb2};
constexpr int key_height = 60;  // and no less than the two rows of the key

TEST(PlotGround, IsSeenFromAboveToOneScale) {
  const TemporaryFolder folder;
  // A square of 2 m and, on the performer's left (+x) and farther ahead (+z), another of 1 m.
  const GroundCurve square{.name = "one",
                           .points = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {0.0, 0.0}}};
  const GroundCurve ahead{.name = "two",
                          .points = {{3.0, 3.0}, {4.0, 3.0}, {4.0, 4.0}, {3.0, 4.0}, {3.0, 3.0}}};
  const GroundPanel panel{.title = "it's a `panel`", .curves = {square, ahead}};
  plot_ground({&panel, 1}, folder / "ground.png");
  const Image image = read_image(folder / "ground.png");
  const Spot one = find_color(image, first_color, image.height - key_height);
  const Spot two = find_color(image, second_color, image.height - key_height);
  ASSERT_GT(one.pixels, 300);
  ASSERT_GT(two.pixels, 150);
  EXPECT_NEAR(one.right - one.left, one.bottom - one.top, 12);  // the dot at the end sticks out
  EXPECT_NEAR(two.right - two.left, two.bottom - two.top, 12);
  EXPECT_NEAR(one.right - one.left, 2 * (two.right - two.left), 24);
  EXPECT_LT(two.right, one.left);
  EXPECT_LT(two.bottom, one.top);
}

TEST(PlotGround, WhatWasAskedIsPale) {
  const TemporaryFolder folder;
  GroundPanel panel{
      .title = "panel",
      .curves = {{.name = "one", .kind = GroundCurve::Kind::walked, .points = {{0.0, 0.0}, {0.0, 5.0}}}}};
  const auto strong = [&] {
    plot_ground({&panel, 1}, folder / "ground.png");
    const Image image = read_image(folder / "ground.png");
    return find_color(image, first_color, image.height - key_height).pixels;
  };
  const int walked = strong();
  panel.curves[0].kind = GroundCurve::Kind::asked;
  EXPECT_LT(strong(), walked / 2);
}

TEST(PlotGround, RefusesWhatCannotBeShown) {
  const TemporaryFolder folder;
  const auto refuses = [&](const std::vector<GroundPanel>& panels) {
    EXPECT_THROW(plot_ground(panels, folder / "none.png"), InvalidArgument);
  };
  refuses({});
  refuses({{.title = "empty", .curves = {}}});
  refuses({{.title = "nowhere", .curves = {{.name = "one", .points = {{0.0, std::nan("")}}}}}});
  EXPECT_FALSE(std::filesystem::exists(folder / "none.png"));
}

}  // namespace
}  // namespace reprise
