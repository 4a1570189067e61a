// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The queries of one pair of key-frames: a grid of target distances and times.

#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "reprise/path/keyframe_optimizer.h"
#include "reprise/pipeline/evaluate_keyframes.h"
#include "reprise/synthesis/transition_smoothness.h"

namespace reprise {

struct GridQuery {
  int target_distance = 0;  // metres
  int target_time = 0;      // seconds
  MotionPath path;
  std::vector<int> transitions;  // of the path, as indices into `PathMetrics::transitions`
  double cpu_seconds = 0.0;      // of the search, on its thread
  Correction correction;         // what `plan_correction` would make of the path
  // Means over the path's transitions, each as often as it is taken; none for a path without.
  std::optional<TransitionSmoothness> smoothness;
  bool is_reachable = false;

  double distance_error() const { return std::abs(path.distance - target_distance); }
  double time_error() const { return std::abs(path.time - target_time); }
  double corrected_distance_error() const { return std::abs(correction.distance - target_distance); }
  double corrected_time_error() const { return std::abs(correction.time - target_time); }
};

struct KeyframeGrid {
  std::string database;  // how the tables call it
  GridPair pair;
  double frames_per_second = 25.0;
  double preparation_cpu_seconds = 0.0;  // what all targets share
  std::vector<GridQuery> queries;        // distance by distance within time by time, both from 1
};

using SmoothnessOfTransition = std::map<int, TransitionSmoothness>;

// Key-frames of the pair, in order.
std::vector<FrameId> keyframes_of(const GridPair& pair, const PerformanceDatabase& database);

// The path from key-frame to key-frame that takes these transitions: its segments alone. Throws
// `InvalidArgument` if they do not fit on one another.
std::vector<PathSegment> path_segments(const std::vector<FrameId>& keyframes, const PathMetrics& metrics,
                                       const std::vector<int>& transitions);

// Paths and times of all targets, in parallel; the same paths for any number of threads. Throws `Error` if
// there is no path from key-frame to key-frame.
KeyframeGrid search_grid(const std::string& name, const GridPair& pair, const PerformanceDatabase& database,
                         const PathMetrics& metrics, const EvaluateKeyframesOptions& options);

// Adds to `known` what it lacks of the transitions that the paths of `grid` take. In parallel.
void add_smoothness(const KeyframeGrid& grid, const PerformanceDatabase& database, const PathMetrics& metrics,
                    SmoothnessOfTransition& known);

// Fills in what follows from paths and options: reachability, correction, smoothness.
void complete_grid(KeyframeGrid& grid, const SmoothnessOfTransition& smoothness,
                   const EvaluateKeyframesOptions& options);

// The reachable target nearest to that of `query`, by the weights of the cost; the earliest of several. Null:
// none is reachable.
const GridQuery* nearest_reachable(const KeyframeGrid& grid, const GridQuery& query,
                                   const KeyframeOptions& options);

}  // namespace reprise
