// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Exact best-first search for the cheapest walk through a state graph.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reprise/path/state_graph.h"

namespace reprise::path_detail {

// cost(walk) = sum of edge costs + distance_weight |distance - target_distance| + time_weight |steps + 1 -
// target_frames|
struct WalkTargets {
  double distance = 0.0;  // metres
  double frames = 0.0;
  double distance_weight = 0.0;  // >= 0
  double time_weight = 0.0;      // >= 0
};

struct Walk {
  std::vector<std::int32_t> edges;  // indices into StateGraph::edges, from start to end
  double cost = 0.0;
  double lower_bound = 0.0;  // no walk costs less; equals `cost` when proved to `cost_tolerance`
  std::size_t labels = 0;
};

// Costs that differ by less count as equal: distances are sums of real numbers in different orders.
inline constexpr double cost_tolerance = 1e-9;

// Precondition: the graph is not empty. Always returns a walk; looks at no more than about `max_labels`
// labels.
Walk find_cheapest_walk(const StateGraph& graph, const WalkTargets& targets, std::size_t max_labels);

}  // namespace reprise::path_detail
