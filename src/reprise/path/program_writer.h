// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A key-frame query as an integer program in LP format, so that anyone can check an optimum with any solver.

#pragma once

#include <string>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise {

// CPLEX LP text whose optimum is that of `find_keyframe_path`: for each pair of consecutive key-frames an
// integer flow on a graph of decisions (not the optimiser's own), both absolute values as sums of what is
// over and under, hard limits as bounds, a row for each compulsory clip, and a second flow, of what is left
// to play, that keeps loops connected to the path. A head comment states units, what the names of columns and
// rows say, and how to read a solution.
//
// `cost_bound`: the cost of some feasible path (the optimum, if it is known); it bounds how often an edge is
// used. Throws what `find_keyframe_path` throws, and `InvalidArgument` for a query with a goal or a route, if
// there is no path, for a bound that is not finite or below every path's cost, and if nothing bounds how
// often a loop is used: paths may have over 20,000 frames (time has hardly a weight and no limit) and
// transitions cost nothing or hardly anything.
std::string write_keyframe_program(const PathMetrics& metrics, const KeyframeQuery& query,
                                   const KeyframeOptions& options, const std::vector<std::string>& clip_names,
                                   double cost_bound);

}  // namespace reprise
