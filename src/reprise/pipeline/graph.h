// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "graph": the transitions that were found, and what the user makes of them.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/graph/surface_motion_graph.h"
#include "reprise/pipeline/similarity.h"

namespace reprise {

// Edges are written as `parse_edge` and `parse_transition` read them. Applied in this order.
struct GraphOptions {
  std::vector<std::string> restore;    // removals to take back, as they were made
  std::vector<std::string> remove;     // edges to take out, now and whenever they are found again
  std::vector<std::string> unprotect;  // protected transitions to let go
  std::vector<std::string> drop;       // transitions made by hand to take out
  std::vector<std::string> add;        // transitions to make by hand
  // Transitions that stay whatever happens: of a pattern without frames those in force, with frames removed
  // ones as well.
  std::vector<std::string> protect;
  std::optional<Pruning> pruning;  // none: as it was
};

// What `SimilarityOptions::requests` must hold for `make_graph`: the transitions that `previous` protects or
// that were made by hand, and those to add. Throws what `make_graph` throws for them.
std::vector<TransitionRequest> requested_transitions(const PerformanceDatabase& database,
                                                     const GraphOptions& options,
                                                     const std::optional<SurfaceMotionGraph>& previous);

// The graph of a database with the transitions of `similarity` and the edits of `previous` (the graph file as
// it was, if any), then those of `options`. What is protected or made by hand is measured anew, at its frames
// and with its window, so that all costs are of one metric. An edit that changes nothing is warned of. Throws
// `InvalidArgument` for an edge that does not exist, something to take back that was never done, a transition
// that does not fit into its clips, and edits of `previous` that mean clips or frames the database does not
// have.
SurfaceMotionGraph make_graph(const PerformanceDatabase& database, const SimilarityResult& similarity,
                              const GraphOptions& options, const std::optional<SurfaceMotionGraph>& previous);

// The graph of a file, or, if `graph` is empty, one of the default similarity (kept in the cache beside
// `database_path`) without edits. Throws as `load_graph`, and `InvalidArgument` if it does not fit the
// database.
SurfaceMotionGraph open_graph(const PerformanceDatabase& database, const std::filesystem::path& database_path,
                              const std::filesystem::path& graph);

// For people: how many transitions there are and why others are not in force; the strongly connected
// components, and for each clip which frames go on for ever and which only lead there or away.
std::string describe_graph(const SurfaceMotionGraph& graph);

}  // namespace reprise
