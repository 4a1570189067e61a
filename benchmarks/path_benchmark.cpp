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

#include "reprise/path/keyframe_optimizer.h"
#include "support/keyframe_program.h"

namespace {

using reprise::Transition;

struct RandomGraph {
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  std::vector<Transition> transitions;
  std::vector<std::string> names;
};

// Clips of 30 to 130 frames, every other one walking 4 cm a frame, and `per_pair` transitions for each
// ordered pair.
RandomGraph random_graph(std::size_t clip_count, int per_pair, std::mt19937& random) {
  RandomGraph graph;
  std::uniform_int_distribution<int> length(30, 130);
  std::normal_distribution<double> noise(0.0, 0.004);
  for (std::size_t i = 0; i < clip_count; ++i) {
    const double speed = i % 2 == 0 ? 0.04 : 0.0;
    std::vector<Eigen::Vector2d> trajectory{Eigen::Vector2d::Zero()};
    for (int frame = length(random); frame > 1; --frame) {
      trajectory.push_back(trajectory.back() + Eigen::Vector2d(noise(random), speed + noise(random)));
    }
    graph.trajectories.push_back(std::move(trajectory));
    graph.names.push_back(fmt::format("clip{}", i));
  }
  std::uniform_real_distribution<double> cost(0.1, 0.6);
  for (std::size_t source = 0; source < clip_count; ++source) {
    for (std::size_t target = 0; target < clip_count; ++target) {
      for (int i = 0; i < per_pair; ++i) {
        const int source_last = static_cast<int>(graph.trajectories[source].size()) - 1;
        const int target_last = static_cast<int>(graph.trajectories[target].size()) - 1;
        Transition transition;
        transition.source_clip = source;
        transition.target_clip = target;
        transition.half_window = std::uniform_int_distribution<int>(2, 12)(random);
        const int L = transition.half_window;
        transition.m = std::uniform_int_distribution<int>(L, source_last - L)(random);
        transition.n = std::uniform_int_distribution<int>(L, target_last - L)(random);
        transition.source_from_target.translation =
            graph.trajectories[source][static_cast<std::size_t>(transition.m)] -
            graph.trajectories[target][static_cast<std::size_t>(transition.n)];
        transition.cost = cost(random);
        graph.transitions.push_back(transition);
      }
    }
  }
  return graph;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

// Targets lie within a fifth of those given; the first key-frame lies early and the last late in its clip, so
// that transitions lead out and in.
reprise::KeyframeQuery random_query(const RandomGraph& graph, double distance, double time,
                                    std::mt19937& random) {
  reprise::KeyframeQuery query;
  for (int i = 0; i < 2; ++i) {
    const std::size_t clip_idx =
        std::uniform_int_distribution<std::size_t>(0, graph.names.size() - 1)(random);
    const std::size_t frames = graph.trajectories[clip_idx].size();
    const std::size_t frame_idx = std::uniform_int_distribution<std::size_t>(0, frames / 4)(random);
    query.keyframes.push_back({clip_idx, i == 0 ? frame_idx : frames - 1 - frame_idx});
  }
  std::uniform_real_distribution<double> factor(0.8, 1.2);
  query.distance = distance * factor(random);
  query.time = time * factor(random);
  return query;
}

void measure(const char* name, std::size_t clip_count, int per_pair, double distance, double time,
             int queries, const reprise::KeyframeOptions& options = {}) {
  std::mt19937 random(7);
  std::vector<double> times, labels;
  double worst_gap = 0.0;
  int unproved = 0;
  while (static_cast<int>(times.size()) < queries) {
    const RandomGraph graph = random_graph(clip_count, per_pair, random);
    const reprise::PathMetrics metrics(graph.trajectories, graph.transitions, reprise::BlendProfile::smooth,
                                       25.0);
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
    const reprise::PathMetrics metrics(graph.trajectories, graph.transitions, reprise::BlendProfile::smooth,
                                       25.0);
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
