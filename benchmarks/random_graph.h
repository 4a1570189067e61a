// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Random graphs shaped like those of real databases, and queries on them, for the benchmarks of paths.

#pragma once

#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise::benchmark {

struct RandomGraph {
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  std::vector<Transition> transitions;
  std::vector<std::string> names;

  PathMetrics metrics() const { return {trajectories, transitions, BlendProfile::smooth, 25.0}; }
};

// Clips of 30 to 130 frames, every other one walking 4 cm a frame, and `per_pair` transitions for each
// ordered pair.
inline RandomGraph random_graph(std::size_t clip_count, int per_pair, std::mt19937& random) {
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

// Targets lie within a fifth of those given; the first key-frame lies early and the last late in its clip, so
// that transitions lead out and in.
inline KeyframeQuery random_query(const RandomGraph& graph, double distance, double time,
                                  std::mt19937& random) {
  KeyframeQuery query;
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

}  // namespace reprise::benchmark
