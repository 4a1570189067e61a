// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Walks through a state graph as they lie on the ground, and what their places cost.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "reprise/path/keyframe_query.h"
#include "reprise/path/route_line.h"
#include "reprise/path/state_graph.h"
#include "reprise/path/walk_bounds.h"

namespace reprise::path_detail {

// Where a node is; frame -1 where no edge leads. A node does not say it, the edges that lead there do.
struct NodePlace {
  std::size_t clip_idx = 0;
  int frame = -1;
};
std::vector<NodePlace> node_places(const PathMetrics& metrics, const StateGraph& graph, const FrameId& first);

// Of (x, z), as GroundTransform turns them.
Eigen::Matrix2d ground_rotation(double yaw);

// How an edge moves the ground centre: everything in the axes of the clip it leaves from.
struct GroundStep {
  double yaw = 0.0;  // of source_from_target of its transition; 0 when it plays on
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  // of the centre, from source to target
  std::uint32_t first_offset = 0;                          // in GroundMotion::offsets
};

// The edges' motion, by edge index. Offsets are those of the frames after the source, the target's included:
// metres from the source's centre.
struct GroundMotion {
  std::vector<GroundStep> steps;
  std::vector<Eigen::Vector2d> offsets;

  std::span<const Eigen::Vector2d> of_edge(const StateGraph& graph, std::size_t edge_idx) const {
    return {&offsets[steps[edge_idx].first_offset], static_cast<std::size_t>(graph.edges[edge_idx].steps)};
  }
};
GroundMotion ground_motion(const PathMetrics& metrics, const StateGraph& graph, const FrameId& first);

// A partial walk from the start, where it stands and what it has cost.
struct GroundLabel {
  double cost = 0.0;                                   // transitions and deviation from the route, weighted
  double distance = 0.0;                               // metres walked
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the centre, from where it started
  double yaw = 0.0;                                    // of world_from_clip, in (-pi, pi]
  double marker = 0.0;                                 // metres along the route
  double bound = 0.0;                                  // no walk that begins like this costs less
  std::int32_t steps = 0;
  std::int32_t node = 0;
  std::int32_t parent = -1;
  std::int32_t edge = -1;
};

// A query with places: weights and limits of KeyframeQuery and KeyframeOptions, frames for seconds.
struct GroundTask {
  const StateGraph* graph = nullptr;
  GroundMotion motion;
  WalkTargets targets;
  std::optional<GroundGoal> goal;
  std::optional<RouteLine> route;
  double max_deviation = unlimited;
  double position_weight = 0.0;  // per metre
  double turn_weight = 0.0;      // per radian
  double route_weight = 0.0;     // per metre and frame

  GroundLabel first_label() const;
  // Goes along an edge; false if the route's limit forbids it. `parent`, `edge` and `bound` are the caller's.
  bool follow(const GroundLabel& label, std::size_t edge_idx, GroundLabel& next) const;
  // What a walk that ends with this label costs in all; infinite if it breaks a limit.
  double cost_at_end(const GroundLabel& label) const;
  // Metres from the centre to the goal; 0 without one.
  double gap_to_goal(const GroundLabel& label) const;
  // Metres from the centre to the marker and on along the line to its end; 0 without a route.
  double rest_of_route(const GroundLabel& label) const;
  // Metres from the centre straight to the end of the route: never more than the rest of it.
  double gap_to_route_end(const GroundLabel& label) const;
};

// Limits are kept up to this, in their units: what the search adds up is rounded.
inline constexpr double limit_slack = 1e-9;

}  // namespace reprise::path_detail
