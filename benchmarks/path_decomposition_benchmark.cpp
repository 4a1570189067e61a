// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The exact optimiser beside the paper's own decomposition, with GLPK as its integer solver, on random graphs
// small enough for it.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "paper_decomposition.h"
#include "random_graph.h"
#include "reprise/core/cpu_clock.h"
#include "reprise/path/keyframe_optimizer.h"

namespace {

using namespace reprise::benchmark;

// Milliseconds.
double processor_time() {
  return 1e3 * reprise::process_cpu_seconds();
}

template <typename Number>
Number median(std::vector<Number> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? Number() : values[values.size() / 2];
}

void measure(std::size_t clip_count, int per_pair, double distance, double time, int queries) {
  std::mt19937 random(9);
  std::vector<double> own, paper, ratios;
  std::vector<std::size_t> walks, loops, programs;
  double worst_difference = 0.0;
  double worst_loss = 0.0;
  int losses = 0;
  int too_large = 0;
  int unsolved = 0;
  while (static_cast<int>(own.size()) < queries && too_large + unsolved < 10 * queries) {
    const RandomGraph graph = random_graph(clip_count, per_pair, random);
    const reprise::PathMetrics metrics = graph.metrics();
    const reprise::KeyframeQuery query = random_query(graph, distance, time, random);
    const reprise::KeyframeOptions options;
    if (query.keyframes[0] == query.keyframes[1]) continue;
    double start = processor_time();
    const auto path = reprise::find_keyframe_path(metrics, query, options, graph.names);
    const double own_time = processor_time() - start;
    if (!path || path->segments.size() < 2) continue;
    start = processor_time();
    const DecompositionResult whole =
        solve_by_decomposition(metrics, query, options, LoopAttachment::to_loops);
    const double paper_time = processor_time() - start;
    if (!whole.is_complete || std::isnan(whole.cost)) {
      ++(whole.is_complete ? unsolved : too_large);
      continue;
    }
    const DecompositionResult literal =
        solve_by_decomposition(metrics, query, options, LoopAttachment::to_walk);
    own.push_back(own_time);
    paper.push_back(paper_time);
    ratios.push_back(paper_time / own_time);
    walks.push_back(whole.walks);
    loops.push_back(whole.loops);
    programs.push_back(whole.programs);
    worst_difference = std::max(worst_difference, std::abs(whole.cost - path->cost));
    const double loss = literal.cost - path->cost;
    losses += loss > 1e-6 ? 1 : 0;
    worst_loss = std::max(worst_loss, loss);
  }
  if (own.empty()) return;
  fmt::print(
      "{:>5} {:>9} {:>7.0f} {:>5.0f} {:>4} {:>6}/{:<6} {:>6}/{:<6} {:>9} {:>9.3f} {:>10.1f} {:>10.1f} ",
      clip_count, per_pair, distance, time, own.size(), median(walks),
      *std::max_element(walks.begin(), walks.end()), median(loops),
      *std::max_element(loops.begin(), loops.end()), median(programs), median(own), median(paper),
      *std::max_element(paper.begin(), paper.end()));
  fmt::print("{:>9.0f} {:>9.1e} {:>6} {:>8.3f} {:>9} {:>8}\n", median(ratios), worst_difference, losses,
             worst_loss, too_large, unsolved);
}

}  // namespace

// path_decomposition_benchmark [QUERIES]
int main(int argc, char** argv) {
  const int queries = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  fmt::print(
      "Processor time in ms. 'worse': queries whose optimum needs loops on loops, which Eq. 14 as printed "
      "leaves out.\n");
  fmt::print(
      "{:>5} {:>9} {:>7} {:>5} {:>4} {:>13} {:>13} {:>9} {:>9} {:>10} {:>10} {:>9} {:>9} {:>6} {:>8} {:>9} "
      "{:>8}\n",
      "clips", "per pair", "metres", "s", "n", "walks", "loops", "programs", "own med", "paper med",
      "paper max", "ratio", "differs", "worse", "by up to", "too large", "unsolved");
  measure(2, 1, 2.0, 4.0, queries);
  measure(2, 2, 2.0, 4.0, queries);
  measure(2, 2, 5.0, 10.0, queries);
  measure(2, 3, 3.0, 6.0, queries);
  measure(3, 1, 3.0, 6.0, queries);
  measure(4, 1, 3.0, 6.0, queries);
  return 0;
}
