// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The walks of a key-frame query as the paths of a small directed graph.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::path_detail {

// A node is (key-frames shown, compulsory clips shown, clip, frame) at frames where something can be decided:
// a transition leaves, or a key-frame is shown. An edge plays on to the next such frame of the clip, or takes
// a transition and plays on from its arrival. Every edge lasts at least one frame, so steps order the nodes
// of a walk.
struct StateEdge {
  std::int32_t target = 0;
  std::int32_t steps = 0;        // frames after the source, the target's frame included
  std::int32_t transition = -1;  // -1: plays on
  double distance = 0.0;         // metres
  double cost = 0.0;             // of the transition
};

struct StateGraph {
  // Edges of node i are edges[first_edge[i]] .. edges[first_edge[i + 1] - 1]. The last node is the end of the
  // path: the last key-frame, shown after all others; it has no edges. Empty when the end cannot be reached.
  // Every other node lies on some path from start to end.
  std::vector<std::int32_t> first_edge;
  std::vector<StateEdge> edges;
  std::int32_t start = 0;

  bool empty() const { return edges.empty(); }
  std::int32_t node_count() const { return static_cast<std::int32_t>(first_edge.size()) - 1; }
  std::int32_t end() const { return node_count() - 1; }
};

// Of the query: key-frames, forbidden and compulsory clips. Preconditions: at least two key-frames, all
// inside their clips and none in a forbidden one; at most `most_compulsory_clips`.
inline constexpr std::size_t most_compulsory_clips = 8;
StateGraph build_state_graph(const PathMetrics& metrics, const KeyframeQuery& query);

// Says what of the query has no path and what the graph lacks. Precondition: its state graph is empty.
std::string explain_no_path(const PathMetrics& metrics, const KeyframeQuery& query,
                            const std::vector<std::string>& clip_names);

}  // namespace reprise::path_detail
