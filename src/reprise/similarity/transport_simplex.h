// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Network simplex for dense transport problems in whole numbers: optimum and dual agree to the last bit.

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace reprise {

__extension__ using Int128 = __int128;

// Moves supplies of sources to demands of sinks at least cost. The basis is a strongly feasible spanning tree
// (Cunningham 1976), so that it ends; the whole row of a source is priced at once, which the processor does
// many arcs at a time. Memory is kept from one problem to the next.
class TransportSimplex {
 public:
  // Makes room for a problem; everything is to be filled in afterwards.
  void resize(std::size_t source_count, std::size_t sink_count);

  // Positive masses; both sums must be the same.
  std::int64_t* supplies() { return masses_.data(); }
  std::int64_t* demands() { return masses_.data() + source_count_; }
  // Costs of one source to all sinks, not negative.
  std::int32_t* cost_row(std::size_t source) { return costs_.data() + source * stride_; }
  // The dual: u of sources and v of sinks, u - v <= cost for every arc. Before the search, v is a guess (zero
  // after `resize`).
  const std::int64_t* source_potentials() const { return potentials_.data(); }
  std::int64_t* sink_potentials() { return potentials_.data() + source_count_; }

  // Finds the optimum; the better the guess of v, the sooner. Ends early, and returns false, once the dual
  // bound is above `cutoff`; then only `dual_bound` holds.
  bool solve(Int128 cutoff);

  // Cost of the transport found: sum of mass x cost.
  Int128 cost() const;
  // sum supply u - sum demand v, the best seen: equal to the cost at the optimum.
  Int128 dual_bound() const { return dual_bound_; }

 private:
  struct Arc {
    std::int32_t source = 0;
    std::int32_t sink = 0;
    std::int64_t reduced_cost = 0;
  };
  struct Node {
    std::int64_t flow = 0;  // of the arc to or from the parent
    std::int32_t parent = -1;
    std::int32_t first_child = -1;
    std::int32_t next = -1;  // sibling
    std::int32_t previous = -1;
    std::int32_t depth = -1;  // -1: not hung yet
  };

  void find_candidates(std::span<const std::int32_t> sources, std::span<const std::int32_t> sinks);
  void choose_basis();
  void ship(const Arc& arc);
  void ship_tight_arcs();
  void link_neighbors(std::span<const Arc> arcs);
  void hang_tree();
  void hang_component(std::int32_t root, std::int32_t parent);
  void set_flows();
  void set_potentials();
  // Least of cost + v over a row, and a sink where it is reached.
  std::int64_t best_of_row(std::size_t source) const;
  std::int32_t sink_with(std::size_t source, std::int64_t best) const;
  void pivot(std::int32_t source, std::int32_t sink);
  void attach(std::int32_t node, std::int32_t parent);
  void detach(std::int32_t node);
  bool is_source(std::int32_t node) const { return static_cast<std::size_t>(node) < source_count_; }
  Node& at(std::int32_t node) { return nodes_[static_cast<std::size_t>(node)]; }
  // Arcs run from sources to sinks.
  bool points_up(std::int32_t node) const { return is_source(node); }
  std::int64_t cost_between(std::int32_t node, std::int32_t other) const;
  std::int64_t reduced_cost(std::int32_t source, std::int32_t sink) const;

  std::size_t source_count_ = 0;
  std::size_t sink_count_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::int32_t> costs_;       // sources x stride, the rest of a row is padding
  std::vector<std::int64_t> masses_;      // sources, then sinks
  std::vector<std::int64_t> potentials_;  // likewise, and padding
  std::vector<Node> nodes_;               // sources, then sinks
  Int128 dual_bound_ = 0;

  std::vector<Arc> candidates_;
  std::vector<Arc> basis_;  // the first one
  std::vector<std::int64_t> left_, sample_;
  std::vector<std::int32_t> open_sources_, open_sinks_, offsets_, neighbors_, degree_, queue_;
};

}  // namespace reprise
