// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A walk on a state graph as the path it stands for.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/path/state_graph.h"

namespace reprise::path_detail {

// Lays the walk along `edges` (from start to end of `graph`) out as segments and measures it anew, without a
// search's roundings: distance, time, and the terms of its cost (Eq. 7) for transitions, distance and time.
// Total cost, bound and labels are the caller's.
MotionPath path_of_walk(const PathMetrics& metrics, const KeyframeQuery& query,
                        const KeyframeOptions& options, const StateGraph& graph,
                        const std::vector<std::int32_t>& edges);

}  // namespace reprise::path_detail
