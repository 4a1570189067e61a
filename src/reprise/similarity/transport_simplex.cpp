// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/transport_simplex.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace reprise {
namespace {

constexpr std::size_t lanes = 16;  // a row of costs is padded to a multiple of this
constexpr std::int64_t far_away = std::numeric_limits<std::int64_t>::max() / 4;
// Arcs a cheap basis is chosen from, for each node.
constexpr std::size_t candidates_per_node = 4;

template <typename T>
void grow(std::vector<T>& values, std::size_t size) {
  if (values.size() < size) values.resize(size);
}

}  // namespace

void TransportSimplex::resize(std::size_t source_count, std::size_t sink_count) {
  source_count_ = source_count;
  sink_count_ = sink_count;
  stride_ = (sink_count + lanes - 1) / lanes * lanes;
  grow(costs_, source_count * stride_);
  for (std::size_t i = 0; i < source_count; ++i) {
    std::fill(cost_row(i) + sink_count, cost_row(i) + stride_, 0);
  }
  masses_.resize(source_count + sink_count);
  potentials_.assign(source_count + stride_, 0);
  std::fill(potentials_.begin() + static_cast<std::ptrdiff_t>(source_count + sink_count), potentials_.end(),
            far_away);
}

std::int64_t TransportSimplex::reduced_cost(std::int32_t source, std::int32_t sink) const {
  const auto i = static_cast<std::size_t>(source);
  const auto j = static_cast<std::size_t>(sink);
  return costs_[i * stride_ + j] - potentials_[i] + potentials_[source_count_ + j];
}

std::int64_t TransportSimplex::cost_between(std::int32_t node, std::int32_t other) const {
  const auto source = static_cast<std::size_t>(std::min(node, other));
  const auto sink = static_cast<std::size_t>(std::max(node, other)) - source_count_;
  return costs_[source * stride_ + sink];
}

std::int64_t TransportSimplex::best_of_row(std::size_t source) const {
  const std::int32_t* costs = costs_.data() + source * stride_;
  const std::int64_t* v = potentials_.data() + source_count_;
  std::array<std::int64_t, lanes> best;
  best.fill(far_away);
  for (std::size_t first = 0; first < stride_; first += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::int64_t value = costs[first + k] + v[first + k];
      best[k] = value < best[k] ? value : best[k];
    }
  }
  return *std::ranges::min_element(best);
}

std::int32_t TransportSimplex::sink_with(std::size_t source, std::int64_t best) const {
  const std::int32_t* costs = costs_.data() + source * stride_;
  const std::int64_t* v = potentials_.data() + source_count_;
  std::size_t j = 0;
  while (costs[j] + v[j] != best) ++j;
  return static_cast<std::int32_t>(j);
}

// The cheaper arcs between some sources and sinks, cheapest first.
void TransportSimplex::find_candidates(std::span<const std::int32_t> sources,
                                       std::span<const std::int32_t> sinks) {
  const std::size_t arc_count = sources.size() * sinks.size();
  const std::size_t wanted = candidates_per_node * (sources.size() + sinks.size());
  std::int64_t limit = far_away;
  if (wanted < arc_count) {
    // The limit that lets about as many pass as are wanted, from a sample.
    sample_.clear();
    for (std::size_t arc = 0; arc < arc_count; arc += arc_count / 1024 + 1) {
      sample_.push_back(reduced_cost(sources[arc / sinks.size()], sinks[arc % sinks.size()]));
    }
    const auto rank = static_cast<std::ptrdiff_t>(sample_.size() * wanted / arc_count);
    std::ranges::nth_element(sample_, sample_.begin() + rank);
    limit = sample_[static_cast<std::size_t>(rank)];
  }
  candidates_.clear();
  for (const std::int32_t i : sources) {
    for (const std::int32_t j : sinks) {
      const std::int64_t reduced = reduced_cost(i, j);
      if (reduced <= limit) candidates_.push_back({i, j, reduced});
    }
  }
  std::ranges::sort(candidates_, {}, &Arc::reduced_cost);
}

void TransportSimplex::ship(const Arc& arc) {
  std::int64_t& supply = left_[static_cast<std::size_t>(arc.source)];
  std::int64_t& demand = left_[source_count_ + static_cast<std::size_t>(arc.sink)];
  const std::int64_t mass = std::min(supply, demand);
  if (mass == 0) return;
  basis_.push_back(arc);
  supply -= mass;
  demand -= mass;
}

// `neighbors_` from `offsets_[n]` to `offsets_[n + 1]`: what the arcs connect node n with.
void TransportSimplex::link_neighbors(std::span<const Arc> arcs) {
  offsets_.assign(source_count_ + sink_count_ + 2, 0);
  const auto sink_node = [&](const Arc& arc) { return source_count_ + static_cast<std::size_t>(arc.sink); };
  for (const Arc& arc : arcs) {
    ++offsets_[static_cast<std::size_t>(arc.source) + 2];
    ++offsets_[sink_node(arc) + 2];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  neighbors_.resize(2 * arcs.size());
  for (const Arc& arc : arcs) {
    const auto source = static_cast<std::size_t>(arc.source);
    const std::size_t sink = sink_node(arc);
    neighbors_[static_cast<std::size_t>(offsets_[source + 1]++)] = static_cast<std::int32_t>(sink);
    neighbors_[static_cast<std::size_t>(offsets_[sink + 1]++)] = arc.source;
  }
}

// Ships along the arcs that the guess makes tight, from the leaves of their graph inwards: where it is a tree
// there is no other way, and with the potential of a similar problem most of it is.
void TransportSimplex::ship_tight_arcs() {
  const auto end = std::ranges::find_if(candidates_, [](const Arc& arc) { return arc.reduced_cost > 0; });
  link_neighbors({candidates_.begin(), end});
  const std::size_t node_count = source_count_ + sink_count_;
  degree_.resize(node_count);
  queue_.clear();
  for (std::size_t n = 0; n < node_count; ++n) {
    degree_[n] = offsets_[n + 1] - offsets_[n];
    if (degree_[n] == 1) queue_.push_back(static_cast<std::int32_t>(n));
  }
  const auto close_if_done = [&](std::size_t n) {
    if (left_[n] > 0) return;
    for (std::int32_t k = offsets_[n]; k < offsets_[n + 1]; ++k) {
      const std::int32_t other = neighbors_[static_cast<std::size_t>(k)];
      const auto o = static_cast<std::size_t>(other);
      if (--degree_[o] == 1 && left_[o] > 0) queue_.push_back(other);
    }
  };
  for (std::size_t q = 0; q < queue_.size(); ++q) {
    const std::int32_t node = queue_[q];
    const auto n = static_cast<std::size_t>(node);
    if (left_[n] == 0) continue;
    for (std::int32_t k = offsets_[n]; k < offsets_[n + 1]; ++k) {
      const std::int32_t other = neighbors_[static_cast<std::size_t>(k)];
      if (left_[static_cast<std::size_t>(other)] == 0) continue;
      ship({std::min(node, other), std::max(node, other) - static_cast<std::int32_t>(source_count_), 0});
      close_if_done(n);
      close_if_done(static_cast<std::size_t>(other));
      break;
    }
  }
}

// A forest along which everything can be shipped, cheap arcs first: each arc of it empties a source or fills
// a sink.
void TransportSimplex::choose_basis() {
  basis_.clear();
  left_ = masses_;
  for (bool is_first = true;; is_first = false) {
    open_sources_.clear();
    open_sinks_.clear();
    for (std::size_t n = 0; n < left_.size(); ++n) {
      if (left_[n] == 0) continue;
      if (n < source_count_) {
        open_sources_.push_back(static_cast<std::int32_t>(n));
      } else {
        open_sinks_.push_back(static_cast<std::int32_t>(n - source_count_));
      }
    }
    if (open_sources_.empty()) return;
    find_candidates(open_sources_, open_sinks_);
    if (is_first) ship_tight_arcs();
    for (const Arc& arc : candidates_) ship(arc);
  }
}

void TransportSimplex::attach(std::int32_t node, std::int32_t parent) {
  Node& above = at(parent);
  Node& self = at(node);
  self.parent = parent;
  self.next = above.first_child;
  self.previous = -1;
  if (self.next >= 0) at(self.next).previous = node;
  above.first_child = node;
}

void TransportSimplex::detach(std::int32_t node) {
  const Node& self = at(node);
  if (self.next >= 0) at(self.next).previous = self.previous;
  if (self.previous >= 0) {
    at(self.previous).next = self.next;
  } else {
    at(self.parent).first_child = self.next;
  }
}

// Hangs everything that the basis connects with `root` below it.
void TransportSimplex::hang_component(std::int32_t root, std::int32_t parent) {
  const std::size_t begin = queue_.size();
  at(root).depth = parent < 0 ? 0 : at(parent).depth + 1;
  if (parent >= 0) attach(root, parent);
  queue_.push_back(root);
  for (std::size_t q = begin; q < queue_.size(); ++q) {
    const std::int32_t node = queue_[q];
    const auto n = static_cast<std::size_t>(node);
    for (std::int32_t k = offsets_[n]; k < offsets_[n + 1]; ++k) {
      const std::int32_t other = neighbors_[static_cast<std::size_t>(k)];
      if (at(other).depth >= 0) continue;
      at(other).depth = at(node).depth + 1;
      attach(other, node);
      queue_.push_back(other);
    }
  }
}

// One tree of the basis. A component hangs from the cheapest arc of its first source to what hangs already:
// it carries nothing and points up, so the tree is strongly feasible.
void TransportSimplex::hang_tree() {
  nodes_.assign(source_count_ + sink_count_, Node{});
  link_neighbors(basis_);
  queue_.clear();
  hang_component(basis_.front().source, -1);
  for (std::size_t i = 0; i < source_count_; ++i) {
    const auto source = static_cast<std::int32_t>(i);
    if (at(source).depth >= 0) continue;
    std::int32_t parent = -1;
    std::int64_t least = far_away;
    for (const std::int32_t other : queue_) {
      if (is_source(other)) continue;
      const std::int64_t reduced = reduced_cost(source, other - static_cast<std::int32_t>(source_count_));
      if (reduced < least) {
        least = reduced;
        parent = other;
      }
    }
    hang_component(source, parent);
  }
}

// From the leaves upwards.
void TransportSimplex::set_flows() {
  left_ = masses_;
  for (std::size_t j = 0; j < sink_count_; ++j) left_[source_count_ + j] = -left_[source_count_ + j];
  for (std::size_t q = queue_.size() - 1; q > 0; --q) {
    const std::int32_t node = queue_[q];
    const std::int64_t surplus = left_[static_cast<std::size_t>(node)];
    left_[static_cast<std::size_t>(at(node).parent)] += surplus;
    at(node).flow = points_up(node) ? surplus : -surplus;
  }
}

// Along an arc of the tree the potential falls by its cost.
void TransportSimplex::set_potentials() {
  for (std::size_t q = 1; q < queue_.size(); ++q) {
    const std::int32_t node = queue_[q];
    const std::int32_t parent = at(node).parent;
    const std::int64_t cost = cost_between(node, parent);
    potentials_[static_cast<std::size_t>(node)] =
        potentials_[static_cast<std::size_t>(parent)] + (points_up(node) ? cost : -cost);
  }
}

void TransportSimplex::pivot(std::int32_t source, std::int32_t sink) {
  const std::int32_t sink_node = sink + static_cast<std::int32_t>(source_count_);
  const std::int64_t reduced = reduced_cost(source, sink);
  std::int32_t a = source;
  std::int32_t b = sink_node;
  while (a != b) {
    if (at(a).depth >= at(b).depth) {
      a = at(a).parent;
    } else {
      b = at(b).parent;
    }
  }
  const std::int32_t join = a;
  // Mass goes round: along the entering arc, up from its sink to the join, down to its source. Of several
  // arcs that run dry the last one on the way from the join leaves: the tree stays strongly feasible.
  std::int64_t mass = std::numeric_limits<std::int64_t>::max();
  std::int32_t leaving = -1;
  bool leaves_source_side = false;
  for (std::int32_t n = source; n != join; n = at(n).parent) {
    if (points_up(n) && at(n).flow < mass) {
      mass = at(n).flow;
      leaving = n;
      leaves_source_side = true;
    }
  }
  for (std::int32_t n = sink_node; n != join; n = at(n).parent) {
    if (!points_up(n) && at(n).flow <= mass) {
      mass = at(n).flow;
      leaving = n;
      leaves_source_side = false;
    }
  }
  if (mass > 0) {
    for (std::int32_t n = source; n != join; n = at(n).parent) at(n).flow += points_up(n) ? -mass : mass;
    for (std::int32_t n = sink_node; n != join; n = at(n).parent) at(n).flow += points_up(n) ? mass : -mass;
  }
  // The branch below the leaving arc is hung from its end of the entering one.
  const std::int32_t end = leaves_source_side ? source : sink_node;
  std::int32_t node = end;
  std::int32_t parent = leaves_source_side ? sink_node : source;
  std::int64_t flow = mass;
  while (true) {
    Node& self = at(node);
    const std::int32_t old_parent = self.parent;
    const std::int64_t old_flow = self.flow;
    detach(node);
    attach(node, parent);
    self.flow = flow;
    if (node == leaving) break;
    parent = node;
    flow = old_flow;
    node = old_parent;
  }
  const std::int64_t shift = leaves_source_side ? reduced : -reduced;
  for (node = end;;) {
    Node& self = at(node);
    potentials_[static_cast<std::size_t>(node)] += shift;
    self.depth = at(self.parent).depth + 1;
    if (self.first_child >= 0) {
      node = self.first_child;
      continue;
    }
    while (node != end && at(node).next < 0) node = at(node).parent;
    if (node == end) break;
    node = at(node).next;
  }
}

bool TransportSimplex::solve(Int128 cutoff) {
  // The best that the guess of v allows.
  for (std::size_t i = 0; i < source_count_; ++i) potentials_[i] = best_of_row(i);
  dual_bound_ = 0;
  for (std::size_t n = 0; n < masses_.size(); ++n) {
    const Int128 term = static_cast<Int128>(masses_[n]) * potentials_[n];
    dual_bound_ += n < source_count_ ? term : -term;
  }
  if (dual_bound_ > cutoff) return false;
  choose_basis();
  hang_tree();
  set_flows();
  set_potentials();
  while (true) {
    candidates_.clear();
    Int128 bound = 0;
    for (std::size_t i = 0; i < source_count_; ++i) {
      const std::int64_t best = best_of_row(i);
      bound += static_cast<Int128>(masses_[i]) * best;
      if (best < potentials_[i]) {
        candidates_.push_back({static_cast<std::int32_t>(i), 0, best - potentials_[i]});
      }
    }
    for (std::size_t j = 0; j < sink_count_; ++j) {
      bound -= static_cast<Int128>(masses_[source_count_ + j]) * potentials_[source_count_ + j];
    }
    dual_bound_ = std::max(dual_bound_, bound);
    if (candidates_.empty()) return true;
    if (dual_bound_ > cutoff) return false;
    std::ranges::sort(candidates_, {}, &Arc::reduced_cost);
    for (const Arc& candidate : candidates_) {
      const auto i = static_cast<std::size_t>(candidate.source);
      const std::int64_t best = best_of_row(i);
      if (best < potentials_[i]) pivot(candidate.source, sink_with(i, best));
    }
  }
}

Int128 TransportSimplex::cost() const {
  Int128 sum = 0;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].parent >= 0) {
      sum +=
          static_cast<Int128>(nodes_[n].flow) * cost_between(static_cast<std::int32_t>(n), nodes_[n].parent);
    }
  }
  return sum;
}

}  // namespace reprise
