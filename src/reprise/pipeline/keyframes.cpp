// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframes.h"

#include <chrono>

namespace reprise {
namespace {

nlohmann::json make_report(const KeyframesOptions& options, const SurfaceMotionGraph& graph,
                           const MotionPath& path, const std::vector<FrameOrigin>& frames, double seconds) {
  nlohmann::json transitions = nlohmann::json::array();
  for (const PathSegment& segment : path.segments) {
    if (!segment.transition) continue;
    transitions.push_back({{"transition", to_string(*segment.transition, graph)},
                           {"half_window", segment.transition->half_window},
                           {"cost", segment.transition->cost}});
  }
  nlohmann::json shown = nlohmann::json::array();
  for (const FrameOrigin& frame : frames) {
    nlohmann::json entry = {{"clip", frame.clip}, {"frame", frame.frame_idx}};
    if (frame.is_blend()) {
      entry["partner_clip"] = frame.partner_clip;
      entry["partner_frame"] = frame.partner_frame_idx;
      entry["weight"] = frame.partner_weight;
    }
    shown.push_back(std::move(entry));
  }
  return {{"keyframes", options.keyframes},
          {"target_distance", options.distance},
          {"target_time", options.time},
          {"distance", path.distance},
          {"time", path.time},
          {"frame_count", path.frame_count},
          {"transition_cost", path.transition_cost},
          {"distance_weight", options.optimizer.distance_weight},
          {"time_weight", options.optimizer.time_weight},
          {"cost", path.cost},
          {"lower_bound", path.lower_bound},
          {"gap", path.gap()},
          {"labels", path.labels},
          {"seconds", seconds},
          {"metric", graph.metric},
          {"database_hash", graph.database_hash},
          {"transitions", std::move(transitions)},
          {"frames", std::move(shown)}};
}

}  // namespace

PathMetrics path_metrics(const PerformanceDatabase& database, const SurfaceMotionGraph& graph) {
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  for (const MeshSequence& clip : database.clips()) trajectories.push_back(ground_trajectory(clip));
  return {std::move(trajectories), graph.active_transitions(), graph.options.profile,
          database.frames_per_second()};
}

tl::expected<KeyframesResult, NoPath> run_keyframes(const PerformanceDatabase& database,
                                                    const SurfaceMotionGraph& graph,
                                                    const KeyframesOptions& options) {
  check_graph_fits(graph, database);
  KeyframeQuery query{.distance = options.distance, .time = options.time};
  for (const std::string& text : options.keyframes) query.keyframes.push_back(database.parse_frame(text));

  const PathMetrics metrics = path_metrics(database, graph);
  const auto start = std::chrono::steady_clock::now();
  tl::expected<MotionPath, NoPath> path =
      find_keyframe_path(metrics, query, options.optimizer, database.clip_names());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!path) return tl::make_unexpected(std::move(path.error()));

  const PoissonReconstruction poisson(database.topology(), database.clip(0).frame(0));
  KeyframesResult result{.path = std::move(*path)};
  result.animation =
      synthesize(result.path, database, poisson, {.profile = graph.options.profile, .name = options.name});
  result.report = make_report(options, graph, result.path, result.animation.origins(), seconds);
  return result;
}

}  // namespace reprise
