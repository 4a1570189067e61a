// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gnuplot.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

// Pixels.
constexpr std::size_t wanted_height = 480;  // of a panel
constexpr double left = 75.0;
constexpr double top = 88.0;
constexpr double below = 62.0;
constexpr double bar_gap = 10.0;
constexpr double bar_width = 13.0;
constexpr double between = 108.0;  // panels; the colour bar with its figures stands here

// Each place as a square of `cell` pixels: gnuplot would leave seams between places, or blur them.
std::vector<float> raster(const GridPanel& panel, std::size_t cell) {
  std::vector<float> values;
  for (const std::vector<double>& row : panel.rows) {
    for (std::size_t i = 0; i < cell; ++i) {
      for (const double value : row) values.insert(values.end(), cell, static_cast<float>(value));
    }
  }
  return values;
}

double largest_value(const GridPanel& panel) {
  if (panel.largest > 0.0) return panel.largest;
  double largest = 0.0;
  for (const std::vector<double>& row : panel.rows) {
    for (const double value : row) {
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  return largest > 0.0 ? largest : 1.0;
}

void check(std::span<const GridPanel> panels) {
  if (panels.empty()) throw InvalidArgument("plot_grids: expected at least one panel, found none");
  for (const GridPanel& panel : panels) {
    const std::size_t width = panel.rows.empty() ? 0 : panel.rows.front().size();
    if (width == 0) throw InvalidArgument(fmt::format("panel '{}': has no value to plot", panel.title));
    for (const std::vector<double>& row : panel.rows) {
      if (row.size() != width) {
        throw InvalidArgument(
            fmt::format("panel '{}': expected rows of {} values, found {}", panel.title, width, row.size()));
      }
    }
  }
}

}  // namespace

void plot_grids(std::span<const GridPanel> panels, const GridAxes& axes, const std::string& title,
                const std::filesystem::path& png) {
  check(panels);
  std::size_t most_rows = 0, most_columns = 0;
  for (const GridPanel& panel : panels) {
    most_rows = std::max(most_rows, panel.rows.size());
    most_columns = std::max(most_columns, panel.rows.front().size());
  }
  const std::size_t cell = std::clamp<std::size_t>(wanted_height / std::max(most_rows, most_columns), 1, 40);
  const double step = static_cast<double>(cell * most_columns) + between;
  const double width = left + step * static_cast<double>(panels.size()) - 35.0;
  const double height = top + static_cast<double>(cell * most_rows) + below;

  const GnuplotFolder folder;
  std::string script = gnuplot_canvas(static_cast<int>(width), static_cast<int>(height), 11);
  script += gnuplot_palette();
  script += "set border 15 lw 1 lc rgb '#404040' front\nunset key\nset multiplot\n";
  script += fmt::format("set label {} at screen 0.5,screen {} center font ',13'\n", gnuplot_quoted(title),
                        1.0 - 22.0 / height);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const GridPanel& panel = panels[p];
    const std::size_t columns = panel.rows.front().size();
    const auto panel_width = static_cast<double>(cell * columns);
    const auto panel_height = static_cast<double>(cell * panel.rows.size());
    const double panel_left = left + step * static_cast<double>(p);
    const double bottom = height - top - panel_height;
    script += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
        "{}\n",
        panel_left / width, (panel_left + panel_width) / width, bottom / height,
        (bottom + panel_height) / height);
    script += fmt::format("set title {} font ',11' offset 0,-0.4\nset xlabel {}\nset ylabel {} offset 1,0\n",
                          gnuplot_quoted(panel.title), gnuplot_quoted(axes.x_label),
                          gnuplot_quoted(p == 0 ? axes.y_label : ""));
    script += fmt::format("set xtics out nomirror scale 0.4 {}\nset ytics out nomirror scale 0.4 {}\n",
                          round_step(std::max(1.0, 34.0 / static_cast<double>(cell))),
                          round_step(std::max(1.0, 34.0 / static_cast<double>(cell))));
    const double first_x = axes.first_x - 0.5, first_y = axes.first_y - 0.5;
    script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", first_x,
                          first_x + static_cast<double>(columns), first_y,
                          first_y + static_cast<double>(panel.rows.size()));
    const double largest = largest_value(panel);
    script += fmt::format("set cbrange [0:{}]\nset colorbox user origin {},{} size {},{}\n", largest,
                          (panel_left + panel_width + bar_gap) / width, bottom / height, bar_width / width,
                          panel_height / height);
    script += fmt::format("set cbtics scale 0.3 font ',10' offset -0.6,0 format '%.3g' {}\n",
                          round_step(largest / 6.0));
    script +=
        "set object 1 rectangle from graph 0,graph 0 to graph 1,graph 1 behind fc rgb '#c8c8c8' fs "
        "solid noborder\n";
    const std::string file = fmt::format("grid{}.bin", p);
    folder.write(file, raster(panel, cell));
    const double pixel = 1.0 / static_cast<double>(cell);
    script += fmt::format(
        "plot '{}' binary array=({},{}) format='%float32' origin=({},{}) dx={} dy={} with image\n", file,
        cell * columns, cell * panel.rows.size(), first_x + 0.5 * pixel, first_y + 0.5 * pixel, pixel, pixel);
    script += "unset label\n";  // the title of the whole stands in the first panel's script
  }
  folder.draw(script + "unset multiplot\n", png);
}

}  // namespace reprise
