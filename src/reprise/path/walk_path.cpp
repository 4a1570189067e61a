// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/walk_path.h"

#include <cmath>

namespace reprise::path_detail {

MotionPath path_of_walk(const PathMetrics& metrics, const KeyframeQuery& query,
                        const KeyframeOptions& options, const StateGraph& graph,
                        const std::vector<std::int32_t>& edges) {
  MotionPath path;
  PathSegment segment;
  segment.clip_idx = query.keyframes.front().clip_idx;
  segment.first_frame = static_cast<int>(query.keyframes.front().frame_idx);
  const auto close_segment = [&](int last_frame) {
    segment.last_frame = last_frame;
    path.distance += metrics.clip_distance(segment.clip_idx, segment.first_frame, last_frame);
    path.frame_count += last_frame - segment.first_frame + 1;
    path.segments.push_back(segment);
  };
  for (const std::int32_t edge_idx : edges) {
    const StateEdge& edge = graph.edges[static_cast<std::size_t>(edge_idx)];
    if (edge.transition < 0) continue;
    const auto transition_idx = static_cast<std::size_t>(edge.transition);
    const Transition& transition = metrics.transitions()[transition_idx];
    segment.transition = transition;
    close_segment(transition.leave());
    path.costs.transitions += transition.cost;
    path.distance += metrics.blend_distance(transition_idx);
    path.frame_count += 2 * transition.half_window - 1;
    segment =
        PathSegment{.clip_idx = transition.target_clip, .first_frame = transition.arrive(), .transition = {}};
  }
  close_segment(static_cast<int>(query.keyframes.back().frame_idx));
  path.time = path.frame_count / metrics.frames_per_second();
  path.costs.distance = options.distance_weight * std::abs(path.distance - query.distance);
  path.costs.time =
      options.time_weight * std::abs(path.frame_count - query.time * metrics.frames_per_second());
  return path;
}

}  // namespace reprise::path_detail
