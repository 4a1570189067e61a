// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframes.h"

#include <chrono>

#include <fmt/format.h>

#include "reprise/path/program_writer.h"
#include "reprise/pipeline/path_report.h"
#include "reprise/render/ground_plot.h"

namespace reprise {
namespace {

nlohmann::json describe_limit(double least, double greatest) {
  nlohmann::json limit = nlohmann::json::array({least, nullptr});
  if (greatest < unlimited) limit[1] = greatest;
  return limit;
}

nlohmann::json describe_query(const KeyframesOptions& options) {
  nlohmann::json query = {{"keyframes", options.keyframes},
                          {"target_distance", options.distance},
                          {"target_time", options.time},
                          {"distance_weight", options.optimizer.distance_weight},
                          {"time_weight", options.optimizer.time_weight}};
  if (options.min_distance > 0.0 || options.max_distance < unlimited) {
    query["distance_limits"] = describe_limit(options.min_distance, options.max_distance);
  }
  if (options.min_time > 0.0 || options.max_time < unlimited) {
    query["time_limits"] = describe_limit(options.min_time, options.max_time);
  }
  if (!options.forbidden_clips.empty()) query["forbidden_clips"] = options.forbidden_clips;
  if (!options.compulsory_clips.empty()) query["compulsory_clips"] = options.compulsory_clips;
  if (options.goal) {
    query["goal"] = {options.goal->position.x(), options.goal->position.y()};
    query["position_weight"] = options.optimizer.position_weight;
    if (options.goal->turn) {
      query["goal_turn"] = *options.goal->turn;
      query["turn_weight"] = options.optimizer.turn_weight;
    }
  }
  if (options.route) {
    for (const Eigen::Vector2d& point : options.route->points)
      query["route"].push_back({point.x(), point.y()});
    query["route_weight"] = options.optimizer.route_weight;
  }
  return query;
}

nlohmann::json make_report(const KeyframesOptions& options, const SurfaceMotionGraph& graph,
                           const KeyframesResult& result, const std::optional<Correction>& correction,
                           double seconds) {
  const MotionPath& path = result.path;
  nlohmann::json report = describe_query(options);
  report.update({{"distance", path.distance},
                 {"time", path.time},
                 {"frame_count", path.frame_count},
                 {"cost", path.cost},
                 {"costs",
                  {{"transitions", path.costs.transitions},
                   {"distance", path.costs.distance},
                   {"time", path.costs.time},
                   {"position", path.costs.position},
                   {"turn", path.costs.turn},
                   {"route", path.costs.route}}},
                 {"lower_bound", path.lower_bound},
                 {"gap", path.gap()},
                 {"labels", path.labels},
                 {"seconds", seconds},
                 {"metric", graph.metric},
                 {"database_hash", graph.database_hash},
                 {"transitions", describe_transitions(path, graph)},
                 {"frames", describe_frames(result.animation.origins())}});
  const Eigen::Vector2d& end = result.track.centers.back();
  report["end"] = {{"position", {end.x(), end.y()}}, {"turn", result.track.turn}};
  if (correction) {
    report["correction"] = {{"frame_count", correction->frame_count},
                            {"stretch", correction->stretch},
                            {"distance", correction->distance},
                            {"time", correction->time}};
  }
  return report;
}

std::vector<std::size_t> clip_indices(const PerformanceDatabase& database,
                                      const std::vector<std::string>& names) {
  std::vector<std::size_t> indices;
  for (const std::string& name : names) indices.push_back(database.clip_idx(name));
  return indices;
}

}  // namespace

PathMetrics path_metrics(const PerformanceDatabase& database, const SurfaceMotionGraph& graph) {
  std::vector<std::vector<Eigen::Vector2d>> trajectories;
  for (const MeshSequence& clip : database.clips()) trajectories.push_back(ground_trajectory(clip));
  return {std::move(trajectories), graph.active_transitions(), graph.options.profile,
          database.frames_per_second()};
}

KeyframeQuery keyframe_query(const PerformanceDatabase& database, const KeyframesOptions& options) {
  KeyframeQuery query{.distance = options.distance,
                      .time = options.time,
                      .min_distance = options.min_distance,
                      .max_distance = options.max_distance,
                      .min_time = options.min_time,
                      .max_time = options.max_time,
                      .forbidden_clips = clip_indices(database, options.forbidden_clips),
                      .compulsory_clips = clip_indices(database, options.compulsory_clips),
                      .goal = options.goal,
                      .route = options.route};
  for (const std::string& text : options.keyframes) query.keyframes.push_back(database.parse_frame(text));
  return query;
}

tl::expected<std::vector<KeyframesResult>, NoPath> run_keyframe_alternatives(
    const PerformanceDatabase& database, const SurfaceMotionGraph& graph, const KeyframesOptions& options) {
  check_graph_fits(graph, database);
  const KeyframeQuery query = keyframe_query(database, options);
  const PathMetrics metrics = path_metrics(database, graph);
  const auto start = std::chrono::steady_clock::now();
  auto paths =
      find_alternative_paths(metrics, query, options.optimizer, options.alternatives, database.clip_names());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!paths) return tl::make_unexpected(std::move(paths.error()));

  const Synthesizer synthesizer(database);
  std::vector<KeyframesResult> results;
  for (MotionPath& path : *paths) {
    SynthesisOptions synthesis{
        .profile = graph.options.profile,
        .name = results.empty() ? options.name : fmt::format("{}-{}", options.name, results.size() + 1),
        .plant_feet = options.plant_feet};
    if (options.correction) {
      CorrectionOptions limits = *options.correction;
      if (options.goal || options.route) limits.max_stretch = 0.0;
      synthesis.correction =
          plan_correction(path, options.distance, options.time, database.frames_per_second(), limits);
    }
    KeyframesResult result{.path = std::move(path)};
    result.track = ground_track(metrics, result.path);
    result.animation = synthesizer.synthesize(result.path, synthesis);
    result.report = make_report(options, graph, result, synthesis.correction, seconds);
    results.push_back(std::move(result));
  }
  return results;
}

tl::expected<KeyframesResult, NoPath> run_keyframes(const PerformanceDatabase& database,
                                                    const SurfaceMotionGraph& graph,
                                                    const KeyframesOptions& options) {
  KeyframesOptions best = options;
  best.alternatives.count = 1;
  auto results = run_keyframe_alternatives(database, graph, best);
  if (!results) return tl::make_unexpected(std::move(results.error()));
  return std::move(results->front());
}

void draw_top_view(const KeyframesOptions& options, std::span<const KeyframesResult> results,
                   const std::filesystem::path& png) {
  GroundPanel panel{.title = "from above"};
  if (options.route) {
    panel.curves.push_back({"route asked for", GroundCurve::Kind::asked, options.route->points});
  }
  if (options.goal) panel.curves.push_back({"goal", GroundCurve::Kind::asked, {options.goal->position}});
  for (const KeyframesResult& result : results) {
    panel.curves.push_back({result.animation.name(), GroundCurve::Kind::walked, result.track.centers});
  }
  plot_ground(std::span(&panel, 1), png);
}

std::string keyframe_program(const PerformanceDatabase& database, const SurfaceMotionGraph& graph,
                             const KeyframesOptions& options, double cost) {
  check_graph_fits(graph, database);
  return write_keyframe_program(path_metrics(database, graph), keyframe_query(database, options),
                                options.optimizer, database.clip_names(), cost);
}

}  // namespace reprise
