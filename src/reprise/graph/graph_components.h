// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where a walk on the graph can go on for ever, and what only leads there or away.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "reprise/graph/transition.h"

namespace reprise {

struct FrameRange {
  std::size_t clip_idx = 0;
  int first = 0;
  int last = 0;
  bool operator==(const FrameRange&) const = default;
};

// Frames that can all be reached from each other: a strongly connected component of the graph whose nodes are
// the frames of all clips and whose edges lead from a frame to the next of its clip, and by a transition from
// the last pure source frame to the first pure target frame (m - L to n + L).
struct GraphComponent {
  std::vector<FrameRange> ranges;        // one a clip at most: from the first arrival to the last departure
  std::vector<std::size_t> transitions;  // those that begin and end in it
  std::vector<std::size_t> leads_to;     // components a walk can go over to, and not come back
};

// Frames of a clip of which the same is true.
struct ClipPart {
  enum class Kind : std::uint8_t {
    core,      // of a component: a walk goes on for ever and comes back
    lead_in,   // a walk goes on for ever from here, but none comes back
    passage,   // from one component to another
    lead_out,  // a walk comes here from a component and must end
    apart,     // neither: every walk ends, and none comes from a component
  };
  FrameRange range;
  Kind kind = Kind::apart;
  std::optional<std::size_t> component;  // of the core
};

struct GraphComponents {
  std::vector<GraphComponent> components;  // most frames first; without a way back to itself a frame is none
  std::vector<ClipPart> parts;             // all frames of all clips, in order
  std::vector<bool> goes_on;               // of each transition: some walk goes on for ever after it
  std::vector<bool> comes_from;            // of each: some walk comes to it from a component
};

// `frame_counts`: of each clip. Linear in frames and transitions but for `leads_to`. Throws `InvalidArgument`
// for a transition whose window leaves its clip, or of a clip that does not exist.
GraphComponents find_components(std::span<const int> frame_counts, std::span<const Transition> transitions);

}  // namespace reprise
