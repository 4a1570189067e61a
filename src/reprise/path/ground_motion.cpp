// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/ground_motion.h"

#include <cmath>
#include <cstddef>

namespace reprise::path_detail {

Eigen::Matrix2d ground_rotation(double yaw) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  Eigen::Matrix2d R;
  R << c, s, -s, c;
  return R;
}

std::vector<NodePlace> node_places(const PathMetrics& metrics, const StateGraph& graph,
                                   const FrameId& first) {
  std::vector<NodePlace> places(static_cast<std::size_t>(graph.node_count()));
  const auto start = static_cast<std::size_t>(graph.start);
  places[start] = {first.clip_idx, static_cast<int>(first.frame_idx)};
  std::vector<std::size_t> open{start};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    for (auto i = static_cast<std::size_t>(graph.first_edge[node]);
         i < static_cast<std::size_t>(graph.first_edge[node + 1]); ++i) {
      const StateEdge& edge = graph.edges[i];
      NodePlace& target = places[static_cast<std::size_t>(edge.target)];
      if (target.frame >= 0) continue;
      target = {places[node].clip_idx, places[node].frame + edge.steps};
      if (edge.transition >= 0) {
        const Transition& transition = metrics.transitions()[static_cast<std::size_t>(edge.transition)];
        target = {transition.target_clip, transition.arrive() + edge.steps - 2 * transition.half_window};
      }
      open.push_back(static_cast<std::size_t>(edge.target));
    }
  }
  return places;
}

GroundMotion ground_motion(const PathMetrics& metrics, const StateGraph& graph, const FrameId& first) {
  const std::vector<NodePlace> places = node_places(metrics, graph, first);
  GroundMotion motion;
  motion.steps.reserve(graph.edges.size());
  for (std::size_t node = 0; node < places.size(); ++node) {
    if (places[node].frame < 0) continue;  // it cannot be reached, and neither can its edges
    const std::vector<Eigen::Vector2d>& source = metrics.trajectory(places[node].clip_idx);
    const Eigen::Vector2d& origin = source[static_cast<std::size_t>(places[node].frame)];
    for (auto i = static_cast<std::size_t>(graph.first_edge[node]);
         i < static_cast<std::size_t>(graph.first_edge[node + 1]); ++i) {
      const StateEdge& edge = graph.edges[i];
      GroundStep step{.first_offset = static_cast<std::uint32_t>(motion.offsets.size())};
      if (edge.transition < 0) {
        for (int k = 1; k <= edge.steps; ++k) {
          motion.offsets.emplace_back(source[static_cast<std::size_t>(places[node].frame + k)] - origin);
        }
      } else {
        const auto transition_idx = static_cast<std::size_t>(edge.transition);
        const Transition& transition = metrics.transitions()[transition_idx];
        const std::vector<Eigen::Vector2d>& target = metrics.trajectory(transition.target_clip);
        const int window = 2 * transition.half_window;
        for (int k = 1; k <= window; ++k) {
          motion.offsets.emplace_back(metrics.blend_center(transition_idx, k - transition.half_window) -
                                      origin);
        }
        for (int k = 1; k <= edge.steps - window; ++k) {
          motion.offsets.emplace_back(transition.source_from_target *
                                          target[static_cast<std::size_t>(transition.arrive() + k)] -
                                      origin);
        }
        step.yaw = transition.source_from_target.yaw;
      }
      step.displacement = motion.offsets.back();
      motion.steps.resize(i + 1);
      motion.steps[i] = step;
    }
  }
  motion.steps.resize(graph.edges.size());
  return motion;
}

GroundLabel GroundTask::first_label() const {
  GroundLabel label{.node = graph->start};
  if (!route) return label;
  const RouteLine::Match match = route->follow(0.0, label.position);
  label.marker = match.marker;
  label.cost = route_weight * match.deviation;
  return label;
}

bool GroundTask::follow(const GroundLabel& label, std::size_t edge_idx, GroundLabel& next) const {
  const StateEdge& edge = graph->edges[edge_idx];
  const GroundStep& step = motion.steps[edge_idx];
  const Eigen::Matrix2d R = ground_rotation(label.yaw);
  next = label;
  next.cost += edge.cost;
  next.distance += edge.distance;
  next.steps += edge.steps;
  next.node = edge.target;
  next.position += R * step.displacement;
  if (step.yaw != 0.0) next.yaw = wrap_angle(label.yaw + step.yaw);
  if (!route) return true;
  for (const Eigen::Vector2d& offset : motion.of_edge(*graph, edge_idx)) {
    const RouteLine::Match match = route->follow(next.marker, label.position + R * offset);
    if (match.deviation > max_deviation + limit_slack) return false;
    next.marker = match.marker;
    next.cost += route_weight * match.deviation;
  }
  return true;
}

double GroundTask::gap_to_goal(const GroundLabel& label) const {
  return goal ? (label.position - goal->position).norm() : 0.0;
}

double GroundTask::gap_to_route_end(const GroundLabel& label) const {
  return route ? (label.position - route->end()).norm() : 0.0;
}

double GroundTask::rest_of_route(const GroundLabel& label) const {
  if (!route) return 0.0;
  const RouteLine::Match match = route->follow(label.marker, label.position);
  return match.deviation + route->length() - match.marker;
}

double GroundTask::cost_at_end(const GroundLabel& label) const {
  const double frames = label.steps + 1;
  if (frames < targets.min_frames - limit_slack || frames > targets.max_frames + limit_slack ||
      label.distance < targets.min_distance - limit_slack ||
      label.distance > targets.max_distance + limit_slack) {
    return infinity;
  }
  double cost = label.cost + targets.distance_weight * std::abs(label.distance - targets.distance) +
                targets.time_weight * std::abs(frames - targets.frames);
  if (goal) {
    const double gap = gap_to_goal(label);
    if (gap > goal->position_tolerance + limit_slack) return infinity;
    cost += position_weight * gap;
    if (goal->turn) {
      const double turn = std::abs(wrap_angle(label.yaw - *goal->turn));
      if (turn > goal->turn_tolerance + limit_slack) return infinity;
      cost += turn_weight * turn;
    }
  }
  if (route) cost += position_weight * rest_of_route(label);
  return cost;
}

}  // namespace reprise::path_detail
