// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframe_grid.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "reprise/core/cpu_clock.h"
#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"

namespace reprise {
namespace {

constexpr double rounding = 1e-9;  // 25 frames are a second, whatever 1.24 + 0.76 is

// What tells transitions apart.
auto identity(const Transition& t) {
  return std::tuple(t.source_clip, t.m, t.target_clip, t.n, t.half_window, t.source_from_target.yaw,
                    t.source_from_target.translation.x(), t.source_from_target.translation.y(), t.cost);
}

using TransitionIndex = std::map<decltype(identity(Transition())), int>;

TransitionIndex index_of(const std::vector<Transition>& transitions) {
  TransitionIndex index;
  for (std::size_t i = 0; i < transitions.size(); ++i)
    index.try_emplace(identity(transitions[i]), static_cast<int>(i));
  return index;
}

}  // namespace

std::vector<FrameId> keyframes_of(const GridPair& pair, const PerformanceDatabase& database) {
  return {database.parse_frame(pair.from), database.parse_frame(pair.to)};
}

std::vector<PathSegment> path_segments(const std::vector<FrameId>& keyframes, const PathMetrics& metrics,
                                       const std::vector<int>& transitions) {
  std::vector<PathSegment> segments;
  std::size_t clip_idx = keyframes.front().clip_idx;
  int first = static_cast<int>(keyframes.front().frame_idx);
  const auto broken = [&](const std::string& what) {
    throw InvalidArgument(fmt::format("a path of {} transitions: {}", transitions.size(), what));
  };
  for (const int index : transitions) {
    if (index < 0 || static_cast<std::size_t>(index) >= metrics.transitions().size())
      broken(fmt::format("expected indices below {}, found {}", metrics.transitions().size(), index));
    const Transition& transition = metrics.transitions()[static_cast<std::size_t>(index)];
    if (transition.source_clip != clip_idx || transition.leave() < first)
      broken(fmt::format("transition {} does not leave from where the path is", index));
    segments.push_back({clip_idx, first, transition.leave(), transition});
    clip_idx = transition.target_clip;
    first = transition.arrive();
  }
  const auto last = static_cast<int>(keyframes.back().frame_idx);
  if (clip_idx != keyframes.back().clip_idx || last < first) broken("does not end at its key-frame");
  segments.push_back({clip_idx, first, last, std::nullopt});
  return segments;
}

KeyframeGrid search_grid(const std::string& name, const GridPair& pair, const PerformanceDatabase& database,
                         const PathMetrics& metrics, const EvaluateKeyframesOptions& options) {
  KeyframeGrid grid{.database = name, .pair = pair, .frames_per_second = metrics.frames_per_second()};
  const KeyframeQuery shared{.keyframes = keyframes_of(pair, database)};
  const std::string label = fmt::format("{} {} -> {}", name, pair.from, pair.to);

  const double start = process_cpu_seconds();
  const KeyframeOptimizer optimizer(metrics, shared, options.optimizer, database.clip_names(),
                                    options.max_time);
  grid.preparation_cpu_seconds = process_cpu_seconds() - start;

  const auto distances = static_cast<std::size_t>(options.max_distance);
  grid.queries.resize(distances * static_cast<std::size_t>(options.max_time));
  const TransitionIndex index = index_of(metrics.transitions());
  Progress progress(label, grid.queries.size());
  parallel_for(0, grid.queries.size(), [&](std::size_t i) {
    GridQuery& query = grid.queries[i];
    query.target_distance = static_cast<int>(i % distances) + 1;
    query.target_time = static_cast<int>(i / distances) + 1;
    const double began = thread_cpu_seconds();
    tl::expected<MotionPath, NoPath> path = optimizer.find(query.target_distance, query.target_time);
    query.cpu_seconds = thread_cpu_seconds() - began;
    if (!path) throw Error(fmt::format("{}: no path: {}", label, path.error().reason));
    query.path = std::move(*path);
    for (const PathSegment& segment : query.path.segments) {
      if (segment.transition) query.transitions.push_back(index.at(identity(*segment.transition)));
    }
    progress.advance();
  });
  return grid;
}

void add_smoothness(const KeyframeGrid& grid, const PerformanceDatabase& database, const PathMetrics& metrics,
                    SmoothnessOfTransition& known) {
  std::set<int> missing;
  for (const GridQuery& query : grid.queries)
    missing.insert(query.transitions.begin(), query.transitions.end());
  std::erase_if(missing, [&](int transition) { return known.contains(transition); });
  const std::vector<int> order(missing.begin(), missing.end());
  std::vector<TransitionSmoothness> found(order.size());
  Progress progress("smoothness of transitions", order.size());
  parallel_for(0, order.size(), [&](std::size_t i) {
    found[i] = transition_smoothness(database, metrics.transitions()[static_cast<std::size_t>(order[i])]);
    progress.advance();
  });
  for (std::size_t i = 0; i < order.size(); ++i) known[order[i]] = found[i];
}

void complete_grid(KeyframeGrid& grid, const SmoothnessOfTransition& smoothness,
                   const EvaluateKeyframesOptions& options) {
  for (GridQuery& query : grid.queries) {
    query.correction = plan_correction(query.path, query.target_distance, query.target_time,
                                       grid.frames_per_second, options.correction);
    query.is_reachable = query.distance_error() <= options.reach_distance + rounding &&
                         query.time_error() <= options.reach_time + rounding;
    query.smoothness.reset();
    if (query.transitions.empty()) continue;
    TransitionSmoothness mean;
    for (const int transition : query.transitions) {
      const TransitionSmoothness& one = smoothness.at(transition);
      mean.weighted += one.weighted;
      mean.normalized += one.normalized;
    }
    const auto count = static_cast<double>(query.transitions.size());
    query.smoothness = {.weighted = mean.weighted / count, .normalized = mean.normalized / count};
  }
}

const GridQuery* nearest_reachable(const KeyframeGrid& grid, const GridQuery& query,
                                   const KeyframeOptions& options) {
  const GridQuery* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const GridQuery& other : grid.queries) {
    if (!other.is_reachable) continue;
    const double cost =
        options.distance_weight * std::abs(other.target_distance - query.target_distance) +
        options.time_weight * grid.frames_per_second * std::abs(other.target_time - query.target_time);
    if (cost < least) {
      least = cost;
      nearest = &other;
    }
  }
  return nearest;
}

}  // namespace reprise
