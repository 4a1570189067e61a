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
constexpr double plot_height = 330.0;
constexpr double left = 76.0;
constexpr double right = 20.0;
constexpr double title_height = 40.0;
constexpr double key_height = 18.0;  // of an entry
constexpr double letter_width = 7.2;
constexpr double narrowest = 560.0;

constexpr double bars_share = 0.8;  // of a column's width

void check(const BarPlot& plot) {
  if (plot.columns.empty() || plot.series.empty()) {
    throw InvalidArgument(
        fmt::format("plot_bars: expected at least one column and one series, found {} and {}",
                    plot.columns.size(), plot.series.size()));
  }
  for (const BarSeries& series : plot.series) {
    for (const std::vector<double>* values : {&series.values, &series.deviations}) {
      if (values->size() == plot.columns.size() || (values == &series.deviations && values->empty()))
        continue;
      throw InvalidArgument(fmt::format("plot_bars: series '{}': expected {} values, found {}", series.name,
                                        plot.columns.size(), values->size()));
    }
  }
}

double highest(const BarPlot& plot) {
  double high = 0.0;
  for (const BarSeries& series : plot.series) {
    for (std::size_t c = 0; c < series.values.size(); ++c) {
      const double top_end = series.values[c] + (series.deviations.empty() ? 0.0 : series.deviations[c]);
      if (std::isfinite(top_end)) high = std::max(high, top_end);
    }
  }
  for (const BarLevel& level : plot.levels) high = std::max(high, level.value);
  return high > 0.0 ? 1.06 * high : 1.0;
}

}  // namespace

void plot_bars(const BarPlot& plot, const std::filesystem::path& png) {
  check(plot);
  std::size_t longest = 0;
  for (const std::string& column : plot.columns) longest = std::max(longest, column.size());
  const auto columns = static_cast<double>(plot.columns.size());
  const auto bars = static_cast<double>(plot.series.size());
  const double below = 20.0 + letter_width * static_cast<double>(longest);
  const double width = left + std::max(narrowest, columns * std::max(15.0, 8.0 * bars)) + right;
  const double top =
      title_height + key_height * static_cast<double>(plot.series.size() + plot.levels.size()) + 8.0;
  const double height = top + plot_height + below;
  const double high = highest(plot);

  const GnuplotFolder folder;
  std::string script = gnuplot_canvas(static_cast<int>(width), static_cast<int>(height), 11);
  script += fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
      "{}\n",
      left / width, 1.0 - right / width, below / height, 1.0 - top / height);
  script += fmt::format(
      "set border 3 lc rgb '#404040'\nset tics nomirror\nset grid ytics lc rgb '#e0e0e0' lw 1\n"
      "set xrange [-0.6:{}]\nset yrange [0:{}]\nset ytics scale 0.5 {} format '%g'\n",
      columns - 0.4, high, round_step(high / 6.0));
  script += fmt::format("set label {} at screen 0.5,screen {} center font ',13'\nset ylabel {} offset 1,0\n",
                        gnuplot_quoted(plot.title), 1.0 - 18.0 / height, gnuplot_quoted(plot.y_label));
  script +=
      fmt::format("set key at screen {},screen {} left top vertical maxcols 1 Left reverse samplen 1.5\n",
                  left / width, 1.0 - 36.0 / height);
  std::string labels;
  for (std::size_t c = 0; c < plot.columns.size(); ++c) {
    labels += fmt::format("{}{} {}", c == 0 ? "" : ", ", gnuplot_quoted(plot.columns[c]), c);
  }
  script +=
      fmt::format("set xtics scale 0 rotate by 90 right ({})\nset style fill solid 0.85 noborder\n", labels);

  std::string plots;
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const BarSeries& series = plot.series[s];
    const double bar_width = bars_share / bars;
    std::vector<double> points;
    for (std::size_t c = 0; c < plot.columns.size(); ++c) {
      if (!std::isfinite(series.values[c])) continue;
      points.push_back(static_cast<double>(c) + bar_width * (static_cast<double>(s) - 0.5 * (bars - 1.0)));
      points.push_back(series.values[c]);
      points.push_back(series.deviations.empty() ? 0.0 : series.deviations[c]);
    }
    const char* const color = gnuplot_colors[s % gnuplot_colors.size()];
    if (points.empty()) {
      plots += fmt::format("{}NaN with boxes lc rgb '{}' title {}", plots.empty() ? "" : ", ", color,
                           gnuplot_quoted(series.name));
      continue;
    }
    const std::string file = fmt::format("bars{}.bin", s);
    folder.write(file, points);
    const std::string data =
        fmt::format("'{}' binary record=({}) format='%float64%float64%float64'", file, points.size() / 3);
    plots += fmt::format("{}{} using 1:2:({}) with boxes lc rgb '{}' title {}", plots.empty() ? "" : ", ",
                         data, 0.92 * bar_width, color, gnuplot_quoted(series.name));
    if (!series.deviations.empty()) {
      plots += fmt::format(
          ", {} using 1:($2-$3):(0):(2*$3) with vectors nohead lw 1 lc rgb '#202020' notitle", data);
    }
  }
  for (const BarLevel& level : plot.levels) {
    plots +=
        fmt::format(", {} with lines dt 2 lw 1.6 lc rgb '{}' title {}", level.value,
                    gnuplot_colors[level.series_idx % gnuplot_colors.size()], gnuplot_quoted(level.name));
  }
  folder.draw(script + fmt::format("plot {}\n", plots), png);
}

}  // namespace reprise
