// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/keyframe_optimizer.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/path/state_graph.h"
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

// Length of the blended ground trajectory, from the pure source frame to the pure target frame.
double blended_distance(const Transition& transition, BlendProfile profile,
                        const std::vector<Eigen::Vector2d>& source,
                        const std::vector<Eigen::Vector2d>& target) {
  const auto center = [&](int k) -> Eigen::Vector2d {
    const double alpha = blend_weight(profile, k, transition.half_window);
    return (1.0 - alpha) * source[static_cast<std::size_t>(transition.m + k)] +
           alpha * (transition.source_from_target * target[static_cast<std::size_t>(transition.n + k)]);
  };
  double distance = 0.0;
  for (int k = -transition.half_window; k < transition.half_window; ++k) {
    distance += (center(k + 1) - center(k)).norm();
  }
  return distance;
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
  check_not_negative("target distance", query.distance);
  check_not_negative("target time", query.time);
  check_not_negative("distance weight", options.distance_weight);
  check_not_negative("time weight", options.time_weight);
}

// Lays the walk out as segments and measures it anew, without the search's roundings.
MotionPath path_from_walk(const PathMetrics& metrics, const KeyframeQuery& query,
                          const KeyframeOptions& options, const path_detail::StateGraph& graph,
                          const path_detail::Walk& walk) {
  MotionPath path;
  PathSegment segment;
  segment.clip_idx = query.keyframes.front().clip_idx;
  segment.first_frame = static_cast<int>(query.keyframes.front().frame_idx);
  int steps = 0;
  for (const std::int32_t edge_idx : walk.edges) {
    const path_detail::StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    if (edge.transition < 0) continue;
    const auto transition_idx = static_cast<std::size_t>(edge.transition);
    const Transition& transition = metrics.transitions()[transition_idx];
    segment.last_frame = transition.leave();
    segment.transition = transition;
    path.transition_cost += transition.cost;
    path.distance += metrics.clip_distance(segment.clip_idx, segment.first_frame, segment.last_frame) +
                     metrics.blend_distance(transition_idx);
    steps += segment.last_frame - segment.first_frame + 2 * transition.half_window;
    path.segments.push_back(segment);
    segment =
        PathSegment{.clip_idx = transition.target_clip, .first_frame = transition.arrive(), .transition = {}};
  }
  segment.last_frame = static_cast<int>(query.keyframes.back().frame_idx);
  path.distance += metrics.clip_distance(segment.clip_idx, segment.first_frame, segment.last_frame);
  steps += segment.last_frame - segment.first_frame;
  path.segments.push_back(segment);

  path.frame_count = steps + 1;
  path.time = path.frame_count / metrics.frames_per_second();
  path.cost = path.transition_cost + options.distance_weight * std::abs(path.distance - query.distance) +
              options.time_weight * std::abs(path.frame_count - query.time * metrics.frames_per_second());
  const bool proved = walk.lower_bound >= walk.cost - path_detail::cost_tolerance;
  path.lower_bound = proved ? path.cost : std::min(walk.lower_bound, path.cost);
  path.labels = walk.labels;
  return path;
}

}  // namespace

PathMetrics::PathMetrics(std::vector<std::vector<Eigen::Vector2d>> trajectories,
                         std::vector<Transition> transitions, BlendProfile profile, double frames_per_second)
    : transitions_(std::move(transitions)), frames_per_second_(frames_per_second) {
  if (!std::isfinite(frames_per_second) || frames_per_second <= 0.0) {
    throw InvalidArgument(
        fmt::format("frames per second: expected a positive number, found {}", frames_per_second));
  }
  for (const std::vector<Eigen::Vector2d>& trajectory : trajectories) {
    std::vector<double> cumulative(trajectory.size(), 0.0);
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
      cumulative[i] = cumulative[i - 1] + (trajectory[i] - trajectory[i - 1]).norm();
    }
    cumulative_.push_back(std::move(cumulative));
  }
  for (std::size_t i = 0; i < transitions_.size(); ++i) {
    const Transition& transition = transitions_[i];
    check_transition(transition, i, trajectories);
    blend_distances_.push_back(blended_distance(transition, profile, trajectories[transition.source_clip],
                                                trajectories[transition.target_clip]));
  }
}

tl::expected<MotionPath, NoPath> find_keyframe_path(const PathMetrics& metrics, const KeyframeQuery& query,
                                                    const KeyframeOptions& options,
                                                    const std::vector<std::string>& clip_names) {
  check_query(metrics, query, options, clip_names);
  const path_detail::StateGraph graph = path_detail::build_state_graph(metrics, query.keyframes);
  if (graph.empty()) {
    return tl::make_unexpected(NoPath{path_detail::explain_no_path(metrics, query.keyframes, clip_names)});
  }
  const path_detail::Walk walk =
      path_detail::find_cheapest_walk(graph,
                                      {.distance = query.distance,
                                       .frames = query.time * metrics.frames_per_second(),
                                       .distance_weight = options.distance_weight,
                                       .time_weight = options.time_weight},
                                      options.max_labels);
  return path_from_walk(metrics, query, options, graph, walk);
}

}  // namespace reprise
