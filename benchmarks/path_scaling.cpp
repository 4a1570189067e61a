// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Processor time of key-frame queries against the number of transitions and the length of the target: alone,
// and as one of many targets of a pair of key-frames. Random graphs of 30 to 130 frames a clip.

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "random_graph.h"
#include "reprise/core/cpu_clock.h"
#include "reprise/path/keyframe_optimizer.h"

namespace {

using namespace reprise::benchmark;

// Milliseconds.
double processor_time() {
  return 1e3 * reprise::process_cpu_seconds();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Walks of the graphs cover about so much ground, metres a second, when they take all clips alike.
constexpr double mean_speed = 0.5;

struct Figures {
  std::vector<double> alone, shared;  // milliseconds
  int unproved = 0;
  double worst_gap = 0.0;
};

// `targets` of each of `pairs` pairs of key-frames: the first alone, all with what they share.
void measure(std::size_t clip_count, int per_pair, double seconds, int pairs, int targets) {
  std::mt19937 random(7);
  Figures figures;
  for (int pair = 0; pair < pairs;) {
    const RandomGraph graph = random_graph(clip_count, per_pair, random);
    const reprise::PathMetrics metrics = graph.metrics();
    const reprise::KeyframeOptions options;
    const reprise::KeyframeQuery query = random_query(graph, mean_speed * seconds, seconds, random);
    double start = processor_time();
    const auto path = reprise::find_keyframe_path(metrics, query, options, graph.names);
    const double alone = processor_time() - start;
    if (!path || path->segments.size() < 2) continue;
    ++pair;
    figures.alone.push_back(alone);

    start = processor_time();
    const reprise::KeyframeOptimizer optimizer(metrics, query, options, graph.names, 1.2 * seconds);
    std::uniform_real_distribution<double> factor(0.8, 1.2);
    for (int i = 0; i < targets; ++i) {
      const auto found = optimizer.find(mean_speed * seconds * factor(random), seconds * factor(random));
      figures.unproved += found->gap() > 0.0 ? 1 : 0;
      figures.worst_gap = std::max(figures.worst_gap, found->gap());
    }
    figures.shared.push_back((processor_time() - start) / targets);
  }
  fmt::print("{:>11} {:>9.0f} {:>6} {:>11.1f} {:>11.1f} {:>11.1f} {:>11.1f} {:>9}/{:<4} {:>9.4f}\n",
             clip_count * clip_count * static_cast<std::size_t>(per_pair), seconds, pairs,
             median(figures.alone), *std::max_element(figures.alone.begin(), figures.alone.end()),
             median(figures.shared), *std::max_element(figures.shared.begin(), figures.shared.end()),
             figures.unproved, pairs * targets, figures.worst_gap);
  std::fflush(stdout);
}

}  // namespace

// path_scaling [PAIRS [MOST_TRANSITIONS [LONGEST_TARGET_SECONDS [LEAST_TRANSITIONS]]]]
int main(int argc, char** argv) {
  const int pairs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const double most = argc > 2 ? std::atof(argv[2]) : 1e4;
  const double longest = argc > 3 ? std::atof(argv[3]) : 600.0;
  const double least = argc > 4 ? std::atof(argv[4]) : 0.0;
  fmt::print("Processor time in ms of one query: alone, and with what the targets of a pair share.\n");
  fmt::print("{:>11} {:>9} {:>6} {:>11} {:>11} {:>11} {:>11} {:>14} {:>9}\n", "transitions", "target s",
             "pairs", "alone med", "alone max", "shared med", "shared max", "unproved", "worst gap");
  for (const std::size_t clip_count : {5u, 10u, 16u, 32u, 50u}) {
    const auto transitions = static_cast<double>(4 * clip_count * clip_count);
    if (transitions < least || transitions > most) continue;
    for (const double seconds : {10.0, 30.0, 60.0, 180.0, 600.0}) {
      if (seconds <= longest) measure(clip_count, 4, seconds, pairs, 10);
    }
  }
  return 0;
}
