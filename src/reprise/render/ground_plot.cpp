// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/ground_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gnuplot.h"

namespace reprise {
namespace {

constexpr double height = 460.0;       // of the ground shown, pixels
constexpr double least_width = 200.0;  // and so much a letter of the title:
constexpr double letter = 10.0;
constexpr double left = 70.0;
constexpr double between = 80.0;
constexpr double top = 50.0;
constexpr double below = 65.0;    // for the labels of the axis
constexpr double key_row = 24.0;  // pixels a name
constexpr double margin = 0.5;    // metres around the curves

struct Extent {
  Eigen::Vector2d least;
  Eigen::Vector2d greatest;
};

Extent extent_of(const GroundPanel& panel) {
  Extent extent{Eigen::Vector2d::Constant(INFINITY), Eigen::Vector2d::Constant(-INFINITY)};
  for (const GroundCurve& curve : panel.curves) {
    for (const Eigen::Vector2d& point : curve.points) {
      if (!point.allFinite()) {
        throw InvalidArgument(fmt::format("plot_ground: '{}' has a point that is not finite", curve.name));
      }
      extent.least = extent.least.cwiseMin(point);
      extent.greatest = extent.greatest.cwiseMax(point);
    }
  }
  if (!extent.least.allFinite()) {
    throw InvalidArgument(fmt::format("plot_ground: the panel '{}' has nothing to show", panel.title));
  }
  extent.least.array() -= margin;
  extent.greatest.array() += margin;
  return extent;
}

std::string line_style(GroundCurve::Kind kind, const char* color) {
  // Asked lines are pale: 0xa0 of 0xff is see-through.
  return kind == GroundCurve::Kind::asked ? fmt::format("with lines lw 9 lc rgb '#a0{}'", color + 1)
                                          : fmt::format("with lines lw 2 lc rgb '{}'", color);
}

std::string end_style(GroundCurve::Kind kind, const char* color) {
  return kind == GroundCurve::Kind::asked ? fmt::format("with points pt 6 ps 2.5 lw 2 lc rgb '{}'", color)
                                          : fmt::format("with points pt 7 ps 1.2 lc rgb '{}'", color);
}

}  // namespace

void plot_ground(std::span<const GroundPanel> panels, const std::filesystem::path& png) {
  if (panels.empty()) throw InvalidArgument("plot_ground: expected at least one panel, found none");
  std::vector<Extent> extents;
  double tallest = 0.0;
  struct Name {
    std::string text;
    GroundCurve::Kind kind;
  };
  std::vector<Name> names;
  const auto name_idx = [&](const std::string& text) {
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const Name& name) { return name.text == text; });
    return static_cast<std::size_t>(found - names.begin());
  };
  for (const GroundPanel& panel : panels) {
    extents.push_back(extent_of(panel));
    tallest = std::max(tallest, extents.back().greatest.y() - extents.back().least.y());
    for (const GroundCurve& curve : panel.curves) {
      if (name_idx(curve.name) == names.size()) names.push_back({curve.name, curve.kind});
    }
  }
  // One scale for all panels, so that ways can be compared.
  const double pixels_per_metre = height / tallest;
  std::vector<double> widths;
  double total_width = left + 20.0 - between;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    Extent& extent = extents[p];
    const double wanted = std::max(least_width, letter * static_cast<double>(panels[p].title.size()));
    const double missing = wanted / pixels_per_metre - (extent.greatest.x() - extent.least.x());
    if (missing > 0.0) {
      extent.least.x() -= missing / 2.0;
      extent.greatest.x() += missing / 2.0;
    }
    extent.greatest.y() = extent.least.y() + tallest;
    widths.push_back((extent.greatest.x() - extent.least.x()) * pixels_per_metre);
    total_width += widths.back() + between;
  }
  const double total_height = top + height + below + key_row * static_cast<double>(names.size());

  const GnuplotFolder folder;
  std::string script =
      gnuplot_canvas(static_cast<int>(std::ceil(total_width)), static_cast<int>(total_height), 13);
  script += fmt::format(
      "set multiplot\nset xtics {0} scale 0.5\nset ytics {0} scale 0.5\nset grid lc rgb '#e0e0e0' lw 1\n"
      "set border 3 lc rgb '#404040'\nset tics nomirror\nset tmargin at screen {1}\nset bmargin at screen "
      "{2}\n",
      round_step(tallest / 8.0), (total_height - top) / total_height,
      (total_height - top - height) / total_height);
  double panel_left = left;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Extent& extent = extents[p];
    script += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset xrange [{}:{}]\nset yrange [{}:{}]\n"
        "set title {} font ',15'\nset xlabel 'x (m)'\nset ylabel {} offset 0.8,0\n",
        panel_left / total_width, (panel_left + widths[p]) / total_width, extent.greatest.x(),
        extent.least.x(), extent.least.y(), extent.greatest.y(), gnuplot_quoted(panels[p].title),
        p == 0 ? "'z (m)'" : "''");
    const bool has_key = p + 1 == panels.size();
    script += has_key ? fmt::format("set key at screen {},screen {} left bottom Left reverse samplen 3\n",
                                    left / total_width, 8.0 / total_height)
                      : std::string("unset key\n");
    std::string plots;
    const auto add = [&](const std::string& plot) { plots += (plots.empty() ? "" : ", ") + plot; };
    for (std::size_t c = 0; c < panels[p].curves.size(); ++c) {
      const GroundCurve& curve = panels[p].curves[c];
      if (curve.points.empty()) continue;
      const char* color = gnuplot_colors[name_idx(curve.name) % gnuplot_colors.size()];
      std::vector<std::array<double, 2>> points;
      for (const Eigen::Vector2d& point : curve.points) points.push_back({point.x(), point.y()});
      const auto show = [&](const std::string& file, const std::string& style) {
        folder.write(file, points);
        add(fmt::format("'{}' binary record=({}) format='%float64%float64' using 1:2 {} notitle", file,
                        points.size(), style));
      };
      if (points.size() > 1) show(fmt::format("line{}_{}.bin", p, c), line_style(curve.kind, color));
      points.erase(points.begin(), points.end() - 1);
      show(fmt::format("end{}_{}.bin", p, c), end_style(curve.kind, color));
    }
    for (std::size_t n = 0; has_key && n < names.size(); ++n) {
      add(fmt::format("NaN {} title {}", line_style(names[n].kind, gnuplot_colors[n % gnuplot_colors.size()]),
                      gnuplot_quoted(names[n].text)));
    }
    script += fmt::format("plot {}\n", plots);
    panel_left += widths[p] + between;
  }
  folder.draw(script + "unset multiplot\n", png);
}

}  // namespace reprise
