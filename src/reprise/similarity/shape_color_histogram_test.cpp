// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/shape_color_histogram.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/similarity/histogram_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using test::as_map;
using test::blue;
using test::database_of;
using test::difference;
using test::dressed;
using test::green;
using test::literal;
using ::testing::HasSubstr;
using ::testing::Throws;

// The coarse histogram of a turned frame, straight from the definition.
std::map<BinId, std::int64_t> turned_by_definition(const ShapeColorHistograms& histograms, std::size_t frame,
                                                   int half_turns) {
  const BinGrid& grid = histograms.grid();
  const int azimuth_bins = grid.options().azimuth_bins;
  const int fine = grid.half_turn_count();
  std::map<BinId, std::int64_t> bins;
  for (const FineHistogram::Entry& entry : histograms.frame(frame).entries) {
    const int azimuth = (((entry.azimuth + half_turns) % fine) + fine) % fine;
    const int cell = entry.cell_ring * azimuth_bins + azimuth * azimuth_bins / fine;
    bins[grid.bin(cell, entry.color)] += entry.count;
  }
  return bins;
}

TEST(ShapeColorHistograms, SignaturesKeepAllVoxelsAtEveryTurn) {
  const PerformanceDatabase database = database_of({dressed("walk", 3, blue)});
  for (const HistogramOptions& options :
       {HistogramOptions{.voxel_size = 0.04}, HistogramOptions{.azimuth_bins = 6, .azimuth_refinement = 3},
        HistogramOptions{.color_bins = {60, 60, 60}, .voxel_size = 0.03}, literal(0.05)}) {
    const ShapeColorHistograms histograms(database, options);
    const int fine = histograms.grid().half_turn_count();
    const int fine_per_bin = fine / options.azimuth_bins;
    EXPECT_EQ(fine, 2 * options.azimuth_bins * options.azimuth_refinement);
    Signature signature;
    for (std::size_t f = 0; f < histograms.frame_count(); ++f) {
      const auto whole = turned_by_definition(histograms, f, 0);
      for (int turn = -fine - 3; turn <= fine + 3; turn += fine < 50 ? 1 : 7) {
        histograms.signature(f, turn, signature);
        EXPECT_EQ(as_map(signature), turned_by_definition(histograms, f, turn)) << f << " by " << turn;
        EXPECT_TRUE(std::ranges::is_sorted(signature.bins));
        EXPECT_EQ(std::ranges::adjacent_find(signature.bins), signature.bins.end());
        EXPECT_GT(std::ranges::min(signature.masses), 0);
        EXPECT_EQ(signature.masses.size(), signature.bins.size());
        std::int64_t sum = 0;
        for (const auto& [bin, mass] : whole) sum += mass;
        EXPECT_EQ(signature.total, sum);
      }
      // A full circle is no turn.
      histograms.signature(f, fine, signature);
      EXPECT_EQ(as_map(signature), whole);
      // A turn by a coarse bin gives every bin the number of the next.
      histograms.signature(f, fine_per_bin, signature);
      std::map<BinId, std::int64_t> relabelled;
      for (const auto& [bin, mass] : whole) {
        const int cell = histograms.grid().cell_of(bin);
        const int ring = cell / options.azimuth_bins;
        const int next = (cell % options.azimuth_bins + 1) % options.azimuth_bins;
        relabelled[histograms.grid().bin(ring * options.azimuth_bins + next,
                                         histograms.grid().color_of(bin))] = mass;
      }
      EXPECT_EQ(as_map(signature), relabelled);
    }
  }
}

TEST(ShapeColorHistograms, LargePalettesAreCountedLikeSmallOnes) {
  // Every vertex its own colour: more than the 128 that fit into registers.
  MeshSequence clip = test::walk("walk", 1);
  std::vector<Color> colors;
  for (std::size_t v = 0; v < clip.vertex_count(); ++v) {
    colors.push_back({static_cast<std::uint8_t>(37 * v), static_cast<std::uint8_t>(101 * v),
                      static_cast<std::uint8_t>(11 * v)});
  }
  clip.set_colors(std::move(colors));
  const ShapeColorHistograms histograms(database_of({clip}), literal(0.03));
  ASSERT_GT(histograms.grid().color_count(), 128);
  Signature signature;
  for (const int turn : {0, 1, 7, 133, 399}) {
    histograms.signature(0, turn, signature);
    EXPECT_EQ(as_map(signature), turned_by_definition(histograms, 0, turn)) << turn;
    EXPECT_TRUE(std::ranges::is_sorted(signature.bins));
  }
}

TEST(ShapeColorHistograms, CountsTheVolume) {
  // A ball of radius 1 of 0.02 m voxels, at centres of cells whose volumes are known.
  const test::Shape ball = test::sphere(4);
  MeshSequence clip("ball", ball.topology, 1, 25.0);
  clip.frame(0) = ball.positions;
  const ShapeColorHistograms histograms(
      database_of({clip}), {.radius_bins = 1, .polar_bins = 1, .azimuth_bins = 2, .azimuth_refinement = 1});
  Signature signature;
  histograms.signature(0, 0, signature);
  EXPECT_NEAR(histograms.grid().max_radius(), 1.0 + 0.02, 0.02);
  // The touched voxels add a layer of half a voxel times 3/2.
  const double volume = 4.0 / 3.0 * std::numbers::pi + 4.0 * std::numbers::pi * 0.75 * 0.02;
  EXPECT_NEAR(static_cast<double>(signature.total) * 0.02 * 0.02 * 0.02, volume, 0.01 * volume);
  ASSERT_EQ(signature.size(), 2U);
  EXPECT_NEAR(signature.masses[0], signature.masses[1], 0.01 * signature.masses[0]);
  // Far more voxels a bin than 16 bits count.
  EXPECT_GT(signature.masses[0], 4 * std::numeric_limits<std::uint16_t>::max());
  EXPECT_GT(histograms.frame(0).entries.size(), 4U);
}

TEST(ShapeColorHistograms, NothingDependsOnThePlaceOnTheGround) {
  const MeshSequence walk = dressed("walk", 6, blue);
  MeshSequence moved = test::moved(walk, {.yaw = 1.234, .translation = {3.0, -7.0}}, "moved");
  moved.set_colors({walk.colors(0).begin(), walk.colors(0).end()});
  const ShapeColorHistograms histograms(database_of({walk, moved}), {});
  for (std::size_t f = 0; f < 6; ++f) {
    // float32 vertices lie elsewhere by a part in 10^7: a handful of voxels tell the difference.
    EXPECT_LT(difference(histograms, f, 6 + f), 0.001) << f;
    EXPECT_NEAR(wrap_angle(histograms.frame(f).yaw - histograms.frame(6 + f).yaw - 1.234), 0.0, 1e-5);
  }
  EXPECT_GT(difference(histograms, 0, 5), 0.01) << "other poses must differ";
}

TEST(ShapeColorHistograms, TurnsAsAYawDoes) {
  const ShapeColorHistograms histograms(database_of({dressed("walk", 1, blue)}), {});
  const BinGrid& grid = histograms.grid();
  const auto mean = [&](int half_turns) {
    Signature signature;
    histograms.signature(0, half_turns, signature);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < signature.size(); ++i) {
      const double red = grid.palette()[static_cast<std::size_t>(grid.color_of(signature.bins[i]))][0];
      sum += signature.masses[i] * red * grid.cell_point(grid.cell_of(signature.bins[i]));
    }
    return Eigen::Vector3d(sum / static_cast<double>(signature.total));
  };
  const Eigen::Vector3d still = mean(0);
  ASSERT_GT(std::hypot(still.x(), still.z()), 0.01);
  for (const int bins : {1, 5, -3}) {
    const Eigen::Matrix3d R = GroundTransform{.yaw = bins * 2.0 * std::numbers::pi / 20}.rotation();
    EXPECT_LT((mean(bins * 20) - R * still).norm(), 1e-9);
  }
}

TEST(ShapeColorHistograms, TheFrameTurnedByItsYawIsTheOneCounted) {
  // Where the hand with its own colour is in space is where its voxels are counted.
  const MeshSequence clip = dressed("walk", 1, blue);
  const ShapeColorHistograms histograms(database_of({clip}), literal());
  const BinGrid& grid = histograms.grid();
  const PositionsView positions = clip.frame(0);
  Eigen::Vector3d hand = Eigen::Vector3d::Zero();
  int count = 0;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (clip.colors(0)[static_cast<std::size_t>(v)] != Color{240, 30, 30}) continue;
    hand += positions.row(v).transpose().cast<double>();
    ++count;
  }
  ASSERT_GT(count, 2);
  hand = GroundTransform{.yaw = histograms.frame(0).yaw}.rotation() * (hand / count - centroid(positions));
  std::complex<double> direction = 0.0;
  for (const FineHistogram::Entry& entry : histograms.frame(0).entries) {
    if (grid.palette()[entry.color] != BinGrid::ColorBin{9, 1, 1}) continue;
    direction += std::polar(static_cast<double>(entry.count),
                            2.0 * std::numbers::pi * (entry.azimuth + 0.5) / grid.half_turn_count());
  }
  EXPECT_NEAR(wrap_angle(std::arg(direction) - std::atan2(hand.x(), hand.z())), 0.0, 0.1);
  // The reference looks at its farthest vertex, which is at the end of this arm.
  EXPECT_NEAR(std::arg(direction), 0.0, 0.2);
}

TEST(ShapeColorHistograms, AreTheSameForAnyNumberOfThreads) {
  const PerformanceDatabase database =
      database_of({dressed("walk", 8, blue), dressed("other", 5, green, 7.0)});
  const auto make = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return ShapeColorHistograms(database, {.voxel_size = 0.03});
  };
  const ShapeColorHistograms one = make(1);
  const ShapeColorHistograms four = make(4);
  EXPECT_EQ(one.grid().max_radius(), four.grid().max_radius());
  EXPECT_EQ(one.grid().palette(), four.grid().palette());
  for (std::size_t f = 0; f < one.frame_count(); ++f) {
    EXPECT_EQ(one.frame(f).yaw, four.frame(f).yaw);
    for (const int turn : {0, 11})
      EXPECT_EQ(turned_by_definition(one, f, turn), turned_by_definition(four, f, turn));
  }
}

TEST(ShapeColorHistograms, FlatSurfacesCountAsWhatTheyTouch) {
  const test::Shape sheet = test::sheet(4);
  MeshSequence clip("sheet", sheet.topology, 1, 25.0);
  clip.frame(0) = sheet.positions;
  const ShapeColorHistograms histograms(database_of({clip}), {.voxel_size = 0.1});
  Signature signature;
  histograms.signature(0, 0, signature);
  EXPECT_GE(signature.total, 100);
  EXPECT_LE(signature.total, 2 * 13 * 13);  // two layers if it lies between them, turned by any angle
}

TEST(ShapeColorHistograms, RealCapturesWithHolesAndFoldsAreCut) {
  REPRISE_REQUIRE_DATA();
  for (const char* name : {"ama/jumping", "horse_gallop"}) {
    const auto reader = open_sequence({.path = test::data_folder() / name});
    MeshSequence clip("clip", reader->topology(), 3, 25.0);
    for (std::size_t f = 0; f < 3; ++f) clip.frame(f) = reader->read(10 * f).positions;
    MeshSequence moved = test::moved(clip, {.yaw = -2.0, .translation = {1.0, 2.0}}, "moved");
    const ShapeColorHistograms histograms(database_of({clip, moved}), {});
    for (std::size_t f = 0; f < 3; ++f) EXPECT_LT(difference(histograms, f, 3 + f), 0.002) << name << f;
    EXPECT_GT(difference(histograms, 0, 2), 0.05);
  }
}

TEST(ShapeColorHistograms, SayWhatIsWrong) {
  const auto message = [](const char* text) {
    return Throws<InvalidArgument>(::testing::Property(&InvalidArgument::what, HasSubstr(text)));
  };
  const auto make = [](std::vector<MeshSequence> clips,
                       const HistogramOptions& options = {.voxel_size = 0.05}) {
    return ShapeColorHistograms(database_of(std::move(clips)), options);
  };
  const MeshSequence good = test::walk("good", 2);
  // No clip.
  EXPECT_THAT([&] { make({}); }, message("expected at least one clip"));
  // A vertex that is not finite, in the first frame and in a later one.
  for (const std::size_t frame : {0U, 1U}) {
    MeshSequence bad = test::walk("bad", 2);
    bad.frame(frame)(7, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT([&] { make({bad}); }, message(frame == 0 ? "bad:0: " : "bad:1: "));
    EXPECT_THAT([&] { make({good, bad}); }, message("vertex 7"));
  }
  // A surface without area.
  MeshSequence empty = test::walk("empty", 2);
  empty.frame(1).setConstant(1.0F);
  EXPECT_THAT([&] { make({good, empty}); }, message("empty:1: "));
  // Inside out: mirrored.
  MeshSequence mirrored = test::walk("mirrored", 3);
  mirrored.frame(2).col(0) *= -1.0F;
  EXPECT_THAT([&] { make({good, mirrored}); }, message("mirrored:2: the surface is inside out"));
  // Of several wrong frames the first, on any number of threads.
  mirrored.frame(1).col(0) *= -1.0F;
  EXPECT_THAT([&] { make({good, mirrored}); }, message("mirrored:1: the surface is inside out"));
  // Colours in one clip only.
  EXPECT_THAT(
      [&] {
        make({dressed("red", 1, blue), test::walk("plain", 1)});
      },
      message("found them in 'red' but not in 'plain'"));
  EXPECT_NO_THROW(make({dressed("red", 1, blue), test::walk("plain", 1)}, {.use_color = false}));
  // Options out of range.
  EXPECT_THAT([&] { make({good}, {.color_footprint = -0.1}); }, message("color_footprint is -0.1"));
  EXPECT_THAT([&] { make({good}, {.radius_bins = 0}); }, message("radius_bins is 0"));
  EXPECT_THAT([&] { make({good}, {.azimuth_bins = 7}); }, message("azimuth_bins is 7"));
  EXPECT_THAT([&] { make({good}, {.voxel_size = -1.0}); }, message("voxel_size is -1"));
  // More voxels than memory should hold: says how many and where.
  MeshSequence large = test::walk("large", 1);
  large.frame(0) *= 10.0F;
  EXPECT_THAT([&] { make({good, large}, {.voxel_size = 0.01}); }, message("large:0: a surface of"));
  // Texture coordinates that are not numbers.
  MeshSequence textured = test::walk("textured", 1);
  Topology topology = *textured.topology();
  topology.uvs = {{0.0F, 0.0F}, {1.0F, std::numeric_limits<float>::infinity()}};
  topology.triangle_uvs.assign(topology.triangles.size(), {0, 1, 0});
  topology.texture = std::make_shared<const Image>(Image{.width = 1, .height = 1, .rgb = {1, 2, 3}});
  textured.share_topology(std::make_shared<const Topology>(std::move(topology)));
  EXPECT_THAT([&] { make({textured}); }, message("texture coordinate 1: expected finite numbers"));
}

}  // namespace
}  // namespace reprise
