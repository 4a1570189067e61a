// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "reprise/render/child_process.h"
#include "reprise/render/plots.h"
#include "reprise/render/renderer.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Image gradient(int width, int height, int shift = 0) {
  Image image{.width = width, .height = height};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<std::uint8_t>(x + shift));
      image.rgb.push_back(static_cast<std::uint8_t>(y));
      image.rgb.push_back(static_cast<std::uint8_t>(x * y));
    }
  }
  return image;
}

std::size_t count_near(const Image& image, Color color, int tolerance = 3) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    bool near = true;
    for (std::size_t c = 0; c < 3; ++c)
      near = near && std::abs(int{image.rgb[i + c]} - int{color[c]}) <= tolerance;
    count += near ? 1 : 0;
  }
  return count;
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// What a program prints; its arguments are fixed by the test.
std::string output_of(const std::vector<std::string>& arguments, const fs::path& file) {
  ChildProcess child(arguments, {.output = file}, "by the tests");
  EXPECT_TRUE(child.finish()) << child.report();
  return read_text_file(file);
}

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(Tile, PutsEveryImageWholeInItsPlace) {
  const std::vector<Image> images = {gradient(5, 4), gradient(5, 4, 50), gradient(5, 4, 100)};
  const Image tiled = tile(images, 2);
  ASSERT_EQ(tiled.width, 10);
  ASSERT_EQ(tiled.height, 8);
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t y = 0; y < 4; ++y) {
      for (std::size_t x = 0; x < 15; ++x) {
        EXPECT_EQ(tiled.rgb[((i / 2) * 4 + y) * 30 + (i % 2) * 15 + x], images[i].rgb[y * 15 + x]);
      }
    }
  }
  EXPECT_EQ(tile({images[0]}, 7).rgb, images[0].rgb);
  EXPECT_THROW(tile({}, 1), InvalidArgument);
  EXPECT_THROW(tile(images, 0), InvalidArgument);
  EXPECT_THROW(tile({gradient(5, 4), gradient(4, 5)}, 2), InvalidArgument);
}

TEST(VideoWriter, HasEveryFrameTheSizeAndTheRate) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a:b 'c'.mp4";
  VideoWriter video(path, 64, 48, 25.0);
  for (int i = 0; i < 9; ++i) video.append(gradient(64, 48, 10 * i));
  EXPECT_FALSE(fs::exists(path)) << "only whole videos have their name";
  video.commit();
  ASSERT_EQ(entries(folder.path()), 1U);
  const std::string facts = output_of(
      {"ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "default", "file:" + path.string()},
      folder / "facts");
  EXPECT_THAT(facts, AllOf(HasSubstr("codec_name=h264"), HasSubstr("width=64"), HasSubstr("height=48"),
                           HasSubstr("nb_read_frames=9"), HasSubstr("r_frame_rate=25/1"),
                           HasSubstr("pix_fmt=yuv420p"), HasSubstr("color_space=bt709"),
                           HasSubstr("color_range=tv")));
}

TEST(VideoWriter, KeepsColors) {
  const TemporaryFolder folder;
  Image red{.width = 32, .height = 32};
  for (int i = 0; i < 32 * 32; ++i) red.rgb.insert(red.rgb.end(), {200, 40, 60});
  VideoWriter video(folder / "red.mp4", 32, 32, 25.0);
  video.append(red);
  video.commit();
  const std::string raw = output_of({"ffmpeg", "-v", "error", "-i", (folder / "red.mp4").string(), "-f",
                                     "rawvideo", "-pix_fmt", "rgb24", "pipe:1"},
                                    folder / "raw");
  ASSERT_EQ(raw.size(), red.rgb.size());
  const std::size_t pixel = 500;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(static_cast<std::uint8_t>(raw[3 * pixel + c]), red.rgb[c], 4);
  }
}

TEST(VideoWriter, LeavesNothingWithoutACommit) {
  const TemporaryFolder folder;
  {
    VideoWriter video(folder / "a.mp4", 64, 48, 25.0);
    video.append(gradient(64, 48));
  }
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(VideoWriter, RefusesBadSizesRatesAndFrames) {
  const TemporaryFolder folder;
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 63, 48, 25.0), InvalidArgument);
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 64, 47, 25.0), InvalidArgument);
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 0, 48, 25.0), InvalidArgument);
  EXPECT_THROW(VideoWriter(folder / "a.mp4", 64, 48, 0.0), InvalidArgument);
  EXPECT_THROW(VideoWriter(folder / "no" / "a.mp4", 64, 48, 25.0), FileError);
  VideoWriter video(folder / "a.mp4", 64, 48, 25.0);
  EXPECT_THROW(video.append(gradient(48, 64)), InvalidArgument);
  EXPECT_THROW(video.commit(), InvalidArgument);
}

TEST(ChildProcess, AMissingProgramIsNamedWithWhatItIsNeededFor) {
  const auto start = [] { ChildProcess child({"reprise-no-such-program"}, {}, "to fly"); };
  EXPECT_THAT(message_of(start), AllOf(HasSubstr("reprise-no-such-program"), HasSubstr("to fly")));
}

TEST(ChildProcess, ADeadChildIsAFailedWriteNotASignal) {
  ChildProcess child({"false"}, {.input = true}, "by the tests");
  const std::vector<std::uint8_t> bytes(1 << 20);
  EXPECT_FALSE(child.write(bytes) && child.write(bytes));
  EXPECT_FALSE(child.finish());
  EXPECT_THAT(child.report(), HasSubstr("status 1"));
}

DissimilarityMatrix striped(std::size_t first_clip, std::size_t second_clip) {
  DissimilarityMatrix matrix("vertex", "key", {"it's `one`", "two_2"}, {first_clip, second_clip});
  for (std::size_t a = 0; a < matrix.frame_count(); ++a) {
    for (std::size_t b = a + 1; b < matrix.frame_count(); ++b) {
      matrix.set(a, b, (b - a) % 20 < 10 ? 0.05F : 0.1F, 0.0F);
    }
  }
  return matrix;
}

TEST(PlotMatrix, ShowsThePaletteAndTheTransitions) {
  const TemporaryFolder folder;
  const DissimilarityMatrix matrix = striped(60, 40);
  plot_matrix(matrix, {}, folder / "plain.png");
  plot_matrix(matrix, {{.source_clip = 0, .target_clip = 1, .m = 30, .n = 20}}, folder / "marked.png");
  const Image plain = read_image(folder / "plain.png");
  const Image marked = read_image(folder / "marked.png");
  EXPECT_EQ(plain.width, 1400);
  EXPECT_EQ(plain.height, 1250);
  EXPECT_GT(count_near(plain, {0x44, 0x01, 0x54}), 3000U) << "the diagonal";
  EXPECT_GT(count_near(plain, {0xfd, 0xe7, 0x25}), 100000U) << "the largest value";
  EXPECT_GT(count_near(plain, {0x21, 0x91, 0x8c}), 100000U) << "half of it";
  // The mark changes the picture around its own place, and only there: row 30 of 100, column 80 of 100.
  std::size_t inside = 0;
  std::size_t outside = 0;
  for (int y = 0; y < 1250; ++y) {
    for (int x = 0; x < 1400; ++x) {
      const std::size_t i = 3 * (static_cast<std::size_t>(y) * 1400 + static_cast<std::size_t>(x));
      if (std::equal(&plain.rgb[i], &plain.rgb[i] + 3, &marked.rgb[i])) continue;
      const bool near = std::hypot(x - (170.0 + 10.4 * 80.5), y - (75.0 + 10.4 * 30.5)) < 12.0;
      (near ? inside : outside) += 1;
    }
  }
  EXPECT_GT(inside, 20U);
  EXPECT_EQ(outside, 0U);
}

TEST(PlotMatrix, MoreFramesThanPixelsStillFit) {
  const TemporaryFolder folder;
  plot_matrix(striped(1500, 1300), {}, folder / "large.png");
  EXPECT_EQ(read_image(folder / "large.png").width, 1400);
}

TEST(PlotMatrix, RefusesTransitionsOutsideAndLeavesNothing) {
  const TemporaryFolder folder;
  const DissimilarityMatrix matrix = striped(6, 4);
  EXPECT_THROW(plot_matrix(matrix, {{.source_clip = 0, .target_clip = 2}}, folder / "a.png"),
               InvalidArgument);
  EXPECT_THROW(plot_matrix(matrix, {{.source_clip = 0, .target_clip = 1, .m = 0, .n = 4}}, folder / "a.png"),
               InvalidArgument);
  EXPECT_THROW(plot_matrix(DissimilarityMatrix(), {}, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(plot_matrix(matrix, {}, folder / "no" / "a.png"), FileError);
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(PlotMatrices, EveryPanelHasItsOwnScaleAndMarks) {
  const TemporaryFolder folder;
  const DissimilarityMatrix matrix = striped(60, 40);
  DissimilarityMatrix halved = matrix;
  for (std::size_t a = 0; a < 100; ++a) {
    for (std::size_t b = a + 1; b < 100; ++b) halved.set(a, b, 0.5F * matrix.value(a, b), 0.0F);
  }
  const std::vector<Transition> transitions = {{.source_clip = 0, .target_clip = 1, .m = 30, .n = 20}};
  const std::vector<MatrixPanel> one = {{.matrix = &matrix, .title = "a"}};
  const std::vector<MatrixPanel> two = {{.matrix = &matrix, .title = "a"}, {.matrix = &halved, .title = "b"}};
  const std::vector<MatrixPanel> marked = {{.matrix = &matrix, .title = "a"},
                                           {.matrix = &halved, .transitions = &transitions, .title = "b"}};
  plot_matrices(one, 4, folder / "one.png");
  plot_matrices(two, 2, folder / "two.png");
  plot_matrices(marked, 2, folder / "marked.png");
  const Image single = read_image(folder / "one.png");
  const Image pair = read_image(folder / "two.png");
  const Image with_marks = read_image(folder / "marked.png");
  EXPECT_GT(pair.width, single.width);
  EXPECT_EQ(pair.height, single.height);
  const Color largest = {0xfd, 0xe7, 0x25};
  EXPECT_NEAR(static_cast<double>(count_near(pair, largest)),
              2.0 * static_cast<double>(count_near(single, largest)),
              0.02 * static_cast<double>(count_near(pair, largest)))
      << "half the values on half the scale look the same";
  // Marks change the second panel alone.
  ASSERT_EQ(with_marks.rgb.size(), pair.rgb.size());
  std::array<std::size_t, 2> changed = {0, 0};
  const auto width = static_cast<std::size_t>(pair.width);
  for (std::size_t i = 0; i < pair.rgb.size(); i += 3) {
    const bool same = std::equal(&pair.rgb[i], &pair.rgb[i] + 3, &with_marks.rgb[i]);
    changed[2 * (i / 3 % width) > width ? 1 : 0] += same ? 0 : 1;
  }
  EXPECT_EQ(changed[0], 0U);
  EXPECT_GT(changed[1], 20U);
}

TEST(PlotMatrices, RefusesNothingAndOtherClips) {
  const TemporaryFolder folder;
  const DissimilarityMatrix matrix = striped(6, 4);
  const DissimilarityMatrix other = striped(4, 6);
  const std::vector<MatrixPanel> differ = {{.matrix = &matrix, .title = "a"},
                                           {.matrix = &other, .title = "b"}};
  const std::vector<MatrixPanel> null = {{.title = "a"}};
  EXPECT_THROW(plot_matrices({}, 2, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(plot_matrices(differ, 2, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(plot_matrices(null, 2, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(plot_matrices({differ.data(), 1}, 0, folder / "a.png"), InvalidArgument);
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(PlotCurves, DrawsEveryCurveInItsColor) {
  const TemporaryFolder folder;
  const Curve high = {.name = "it's `high`", .points = {{0.0, 0.9}, {1.0, 0.9}}};
  const Curve low = {.name = "low_1", .points = {{0.0, 0.1}, {1.0, 0.1}}};
  const std::vector<CurvePanel> both = {{.title = "a", .curves = {high, low}},
                                        {.title = "b", .curves = {low}}};
  const std::vector<CurvePanel> first = {{.title = "a", .curves = {high}}, {.title = "b"}};
  plot_curves(both, folder / "both.png");
  plot_curves(first, folder / "first.png");
  const Color first_color = {0xd5, 0x5e, 0x00};
  const Color second_color = {0x00, 0x72, 0xb2};
  const Image drawn = read_image(folder / "both.png");
  EXPECT_GT(count_near(drawn, first_color), 400U);
  EXPECT_GT(count_near(drawn, second_color), 800U) << "in both panels";
  EXPECT_EQ(count_near(read_image(folder / "first.png"), second_color), 0U);
  EXPECT_THROW(plot_curves({}, folder / "none.png"), InvalidArgument);
}

TEST(PlotGrids, ShowsEveryPlaceInItsColorAndNothingAsGrey) {
  const TemporaryFolder folder;
  const Color lowest = {0x44, 0x01, 0x54}, highest = {0xfd, 0xe7, 0x25}, grey = {0xc8, 0xc8, 0xc8};
  const auto drawn = [&](const std::vector<std::vector<double>>& rows, double largest = 0.0) {
    const GridPanel panel{.title = "it's a `panel`", .rows = rows, .largest = largest};
    plot_grids({&panel, 1}, {.x_label = "x", .y_label = "y"}, "title", folder / "grid.png");
    return read_image(folder / "grid.png");
  };
  // All places are as large as each other, but for what the border covers; low and high values are on the
  // colour bar as well.
  const Image image = drawn({{0.0, 2.0}, {NAN, 0.0}});
  const std::size_t cell = count_near(image, grey);
  EXPECT_GT(cell, 1000U);
  EXPECT_GT(20 * count_near(image, lowest), 2 * 19 * cell);
  EXPECT_LT(count_near(image, lowest), 3 * cell);
  EXPECT_GT(20 * count_near(image, highest), 19 * cell);
  EXPECT_LT(count_near(image, highest), 2 * cell);
  // y goes upwards: what is in the first row stands below.
  const auto middle_row = [&](const Image& picture, const Color& color) {
    double sum = 0.0;
    std::size_t count = 0;
    for (int y = 0; y < picture.height; ++y) {
      const auto stride = 3 * static_cast<std::size_t>(picture.width);
      const Image row{
          .width = picture.width,
          .height = 1,
          .rgb = {
              picture.rgb.begin() + static_cast<std::ptrdiff_t>(stride * static_cast<std::size_t>(y)),
              picture.rgb.begin() + static_cast<std::ptrdiff_t>(stride * static_cast<std::size_t>(y + 1))}};
      const std::size_t here = count_near(row, color);
      sum += static_cast<double>(here) * y;
      count += here;
    }
    return sum / static_cast<double>(count);
  };
  const Image split = drawn({{NAN, NAN}, {0.0, 0.0}});
  EXPECT_GT(middle_row(split, grey), middle_row(split, lowest));
  EXPECT_LT(count_near(drawn({{1.0, 1.0}}, 4.0), highest), cell) << "the scale goes on to 4";

  const auto refuses = [&](const std::vector<GridPanel>& panels) {
    EXPECT_THROW(plot_grids(panels, {}, "", folder / "none.png"), InvalidArgument);
  };
  refuses({});
  refuses({{.title = "empty"}});
  refuses({{.title = "ragged", .rows = {{1.0, 2.0}, {1.0}}}});
  EXPECT_FALSE(fs::exists(folder / "none.png"));
}

TEST(PlotDots, ShowsEverySeriesInItsColor) {
  const TemporaryFolder folder;
  const Color first = {0xd5, 0x5e, 0x00}, second = {0x00, 0x72, 0xb2};
  const auto drawn = [&](const std::vector<DotSeries>& series, DotPanel::Scale scale) {
    const DotPanel panel{.title = "panel", .x_label = "x", .scale = scale, .series = series};
    plot_dots({"a", "it's b"}, {&panel, 1}, folder / "dots.png");
    return read_image(folder / "dots.png");
  };
  using Scale = DotPanel::Scale;
  const Image key = drawn({{"one", {NAN, NAN}}, {"two", {NAN, NAN}}}, Scale::from_zero);
  for (const Scale scale : {Scale::from_zero, Scale::logarithmic}) {
    const Image both = drawn({{"one", {0.5, 3.0}}, {"two", {NAN, 20.0}}}, scale);
    const std::size_t mark = count_near(key, first);
    EXPECT_GE(count_near(both, first), 2 * mark) << "two and the key";
    EXPECT_GT(count_near(both, second), count_near(key, second));
  }
  EXPECT_EQ(count_near(drawn({{"one", {0.0, NAN}}, {"two", {NAN, 1.0}}}, Scale::logarithmic), first),
            count_near(key, first))
      << "zero has no place on a logarithmic scale";
  const DotPanel uneven{.title = "uneven", .series = {{"one", {1.0}}}};
  EXPECT_THROW(plot_dots({"a", "b"}, {&uneven, 1}, folder / "none.png"), InvalidArgument);
  EXPECT_THROW(plot_dots({}, {&uneven, 1}, folder / "none.png"), InvalidArgument);
  EXPECT_THROW(plot_dots({"a"}, {}, folder / "none.png"), InvalidArgument);
}

TEST(DrawSheet, ShowsEveryPicturePixelForPixel) {
  const TemporaryFolder folder;
  const std::vector<CaptionedPicture> pictures = {{.image = gradient(120, 60), .lines = {"a", "it's"}},
                                                  {.image = gradient(120, 60, 40), .lines = {"b"}},
                                                  {.image = gradient(120, 60, 80), .lines = {}}};
  draw_sheet(pictures, 2, "three `pictures`", folder / "sheet.png");
  const Image sheet = read_image(folder / "sheet.png");
  const auto shows = [&](const Image& picture) {
    const auto stride = 3 * static_cast<std::size_t>(sheet.width);
    for (std::size_t top = 0; top + 60 <= static_cast<std::size_t>(sheet.height); ++top) {
      for (std::size_t left = 0; left + 120 <= static_cast<std::size_t>(sheet.width); ++left) {
        bool same = true;
        for (std::size_t row = 0; same && row < 60; ++row) {
          const auto* begin = sheet.rgb.data() + (top + row) * stride + 3 * left;
          same = std::equal(begin, begin + 360, picture.rgb.data() + 360 * row);
        }
        if (same) return true;
      }
    }
    return false;
  };
  for (const CaptionedPicture& picture : pictures) EXPECT_TRUE(shows(picture.image));
  EXPECT_FALSE(shows(gradient(120, 60, 20)));
  EXPECT_THROW(draw_sheet({}, 2, "", folder / "none.png"), InvalidArgument);
  EXPECT_THROW(draw_sheet({{.image = gradient(4, 4)}, {.image = gradient(4, 5)}}, 2, "", folder / "none.png"),
               InvalidArgument);
  EXPECT_FALSE(fs::exists(folder / "none.png"));
}

SurfaceMotionGraph complete_graph(std::size_t clip_count) {
  SurfaceMotionGraph graph;
  for (std::size_t c = 0; c < clip_count; ++c) {
    graph.clips.push_back(
        {.name = fmt::format("clip <{}> & \\N", c), .frame_count = 50, .frames_per_second = 25.0});
  }
  for (std::size_t a = 0; a < clip_count; ++a) {
    for (std::size_t b = 0; b < clip_count; ++b) {
      graph.transitions.push_back(
          {.source_clip = a, .target_clip = b, .m = 12, .n = 30, .half_window = 8, .cost = 0.13});
    }
  }
  return graph;
}

void expect_well_formed(const fs::path& svg, const fs::path& scratch) {
  // xmllint reads the document type's file from the network unless told not to.
  ChildProcess child({"xmllint", "--nonet", "--noout", svg.string()}, {.output = scratch}, "by the tests");
  EXPECT_TRUE(child.finish()) << child.report();
}

TEST(DrawGraph, HasEveryNodeAndEveryEdgeAndIsWellFormed) {
  for (const std::size_t clip_count : {1U, 3U, 9U}) {
    const TemporaryFolder folder;
    const fs::path path = folder / "graph.svg";
    draw_graph(complete_graph(clip_count), path);
    const std::string svg = read_text_file(path);
    EXPECT_EQ(occurrences(svg, "class=\"node\""), clip_count);
    EXPECT_EQ(occurrences(svg, "class=\"edge\""), clip_count * clip_count);
    for (std::size_t c = 0; c < clip_count; ++c) {
      EXPECT_THAT(svg, HasSubstr(fmt::format("clip &lt;{}&gt; &amp; \\N", c)))
          << "names are text, not markup";
    }
    EXPECT_THAT(svg, HasSubstr("50 frames, 2.0 s"));
    EXPECT_THAT(svg, HasSubstr("12→30, L 8, 0.130 m"));
    EXPECT_THAT(svg, Not(HasSubstr("stroke-dasharray")));
    expect_well_formed(path, folder / "scratch");
  }
}

TEST(DrawGraph, RemovedEdgesAreDashed) {
  const TemporaryFolder folder;
  SurfaceMotionGraph graph = complete_graph(2);
  graph.removed.push_back({.source_clip = graph.clips[0].name, .target_clip = graph.clips[1].name});
  draw_graph(graph, folder / "graph.svg");
  const std::string svg = read_text_file(folder / "graph.svg");
  EXPECT_EQ(occurrences(svg, "class=\"edge\""), 4U);
  EXPECT_EQ(occurrences(svg, "stroke-dasharray"), 1U);
}

TEST(DrawGraph, AMissingFolderIsAFileError) {
  const TemporaryFolder folder;
  EXPECT_THROW(draw_graph(complete_graph(2), folder / "no" / "graph.svg"), FileError);
}

}  // namespace
}  // namespace reprise
