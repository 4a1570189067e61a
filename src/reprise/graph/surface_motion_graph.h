// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The surface motion graph (HSSMG 4.3): clips are nodes, transitions are edges, the user removes what is
// unwanted.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/graph/transition.h"

namespace reprise {

struct GraphClip {
  std::string name;
  int frame_count = 0;
  double frames_per_second = 25.0;
};

// A removal the user asked for: all edges from one clip to another, or (m and n given) the transitions of
// that pair near m -> n. Kept by name, so that it survives when transitions are computed anew.
struct RemovedEdge {
  std::string source_clip;
  std::string target_clip;
  int m = -1;  // -1: every transition of the pair
  int n = -1;
  bool operator==(const RemovedEdge&) const = default;
};

struct SurfaceMotionGraph {
  std::string database_hash;  // content hash of the database the graph was made from
  std::string metric;
  std::vector<GraphClip> clips;
  std::vector<Transition> transitions;  // all that were found, removed ones included
  std::vector<RemovedEdge> removed;
  TransitionOptions options;

  // Transitions that are in force: found and not removed.
  std::vector<Transition> active_transitions() const;
  bool is_removed(const Transition& transition) const;
};

// Parses "walk->run" or "walk:12->run:30" and checks the names. Throws `InvalidArgument` (offers the nearest
// name).
RemovedEdge parse_edge(const std::string& text, const SurfaceMotionGraph& graph);

// "walk:12->run:30".
std::string to_string(const Transition& transition, const SurfaceMotionGraph& graph);

// The graph of transitions that were found with these options in a matrix of `metric`.
SurfaceMotionGraph build_graph(const PerformanceDatabase& database, std::string metric,
                               std::vector<Transition> transitions, const TransitionOptions& options = {});

// Readable JSON (docs/surface-motion-graph.md), written whole or not at all. `load_graph` throws `FileError`
// for text that is not JSON (line and column), a missing or ill-typed field (names it), a later format
// version.
void save_graph(const SurfaceMotionGraph& graph, const std::filesystem::path& path);
SurfaceMotionGraph load_graph(const std::filesystem::path& path);

// Throws `InvalidArgument` if the graph was made from another database (clips or contents differ; says
// which).
void check_graph_fits(const SurfaceMotionGraph& graph, const PerformanceDatabase& database);

}  // namespace reprise
