// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Colours of histograms: where they come from and how they are counted.

#include <algorithm>
#include <map>
#include <random>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/similarity/histogram_test_support.h"

namespace reprise {
namespace {

using test::blue;
using test::database_of;
using test::difference;
using test::dressed;
using test::green;
using test::literal;
using test::shape_of;

TEST(ShapeColorHistograms, RecolouringChangesColoursAlone) {
  const MeshSequence walk = dressed("walk", 3, blue);
  const MeshSequence recolored = dressed("recolored", 3, green);
  const ShapeColorHistograms both(database_of({walk, recolored}), {});
  const ShapeColorHistograms shape(database_of({walk, recolored}), {.use_color = false});
  EXPECT_EQ(shape.grid().palette(), (std::vector<BinGrid::ColorBin>{{0, 0, 0}}));
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_GT(difference(both, f, 3 + f), 0.3) << "half of the body is cloth";
    EXPECT_EQ(difference(shape, f, 3 + f), 0.0);
    EXPECT_EQ(shape_of(both, f), shape_of(both, 3 + f));
    EXPECT_EQ(shape_of(both, f), shape_of(shape, f));
  }
}

TEST(ShapeColorHistograms, ColoursComeFromWhatSaysMost) {
  const auto textured = [](MeshSequence clip, Color color) {
    Topology topology = *clip.topology();
    topology.uvs = {{0.1F, 0.1F}, {0.9F, 0.1F}, {0.5F, 0.9F}};
    topology.triangle_uvs.assign(topology.triangles.size(), {0, 1, 2});
    Image image{.width = 2, .height = 2, .rgb = {}};
    for (int pixel = 0; pixel < 4; ++pixel) image.rgb.insert(image.rgb.end(), color.begin(), color.end());
    topology.texture = std::make_shared<const Image>(std::move(image));
    clip.share_topology(std::make_shared<const Topology>(std::move(topology)));
    return clip;
  };
  const auto palette = [](std::vector<MeshSequence> clips) {
    const ShapeColorHistograms histograms(database_of(std::move(clips)), literal(0.05));
    return histograms.grid().palette();
  };
  using ::testing::Contains;
  using ::testing::ElementsAre;
  using ::testing::Not;
  const Color white = {255, 255, 255};
  const BinGrid::ColorBin white_bin = {9, 9, 9};
  const BinGrid::ColorBin blue_bin = {1, 2, 7};
  const BinGrid::ColorBin green_bin = {1, 7, 2};
  // Nothing: one colour.
  EXPECT_THAT(palette({test::walk("a", 1)}), ElementsAre(BinGrid::ColorBin{0, 0, 0}));
  // A texture, also where some or all vertices have colours that are the same in all clips.
  EXPECT_THAT(palette({textured(test::walk("a", 1), white)}), ElementsAre(white_bin));
  EXPECT_THAT(palette({textured(dressed("a", 1, blue), white), test::walk("b", 1)}), ElementsAre(white_bin));
  EXPECT_THAT(palette({textured(dressed("a", 1, blue), white), dressed("b", 1, blue)}),
              ElementsAre(white_bin));
  // Colours of vertices that tell clips apart.
  EXPECT_THAT(palette({textured(dressed("a", 1, blue), white), dressed("b", 1, green)}),
              ::testing::AllOf(Contains(blue_bin), Contains(green_bin), Not(Contains(white_bin))));
  // Colours of vertices without a texture.
  EXPECT_THAT(palette({dressed("a", 1, blue)}), Contains(blue_bin));
  // Colours that change from frame to frame.
  MeshSequence changing = test::walk("a", 2);
  std::vector<Color> colors(2 * changing.vertex_count(), blue);
  std::fill(colors.begin() + static_cast<std::ptrdiff_t>(changing.vertex_count()), colors.end(), green);
  changing.set_colors(colors);
  EXPECT_THAT(palette({textured(changing, white)}), ElementsAre(blue_bin, green_bin));
}

// Voxels of each colour bin of a database, as a part of all.
std::map<BinGrid::ColorBin, double> color_shares(const ShapeColorHistograms& histograms) {
  std::map<BinGrid::ColorBin, double> shares;
  double total = 0.0;
  for (std::size_t f = 0; f < histograms.frame_count(); ++f) {
    for (const FineHistogram::Entry& entry : histograms.frame(f).entries) {
      shares[histograms.grid().palette()[entry.color]] += entry.count;
      total += entry.count;
    }
  }
  for (auto& [color, share] : shares) share /= total;
  return shares;
}

TEST(ShapeColorHistograms, TheFootprintAveragesFinePatterns) {
  // Vertices at random black or white, the same in all frames or anew in each.
  for (const bool of_frame : {false, true}) {
    MeshSequence clip = test::walk("walk", 2);
    std::mt19937 random(4);
    std::vector<Color> colors((of_frame ? 2 : 1) * clip.vertex_count());
    for (Color& color : colors) color.fill(random() % 2 == 0 ? 0 : 255);
    clip.set_colors(std::move(colors));
    const auto middle = [&](double footprint) {
      double share = 0.0;
      const ShapeColorHistograms histograms(
          database_of({clip}), {.voxel_size = 0.03, .color_footprint = footprint, .min_color_share = 0.0});
      for (const auto& [color, part] : color_shares(histograms)) {
        share += color[0] >= 3 && color[0] <= 6 ? part : 0.0;
      }
      return share;
    };
    EXPECT_LT(middle(0.0), 0.6);
    EXPECT_GT(middle(0.5), 0.99);
  }
  // What has one colour keeps it.
  MeshSequence plain = test::walk("walk", 1);
  plain.set_colors(std::vector<Color>(plain.vertex_count(), Color{140, 20, 250}));
  const ShapeColorHistograms histograms(database_of({plain}), {.color_footprint = 0.3});
  EXPECT_EQ(histograms.grid().palette(), (std::vector<BinGrid::ColorBin>{{5, 0, 9}}));
}

TEST(ShapeColorHistograms, RareColoursAreCountedInTheNearestFrequentOnes) {
  const PerformanceDatabase database = database_of({dressed("walk", 2, blue), dressed("other", 1, green)});
  const ShapeColorHistograms all(database, literal(0.03));
  const std::map<BinGrid::ColorBin, double> shares = color_shares(all);
  for (const double least : {0.01, 0.05, 0.4}) {
    HistogramOptions options = literal(0.03);
    options.min_color_share = least;
    const ShapeColorHistograms merged(database, options);
    const std::vector<BinGrid::ColorBin>& palette = merged.grid().palette();
    EXPECT_LT(palette.size(), all.grid().palette().size());
    // Every rare colour goes to one of the nearest that are kept, so its voxels are found there.
    std::map<BinGrid::ColorBin, double> expected;
    for (const auto& [color, share] : shares) {
      const auto distance = [&color = color](const BinGrid::ColorBin& other) {
        int sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += (color[k] - other[k]) * (color[k] - other[k]);
        return sum;
      };
      expected[*std::ranges::min_element(palette, {}, distance)] += share;
      EXPECT_TRUE(share < least || std::ranges::count(palette, color) == 1);
    }
    for (const auto& [color, share] : color_shares(merged)) EXPECT_NEAR(share, expected[color], 1e-12);
    for (std::size_t f = 0; f < 3; ++f) {
      EXPECT_EQ(shape_of(merged, f), shape_of(all, f));
      const auto& entries = merged.frame(f).entries;
      EXPECT_LE(entries.size(), all.frame(f).entries.size());
      const auto place = [](const FineHistogram::Entry& e) {
        return std::tuple(e.cell_ring, e.azimuth, e.color);
      };
      EXPECT_TRUE(std::ranges::is_sorted(entries, {}, place));
      EXPECT_EQ(std::ranges::adjacent_find(entries, {}, place), entries.end()) << "equal ones are merged";
    }
  }
}

}  // namespace
}  // namespace reprise
