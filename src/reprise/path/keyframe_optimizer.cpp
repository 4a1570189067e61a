// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/keyframe_optimizer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/path/ground_search.h"
#include "reprise/path/state_graph.h"
#include "reprise/path/walk_path.h"
#include "reprise/path/walk_search.h"

namespace reprise {
namespace {

void check_not_negative(const char* name, double value) {
  if (!std::isfinite(value) || value < 0.0) {
    throw InvalidArgument(fmt::format("{}: expected a finite number of at least 0, found {}", name, value));
  }
}

void check_transition(const Transition& transition, std::size_t idx,
                      const std::vector<std::vector<Eigen::Vector2d>>& trajectories) {
  if (transition.source_clip >= trajectories.size() || transition.target_clip >= trajectories.size()) {
    throw InvalidArgument(fmt::format("transition {} joins clips {} and {}, expected indices below {}", idx,
                                      transition.source_clip, transition.target_clip, trajectories.size()));
  }
  if (transition.half_window < 1) {
    throw InvalidArgument(
        fmt::format("transition {} has half window {}, expected at least 1", idx, transition.half_window));
  }
  const auto check_window = [&](const char* side, int center, std::size_t frame_count) {
    if (center - transition.half_window < 0 ||
        center + transition.half_window >= static_cast<int>(frame_count)) {
      throw InvalidArgument(
          fmt::format("transition {} needs {} frames {} to {}, but the clip has frames 0 to {}", idx, side,
                      center - transition.half_window, center + transition.half_window,
                      static_cast<std::ptrdiff_t>(frame_count) - 1));
    }
  };
  check_window("source", transition.m, trajectories[transition.source_clip].size());
  check_window("target", transition.n, trajectories[transition.target_clip].size());
  if (!std::isfinite(transition.cost) || transition.cost < 0.0) {
    throw InvalidArgument(fmt::format("transition {} has cost {}, expected a finite number of at least 0",
                                      idx, transition.cost));
  }
}

void check_targets(double distance, double time) {
  check_not_negative("target distance", distance);
  check_not_negative("target time", time);
}

void check_limits(const char* name, const char* unit, double least, double greatest) {
  check_not_negative(fmt::format("least {}", name).c_str(), least);
  if (std::isnan(greatest) || greatest < 0.0) {
    throw InvalidArgument(
        fmt::format("greatest {}: expected a number of at least 0, found {}", name, greatest));
  }
  if (least > greatest) {
    throw InvalidArgument(
        fmt::format("the limits on {0} contradict each other: expected the least ({1:g} {3}) to be at most "
                    "the greatest ({2:g} {3})",
                    name, least, greatest, unit));
  }
}

void check_clips(const PathMetrics& metrics, const KeyframeQuery& query,
                 const std::vector<std::string>& clip_names) {
  for (const auto* clips : {&query.forbidden_clips, &query.compulsory_clips}) {
    for (const std::size_t clip_idx : *clips) {
      if (clip_idx >= metrics.clip_count()) {
        throw InvalidArgument(fmt::format("{} clips: expected indices below {}, found {}",
                                          clips == &query.forbidden_clips ? "forbidden" : "compulsory",
                                          metrics.clip_count(), clip_idx));
      }
    }
  }
  const auto is_forbidden = [&](std::size_t clip_idx) {
    return std::ranges::count(query.forbidden_clips, clip_idx) > 0;
  };
  for (const std::size_t clip_idx : query.compulsory_clips) {
    if (is_forbidden(clip_idx)) {
      throw InvalidArgument(fmt::format("clip '{}' is both compulsory and forbidden", clip_names[clip_idx]));
    }
  }
  for (std::size_t i = 0; i < query.keyframes.size(); ++i) {
    if (is_forbidden(query.keyframes[i].clip_idx)) {
      throw InvalidArgument(fmt::format("key-frame {} lies in '{}', which is forbidden", i + 1,
                                        clip_names[query.keyframes[i].clip_idx]));
    }
  }
  if (query.compulsory_clips.size() > path_detail::most_compulsory_clips) {
    throw InvalidArgument(fmt::format("compulsory clips: expected at most {}, found {}",
                                      path_detail::most_compulsory_clips, query.compulsory_clips.size()));
  }
}

void check_query(const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
                 const std::vector<std::string>& clip_names) {
  if (clip_names.size() != metrics.clip_count()) {
    throw InvalidArgument(
        fmt::format("clip_names: expected {} names, found {}", metrics.clip_count(), clip_names.size()));
  }
  if (query.keyframes.size() < 2) {
    throw InvalidArgument(fmt::format("key-frames: expected at least 2, found {}", query.keyframes.size()));
  }
  for (std::size_t i = 0; i < query.keyframes.size(); ++i) {
    const FrameId& keyframe = query.keyframes[i];
    if (keyframe.clip_idx >= metrics.clip_count()) {
      throw InvalidArgument(fmt::format("key-frame {}: expected a clip index below {}, found {}", i + 1,
                                        metrics.clip_count(), keyframe.clip_idx));
    }
    if (keyframe.frame_idx >= static_cast<std::size_t>(metrics.frame_count(keyframe.clip_idx))) {
      throw InvalidArgument(fmt::format("key-frame {}: expected a frame of '{}' below {}, found {}", i + 1,
                                        clip_names[keyframe.clip_idx], metrics.frame_count(keyframe.clip_idx),
                                        keyframe.frame_idx));
    }
  }
  check_targets(query.distance, query.time);
  check_not_negative("distance weight", options.distance_weight);
  check_not_negative("time weight", options.time_weight);
  check_limits("distance", "m", query.min_distance, query.max_distance);
  check_limits("time", "s", query.min_time, query.max_time);
  check_clips(metrics, query, clip_names);
}

MotionPath path_from_walk(const PathMetrics& metrics, const KeyframeQuery& query,
                          const KeyframeOptions& options, const path_detail::StateGraph& graph,
                          const path_detail::Walk& walk) {
  MotionPath path = path_detail::path_of_walk(metrics, query, options, graph, walk.edges);
  path.cost = path.costs.total();
  const bool proved = walk.lower_bound >= walk.cost - path_detail::cost_tolerance;
  path.lower_bound = proved ? path.cost : std::min(walk.lower_bound, path.cost);
  path.labels = walk.labels;
  return path;
}

}  // namespace

PathMetrics::PathMetrics(std::vector<std::vector<Eigen::Vector2d>> trajectories,
                         std::vector<Transition> transitions, BlendProfile profile, double frames_per_second)
    : trajectories_(std::move(trajectories)),
      transitions_(std::move(transitions)),
      profile_(profile),
      frames_per_second_(frames_per_second) {
  if (!std::isfinite(frames_per_second) || frames_per_second <= 0.0) {
    throw InvalidArgument(
        fmt::format("frames per second: expected a positive number, found {}", frames_per_second));
  }
  for (const std::vector<Eigen::Vector2d>& trajectory : trajectories_) {
    std::vector<double> cumulative(trajectory.size(), 0.0);
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
      cumulative[i] = cumulative[i - 1] + (trajectory[i] - trajectory[i - 1]).norm();
    }
    cumulative_.push_back(std::move(cumulative));
  }
  for (std::size_t i = 0; i < transitions_.size(); ++i) {
    const Transition& transition = transitions_[i];
    check_transition(transition, i, trajectories_);
    double distance = 0.0;
    for (int k = -transition.half_window; k < transition.half_window; ++k) {
      distance += (blend_center(i, k + 1) - blend_center(i, k)).norm();
    }
    blend_distances_.push_back(distance);
  }
}

Eigen::Vector2d PathMetrics::blend_center(std::size_t transition_idx, int k) const {
  const Transition& transition = transitions_[transition_idx];
  const double alpha = blend_weight(profile_, k, transition.half_window);
  const Eigen::Vector2d& source =
      trajectories_[transition.source_clip][static_cast<std::size_t>(transition.m + k)];
  const Eigen::Vector2d& target =
      trajectories_[transition.target_clip][static_cast<std::size_t>(transition.n + k)];
  return (1.0 - alpha) * source + alpha * (transition.source_from_target * target);
}

PathMetrics PathMetrics::without(const std::vector<bool>& transitions) const {
  if (transitions.size() != transitions_.size()) {
    throw InvalidArgument(
        fmt::format("marks of transitions: expected {}, found {}", transitions_.size(), transitions.size()));
  }
  PathMetrics kept = *this;
  kept.transitions_.clear();
  kept.blend_distances_.clear();
  for (std::size_t i = 0; i < transitions_.size(); ++i) {
    if (transitions[i]) continue;
    kept.transitions_.push_back(transitions_[i]);
    kept.blend_distances_.push_back(blend_distances_[i]);
  }
  return kept;
}

struct KeyframeOptimizer::Shared {
  Shared(const PathMetrics& path_metrics, KeyframeQuery keyframe_query,
         const KeyframeOptions& keyframe_options, const std::vector<std::string>& clip_names,
         double longest_time)
      : metrics(path_metrics), query(std::move(keyframe_query)), options(keyframe_options) {
    check_query(metrics, query, options, clip_names);
    if (query.goal || query.route) {
      throw InvalidArgument("a query with a goal or a route: expected none where targets share their work");
    }
    check_not_negative("longest time", longest_time);
    graph = path_detail::build_state_graph(metrics, query);
    if (graph.empty()) {
      reason = path_detail::explain_no_path(metrics, query, clip_names);
    } else {
      finder.emplace(graph, longest_time * metrics.frames_per_second());
    }
  }

  // Why no path keeps the limits, or none was found that does.
  std::string explain_limits(bool exhausted) const {
    const auto least = [&](double distance_weight, double step_weight) {
      return path_detail::shortest_paths(graph,
                                         path_detail::edge_lengths(graph, 0.0, distance_weight, step_weight))
          .length[static_cast<std::size_t>(graph.start)];
    };
    return fmt::format(
        "{} keeps the limits ({:g} to {:g} m, {:g} to {:g} s); without them such paths are at least {:.3f} m "
        "long and take at least {:.2f} s",
        exhausted ? "no path through the key-frames and clips asked for"
                  : "the search limit was reached before a path was found that",
        query.min_distance, query.max_distance, query.min_time, query.max_time, least(1.0, 0.0),
        (least(0.0, 1.0) + 1.0) / metrics.frames_per_second());
  }

  const PathMetrics& metrics;
  KeyframeQuery query;
  KeyframeOptions options;
  path_detail::StateGraph graph;
  std::optional<path_detail::WalkFinder> finder;
  std::string reason;  // why there is no path at all
};

KeyframeOptimizer::KeyframeOptimizer(const PathMetrics& metrics, KeyframeQuery query,
                                     const KeyframeOptions& options,
                                     const std::vector<std::string>& clip_names, double longest_time)
    : shared_(std::make_unique<const Shared>(metrics, std::move(query), options, clip_names, longest_time)) {}

KeyframeOptimizer::~KeyframeOptimizer() = default;
KeyframeOptimizer::KeyframeOptimizer(KeyframeOptimizer&&) noexcept = default;

tl::expected<MotionPath, NoPath> KeyframeOptimizer::find(double distance, double time) const {
  check_targets(distance, time);
  const Shared& shared = *shared_;
  if (!shared.finder) return tl::make_unexpected(NoPath{shared.reason});
  KeyframeQuery query = shared.query;
  query.distance = distance;
  query.time = time;
  const double rate = shared.metrics.frames_per_second();
  const path_detail::Walk walk = shared.finder->find({.distance = distance,
                                                      .frames = time * rate,
                                                      .distance_weight = shared.options.distance_weight,
                                                      .time_weight = shared.options.time_weight,
                                                      .min_distance = query.min_distance,
                                                      .max_distance = query.max_distance,
                                                      .min_frames = query.min_time * rate,
                                                      .max_frames = query.max_time * rate},
                                                     shared.options.max_labels);
  if (walk.edges.empty()) return tl::make_unexpected(NoPath{shared.explain_limits(walk.exhausted)});
  return path_from_walk(shared.metrics, query, shared.options, shared.graph, walk);
}

tl::expected<MotionPath, NoPath> find_keyframe_path(const PathMetrics& metrics, const KeyframeQuery& query,
                                                    const KeyframeOptions& options,
                                                    const std::vector<std::string>& clip_names) {
  check_query(metrics, query, options, clip_names);
  if (query.goal || query.route) return find_ground_path(metrics, query, options, clip_names);
  return KeyframeOptimizer(metrics, query, options, clip_names, query.time).find(query.distance, query.time);
}

}  // namespace reprise
