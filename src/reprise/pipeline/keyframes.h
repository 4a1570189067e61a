// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "keyframes": a key-frame query becomes an animation and a report.

#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "reprise/path/alternatives.h"
#include "reprise/path/ground_search.h"
#include "reprise/synthesis/synthesize.h"

namespace reprise {

struct KeyframesOptions {
  std::vector<std::string> keyframes;  // "CLIP:FRAME", at least two, in the order they are to be shown
  double distance = 0.0;               // wanted ground distance, metres
  double time = 0.0;                   // wanted duration, seconds
  // As in KeyframeQuery, clips by name.
  double min_distance = 0.0;
  double max_distance = unlimited;
  double min_time = 0.0;
  double max_time = unlimited;
  std::vector<std::string> forbidden_clips;
  std::vector<std::string> compulsory_clips;
  std::optional<GroundGoal> goal;
  std::optional<GroundRoute> route;
  KeyframeOptions optimizer;
  AlternativesOptions alternatives{.count = 1};  // different answers wanted, the best one included
  // The small continuous correction of time and distance; none: frames are shown as captured. With a goal or
  // a route time alone is corrected, or the path would end elsewhere.
  std::optional<CorrectionOptions> correction;
  bool plant_feet = true;
  std::string name = "animation";  // of the resulting clip; further answers are NAME-2, NAME-3, ...
};

struct KeyframesResult {
  MotionPath path;
  GroundTrack track;  // of the path, without correction
  MeshSequence animation;
  // distance, time, cost and its terms, lower_bound, gap, seconds (of the search), and frames: clip, frame,
  // and inside a blend partner_clip, partner_frame, weight. docs/keyframes.md lists every field.
  nlohmann::json report;
};

// Knowledge of the database that all queries of a graph share.
PathMetrics path_metrics(const PerformanceDatabase& database, const SurfaceMotionGraph& graph);

// The query of the options. Throws `InvalidArgument` if a key-frame or a clip does not exist.
KeyframeQuery keyframe_query(const PerformanceDatabase& database, const KeyframesOptions& options);

// The answers, best first; at least one. Throws `InvalidArgument` if the graph was made from another
// database, a key-frame or clip does not exist, or an option is out of range.
tl::expected<std::vector<KeyframesResult>, NoPath> run_keyframe_alternatives(
    const PerformanceDatabase& database, const SurfaceMotionGraph& graph, const KeyframesOptions& options);

// The best answer alone.
tl::expected<KeyframesResult, NoPath> run_keyframes(const PerformanceDatabase& database,
                                                    const SurfaceMotionGraph& graph,
                                                    const KeyframesOptions& options);

// The query as an integer program in LP format (program_writer.h). `cost`: that of a path that answers it.
std::string keyframe_program(const PerformanceDatabase& database, const SurfaceMotionGraph& graph,
                             const KeyframesOptions& options, double cost);

// The answers seen from above, beside the goal and the route that were asked for, as a PNG.
void draw_top_view(const KeyframesOptions& options, std::span<const KeyframesResult> results,
                   const std::filesystem::path& png);

}  // namespace reprise
