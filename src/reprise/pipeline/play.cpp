// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/play.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/pipeline/keyframes.h"
#include "reprise/pipeline/path_report.h"

namespace reprise {
namespace {

constexpr const char* mode_name(PlayOptions::Mode mode) {
  switch (mode) {
    case PlayOptions::Mode::loop:
      return "loop";
    case PlayOptions::Mode::period:
      return "period";
    case PlayOptions::Mode::stochastic:
      break;
  }
  return "stochastic";
}

// Largest vertex acceleration of each frame that has a frame on either side, m/frame^2; zero elsewhere.
std::vector<double> peak_accelerations(const MeshSequence& sequence) {
  std::vector<double> peaks(sequence.frame_count(), 0.0);
  if (peaks.size() < 3) return peaks;
  parallel_for(1, peaks.size() - 1, [&](std::size_t f) {
    peaks[f] = std::sqrt(
        static_cast<double>((sequence.frame(f + 1) - 2.0F * sequence.frame(f) + sequence.frame(f - 1))
                                .rowwise()
                                .squaredNorm()
                                .maxCoeff()));
  });
  return peaks;
}

struct MeasuredJoin {
  Transition transition;
  double peak_acceleration = 0.0;  // of the blend and the frames next to it
};

std::vector<MeasuredJoin> measure_joins(const MotionPath& path, const MeshSequence& animation) {
  const std::vector<double> peaks = peak_accelerations(animation);
  std::vector<MeasuredJoin> joins;
  std::size_t at = 0;
  for (const PathSegment& segment : path.segments) {
    if (!segment.transition) break;
    at += static_cast<std::size_t>(segment.last_frame - segment.first_frame);
    const std::size_t arrival = at + 2 * static_cast<std::size_t>(segment.transition->half_window);
    joins.push_back(
        {*segment.transition, *std::max_element(peaks.begin() + static_cast<std::ptrdiff_t>(at),
                                                peaks.begin() + static_cast<std::ptrdiff_t>(arrival) + 1)});
    at = arrival;
  }
  return joins;
}

// Marks the transitions of joins above the limit. How many there are.
std::size_t mark_pops(const std::vector<MeasuredJoin>& joins, double limit,
                      const std::vector<Transition>& transitions, std::vector<bool>& marks) {
  std::size_t found = 0;
  for (const MeasuredJoin& join : joins) {
    if (join.peak_acceleration <= limit) continue;
    for (std::size_t i = 0; i < transitions.size(); ++i) {
      const Transition& transition = transitions[i];
      if (marks[i] || transition.source_clip != join.transition.source_clip ||
          transition.target_clip != join.transition.target_clip || transition.m != join.transition.m ||
          transition.n != join.transition.n || transition.half_window != join.transition.half_window) {
        continue;
      }
      marks[i] = true;
      ++found;
    }
  }
  return found;
}

nlohmann::json clip_times(const std::vector<FrameOrigin>& frames, double frames_per_second) {
  std::map<std::string, std::size_t> count;
  for (const FrameOrigin& frame : frames) {
    ++count[frame.is_blend() && frame.partner_weight > 0.5 ? frame.partner_clip : frame.clip];
  }
  nlohmann::json times = nlohmann::json::object();
  for (const auto& [clip, frame_count] : count) {
    times[clip] = static_cast<double>(frame_count) / frames_per_second;
  }
  return times;
}

nlohmann::json make_report(const PlayStageOptions& options, const SurfaceMotionGraph& graph,
                           const EndlessPlay& play, const MeshSequence& animation,
                           const std::vector<MeasuredJoin>& joins, double captured, std::size_t left_out,
                           double seconds) {
  const MotionPath& path = play.path;
  double peak = 0.0;
  for (const MeasuredJoin& join : joins) peak = std::max(peak, join.peak_acceleration);
  nlohmann::json report = {{"from", options.from},
                           {"mode", mode_name(options.play.mode)},
                           {"without", options.without},
                           {"distance", path.distance},
                           {"time", path.time},
                           {"frame_count", path.frame_count},
                           {"transition_cost", path.costs.transitions},
                           {"captured_acceleration", captured},
                           {"peak_acceleration", peak},
                           {"joins_left_out", left_out},
                           {"seconds", seconds},
                           {"metric", graph.metric},
                           {"database_hash", graph.database_hash},
                           {"clips", clip_times(animation.origins(), animation.frames_per_second())},
                           {"transitions", describe_transitions(path, graph)},
                           {"frames", describe_frames(animation.origins())}};
  report["pop_ratio"] = captured > 0.0 ? nlohmann::json(peak / captured) : nlohmann::json();
  // JSON has no infinity: what is not limited is null.
  const auto limit = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  };
  report["max_pop_ratio"] = limit(options.max_pop_ratio);
  report["max_transition_cost"] = limit(options.play.max_transition_cost);
  if (options.play.mode == PlayOptions::Mode::stochastic) {
    report["seed"] = options.play.seed;
    report["temperature"] = options.play.temperature;
    report["foresight"] = options.play.foresight;
    return report;
  }
  const GroundTransform& round = play.start_from_next;
  report["loop"] = {{"first_frame", play.loop_start},
                    {"period", play.period},
                    {"cost", play.loop_cost},
                    {"cost_per_second", play.loop_cost * animation.frames_per_second() / play.period},
                    {"yaw", round.yaw},
                    {"translation", {round.translation.x(), round.translation.y()}}};
  return report;
}

}  // namespace

tl::expected<PlayResult, NoPath> run_play(const PerformanceDatabase& database,
                                          const SurfaceMotionGraph& graph, const PlayStageOptions& options) {
  check_graph_fits(graph, database);
  if (!(options.max_pop_ratio >= 0.0)) {
    throw InvalidArgument(
        fmt::format("greatest pop ratio: expected a number of at least 0, found {}", options.max_pop_ratio));
  }
  const auto start = std::chrono::steady_clock::now();
  const FrameId from = database.parse_frame(options.from);
  const double captured = captured_acceleration(database);
  PlayOptions play_options = options.play;
  play_options.forbidden_clips.clear();
  for (const std::string& clip : options.without)
    play_options.forbidden_clips.push_back(database.clip_idx(clip));
  // Captures that stand still accelerate nothing, and nothing can be said of a ratio to that.
  const double limit = captured > 0.0 ? options.max_pop_ratio * captured : unlimited;
  play_options.max_peak_acceleration = limit;

  const PathMetrics metrics = path_metrics(database, graph);
  const Synthesizer synthesizer(database);
  std::vector<bool> pops(metrics.transitions().size(), false);
  for (std::size_t left_out = 0;;) {
    auto play = play_endlessly(metrics.without(pops), from, play_options, database.clip_names());
    if (!play) return tl::make_unexpected(std::move(play.error()));
    PlayResult result{.play = std::move(*play), .animation = {}, .report = {}};
    result.animation =
        synthesizer.synthesize(result.play.path, {.profile = graph.options.profile, .name = options.name});
    const std::vector<MeasuredJoin> joins = measure_joins(result.play.path, result.animation);
    const std::size_t found = mark_pops(joins, limit, metrics.transitions(), pops);
    if (found == 0) {
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      result.report =
          make_report(options, graph, result.play, result.animation, joins, captured, left_out, seconds);
      return result;
    }
    left_out += found;
    spdlog::debug("{} joins pop more than their samples said: play begins anew without them", found);
  }
}

}  // namespace reprise
