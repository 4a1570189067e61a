// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Searches for the cheapest walk over the ground: one that is quick, one that proves.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "reprise/path/ground_bounds.h"
#include "reprise/path/ground_guide.h"

namespace reprise::path_detail {

// What the search has found so far.
struct GroundWalk {
  std::vector<std::int32_t> edges;  // indices into StateGraph::edges; empty: no walk that keeps the limits
  double cost = infinity;
  double lower_bound = -infinity;  // no walk costs less; infinite: there is proved to be none
  std::size_t labels = 0;
  // Without a walk: the complete one that breaks the limits least, and the farthest a walk came along the
  // route before its limit stopped it.
  std::optional<GroundLabel> nearest;
  double farthest_marker = 0.0;

  bool found() const { return !edges.empty(); }
};

// Keeps the `width` labels of most promise after each number of steps, no two at nearly the same place and
// turn of the same node, and improves `best` where it can. Looks at no more than about `max_labels` labels;
// returns false if that ended it. Certifies nothing.
bool beam_search(const GroundTask& task, const GroundBounds& bounds, const GroundGuide& guide,
                 std::size_t width, std::size_t max_labels, GroundWalk& best);

// Best-first over bounds, labels that cannot do better than another left out: when it runs to its end
// `best.cost` is the optimum of all walks within the horizon. Sets `best.lower_bound` for these.
void prove(const GroundTask& task, const GroundBounds& bounds, std::size_t max_labels, GroundWalk& best);

// All of it: horizon, bounds, beams, proof. Precondition: the graph is not empty.
GroundWalk find_ground_walk(const GroundTask& task, const GroundGuide& guide, std::size_t max_labels);

}  // namespace reprise::path_detail
