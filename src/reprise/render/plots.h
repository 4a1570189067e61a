// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Pictures of matrices and graphs, drawn by gnuplot and Graphviz.

#pragma once

#include <filesystem>

#include "reprise/graph/surface_motion_graph.h"

namespace reprise {

// Heat map of a matrix as PNG: axes in frames, clip names and borders on both, a colour bar in metres;
// `transitions` (may be empty) are marked at (m, n). Row = source frame from the top, column = target frame.
// Beyond 1040 frames a pixel shows the smallest value of its frames, so that thin valleys survive. Throws
// `Error` if gnuplot is not installed, `FileError` if it fails (with what it said).
void plot_matrix(const DissimilarityMatrix& matrix, const std::vector<Transition>& transitions,
                 const std::filesystem::path& png);

// The graph as SVG: a node per clip with its frames, an edge per ordered pair with its transitions (m -> n,
// L, cost); removed edges are drawn dashed and grey. Beyond 20 edges the labels are left to tooltips, and
// cheap edges are bold. Throws `FileError`.
void draw_graph(const SurfaceMotionGraph& graph, const std::filesystem::path& svg);

}  // namespace reprise
