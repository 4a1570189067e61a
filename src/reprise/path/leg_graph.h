// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The walks between two consecutive key-frames as those of a small directed graph, for integer programs. Made
// without the optimiser's own state graph: a program that shares it could not show its mistakes.

#pragma once

#include <vector>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::path_detail {

// A node is a frame of a clip at which a transition leaves, or one of the two key-frames. An edge plays on to
// the next such frame of the clip, or takes a transition and plays on to the next such frame from its
// arrival. A path is one walk a leg, of at least one edge, from `first` to `last`.
struct LegGraph {
  struct Node {
    std::size_t clip_idx = 0;
    int frame = 0;
  };
  struct Edge {
    std::size_t source = 0;
    std::size_t target = 0;
    int transition = -1;    // -1: plays on
    int steps = 0;          // frames after the source's, the target's included; >= 1
    double distance = 0.0;  // metres
    double cost = 0.0;      // of the transition
  };
  std::vector<Node> nodes;
  std::vector<Edge> edges;  // each lies on some walk from `first` to `last`
  std::size_t first = 0;
  std::size_t last = 0;
};

// Without the transitions marked (one mark each). No edges: there is no walk.
LegGraph make_leg_graph(const PathMetrics& metrics, const FrameId& from, const FrameId& to,
                        const std::vector<bool>& forbidden);

// Keeps the edges marked (one mark each), and of those the ones that still lie on some walk. Returns the
// former indices of the edges left.
std::vector<std::size_t> keep_edges(LegGraph& leg, std::vector<bool> marked);

using EdgeLength = double (*)(const LegGraph::Edge&);  // >= 0

// Least lengths, infinite where there is no way.
std::vector<double> lengths_from(const LegGraph& leg, EdgeLength length, std::size_t node);
std::vector<double> lengths_to(const LegGraph& leg, EdgeLength length, std::size_t node);
// Of a walk from `first` to `last` (of at least one edge).
double least_length(const LegGraph& leg, EdgeLength length);

// For each edge, how often a walk from `first` to `last` of at most `budget` can use it: the first use costs
// the way to it, itself and the way on, every other one a loop through it. Infinite if a loop through it has
// no length.
std::vector<double> most_uses(const LegGraph& leg, EdgeLength length, double budget);

}  // namespace reprise::path_detail
