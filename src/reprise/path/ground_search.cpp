// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/path/ground_walks.h"
#include "reprise/path/state_graph.h"
#include "reprise/path/walk_path.h"
#include "reprise/path/walk_search.h"

namespace reprise {
namespace {

using path_detail::GroundTask;
using path_detail::GroundWalk;
using path_detail::limit_slack;
using path_detail::RouteLine;

// A partial path with its place takes some four times the time and memory of one without.
constexpr std::size_t labels_a_place = 4;

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

void check_weight(const char* name, double value) {
  if (!std::isfinite(value) || value < 0.0) {
    throw InvalidArgument(fmt::format("{}: expected a finite number of at least 0, found {}", name, value));
  }
}

void check_limit(const char* name, double value) {
  if (!(value >= 0.0)) {
    throw InvalidArgument(fmt::format("{}: expected a number of at least 0, found {}", name, value));
  }
}

void check_point(const char* name, const Eigen::Vector2d& point) {
  if (!point.allFinite()) {
    throw InvalidArgument(
        fmt::format("{}: expected two finite numbers, found {}, {}", name, point.x(), point.y()));
  }
}

void check_goal(const KeyframeQuery& query, const KeyframeOptions& options) {
  if (!query.goal) return;
  const GroundGoal& goal = *query.goal;
  check_point("goal", goal.position);
  if (goal.turn && !std::isfinite(*goal.turn)) {
    throw InvalidArgument(fmt::format("turn of the goal: expected a finite number, found {}", *goal.turn));
  }
  check_limit("position tolerance of the goal", goal.position_tolerance);
  check_limit("turn tolerance of the goal", goal.turn_tolerance);
  check_weight("position weight", options.position_weight);
  check_weight("turn weight", options.turn_weight);
  const double away = goal.position.norm();
  if (away - goal.position_tolerance > query.max_distance + limit_slack) {
    throw InvalidArgument(
        fmt::format("the goal is {:.3f} m away and must be met to {:.3f} m, but the path may not be longer "
                    "than {:.3f} m",
                    away, goal.position_tolerance, query.max_distance));
  }
}

void check_route(const KeyframeQuery& query, const KeyframeOptions& options) {
  if (!query.route) return;
  const GroundRoute& route = *query.route;
  const auto differs = [&](const Eigen::Vector2d& point) { return point != route.points.front(); };
  if (route.points.size() < 2 || std::none_of(route.points.begin(), route.points.end(), differs)) {
    throw InvalidArgument(fmt::format("route: expected at least two different points, found {}{}",
                                      route.points.size(), route.points.size() < 2 ? "" : ", all the same"));
  }
  for (const Eigen::Vector2d& point : route.points) check_point("route", point);
  check_limit("greatest deviation from the route", route.max_deviation);
  check_weight("route weight", options.route_weight);
  check_weight("position weight", options.position_weight);
  const double away = RouteLine(route.points).follow(0.0, Eigen::Vector2d::Zero()).deviation;
  if (away > route.max_deviation + limit_slack) {
    throw InvalidArgument(fmt::format(
        "the route begins {:.3f} m from where the first key-frame stands, but the deviation from it may not "
        "exceed {:.3f} m",
        away, route.max_deviation));
  }
}

GroundTask make_task(const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
                     const path_detail::StateGraph& graph) {
  const double fps = metrics.frames_per_second();
  GroundTask task{.graph = &graph,
                  .motion = path_detail::ground_motion(metrics, graph, query.keyframes.front()),
                  .targets = {.distance = query.distance,
                              .frames = query.time * fps,
                              .distance_weight = options.distance_weight,
                              .time_weight = options.time_weight,
                              .min_distance = query.min_distance,
                              .max_distance = query.max_distance,
                              .min_frames = query.min_time * fps,
                              .max_frames = query.max_time * fps},
                  .goal = query.goal,
                  .route = {},
                  .max_deviation = query.route ? query.route->max_deviation : unlimited,
                  .position_weight = options.position_weight,
                  .turn_weight = options.turn_weight,
                  .route_weight = options.route_weight / fps};
  if (query.route) task.route.emplace(query.route->points);
  return task;
}

MotionPath path_from_walk(const PathMetrics& metrics, const KeyframeQuery& query,
                          const KeyframeOptions& options, const path_detail::StateGraph& graph,
                          const GroundWalk& walk) {
  MotionPath path = path_detail::path_of_walk(metrics, query, options, graph, walk.edges);
  const GroundTrack track = ground_track(metrics, path);
  if (query.goal) {
    path.costs.position = options.position_weight * (track.centers.back() - query.goal->position).norm();
    if (query.goal->turn) {
      path.costs.turn = options.turn_weight * std::abs(wrap_angle(track.turn - *query.goal->turn));
    }
  }
  if (query.route) {
    const RouteLine line(query.route->points);
    RouteLine::Match match;
    for (const Eigen::Vector2d& center : track.centers) {
      match = line.follow(match.marker, center);
      path.costs.route += options.route_weight * match.deviation / metrics.frames_per_second();
    }
    path.costs.route += options.position_weight * (match.deviation + line.length() - match.marker);
  }
  path.cost = path.costs.total();
  const bool proved = walk.lower_bound >= walk.cost - path_detail::cost_tolerance;
  path.lower_bound = proved ? path.cost : std::min(walk.lower_bound, path.cost);
  path.labels = walk.labels;
  return path;
}

std::string explain_no_walk(const GroundTask& task, const GroundWalk& walk, double frames_per_second) {
  std::string reason = "no path through the key-frames keeps the limits";
  if (walk.nearest) {
    const path_detail::GroundLabel& nearest = *walk.nearest;
    reason += fmt::format("; the nearest one found walks {:.3f} m in {:.2f} s", nearest.distance,
                          (nearest.steps + 1) / frames_per_second);
    if (task.goal) {
      reason += fmt::format(" and ends {:.3f} m from the goal", task.gap_to_goal(nearest));
      if (task.goal->position_tolerance < unlimited) {
        reason += fmt::format(" (at most {:.3f} m)", task.goal->position_tolerance);
      }
      if (task.goal->turn) {
        reason += fmt::format(", {:.1f} degrees from its turn",
                              std::abs(wrap_angle(nearest.yaw - *task.goal->turn)) * degrees_per_radian);
        if (task.goal->turn_tolerance < unlimited) {
          reason += fmt::format(" (at most {:.1f})", task.goal->turn_tolerance * degrees_per_radian);
        }
      }
    }
  } else if (task.route) {
    reason +=
        fmt::format("; within {:.3f} m of the route the farthest one comes {:.3f} m of its {:.3f} m along",
                    task.max_deviation, walk.farthest_marker, task.route->length());
  }
  const bool proved = walk.lower_bound == path_detail::infinity;
  return reason + (proved ? ". There is none: proved."
                          : ". The search ended before that was proved: there may be one, with more labels "
                            "or a greatest time.");
}

}  // namespace

GroundTrack ground_track(const PathMetrics& metrics, const MotionPath& path) {
  GroundTrack track;
  GroundTransform world_from_clip;
  const auto show = [&](const Eigen::Vector2d& center) { track.centers.push_back(world_from_clip * center); };
  for (const PathSegment& segment : path.segments) {
    if (track.centers.empty()) {
      const auto first = static_cast<std::size_t>(segment.first_frame);
      world_from_clip.translation = -metrics.trajectory(segment.clip_idx)[first];
    }
    for (int frame = segment.first_frame; frame <= segment.last_frame; ++frame) {
      show(metrics.trajectory(segment.clip_idx)[static_cast<std::size_t>(frame)]);
    }
    if (!segment.transition) continue;
    const Transition& taken = *segment.transition;
    const std::vector<Transition>& known = metrics.transitions();
    const auto found = std::find_if(known.begin(), known.end(), [&](const Transition& other) {
      return other.source_clip == taken.source_clip && other.target_clip == taken.target_clip &&
             other.m == taken.m && other.n == taken.n && other.half_window == taken.half_window;
    });
    if (found == known.end()) {
      throw InvalidArgument(
          fmt::format("the path goes from clip {}:{} to clip {}:{}, but there is no such "
                      "transition",
                      taken.source_clip, taken.m, taken.target_clip, taken.n));
    }
    for (int k = -taken.half_window + 1; k < taken.half_window; ++k) {
      show(metrics.blend_center(static_cast<std::size_t>(found - known.begin()), k));
    }
    world_from_clip = world_from_clip * taken.source_from_target;
  }
  track.turn = world_from_clip.yaw;
  return track;
}

tl::expected<MotionPath, NoPath> find_ground_path(const PathMetrics& metrics, const KeyframeQuery& query,
                                                  const KeyframeOptions& options,
                                                  const std::vector<std::string>& clip_names) {
  check_goal(query, options);
  check_route(query, options);
  const path_detail::StateGraph graph = path_detail::build_state_graph(metrics, query);
  if (graph.empty()) {
    return tl::make_unexpected(NoPath{path_detail::explain_no_path(metrics, query, clip_names)});
  }
  const GroundTask task = make_task(metrics, query, options, graph);
  const path_detail::GroundGuide guide(metrics, task, query.keyframes.front());
  const GroundWalk walk = path_detail::find_ground_walk(task, guide, options.max_labels / labels_a_place);
  if (!walk.found()) {
    return tl::make_unexpected(NoPath{explain_no_walk(task, walk, metrics.frames_per_second())});
  }
  return path_from_walk(metrics, query, options, graph, walk);
}

}  // namespace reprise
