// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Key-frame queries on random graphs of realistic size: labels, time and gap of the exact optimiser, and
// beside it GLPK's integer program on the same small queries.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "random_graph.h"
#include "reprise/path/keyframe_optimizer.h"
#include "support/keyframe_program.h"

namespace {

using reprise::benchmark::random_graph;
using reprise::benchmark::random_query;
using reprise::benchmark::RandomGraph;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

void measure(const char* name, std::size_t clip_count, int per_pair, double distance, double time,
             int queries, const reprise::KeyframeOptions& options = {}) {
  std::mt19937 random(7);
  std::vector<double> times, labels;
  double worst_gap = 0.0;
  int unproved = 0;
  while (static_cast<int>(times.size()) < queries) {
    const RandomGraph graph = random_graph(clip_count, per_pair, random);
    const reprise::PathMetrics metrics = graph.metrics();
    const reprise::KeyframeQuery query = random_query(graph, distance, time, random);
    const auto start = std::chrono::steady_clock::now();
    const auto path = reprise::find_keyframe_path(metrics, query, options, graph.names);
    const double elapsed = milliseconds_since(start);
    // Queries without a path, or with none but the captured frames themselves, take no time and would
    // flatter.
    if (!path || path->segments.size() < 2) continue;
    times.push_back(elapsed);
    labels.push_back(static_cast<double>(path->labels));
    worst_gap = std::max(worst_gap, path->gap());
    unproved += path->gap() > 0.0 ? 1 : 0;
  }
  std::sort(times.begin(), times.end());
  fmt::print("{:<40} {:>5} {:>9.2f} {:>9.2f} {:>9.2f} {:>11.0f} {:>11.0f} {:>8} {:>9.4f}\n", name, queries,
             median(times), times[times.size() * 9 / 10], times.back(), median(labels),
             *std::max_element(labels.begin(), labels.end()), unproved, worst_gap);
}

void measure_beside_glpk(const char* name, std::size_t clip_count, int per_pair, double distance, double time,
                         int queries) {
  std::mt19937 random(9);
  std::vector<double> own, glpk;
  double worst_difference = 0.0;
  while (static_cast<int>(own.size()) < queries) {
    const RandomGraph graph = random_graph(clip_count, per_pair, random);
    const reprise::PathMetrics metrics = graph.metrics();
    const reprise::KeyframeQuery query = random_query(graph, distance, time, random);
    const reprise::KeyframeOptions options;
    auto start = std::chrono::steady_clock::now();
    const auto path = reprise::find_keyframe_path(metrics, query, options, graph.names);
    const double own_time = milliseconds_since(start);
    if (!path || path->segments.size() < 2) continue;
    own.push_back(own_time);
    start = std::chrono::steady_clock::now();
    // GLPK is given the optimum as its bound: more help than it would have.
    reprise::test::KeyframeProgram program(metrics, query, options, path->cost);
    worst_difference = std::max(worst_difference, std::abs(program.solve() - path->cost));
    glpk.push_back(milliseconds_since(start));
  }
  fmt::print("{:<40} {:>5} {:>12.2f} {:>12.2f} {:>12.2f} {:>12.2f} {:>12.1e}\n", name, queries, median(own),
             *std::max_element(own.begin(), own.end()), median(glpk),
             *std::max_element(glpk.begin(), glpk.end()), worst_difference);
}

}  // namespace

// path_benchmark [QUERIES]
int main(int argc, char** argv) {
  const int queries = argc > 1 ? std::max(1, std::atoi(argv[1])) : 50;
  fmt::print("{:<40} {:>5} {:>12} {:>12} {:>12} {:>12} {:>12}\n", "query", "n", "own med ms", "own max ms",
             "GLPK med ms", "GLPK max ms", "cost differs");
  measure_beside_glpk("2 clips x 2, 2 m in 4 s", 2, 2, 2.0, 4.0, queries);
  measure_beside_glpk("2 clips x 4, 3 m in 6 s", 2, 4, 3.0, 6.0, queries);
  fmt::print("\n{:<40} {:>5} {:>9} {:>9} {:>9} {:>11} {:>11} {:>8} {:>9}\n", "query", "n", "median ms",
             "p90 ms", "max ms", "labels med", "labels max", "unproved", "worst gap");
  measure("2 clips x 4, 5 m in 10 s", 2, 4, 5.0, 10.0, queries);
  measure("9 clips x 4, 12 m in 8 s", 9, 4, 12.0, 8.0, queries);
  measure("9 clips x 4, 4 m in 8 s", 9, 4, 4.0, 8.0, queries);
  measure("9 clips x 4, 20 m in 40 s", 9, 4, 20.0, 40.0, queries);
  measure("9 clips x 4, 20 m, time without weight", 9, 4, 20.0, 40.0, queries, {.time_weight = 0.0});
  return 0;
}
