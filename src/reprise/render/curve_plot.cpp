// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gnuplot.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

constexpr double side = 430.0;  // of a panel, pixels
constexpr double left = 80.0;
constexpr double top = 50.0;
constexpr double step = side + 90.0;
constexpr double key_width = 105.0;  // beyond the gap after the last panel

}  // namespace

void plot_curves(std::span<const CurvePanel> panels, const std::filesystem::path& png) {
  if (panels.empty()) throw InvalidArgument("plot_curves: expected at least one panel, found none");
  std::vector<std::string> names;
  for (const CurvePanel& panel : panels) {
    for (const Curve& curve : panel.curves) {
      if (std::ranges::find(names, curve.name) == names.end()) names.push_back(curve.name);
    }
  }

  const double width = left + step * static_cast<double>(panels.size()) + key_width;
  const double height = top + side + 75.0;
  const GnuplotFolder folder;
  std::string script = gnuplot_canvas(static_cast<int>(width), static_cast<int>(height), 13);
  script +=
      "set multiplot\nset xrange [0:1]\nset yrange [0:1]\nset xtics 0.2 scale 0.5\nset ytics 0.2 scale 0.5\n"
      "set grid lc rgb '#e0e0e0' lw 1\nset border 3 lc rgb '#404040'\nset tics nomirror\n";
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double panel_left = left + step * static_cast<double>(p);
    script += fmt::format(
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
        "{}\n",
        panel_left / width, (panel_left + side) / width, (height - top - side) / height,
        (height - top) / height);
    script += fmt::format("set title {} font ',15'\nset xlabel {}\nset ylabel {} offset 0.8,0\n",
                          gnuplot_quoted(panels[p].title), gnuplot_quoted(panels[p].x_label),
                          gnuplot_quoted(panels[p].y_label));
    const bool has_key = p + 1 == panels.size();
    script += has_key ? fmt::format("set key at screen {},screen {} left top Left reverse samplen 2\n",
                                    (panel_left + side + 20.0) / width, (height - top) / height)
                      : std::string("unset key\n");
    std::string plots;
    const auto style = [&](std::size_t n) {
      return fmt::format("with lines lw 2.5 lc rgb '{}'", gnuplot_colors[n % gnuplot_colors.size()]);
    };
    for (std::size_t c = 0; c < panels[p].curves.size(); ++c) {
      const Curve& curve = panels[p].curves[c];
      if (curve.points.empty()) continue;
      const auto n = static_cast<std::size_t>(std::ranges::find(names, curve.name) - names.begin());
      const std::string file = fmt::format("curve{}_{}.bin", p, c);
      folder.write(file, curve.points);
      plots += fmt::format("{}'{}' binary record=({}) format='%float64%float64' using 1:2 {} notitle",
                           plots.empty() ? "" : ", ", file, curve.points.size(), style(n));
    }
    // The key names every curve, also those that are not in this panel.
    for (std::size_t n = 0; has_key && n < names.size(); ++n) {
      plots +=
          fmt::format("{}NaN {} title {}", plots.empty() ? "" : ", ", style(n), gnuplot_quoted(names[n]));
    }
    script += fmt::format("plot {}\n", plots.empty() ? "NaN notitle" : plots);
  }
  folder.draw(script + "unset multiplot\n", png);
}

}  // namespace reprise
