// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Play without an end: walks on the graph that never meet a dead end and never take a join that pops.

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "reprise/math/ground_transform.h"
#include "reprise/path/keyframe_optimizer.h"

namespace reprise {

struct PlayOptions {
  enum class Mode {
    loop,    // the cycle of least transition cost per second, again and again, and the cheapest way into it
    period,  // that cycle alone, once: its last frame leads back to its first
    stochastic,  // a random walk that prefers what is cheap now and later
  };
  Mode mode = Mode::stochastic;
  double time = 60.0;        // seconds to play; not used for a period
  std::uint64_t seed = 1;    // the same seed gives the same walk
  double temperature = 0.2;  // metres: of two ways on, one this much dearer is taken 1/e times as often; 0:
                             // the cheapest always
  double foresight = 5.0;    // seconds after which a cost to come counts 1/e
  double max_transition_cost = unlimited;    // metres: dearer joins are never taken
  double max_peak_acceleration = unlimited;  // m/frame^2: neither are joins whose blend moves faster
  std::vector<std::size_t> forbidden_clips;  // never shown, except that play may start in one
};

struct EndlessPlay {
  MotionPath path;  // its cost is that of its transitions
  // Of the loop, except in a random walk:
  int loop_start = 0;               // frame of the path with which the first round begins
  int period = 0;                   // frames of a round
  double loop_cost = 0.0;           // of a round's transitions, metres
  GroundTransform start_from_next;  // brings a round onto the one before it, in the clip the round starts in
};

// A walk from `from` of at least `time` seconds; it ends at the first frame after that where a join could be
// taken. `NoPath` if every way from there ends in a dead end. Throws `InvalidArgument` for options out of
// range, a frame that does not exist, and names that are not one a clip.
tl::expected<EndlessPlay, NoPath> play_endlessly(const PathMetrics& metrics, const FrameId& from,
                                                 const PlayOptions& options,
                                                 const std::vector<std::string>& clip_names);

}  // namespace reprise
