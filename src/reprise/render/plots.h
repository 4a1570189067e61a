// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Pictures of matrices, curves and graphs, drawn by gnuplot and Graphviz.

#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "reprise/graph/surface_motion_graph.h"
#include "reprise/mesh/image.h"

namespace reprise {

// All plots that gnuplot draws throw `Error` if it is not installed, `FileError` if it fails (with what it
// said), and leave nothing half-written.

// Heat map of a matrix as PNG: axes in frames, clip names and borders on both, a colour bar in metres;
// `transitions` (may be empty) are marked at (m, n). Row = source frame from the top, column = target frame.
// Beyond 1040 frames a pixel shows the smallest value of its frames, so that thin valleys survive.
void plot_matrix(const DissimilarityMatrix& matrix, const std::vector<Transition>& transitions,
                 const std::filesystem::path& png);

struct MatrixPanel {
  const DissimilarityMatrix* matrix = nullptr;           // not null
  const std::vector<Transition>* transitions = nullptr;  // marked at (m, n); null: none
  std::string title;
};
// Several matrices of one database in rows of `columns`, each with a colour bar of its own (HSSMG Figure 4).
// Names of clips stand at the left and below. Throws `InvalidArgument` if there is no panel or their clips
// differ.
void plot_matrices(std::span<const MatrixPanel> panels, int columns, const std::filesystem::path& png);

struct Curve {
  std::string name;
  std::vector<std::array<double, 2>> points;  // (x, y), both 0 .. 1; none: only the name is shown
};
struct CurvePanel {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Curve> curves;
};
// Curves over the unit square, panels side by side, one key. A name has one colour in all of them. Throws
// `InvalidArgument` if there is no panel.
void plot_curves(std::span<const CurvePanel> panels, const std::filesystem::path& png);

// A value for every place of a grid. Places without one (NaN) are grey.
struct GridPanel {
  std::string title;
  std::vector<std::vector<double>> rows;  // rows[y][x], as many in each row
  double largest = 0.0;                   // value at the top of the colour bar; 0: the greatest there is
};
// Where panels have their first place and what their axes are called; the next place is one further.
struct GridAxes {
  std::string x_label;
  std::string y_label;
  int first_x = 1;
  int first_y = 1;
};
// Heat maps side by side, y upwards, each with a colour bar of its own. Throws `InvalidArgument` if there is
// no panel, or one is empty or has rows of several lengths.
void plot_grids(std::span<const GridPanel> panels, const GridAxes& axes, const std::string& title,
                const std::filesystem::path& png);

struct DotSeries {
  std::string name;
  std::vector<double> values;  // one a row; NaN: none
};
struct DotPanel {
  enum class Scale { from_zero, logarithmic };
  std::string title;
  std::string x_label;
  Scale scale = Scale::from_zero;
  std::vector<DotSeries> series;
};
// A table as a picture: named rows, panels side by side, a dot a series, one key. A name has one colour in
// all panels. Values that a logarithmic scale cannot show are left out. Throws `InvalidArgument` if there is
// no row or no panel, or a series has not one value a row.
void plot_dots(const std::vector<std::string>& rows, std::span<const DotPanel> panels,
               const std::filesystem::path& png);

struct BarSeries {
  std::string name;
  std::vector<double> values;      // one a column; NaN: none
  std::vector<double> deviations;  // length of the error bar to either side; empty: no error bars
};
// A value to compare with, drawn as a dashed line in the colour of a series.
struct BarLevel {
  std::string name;
  double value = 0.0;
  std::size_t series_idx = 0;
};
struct BarPlot {
  std::string title;
  std::string y_label;
  std::vector<std::string> columns;  // their names stand below, turned
  std::vector<BarSeries> series;
  std::vector<BarLevel> levels;
};
// Columns of one bar a series with error bars (HSSMG Figures 13 and 14). Throws `InvalidArgument` if there is
// no column or no series, or a series has not one value and deviation a column.
void plot_bars(const BarPlot& plot, const std::filesystem::path& png);

struct CaptionedPicture {
  Image image;
  std::vector<std::string> lines;  // below it
};
// Pictures in rows of `columns`, pixel for pixel, each with its caption. All images must have one size, else
// `InvalidArgument`.
void draw_sheet(const std::vector<CaptionedPicture>& pictures, int columns, const std::string& title,
                const std::filesystem::path& png);

// The graph as SVG: a node per clip with its frames, an edge per ordered pair with its transitions (m -> n,
// L, cost); removed edges are drawn dashed and grey. Beyond 20 edges the labels are left to tooltips, and
// cheap edges are bold. Throws `FileError`.
void draw_graph(const SurfaceMotionGraph& graph, const std::filesystem::path& svg);

}  // namespace reprise
