// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Several different answers to one key-frame query, best first.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "reprise/path/keyframe_optimizer.h"

namespace reprise {

struct AlternativesOptions {
  std::size_t count = 3;  // paths wanted, the best one included
  // Frames: two transitions of a pair of clips are the same join if their m and n are each this near.
  int radius = 12;
  // Share, in (0, 1], of an earlier path, by the time around its joins, that one must do without to differ
  // from it.
  double share = 0.5;
  std::size_t max_searches = 1000;  // searches for a path; then the best so far are given with their gaps
};

// Whether a path differs from an earlier one. The joins of a path are its transitions in order, those near
// one before them left out; each weighs the share of the path's time that is nearest to it: its blends and
// half of what is played between it and its neighbours. A path differs if the earlier path's joins that it
// takes as well, or near ones, weigh at most 1 - share. From a path without joins, which plays one clip,
// differs what lasts another number of frames.
bool differs(const MotionPath& path, const MotionPath& earlier, const AlternativesOptions& options);

// Share, 0 to 1, of the frames of the longer path that the other does not show, or not as often. A blended
// frame shows the heavier of its two.
double difference(const MotionPath& a, const MotionPath& b);

// The path `find_keyframe_path` finds, then the best of those that differ from it, then the best of those
// that differ from both, and so on: each an optimum with its own certificate. Fewer than `count` if there are
// no more. If the effort ends early, or a search does, the paths still differ and each keeps the query's
// limits; `lower_bound` is then below `cost`. Deterministic. Throws what `find_keyframe_path` throws, and
// `InvalidArgument` for options out of range.
tl::expected<std::vector<MotionPath>, NoPath> find_alternative_paths(
    const PathMetrics& metrics, const KeyframeQuery& query, const KeyframeOptions& options,
    const AlternativesOptions& alternatives, const std::vector<std::string>& clip_names);

}  // namespace reprise
