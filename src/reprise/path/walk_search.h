// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Exact search for the cheapest walk through a state graph.

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "reprise/path/walk_bounds.h"

namespace reprise::path_detail {

struct Walk {
  std::vector<std::int32_t> edges;  // indices into StateGraph::edges, from start to end
  double cost = infinity;           // infinite: no walk was found that keeps the hard limits
  double lower_bound = 0.0;         // no walk costs less; equals `cost` when proved to `cost_tolerance`
  std::size_t labels = 0;
  bool exhausted = true;  // no walk was found because there is none, not because the labels ran out
};

// Costs that differ by less count as equal: distances are sums of real numbers in different orders.
inline constexpr double cost_tolerance = 1e-9;

// Finds walks of one state graph for many targets; what they share is made once. Thread-safe.
class WalkFinder {
 public:
  // `longest`: the greatest number of frames that will be asked for (more is allowed, and slower). Keeps a
  // reference to `graph`, which is not empty.
  WalkFinder(const StateGraph& graph, double longest);
  ~WalkFinder();

  // The walk of least
  //   sum of edge costs + distance_weight |distance - target| + time_weight |steps + 1 - target frames|
  // that keeps the hard limits. Looks at no more than about `max_labels` labels. Without hard limits there
  // always is one.
  Walk find(const WalkTargets& targets, std::size_t max_labels) const;

 private:
  class Tables;
  const StateGraph& graph_;
  std::unique_ptr<Tables> tables_;
};

Walk find_cheapest_walk(const StateGraph& graph, const WalkTargets& targets, std::size_t max_labels);

}  // namespace reprise::path_detail
