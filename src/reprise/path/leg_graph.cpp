// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/leg_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "reprise/core/interrupt.h"

namespace reprise::path_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using Node = LegGraph::Node;
using Edge = LegGraph::Edge;

// Edges by the node at which a search meets them.
std::vector<std::vector<std::size_t>> edges_at(const LegGraph& leg, std::size_t Edge::*node) {
  std::vector<std::vector<std::size_t>> at(leg.nodes.size());
  for (std::size_t i = 0; i < leg.edges.size(); ++i) at[leg.edges[i].*node].push_back(i);
  return at;
}

// Dijkstra's search from `start`, along the edges or against them.
class ShortestLengths {
 public:
  ShortestLengths(const LegGraph& leg, EdgeLength length, bool forwards)
      : leg_(leg),
        length_(length),
        ahead_(forwards ? &Edge::target : &Edge::source),
        edges_(edges_at(leg, forwards ? &Edge::source : &Edge::target)) {}

  std::vector<double> operator()(std::size_t start) const {
    std::vector<double> least(leg_.nodes.size(), infinity);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    least[start] = 0.0;
    open.emplace(0.0, start);
    while (!open.empty()) {
      const auto [so_far, node] = open.top();
      open.pop();
      if (so_far > least[node]) continue;
      for (const std::size_t i : edges_[node]) {
        const double onward = so_far + length_(leg_.edges[i]);
        const std::size_t next = leg_.edges[i].*ahead_;
        if (onward >= least[next]) continue;
        least[next] = onward;
        open.emplace(onward, next);
      }
    }
    return least;
  }

 private:
  const LegGraph& leg_;
  EdgeLength length_;
  std::size_t Edge::*ahead_;
  std::vector<std::vector<std::size_t>> edges_;
};

double one(const Edge& /*edge*/) {
  return 1.0;
}

}  // namespace

LegGraph make_leg_graph(const PathMetrics& metrics, const FrameId& from, const FrameId& to,
                        const std::vector<bool>& forbidden) {
  std::vector<std::vector<int>> frames(metrics.clip_count());
  for (std::size_t i = 0; i < metrics.transitions().size(); ++i) {
    const Transition& transition = metrics.transitions()[i];
    if (!forbidden[i]) frames[transition.source_clip].push_back(transition.leave());
  }
  for (const FrameId& keyframe : {from, to}) {
    frames[keyframe.clip_idx].push_back(static_cast<int>(keyframe.frame_idx));
  }

  LegGraph leg;
  std::vector<std::size_t> first_node;  // of each clip, and one more
  for (std::size_t clip_idx = 0; clip_idx < frames.size(); ++clip_idx) {
    std::vector<int>& of_clip = frames[clip_idx];
    std::sort(of_clip.begin(), of_clip.end());
    of_clip.erase(std::unique(of_clip.begin(), of_clip.end()), of_clip.end());
    first_node.push_back(leg.nodes.size());
    for (const int frame : of_clip) leg.nodes.push_back({clip_idx, frame});
  }
  first_node.push_back(leg.nodes.size());
  // The node at a frame of a clip or the next after it; `first_node` of the next clip if there is none.
  const auto node_from = [&](std::size_t clip_idx, int frame) {
    const std::vector<int>& of_clip = frames[clip_idx];
    const auto found = std::lower_bound(of_clip.begin(), of_clip.end(), frame);
    return first_node[clip_idx] + static_cast<std::size_t>(found - of_clip.begin());
  };

  for (std::size_t clip_idx = 0; clip_idx < frames.size(); ++clip_idx) {
    for (std::size_t i = first_node[clip_idx]; i + 1 < first_node[clip_idx + 1]; ++i) {
      const int here = leg.nodes[i].frame;
      const int there = leg.nodes[i + 1].frame;
      leg.edges.push_back({.source = i,
                           .target = i + 1,
                           .steps = there - here,
                           .distance = metrics.clip_distance(clip_idx, here, there)});
    }
  }
  for (std::size_t i = 0; i < metrics.transitions().size(); ++i) {
    if (forbidden[i]) continue;
    const Transition& transition = metrics.transitions()[i];
    const std::size_t target = node_from(transition.target_clip, transition.arrive());
    if (target == first_node[transition.target_clip + 1]) continue;  // nothing but the end of the clip
    const int there = leg.nodes[target].frame;
    leg.edges.push_back(
        {.source = node_from(transition.source_clip, transition.leave()),
         .target = target,
         .transition = static_cast<int>(i),
         .steps = 2 * transition.half_window + there - transition.arrive(),
         .distance = metrics.blend_distance(i) +
                     metrics.clip_distance(transition.target_clip, transition.arrive(), there),
         .cost = transition.cost});
  }
  leg.first = node_from(from.clip_idx, static_cast<int>(from.frame_idx));
  leg.last = node_from(to.clip_idx, static_cast<int>(to.frame_idx));
  keep_edges(leg, std::vector<bool>(leg.edges.size(), true));
  return leg;
}

std::vector<std::size_t> keep_edges(LegGraph& leg, std::vector<bool> marked) {
  std::vector<std::size_t> former;
  std::vector<Edge> kept;
  for (std::size_t i = 0; i < leg.edges.size(); ++i) {
    if (!marked[i]) continue;
    former.push_back(i);
    kept.push_back(leg.edges[i]);
  }
  leg.edges = std::move(kept);
  const std::vector<double> before = lengths_from(leg, one, leg.first);
  const std::vector<double> after = lengths_to(leg, one, leg.last);
  const auto is_on_walk = [&](const Edge& edge) {
    return std::isfinite(before[edge.source]) && std::isfinite(after[edge.target]);
  };
  std::size_t count = 0;
  for (std::size_t i = 0; i < leg.edges.size(); ++i) {
    if (!is_on_walk(leg.edges[i])) continue;
    leg.edges[count] = leg.edges[i];
    former[count] = former[i];
    ++count;
  }
  leg.edges.resize(count);
  former.resize(count);
  return former;
}

std::vector<double> lengths_from(const LegGraph& leg, EdgeLength length, std::size_t node) {
  return ShortestLengths(leg, length, true)(node);
}

std::vector<double> lengths_to(const LegGraph& leg, EdgeLength length, std::size_t node) {
  return ShortestLengths(leg, length, false)(node);
}

double least_length(const LegGraph& leg, EdgeLength length) {
  const std::vector<double> after = lengths_to(leg, length, leg.last);
  double least = infinity;
  for (const Edge& edge : leg.edges) {
    if (edge.source == leg.first) least = std::min(least, length(edge) + after[edge.target]);
  }
  return least;
}

std::vector<double> most_uses(const LegGraph& leg, EdgeLength length, double budget) {
  const std::vector<double> before = lengths_from(leg, length, leg.first);
  const std::vector<double> after = lengths_to(leg, length, leg.last);
  const ShortestLengths search(leg, length, true);
  const std::vector<std::vector<std::size_t>> arriving = edges_at(leg, &Edge::target);
  std::vector<double> most(leg.edges.size(), 0.0);
  for (std::size_t node = 0; node < leg.nodes.size(); ++node) {
    if (arriving[node].empty()) continue;
    throw_if_interrupted();
    const std::vector<double> onward = search(node);
    for (const std::size_t i : arriving[node]) {
      const Edge& edge = leg.edges[i];
      const double rest = budget - (before[edge.source] + length(edge) + after[edge.target]);
      if (rest < 0.0) continue;
      const double loop = length(edge) + onward[edge.source];
      // An infinite loop: there is none, and the edge is used once. Never 0 / 0.
      most[i] = loop > 0.0 ? 1.0 + std::floor(rest / loop) : infinity;
    }
  }
  return most;
}

}  // namespace reprise::path_detail
