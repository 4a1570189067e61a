// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The search of HSSMG 5.2.1 as the paper has it: Dijkstra's algorithm with a priority queue on the retrieval
// trellis.

#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "reprise/path/skeleton_retrieval.h"
#include "reprise/path/trellis.h"

namespace reprise::benchmark {

class DijkstraPeer {
 public:
  explicit DijkstraPeer(const path_detail::Trellis& trellis)
      : node_count_(trellis.node_count()),
        captured_count_(trellis.captured_count()),
        edges_(trellis.node_count()) {
    for (const path_detail::Trellis::Run& run : trellis.runs()) {
      for (std::size_t node = run.first; node < run.end; ++node) {
        if (node + 1 < run.end) edges_[node].push_back({node + 1, 0.0, false});
        if (node + 2 < run.end) edges_[node].push_back({node + 2, 0.0, true});
      }
    }
    for (std::size_t n = 0; n < trellis.entered_nodes().size(); ++n) {
      for (const path_detail::Trellis::Entry& entry : trellis.entries(n)) {
        edges_[static_cast<std::size_t>(entry.from)].push_back(
            {static_cast<std::size_t>(trellis.entered_nodes()[n]), entry.cost, entry.is_skip()});
      }
    }
  }

  // Least cost of a walk; `rows`: c_skel of all nodes, one row a frame of the query. Infinite if there is
  // none.
  double solve(const std::vector<std::vector<float>>& rows, const RetrievalOptions& options, double limit) {
    const auto layers = static_cast<std::size_t>(options.most_repeats) + 1;
    std::vector<double> best(rows.size() * node_count_ * layers, std::numeric_limits<double>::infinity());
    using Item = std::pair<double, std::size_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    const auto offer = [&](std::size_t k, std::size_t node, std::size_t repeats, double cost) {
      const double dissimilarity = rows[k][node];
      if (dissimilarity > limit) return;
      const std::size_t state = (k * node_count_ + node) * layers + repeats;
      const double total = cost + options.retrieval_weight * dissimilarity;
      if (total >= best[state]) return;
      best[state] = total;
      queue.emplace(total, state);
    };
    for (std::size_t node = 0; node < captured_count_; ++node) offer(0, node, 0, 0.0);
    while (!queue.empty()) {
      const auto [cost, state] = queue.top();
      queue.pop();
      if (cost > best[state]) continue;
      const std::size_t repeats = state % layers;
      const std::size_t node = state / layers % node_count_;
      const std::size_t k = state / layers / node_count_;
      if (k + 1 == rows.size()) return cost;
      if (repeats + 1 < layers) offer(k + 1, node, repeats + 1, cost + options.repeat_cost);
      for (const Edge& edge : edges_[node]) {
        if (edge.skip && !options.allow_skips) continue;
        offer(k + 1, edge.to, 0, cost + edge.cost + (edge.skip ? options.skip_cost : 0.0));
      }
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  struct Edge {
    std::size_t to;
    double cost;
    bool skip;
  };
  std::size_t node_count_;
  std::size_t captured_count_;
  std::vector<std::vector<Edge>> edges_;
};

}  // namespace reprise::benchmark
