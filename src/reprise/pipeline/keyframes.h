// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "keyframes": a key-frame query becomes an animation and a report.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "reprise/path/keyframe_optimizer.h"
#include "reprise/synthesis/synthesize.h"

namespace reprise {

struct KeyframesOptions {
  std::vector<std::string> keyframes;  // "CLIP:FRAME", at least two, in the order they are to be shown
  double distance = 0.0;               // wanted ground distance, metres
  double time = 0.0;                   // wanted duration, seconds
  KeyframeOptions optimizer;
  std::string name = "animation";  // of the resulting clip
};

struct KeyframesResult {
  MotionPath path;
  MeshSequence animation;
  // distance, time, cost, lower_bound, gap, seconds (of the search), and frames: clip, frame, and inside a
  // blend partner_clip, partner_frame, weight. docs/keyframes.md lists every field.
  nlohmann::json report;
};

// Knowledge of the database that all queries of a graph share.
PathMetrics path_metrics(const PerformanceDatabase& database, const SurfaceMotionGraph& graph);

// Throws `InvalidArgument` if the graph was made from another database or a key-frame does not exist.
tl::expected<KeyframesResult, NoPath> run_keyframes(const PerformanceDatabase& database,
                                                    const SurfaceMotionGraph& graph,
                                                    const KeyframesOptions& options);

}  // namespace reprise
