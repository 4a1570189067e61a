// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Exact earth mover's distance of real histograms, beside LEMON's network simplex on all arcs. Both sides
// start from the two histograms: building the problem is part of the time.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include "real_data.h"
#include "reprise/similarity/earth_movers_distance.h"

namespace reprise::benchmark {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double lemon_distance(const BinGrid& grid, const Signature& a, const Signature& b) {
  lemon::SmartDigraph graph;
  graph.reserveNode(static_cast<int>(a.size() + b.size()));
  graph.reserveArc(static_cast<int>(a.size() * b.size()));
  std::vector<lemon::SmartDigraph::Node> sources, sinks;
  for (std::size_t i = 0; i < a.size(); ++i) sources.push_back(graph.addNode());
  for (std::size_t j = 0; j < b.size(); ++j) sinks.push_back(graph.addNode());
  for (const auto source : sources) {
    for (const auto sink : sinks) graph.addArc(source, sink);
  }
  lemon::SmartDigraph::NodeMap<std::int64_t> supply(graph);
  lemon::SmartDigraph::ArcMap<std::int64_t> cost(graph);
  for (std::size_t i = 0; i < a.size(); ++i) supply[sources[i]] = a.masses[i] * b.total;
  for (std::size_t j = 0; j < b.size(); ++j) supply[sinks[j]] = -b.masses[j] * a.total;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      cost[lemon::SmartDigraph::arcFromId(static_cast<int>(i * b.size() + j))] =
          grid.distance(a.bins[i], b.bins[j]);
    }
  }
  lemon::NetworkSimplex<lemon::SmartDigraph, std::int64_t, std::int64_t> simplex(graph);
  simplex.costMap(cost).supplyMap(supply).run();
  return simplex.totalCost<double>() / static_cast<double>(a.total) / static_cast<double>(b.total) *
         BinGrid::distance_unit;
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

void measure(const char* name, const PerformanceDatabase& database, const HistogramOptions& options,
             int pair_count) {
  const ShapeColorHistograms histograms(database, options);
  EarthMoversSolver solver(histograms.shared_grid());
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> frame(0, histograms.frame_count() - 1);
  std::uniform_int_distribution<int> turn(-10, 10);
  std::vector<double> lemon_seconds, our_seconds, next_seconds, sizes;
  double difference = 0.0;
  for (int k = 0; k < pair_count; ++k) {
    const std::size_t first = frame(random);
    const std::size_t second = frame(random);
    if (first == second) continue;
    const int half_turns = turn(random);
    Signature a, b;
    histograms.signature(first, -half_turns, a);
    histograms.signature(second, half_turns, b);
    sizes.push_back(static_cast<double>(a.size()));
    auto start = std::chrono::steady_clock::now();
    const double expected = lemon_distance(histograms.grid(), a, b);
    lemon_seconds.push_back(seconds_since(start));
    start = std::chrono::steady_clock::now();
    const double found = solver.solve(a, b).distance;
    our_seconds.push_back(seconds_since(start));
    difference = std::max(difference, std::abs(found - expected) / expected);
    // The same pair one turn on, as in a search over turns.
    const Potential guess = solver.potential();
    histograms.signature(first, -half_turns - 1, a);
    histograms.signature(second, half_turns + 1, b);
    start = std::chrono::steady_clock::now();
    solver.solve(a, b, &guess);
    next_seconds.push_back(seconds_since(start));
  }
  fmt::print("| {} | {} | {:.0f} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.1e} |\n", name, sizes.size(),
             median(sizes), 1e3 * median(lemon_seconds), 1e3 * median(our_seconds),
             median(lemon_seconds) / median(our_seconds), 1e3 * median(next_seconds), difference);
}

}  // namespace
}  // namespace reprise::benchmark

int main(int argc, char** argv) {
  using namespace reprise;
  const int pairs = argc > 1 ? std::atoi(argv[1]) : 1000;
  fmt::print(
      "| data | pairs | bins, median | LEMON, ms | Reprise, ms | times faster | the next turn, ms | largest "
      "difference, relative |\n|---|---|---|---|---|---|---|---|\n");
  HistogramOptions shape;
  shape.use_color = false;
  benchmark::measure("ama, shape", benchmark::ama(), shape, pairs);
  const PerformanceDatabase fashion = benchmark::fashion();
  benchmark::measure("fashion, shape", fashion, shape, pairs);
  benchmark::measure("fashion, shape-colour", fashion, {}, pairs);
}
