// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Time along a retrieved path: which moment of it is shown at each frame of the query (HSSMG 5.2.2).

#pragma once

#include <vector>

namespace reprise {

enum class Timing {
  repeats,  // frames as retrieved: a repeated frame stands still ("stop-motion")
  linear,   // the paper's: n repeats become an even way, alpha(j) = j / n
  smooth,   // no corners: a smoothing spline through what was retrieved, within a frame of it
};

// Moments, in frames of the path, one a query frame: never backwards, `path_frame` at the first and last.
// Where neither repeats nor skips are near, all timings are `path_frame`.
std::vector<double> path_times(const std::vector<int>& path_frame, Timing timing);

}  // namespace reprise
