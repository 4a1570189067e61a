// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The surface motion graph (HSSMG 4.3): clips are nodes, transitions are edges, the user edits what was
// found.

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "reprise/graph/measure_transition.h"

namespace reprise {

struct GraphClip {
  std::string name;
  int frame_count = 0;
  double frames_per_second = 25.0;
};

// The transitions an edit means: all from clips to clips, or (m and n given) those near m -> n. By name, so
// that it survives when transitions are computed anew.
struct EdgePattern {
  std::string source_clip;  // a name; '*' in it stands for any letters
  std::string target_clip;
  int m = -1;  // -1: every transition of those clips
  int n = -1;
  // Transitions are near whose m and n are each less than this many frames away. Transitions of a pair lie at
  // least `separation` apart, so with that this means one, also when it has moved a little.
  int within = 1;
  bool operator==(const EdgePattern&) const = default;
};

// Transitions at the ends of the graph that are taken out of force.
enum class Pruning : std::uint8_t {
  none,
  dead_ends,  // those after which no walk goes on for ever
  both_ends,  // and those to which no walk comes that could have gone on for ever
};

// A transition of the graph, and what became of it.
struct GraphEdge {
  enum class Origin : std::uint8_t { found, kept, added };
  enum class State : std::uint8_t { in_force, removed, pruned };
  Transition transition;
  Origin origin = Origin::found;
  State state = State::in_force;
};

// What was found, and what the user wants of it: the edits stay when the transitions are found anew.
struct SurfaceMotionGraph {
  std::string database_hash;  // content hash of the database the graph was made from
  std::string metric;
  std::vector<GraphClip> clips;
  std::vector<Transition> transitions;  // all that were found, removed ones included
  std::vector<EdgePattern> removed;
  // Protected, stored whole: in force whatever removes them, prunes them or does not find them any more.
  std::vector<Transition> kept;
  std::vector<Transition> added;  // made by hand; the same holds for them
  Pruning pruning = Pruning::none;
  TransitionOptions options;
  double captured_acceleration = 0.0;  // of the database, m/frame^2; 0: not known

  // Every transition there is, best first within a pair of clips, pairs in order. Of those between the same
  // two frames one: made by hand, or kept, or found, in this order.
  std::vector<GraphEdge> edges() const;
  std::vector<Transition> active_transitions() const;  // those in force
  // A pattern removes it, kept or not.
  bool is_removed(const Transition& transition) const;
};

bool matches(const EdgePattern& pattern, const Transition& transition, const SurfaceMotionGraph& graph);

// Parses "walk->run", "walk*->hit" or "walk:12->run:30" and checks names and frames. Throws `InvalidArgument`
// (offers the nearest name).
EdgePattern parse_edge(const std::string& text, const SurfaceMotionGraph& graph);
// Parses "walk:12->run:30", or "walk:12->run:30@8" for a half window of 8, which may not fit. Throws
// likewise.
TransitionRequest parse_transition(const std::string& text, const SurfaceMotionGraph& graph);

// "walk:12->run:30".
std::string to_string(const Transition& transition, const SurfaceMotionGraph& graph);
std::string to_string(const EdgePattern& pattern);

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
