// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/path_report.h"

namespace reprise {

nlohmann::json describe_transitions(const MotionPath& path, const SurfaceMotionGraph& graph) {
  nlohmann::json transitions = nlohmann::json::array();
  for (const PathSegment& segment : path.segments) {
    if (!segment.transition) continue;
    transitions.push_back({{"transition", to_string(*segment.transition, graph)},
                           {"half_window", segment.transition->half_window},
                           {"cost", segment.transition->cost}});
  }
  return transitions;
}

nlohmann::json describe_frames(const std::vector<FrameOrigin>& frames) {
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
  return shown;
}

}  // namespace reprise
