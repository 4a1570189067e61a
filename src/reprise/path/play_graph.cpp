// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/play_graph.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

#include "reprise/core/interrupt.h"

namespace reprise::path_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// For each clip the last frame from which one can play for ever, or -1.
std::vector<int> last_live_frames(const PathMetrics& metrics, const std::vector<bool>& allowed) {
  const std::vector<Transition>& transitions = metrics.transitions();
  std::vector<int> last(metrics.clip_count(), std::numeric_limits<int>::max());
  for (bool changed = true; changed;) {
    std::vector<int> still(metrics.clip_count(), -1);
    for (std::size_t i = 0; i < transitions.size(); ++i) {
      const Transition& transition = transitions[i];
      if (!allowed[i] || transition.arrive() > last[transition.target_clip]) continue;
      still[transition.source_clip] = std::max(still[transition.source_clip], transition.leave());
    }
    changed = still != last;
    last = std::move(still);
  }
  return last;
}

// A cycle among the edges by which the nodes were last reached, or nothing.
std::optional<PlayWay> cycle_of(const std::vector<const PlayEdge*>& reached_by,
                                const std::vector<std::int32_t>& reached_from) {
  const std::size_t count = reached_by.size();
  std::vector<std::size_t> seen_on(count, 0);  // number of the search that came by first, from 1
  for (std::size_t first = 0; first < count; ++first) {
    std::size_t node = first;
    while (seen_on[node] == 0 && reached_by[node] != nullptr) {
      seen_on[node] = first + 1;
      node = static_cast<std::size_t>(reached_from[node]);
    }
    if (reached_by[node] == nullptr || seen_on[node] != first + 1) continue;
    PlayWay cycle{.start = static_cast<std::int32_t>(node), .edges = {}};
    for (std::size_t at = node; cycle.edges.empty() || at != node;
         at = static_cast<std::size_t>(reached_from[at])) {
      cycle.edges.push_back(*reached_by[at]);
    }
    std::ranges::reverse(cycle.edges);
    return cycle;
  }
  return std::nullopt;
}

// A cycle of cost less than `ratio` a frame, or nothing (Bellman and Ford).
std::optional<PlayWay> cheaper_cycle(const PlayGraph& graph, const std::vector<bool>& reachable,
                                     double ratio) {
  constexpr double tolerance = 1e-12;  // so that rounding makes no cycle
  const auto count = static_cast<std::size_t>(graph.node_count());
  std::vector<double> length(count, 0.0);
  std::vector<const PlayEdge*> reached_by(count, nullptr);
  std::vector<std::int32_t> reached_from(count, -1);
  for (;;) {
    throw_if_interrupted();
    bool changed = false;
    for (std::int32_t node = 0; node < graph.node_count(); ++node) {
      if (!reachable[static_cast<std::size_t>(node)]) continue;
      for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
        const auto target = static_cast<std::size_t>(edge->target);
        const double reached = length[static_cast<std::size_t>(node)] + edge->cost - ratio * edge->frames;
        if (reached >= length[target] - tolerance) continue;
        length[target] = reached;
        reached_by[target] = edge;
        reached_from[target] = node;
        changed = true;
      }
    }
    if (!changed) return std::nullopt;
    if (std::optional<PlayWay> cycle = cycle_of(reached_by, reached_from)) return cycle;
  }
}

std::vector<bool> nodes_from(const PlayGraph& graph, std::int32_t start) {
  std::vector<bool> reachable(static_cast<std::size_t>(graph.node_count()), false);
  std::vector<std::int32_t> open{start};
  reachable[static_cast<std::size_t>(start)] = true;
  while (!open.empty()) {
    const std::int32_t node = open.back();
    open.pop_back();
    for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
      if (reachable[static_cast<std::size_t>(edge->target)]) continue;
      reachable[static_cast<std::size_t>(edge->target)] = true;
      open.push_back(edge->target);
    }
  }
  return reachable;
}

}  // namespace

PlayGraph::PlayGraph(const PathMetrics& metrics, const std::vector<bool>& allowed) {
  const std::vector<Transition>& transitions = metrics.transitions();
  const std::vector<int> last = last_live_frames(metrics, allowed);
  std::vector<std::vector<std::int32_t>> leaving(metrics.clip_count());
  for (std::size_t i = 0; i < transitions.size(); ++i) {
    if (allowed[i] && transitions[i].arrive() <= last[transitions[i].target_clip]) {
      leaving[transitions[i].source_clip].push_back(static_cast<std::int32_t>(i));
    }
  }
  const auto leave = [&](std::int32_t i) { return transitions[static_cast<std::size_t>(i)].leave(); };
  for (std::size_t clip_idx = 0; clip_idx < leaving.size(); ++clip_idx) {
    std::ranges::stable_sort(leaving[clip_idx], {}, leave);
    first_node_.push_back(frames_.size());
    for (const std::int32_t i : leaving[clip_idx]) {
      if (frames_.size() > first_node_.back() && frames_.back() == leave(i)) continue;
      frames_.push_back(leave(i));
      clips_.push_back(clip_idx);
    }
  }
  first_node_.push_back(frames_.size());
  for (std::size_t clip_idx = 0; clip_idx < leaving.size(); ++clip_idx) {
    auto next = leaving[clip_idx].begin();
    for (std::size_t node = first_node_[clip_idx]; node < first_node_[clip_idx + 1]; ++node) {
      first_edge_.push_back(edges_.size());
      for (; next != leaving[clip_idx].end() && leave(*next) == frames_[node]; ++next) {
        const Transition& transition = transitions[static_cast<std::size_t>(*next)];
        const std::int32_t target = node_at(transition.target_clip, transition.arrive());
        edges_.push_back({.target = target,
                          .transition = *next,
                          .frames = 2 * transition.half_window + frame_of(target) - transition.arrive(),
                          .cost = transition.cost});
      }
      if (node + 1 < first_node_[clip_idx + 1]) {
        edges_.push_back(
            {.target = static_cast<std::int32_t>(node) + 1, .frames = frames_[node + 1] - frames_[node]});
      }
    }
  }
  first_edge_.push_back(edges_.size());
}

std::int32_t PlayGraph::node_at(std::size_t clip_idx, int frame) const {
  const auto first = frames_.begin() + static_cast<std::ptrdiff_t>(first_node_[clip_idx]);
  const auto last = frames_.begin() + static_cast<std::ptrdiff_t>(first_node_[clip_idx + 1]);
  const auto found = std::lower_bound(first, last, frame);
  return found == last ? -1 : static_cast<std::int32_t>(found - frames_.begin());
}

double PlayWay::cost() const {
  double cost = 0.0;
  for (const PlayEdge& edge : edges) cost += edge.cost;
  return cost;
}

std::int64_t PlayWay::frames() const {
  std::int64_t frames = 0;
  for (const PlayEdge& edge : edges) frames += edge.frames;
  return frames;
}

// Lawler's parametric search with Dinkelbach's step: a cycle costs less than `ratio` a frame exactly if it is
// negative under the lengths cost - ratio frames. Each cycle found gives the next ratio, which falls until no
// cycle is cheaper: the last one is the cheapest.
PlayWay cheapest_loop(const PlayGraph& graph, std::int32_t start) {
  const std::vector<bool> reachable = nodes_from(graph, start);
  double ratio = 1.0;
  for (std::int32_t node = 0; node < graph.node_count(); ++node) {
    for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
      ratio = std::max(ratio, edge->cost + 1.0);
    }
  }
  PlayWay loop;
  while (std::optional<PlayWay> cycle = cheaper_cycle(graph, reachable, ratio)) {
    const double cheaper = cycle->cost() / static_cast<double>(cycle->frames());
    if (cheaper >= ratio) break;
    ratio = cheaper;
    loop = std::move(*cycle);
  }

  std::vector<bool> on_loop(static_cast<std::size_t>(graph.node_count()), false);
  for (const PlayEdge& edge : loop.edges) on_loop[static_cast<std::size_t>(edge.target)] = true;
  const PlayWay way = cheapest_way(graph, start, on_loop);
  const std::int32_t entry = way.edges.empty() ? start : way.edges.back().target;
  for (std::size_t i = 0; i < loop.edges.size(); ++i) {
    if (loop.edges[i].target != entry) continue;
    std::ranges::rotate(loop.edges, loop.edges.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    break;
  }
  loop.start = entry;
  return loop;
}

PlayWay cheapest_way(const PlayGraph& graph, std::int32_t start, const std::vector<bool>& goals) {
  const auto count = static_cast<std::size_t>(graph.node_count());
  using Length = std::pair<double, std::int64_t>;  // cost, frames
  std::vector<Length> length(count, {infinity, 0});
  std::vector<const PlayEdge*> reached_by(count, nullptr);
  std::vector<std::int32_t> reached_from(count, -1);
  using Entry = std::pair<Length, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  length[static_cast<std::size_t>(start)] = {0.0, 0};
  queue.push({{0.0, 0}, start});
  while (!queue.empty()) {
    const auto [so_far, node] = queue.top();
    queue.pop();
    if (so_far > length[static_cast<std::size_t>(node)]) continue;
    if (goals[static_cast<std::size_t>(node)]) {
      PlayWay way{.start = start, .edges = {}};
      for (std::int32_t at = node; at != start; at = reached_from[static_cast<std::size_t>(at)]) {
        way.edges.push_back(*reached_by[static_cast<std::size_t>(at)]);
      }
      std::ranges::reverse(way.edges);
      return way;
    }
    for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
      const auto target = static_cast<std::size_t>(edge->target);
      const Length reached{so_far.first + edge->cost, so_far.second + edge->frames};
      if (reached >= length[target]) continue;
      length[target] = reached;
      reached_by[target] = edge;
      reached_from[target] = node;
      queue.push({reached, edge->target});
    }
  }
  return {.start = start, .edges = {}};
}

}  // namespace reprise::path_detail
