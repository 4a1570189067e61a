// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/render/gnuplot.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

// Where things stand, in pixels of the picture.
struct Layout {
  int width = 1400;
  int height = 1250;
  std::size_t side = 1040;  // of a square plot
  double left = 170.0;      // of the first panel
  double top = 75.0;
  double column_step = 0.0;  // from panel to panel
  double row_step = 0.0;
  double bar_gap = 25.0;
  double bar_width = 28.0;
  int font = 13;
  int title_font = 16;
  int name_font = 12;
  double letter_width = 9.0;   // of a clip name
  double name_spacing = 13.0;  // least distance of two names
  int name_slope = 38;         // degrees, of those below that do not fit otherwise
  bool has_ticks = true;
  bool has_labels = true;  // of axes and colour bar
  double mark_scale = 1.0;
};

// Many panels share one picture that is shown a page wide, so that text is larger than the plots are.
Layout panel_layout(int columns, int rows) {
  Layout layout;
  layout.side = 340;
  layout.left = 150.0;
  layout.top = 46.0;
  layout.column_step = 340.0 + 108.0;
  layout.row_step = 340.0 + 56.0;
  layout.width = static_cast<int>(layout.left + layout.column_step * columns);
  layout.height = static_cast<int>(layout.top + layout.row_step * rows + 72.0);
  layout.bar_gap = 12.0;
  layout.bar_width = 14.0;
  layout.font = 14;
  layout.title_font = 16;
  layout.name_font = 14;
  layout.letter_width = 10.5;
  layout.name_spacing = 17.0;
  layout.name_slope = 58;
  layout.has_ticks = false;
  layout.has_labels = false;
  layout.mark_scale = 0.72;
  return layout;
}

// The frames that one pixel of the plot stands for: [first, last).
struct PixelFrames {
  std::size_t first = 0;
  std::size_t last = 0;
};

PixelFrames frames_of_pixel(std::size_t pixel, std::size_t frame_count, std::size_t side) {
  const std::size_t first = pixel * frame_count / side;
  return {first, std::max(first + 1, (pixel + 1) * frame_count / side)};
}

// Values as the plot shows them, one a pixel, rows top to bottom. Drawn pixel for pixel: gnuplot would leave
// seams between frames, or blur them.
std::vector<float> raster(const DissimilarityMatrix& matrix, std::size_t side) {
  std::vector<float> values(side * side);
  parallel_for(0, side, [&](std::size_t row) {
    const PixelFrames rows = frames_of_pixel(row, matrix.frame_count(), side);
    for (std::size_t column = row; column < side; ++column) {
      const PixelFrames columns = frames_of_pixel(column, matrix.frame_count(), side);
      float least = INFINITY;
      for (std::size_t a = rows.first; a < rows.last; ++a) {
        for (std::size_t b = columns.first; b < columns.last; ++b)
          least = std::min(least, matrix.value(a, b));
      }
      values[row * side + column] = least;
      values[column * side + row] = least;
    }
  });
  return values;
}

// 1, 2 or 5 times a power of ten, so that ticks lie at least about 45 pixels apart.
int tick_step(double pixels_per_frame) {
  const double least = 45.0 / pixels_per_frame;
  return static_cast<int>(round_step(std::max(least, 1.0)));
}

// Ticks count the frames of each clip, as in "clip:frame"; none so near to the next clip that its 0 would
// touch.
std::string tick_script(const DissimilarityMatrix& matrix, double pixels_per_frame) {
  const int step = tick_step(pixels_per_frame);
  std::string ticks;
  for (std::size_t c = 0; c < matrix.clip_names().size(); ++c) {
    const auto first = static_cast<double>(matrix.first_frame(c));
    const auto count = static_cast<double>(matrix.clip_frame_counts()[c]);
    for (int tick = 0; tick < static_cast<int>(count); tick += step) {
      const bool has_room = tick == 0 ? count * pixels_per_frame > 14.0 : tick + 0.6 * step <= count;
      if (has_room) ticks += fmt::format("{}'{}' {}", ticks.empty() ? "" : ", ", tick, first + tick);
    }
  }
  return fmt::format(
      "set xtics out nomirror scale 0.5 font ',9' offset 0,0.35 ({0})\n"
      "set ytics out nomirror scale 0.5 font ',9' offset 0.5,0 ({0})\n",
      ticks);
}

std::string clip_script(const DissimilarityMatrix& matrix, const Layout& layout, bool names_left,
                        bool names_below) {
  const double pixels_per_frame =
      static_cast<double>(layout.side) / static_cast<double>(matrix.frame_count());
  const auto& names = matrix.clip_names();
  const auto& counts = matrix.clip_frame_counts();
  bool names_fit = true;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const double wanted = layout.letter_width * static_cast<double>(names[c].size()) + 10.0;
    names_fit = names_fit && wanted <= pixels_per_frame * static_cast<double>(counts[c]);
  }
  const double offset_left = layout.has_ticks ? -5.2 : -0.8;
  const double offset_below = layout.has_ticks ? -2.1 : -0.8;

  std::string script;
  double last_name_position = -1e9;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto first = static_cast<double>(matrix.first_frame(c));
    if (c > 0) {
      script += fmt::format(
          "set arrow from {0},graph 0 to {0},graph 1 nohead front lw 1.2 lc rgb '#66ffffff'\n"
          "set arrow from graph 0,first {0} to graph 1,first {0} nohead front lw 1.2 lc rgb '#66ffffff'\n",
          first);
    }
    // A clip too thin for a line of text of its own goes unnamed rather than unreadable.
    const double middle = first + 0.5 * static_cast<double>(counts[c]);
    if ((middle - last_name_position) * pixels_per_frame < layout.name_spacing) continue;
    last_name_position = middle;
    const std::string name = gnuplot_quoted(names[c]);
    if (names_below) {
      script += fmt::format(
          "set label {} at {},graph 0 offset character 0,{} {} font ',{}' tc rgb '#202020'\n", name, middle,
          offset_below,
          names_fit ? std::string("center") : fmt::format("right rotate by {}", layout.name_slope),
          layout.name_font);
    }
    if (names_left) {
      script += fmt::format(
          "set label {} at graph 0,first {} right offset character {},0 font ',{}' tc rgb '#202020'\n", name,
          middle, offset_left, layout.name_font);
    }
  }
  return script;
}

std::vector<double> transition_points(const MatrixPanel& panel) {
  std::vector<double> points;
  if (panel.transitions == nullptr) return points;
  const auto& counts = panel.matrix->clip_frame_counts();
  for (const Transition& t : *panel.transitions) {
    const bool fits = t.source_clip < counts.size() && t.target_clip < counts.size() && t.m >= 0 &&
                      t.n >= 0 && static_cast<std::size_t>(t.m) < counts[t.source_clip] &&
                      static_cast<std::size_t>(t.n) < counts[t.target_clip];
    if (!fits) {
      throw InvalidArgument(fmt::format(
          "transitions: clip {} frame {} -> clip {} frame {} lies outside of the matrix of {} clips",
          t.source_clip, t.m, t.target_clip, t.n, counts.size()));
    }
    points.push_back(static_cast<double>(panel.matrix->first_frame(t.target_clip)) + t.n + 0.5);
    points.push_back(static_cast<double>(panel.matrix->first_frame(t.source_clip)) + t.m + 0.5);
  }
  return points;
}

// A panel with its upper left corner at (left, top); its data lie in `folder` under names with `index`.
std::string panel_script(const MatrixPanel& panel, const Layout& layout, double left, double top,
                         bool names_left, bool names_below, std::size_t index, const GnuplotFolder& folder) {
  const std::vector<double> points = transition_points(panel);
  const std::vector<float> values = raster(*panel.matrix, layout.side);
  const std::string matrix_file = fmt::format("matrix{}.bin", index);
  const std::string transitions_file = fmt::format("transitions{}.bin", index);
  folder.write(matrix_file, values);
  folder.write(transitions_file, points);
  float largest = 0.0F;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }

  const auto width = static_cast<double>(layout.width);
  const auto height = static_cast<double>(layout.height);
  const auto side = static_cast<double>(layout.side);
  const auto frame_count = static_cast<double>(panel.matrix->frame_count());
  const double bottom = height - top - side;
  std::string script = "unset label\nunset arrow\nunset xtics\nunset ytics\n";
  script += fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
      "{}\n",
      left / width, (left + side) / width, bottom / height, (bottom + side) / height);
  script += fmt::format("set title {} font ',{}' offset 0,{}\n", gnuplot_quoted(panel.title),
                        layout.title_font, layout.has_labels ? -0.3 : -0.4);
  script += fmt::format("set xrange [0:{0}]\nset yrange [{0}:0]\nset cbrange [0:{1}]\n", frame_count,
                        largest > 0.0F ? largest : 1.0F);
  script += fmt::format("set colorbox user origin {},{} size {},{}\n", (left + side + layout.bar_gap) / width,
                        bottom / height, layout.bar_width / width, side / height);
  if (layout.has_labels) {
    script += "set cblabel 'dissimilarity (m)' font ',13' offset 0.8,0\nset cbtics font ',11' scale 0.5\n";
    script += "set label 'target frame' at graph 0.5,screen 0.018 center font ',13'\n";
    script += "set label 'source frame' at screen 0.018,graph 0.5 center rotate by 90 font ',13'\n";
  } else {
    script += fmt::format("set cbtics font ',{}' scale 0.3 offset -0.6,0 format '%.2g m' {}\n",
                          layout.name_font - 1, round_step((largest > 0.0F ? largest : 1.0) / 5.0));
  }
  if (layout.has_ticks) script += tick_script(*panel.matrix, side / frame_count);
  script += clip_script(*panel.matrix, layout, names_left, names_below);
  // An image is placed by the centre of its first pixel.
  const double pixel = frame_count / side;
  script += fmt::format(
      "plot '{3}' binary array=({0},{0}) format='%float32' origin=({1},{1}) dx={2} dy={2} with image",
      layout.side, 0.5 * pixel, pixel, matrix_file);
  if (!points.empty()) {
    const std::string data =
        fmt::format("'{}' binary record=({}) format='%float64%float64' using 1:2 with points pt 7",
                    transitions_file, points.size() / 2);
    script +=
        fmt::format(", {0} ps {1} lc rgb '#303030', {0} ps {2} lc rgb '#ffd21a', {0} ps {3} lc rgb '#fffbe0'",
                    data, 1.25 * layout.mark_scale, 1.05 * layout.mark_scale, 0.5 * layout.mark_scale);
  }
  return script + "\n";
}

void draw_panels(std::span<const MatrixPanel> panels, int columns, const Layout& layout,
                 const fs::path& png) {
  const GnuplotFolder folder;
  std::string script = gnuplot_canvas(layout.width, layout.height, layout.font);
  script += gnuplot_palette() +
            "set border 15 lw 1 lc rgb '#404040' front\nunset key\nset style line 1 lw 0\nset multiplot\n";
  const auto per_row = static_cast<std::size_t>(columns);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / per_row;
    const std::size_t column = i % per_row;
    script += panel_script(panels[i], layout, layout.left + layout.column_step * static_cast<double>(column),
                           layout.top + layout.row_step * static_cast<double>(row), column == 0,
                           i + per_row >= panels.size(), i, folder);
  }
  folder.draw(script + "unset multiplot\n", png);
}

}  // namespace

void plot_matrix(const DissimilarityMatrix& matrix, const std::vector<Transition>& transitions,
                 const fs::path& png) {
  if (matrix.frame_count() == 0) throw InvalidArgument("matrix: has no frame to plot");
  const MatrixPanel panel = {
      .matrix = &matrix,
      .transitions = &transitions,
      .title = fmt::format("Dissimilarity of all pairs of frames ({} metric)", matrix.metric())};
  draw_panels({&panel, 1}, 1, Layout(), png);
}

void plot_matrices(std::span<const MatrixPanel> panels, int columns, const fs::path& png) {
  if (panels.empty() || columns < 1) {
    throw InvalidArgument(
        fmt::format("plot_matrices: expected at least one panel and one column, found {} panels, {} columns",
                    panels.size(), columns));
  }
  for (const MatrixPanel& panel : panels) {
    if (panel.matrix == nullptr || panel.matrix->frame_count() == 0)
      throw InvalidArgument(fmt::format("panel '{}': has no frame to plot", panel.title));
    const DissimilarityMatrix& first = *panels.front().matrix;
    if (panel.matrix->clip_names() != first.clip_names() ||
        panel.matrix->clip_frame_counts() != first.clip_frame_counts()) {
      throw InvalidArgument(
          fmt::format("panel '{}': has other clips than '{}'", panel.title, panels.front().title));
    }
  }
  columns = std::min(columns, static_cast<int>(panels.size()));
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  draw_panels(panels, columns, panel_layout(columns, rows), png);
}

}  // namespace reprise
