// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/surface_color.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/shapes.h"

namespace reprise {
namespace {

using ::testing::HasSubstr;
using ::testing::Throws;

// The unit square with a picture over it: u along x, v along z.
struct Textured {
  Topology topology;
  std::vector<Eigen::Vector3d> points;
};

template <typename ColorOf>
Textured textured_sheet(int cells, int pixels, const ColorOf& color_of) {
  const test::Shape sheet = test::sheet(cells);
  Textured result{.topology = *sheet.topology, .points = {}};
  for (Eigen::Index v = 0; v < sheet.positions.rows(); ++v) {
    result.points.emplace_back(sheet.positions.row(v).transpose().cast<double>());
    result.topology.uvs.push_back({sheet.positions(v, 0), sheet.positions(v, 2)});
  }
  result.topology.triangle_uvs = result.topology.triangles;
  Image image{.width = pixels, .height = pixels, .rgb = {}};
  for (int y = 0; y < pixels; ++y) {
    for (int x = 0; x < pixels; ++x) {
      const Color color = color_of(x, pixels - 1 - y);  // counted upwards, as v
      image.rgb.insert(image.rgb.end(), color.begin(), color.end());
    }
  }
  result.topology.texture = std::make_shared<const Image>(std::move(image));
  return result;
}

// Calls f(triangle, weights, u, v) at random places.
template <typename F>
void for_places(const Textured& sheet, const F& f) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (std::size_t t = 0; t < sheet.topology.triangles.size(); ++t) {
    for (int k = 0; k < 50; ++k) {
      Eigen::Vector3f w(uniform(random), uniform(random), uniform(random));
      if (k < 3) w = Eigen::Vector3f::Unit(k);
      w /= w.sum();
      Eigen::Vector2d uv = Eigen::Vector2d::Zero();
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& corner = sheet.topology.uvs[static_cast<std::size_t>(sheet.topology.triangle_uvs[t][c])];
        uv += static_cast<double>(w[static_cast<Eigen::Index>(c)]) * Eigen::Vector2d(corner[0], corner[1]);
      }
      f(static_cast<std::int32_t>(t), w, uv.x(), uv.y());
    }
  }
}

TEST(PatchColors, FollowsTheTextureToThePatchSize) {
  const Textured sheet = textured_sheet(2, 256, [](int x, int y) {
    return Color{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 77};
  });
  for (const double patch_size : {0.2, 0.05, 0.01}) {
    const PatchColors colors(sheet.topology, sheet.points, patch_size);
    for_places(sheet, [&](std::int32_t triangle, const Eigen::Vector3f& w, double u, double v) {
      const std::array<float, 3>& color = colors.color(triangle, w);
      // Edges are at most 1.5 x 1.52 patch sizes, and a place lies within two thirds of that of its centroid.
      EXPECT_NEAR(color[0], u, 1.52 * patch_size + 0.005);
      EXPECT_NEAR(color[1], v, 1.52 * patch_size + 0.005);
      EXPECT_NEAR(color[2], 77.0 / 255.0, 1e-6);
    });
  }
}

TEST(PatchColors, MeansAroundVerticesAreThoseOfTheTexture) {
  const Textured sheet = textured_sheet(8, 256, [](int x, int y) {
    return Color{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 51};
  });
  const auto means = PatchColors(sheet.topology, sheet.points, 0.01).vertex_means();
  for (Eigen::Index v = 0; v < means.rows(); ++v) {
    const Eigen::Vector3d& p = sheet.points[static_cast<std::size_t>(v)];
    EXPECT_NEAR(means(v, 2), 0.2, 1e-6);
    // Inside, what falls off on one side does so on the other; at the border a third of an edge is missing.
    const bool is_border = std::min({p.x(), p.z(), 1.0 - p.x(), 1.0 - p.z()}) < 0.01;
    EXPECT_NEAR(means(v, 0), p.x(), is_border ? 0.07 : 0.005);
    EXPECT_NEAR(means(v, 1), p.z(), is_border ? 0.07 : 0.005);
  }
}

TEST(PatchColors, FinePatternsBecomeTheirMean) {
  const Textured sheet = textured_sheet(2, 512, [](int x, int y) {
    return (x + y) % 2 == 0 ? Color{255, 255, 0} : Color{0, 0, 0};
  });
  const PatchColors colors(sheet.topology, sheet.points, 0.1);
  for_places(sheet, [&](std::int32_t triangle, const Eigen::Vector3f& w, double, double) {
    EXPECT_NEAR(colors.color(triangle, w)[0], 0.5, 0.05);
    EXPECT_EQ(colors.color(triangle, w)[2], 0.0F);
  });
}

TEST(PatchColors, TextureRepeats) {
  Textured sheet = textured_sheet(2, 64, [](int x, int y) {
    return Color{static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(4 * y), 0};
  });
  const PatchColors colors(sheet.topology, sheet.points, 0.1);
  for (auto& uv : sheet.topology.uvs) uv = {uv[0] + 3.0F, uv[1] - 5.0F};
  const PatchColors shifted(sheet.topology, sheet.points, 0.1);
  for_places(sheet, [&](std::int32_t triangle, const Eigen::Vector3f& w, double, double) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(colors.color(triangle, w)[k], shifted.color(triangle, w)[k], 0.03);
    }
  });
}

TEST(PatchColors, SplitsByTheSizeOfPatches) {
  const Textured sheet = textured_sheet(1, 8, [](int, int) { return Color{1, 2, 3}; });
  EXPECT_EQ(PatchColors(sheet.topology, sheet.points, 2.0).patch_count(), 2U);
  // The diagonal of 1.41 is split into two of about 0.76.
  EXPECT_EQ(PatchColors(sheet.topology, sheet.points, 0.5).patch_count(), 2U * 2U * 2U);
  // Sheared into equilateral triangles, patches have the area asked for.
  Textured sheared = sheet;
  for (Eigen::Vector3d& p : sheared.points) p = {p.x() + 0.5 * p.z(), 0.0, std::sqrt(0.75) * p.z()};
  const PatchColors colors(sheared.topology, sheared.points, 0.01);
  EXPECT_NEAR(static_cast<double>(colors.patch_count()), std::sqrt(0.75) / (0.01 * 0.01), 100.0);
}

TEST(PatchColors, SaysWhatIsWrong) {
  const Textured good = textured_sheet(2, 8, [](int, int) { return Color{1, 2, 3}; });
  const auto message = [](const char* text) {
    return Throws<InvalidArgument>(::testing::Property(&InvalidArgument::what, HasSubstr(text)));
  };
  // No texture.
  EXPECT_THAT([&] { PatchColors(*test::sheet(2).topology, good.points, 0.1); },
              message("expected a topology with a texture"));
  // A texture coordinate that is not a number.
  Textured bad = good;
  bad.topology.uvs[4] = {0.5F, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_THAT([&] { PatchColors(bad.topology, bad.points, 0.1); },
              message("texture coordinate 4: expected finite numbers, found (0.5, nan)"));
  // Points of another surface.
  EXPECT_THAT([&] { PatchColors(good.topology, std::span(good.points).first(3), 0.1); },
              message("expected 9 points, found 3"));
  // More patches than memory should hold.
  EXPECT_THAT([&] { PatchColors(good.topology, good.points, 1e-9); }, message("choose larger voxels"));
}

}  // namespace
}  // namespace reprise
