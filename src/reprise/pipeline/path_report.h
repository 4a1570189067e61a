// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the reports of all stages that make a path have in common.

#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "reprise/graph/surface_motion_graph.h"
#include "reprise/path/keyframe_query.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// The transitions of a path in order: `transition` ("walk:12->run:30"), `half_window`, `cost`.
nlohmann::json describe_transitions(const MotionPath& path, const SurfaceMotionGraph& graph);

// One object a frame: `clip`, `frame`, and inside a blend `partner_clip`, `partner_frame`, `weight`.
nlohmann::json describe_frames(const std::vector<FrameOrigin>& frames);

}  // namespace reprise
