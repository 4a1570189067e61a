// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gnuplot.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

constexpr int gap = 16;          // around every picture, pixels
constexpr int line_height = 20;  // of a caption
constexpr int title_height = 46;

void paste(const Image& image, int left, int top, Image& canvas) {
  const auto bytes = 3 * static_cast<std::size_t>(image.width);
  for (int row = 0; row < image.height; ++row) {
    const auto to = 3 * (static_cast<std::size_t>(top + row) * static_cast<std::size_t>(canvas.width) +
                         static_cast<std::size_t>(left));
    std::memcpy(canvas.rgb.data() + to, image.rgb.data() + bytes * static_cast<std::size_t>(row), bytes);
  }
}

}  // namespace

void draw_sheet(const std::vector<CaptionedPicture>& pictures, int columns, const std::string& title,
                const std::filesystem::path& png) {
  if (pictures.empty() || columns < 1) {
    throw InvalidArgument(
        fmt::format("draw_sheet: expected at least one picture and one column, found {} pictures, {} columns",
                    pictures.size(), columns));
  }
  const Image& first = pictures.front().image;
  std::size_t lines = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Image& image = pictures[i].image;
    validate(image);
    if (image.width != first.width || image.height != first.height) {
      throw InvalidArgument(fmt::format("draw_sheet: picture {} is {} x {}, but the first is {} x {}", i,
                                        image.width, image.height, first.width, first.height));
    }
    lines = std::max(lines, pictures[i].lines.size());
  }
  columns = std::min(columns, static_cast<int>(pictures.size()));
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  const int caption = line_height * static_cast<int>(lines) + 6;
  const int cell_width = first.width + gap;
  const int cell_height = first.height + caption + gap;

  Image canvas{.width = columns * cell_width + gap, .height = title_height + rows * cell_height + gap};
  canvas.rgb.assign(3 * static_cast<std::size_t>(canvas.width) * static_cast<std::size_t>(canvas.height),
                    255);
  std::string script = gnuplot_canvas(canvas.width, canvas.height, 13);
  script += "set margins 0,0,0,0\nunset border\nunset tics\nunset key\n";
  script += fmt::format("set xrange [0:{}]\nset yrange [{}:0]\n", canvas.width, canvas.height);
  script += fmt::format("set label {} at {},{} left front font ',17' tc rgb '#202020'\n",
                        gnuplot_quoted(title), gap, title_height / 2 + 4);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int left = gap + cell_width * (static_cast<int>(i) % columns);
    const int top = title_height + cell_height * (static_cast<int>(i) / columns);
    paste(pictures[i].image, left, top, canvas);
    for (std::size_t line = 0; line < pictures[i].lines.size(); ++line) {
      script += fmt::format("set label {} at {},{} center front font ',{}' tc rgb '#{}'\n",
                            gnuplot_quoted(pictures[i].lines[line]), left + first.width / 2,
                            top + first.height + line_height * (static_cast<int>(line) + 1) - 8,
                            line == 0 ? 13 : 12, line == 0 ? "202020" : "606060");
    }
  }
  const GnuplotFolder folder;
  folder.write("sheet.bin", canvas.rgb);
  // A pixel is placed by its centre.
  script += fmt::format(
      "plot 'sheet.bin' binary array=({},{}) format='%uchar%uchar%uchar' origin=(0.5,0.5) dx=1 dy=1 with "
      "rgbimage\n",
      canvas.width, canvas.height);
  folder.draw(script, png);
}

}  // namespace reprise
