// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "graph": the transitions that were found, without those that the user removes.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/graph/surface_motion_graph.h"
#include "reprise/pipeline/similarity.h"

namespace reprise {

struct GraphOptions {
  std::vector<std::string> remove;   // edges to take out: "walk->run", or "walk:12->run:30"
  std::vector<std::string> restore;  // removed edges to bring back
};

// The graph of a database with the transitions of `similarity`, and removals: those of `previous` (the graph
// file as it was, if any) are carried over, then `remove` and `restore` are applied. Throws `InvalidArgument`
// for an edge that names an unknown clip, or a `restore` that was never removed.
SurfaceMotionGraph make_graph(const PerformanceDatabase& database, const SimilarityResult& similarity,
                              const GraphOptions& options, const std::optional<SurfaceMotionGraph>& previous);

}  // namespace reprise
