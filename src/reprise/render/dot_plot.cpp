// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gnuplot.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

// Pixels.
constexpr double row_height = 26.0;
constexpr double letter_width = 7.2;
constexpr double panel_width = 270.0;
constexpr double between = 46.0;
constexpr double top = 42.0;
constexpr double below = 88.0;

// Not round: dots of several series on one place stay visible as rings and points.
constexpr std::array marks = {7, 6, 5, 9, 4, 8, 13};

struct Range {
  double low = 0.0;
  double high = 1.0;
};

bool is_shown(double value, DotPanel::Scale scale) {
  return std::isfinite(value) && (scale == DotPanel::Scale::from_zero || value > 0.0);
}

Range range_of(const DotPanel& panel) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const DotSeries& series : panel.series) {
    for (const double value : series.values) {
      if (!is_shown(value, panel.scale)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (panel.scale == DotPanel::Scale::from_zero) return {0.0, high > 0.0 ? 1.08 * high : 1.0};
  if (high <= 0.0) return {0.1, 1.0};
  return {std::pow(10.0, std::floor(std::log10(low / 1.3))),
          std::pow(10.0, std::ceil(std::log10(1.3 * high)))};
}

void check(const std::vector<std::string>& rows, std::span<const DotPanel> panels) {
  if (rows.empty() || panels.empty()) {
    throw InvalidArgument(fmt::format("plot_dots: expected at least one row and one panel, found {} and {}",
                                      rows.size(), panels.size()));
  }
  for (const DotPanel& panel : panels) {
    for (const DotSeries& series : panel.series) {
      if (series.values.size() != rows.size()) {
        throw InvalidArgument(fmt::format("panel '{}', series '{}': expected {} values, found {}",
                                          panel.title, series.name, rows.size(), series.values.size()));
      }
    }
  }
}

}  // namespace

void plot_dots(const std::vector<std::string>& rows, std::span<const DotPanel> panels,
               const std::filesystem::path& png) {
  check(rows, panels);
  std::vector<std::string> names;
  std::size_t longest = 0;
  for (const std::string& row : rows) longest = std::max(longest, row.size());
  for (const DotPanel& panel : panels) {
    for (const DotSeries& series : panel.series) {
      if (std::ranges::find(names, series.name) == names.end()) names.push_back(series.name);
    }
  }
  const double left = 24.0 + letter_width * static_cast<double>(longest);
  const double panel_height = row_height * static_cast<double>(rows.size());
  const double width = left + (panel_width + between) * static_cast<double>(panels.size());
  const double height = top + panel_height + below;

  const GnuplotFolder folder;
  std::string script = gnuplot_canvas(static_cast<int>(width), static_cast<int>(height), 11);
  script +=
      "set multiplot\nunset key\nset border 3 lc rgb '#404040'\nset tics nomirror\nset grid lc rgb '#e0e0e0' "
      "lw 1\n";
  script +=
      fmt::format("set yrange [{}:-0.5]\nset bmargin at screen {}\nset tmargin at screen {}\n",
                  static_cast<double>(rows.size()) - 0.5, below / height, (below + panel_height) / height);
  const auto style = [](std::size_t n) {
    return fmt::format("pt {} ps 1.3 lw 2 lc rgb '{}'", marks[n % marks.size()],
                       gnuplot_colors[n % gnuplot_colors.size()]);
  };
  // The key stands below all panels: one of gnuplot's own would be no wider than a panel.
  double key_left = left;
  for (std::size_t n = 0; n < names.size(); ++n) {
    script += fmt::format("set label {} at screen {},screen {} left point {} offset character 1.2,0\n",
                          gnuplot_quoted(names[n]), key_left / width, 14.0 / height, style(n));
    key_left += 44.0 + letter_width * static_cast<double>(names[n].size());
  }
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const DotPanel& panel = panels[p];
    const double panel_left = left + (panel_width + between) * static_cast<double>(p);
    const Range range = range_of(panel);
    std::string labels;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      labels += fmt::format("{}{} {}", row == 0 ? "" : ", ", gnuplot_quoted(p == 0 ? rows[row] : ""), row);
    }
    script += fmt::format("set lmargin at screen {}\nset rmargin at screen {}\nset ytics scale 0 ({})\n",
                          panel_left / width, (panel_left + panel_width) / width, labels);
    script += fmt::format("set title {} font ',13'\nset xlabel {}\n", gnuplot_quoted(panel.title),
                          gnuplot_quoted(panel.x_label));
    if (panel.scale == DotPanel::Scale::logarithmic) {
      script += fmt::format("set logscale x\nset xrange [{}:{}]\nset xtics scale 0.5 10 format '%g'\n",
                            range.low, range.high);
    } else {
      script += fmt::format("unset logscale x\nset xrange [{}:{}]\nset xtics scale 0.5 {} format '%g'\n",
                            range.low, range.high, round_step(range.high / 6.0));
    }
    std::string plots;
    for (std::size_t s = 0; s < panel.series.size(); ++s) {
      const DotSeries& series = panel.series[s];
      std::vector<double> points;
      for (std::size_t row = 0; row < rows.size(); ++row) {
        if (!is_shown(series.values[row], panel.scale)) continue;
        points.push_back(series.values[row]);
        points.push_back(static_cast<double>(row));
      }
      if (points.empty()) continue;
      const auto n = static_cast<std::size_t>(std::ranges::find(names, series.name) - names.begin());
      const std::string file = fmt::format("dots{}_{}.bin", p, s);
      folder.write(file, points);
      plots +=
          fmt::format("{}'{}' binary record=({}) format='%float64%float64' using 1:2 with points {} notitle",
                      plots.empty() ? "" : ", ", file, points.size() / 2, style(n));
    }
    script += fmt::format("plot {}\nunset label\n", plots.empty() ? "NaN notitle" : plots);
  }
  folder.draw(script + "unset multiplot\n", png);
}

}  // namespace reprise
