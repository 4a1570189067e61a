// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "play": motion without an end that never pops, from any frame.

#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "reprise/path/endless_play.h"
#include "reprise/synthesis/synthesize.h"

namespace reprise {

struct PlayStageOptions {
  std::string from;                  // "CLIP:FRAME", where play starts
  std::vector<std::string> without;  // clips that are not to be shown
  // Greatest peak acceleration of a join, in times that of the captured clips (their 99th percentile): 1 or
  // less does not pop. Infinite: any.
  double max_pop_ratio = 1.0;
  PlayOptions play;  // its limit on the acceleration and its forbidden clips are set by the stage
  std::string name = "animation";  // of the resulting clip
};

struct PlayResult {
  EndlessPlay play;
  MeshSequence animation;
  nlohmann::json report;  // docs/endless-play.md lists every field
};

// Plays, synthesises, and measures every join of the result: the estimate of the graph is made from samples
// before the blend is. Joins that are above the limit are left out of the graph and play begins anew, until
// none is. Throws `InvalidArgument` if the graph was made from another database, a frame or clip does not
// exist, or an option is out of range.
tl::expected<PlayResult, NoPath> run_play(const PerformanceDatabase& database,
                                          const SurfaceMotionGraph& graph, const PlayStageOptions& options);

}  // namespace reprise
