// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "graph": transitions are found, the user's removals are kept.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/graph/surface_motion_graph.h"

namespace reprise {

struct GraphOptions {
  TransitionOptions transitions;
  std::vector<std::string> remove;   // edges to take out: "walk->run", or "walk:12->run:30"
  std::vector<std::string> restore;  // removed edges to bring back
};

// Finds the transitions of a database and applies removals: those of `previous` (the graph file as it was, if
// any) are carried over, then `remove` and `restore` are applied. Throws `InvalidArgument` for an edge that
// names an unknown clip, or a `restore` that was never removed.
SurfaceMotionGraph make_graph(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                              const GraphOptions& options, const std::optional<SurfaceMotionGraph>& previous);

}  // namespace reprise
