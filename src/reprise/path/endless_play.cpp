// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/endless_play.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/random.h"
#include "reprise/path/play_graph.h"

namespace reprise {
namespace {

using path_detail::PlayEdge;
using path_detail::PlayGraph;
using path_detail::PlayWay;

void check_at_least(const char* name, double value, double least, bool may_be_infinite) {
  if (!(value >= least) || (!may_be_infinite && !std::isfinite(value))) {
    throw InvalidArgument(fmt::format("{}: expected a number of at least {}, found {}", name, least, value));
  }
}

void validate(const PathMetrics& metrics, const FrameId& from, const PlayOptions& options,
              const std::vector<std::string>& clip_names) {
  if (clip_names.size() != metrics.clip_count()) {
    throw InvalidArgument(
        fmt::format("clip_names: expected {} names, found {}", metrics.clip_count(), clip_names.size()));
  }
  if (from.clip_idx >= metrics.clip_count()) {
    throw InvalidArgument(fmt::format("first frame: expected a clip index below {}, found {}",
                                      metrics.clip_count(), from.clip_idx));
  }
  if (from.frame_idx >= static_cast<std::size_t>(metrics.frame_count(from.clip_idx))) {
    throw InvalidArgument(fmt::format("first frame: expected a frame of '{}' below {}, found {}",
                                      clip_names[from.clip_idx], metrics.frame_count(from.clip_idx),
                                      from.frame_idx));
  }
  check_at_least("time", options.time, 0.0, false);
  check_at_least("temperature", options.temperature, 0.0, false);
  check_at_least("greatest transition cost", options.max_transition_cost, 0.0, true);
  check_at_least("greatest peak acceleration", options.max_peak_acceleration, 0.0, true);
  if (!(options.foresight > 0.0) || !std::isfinite(options.foresight)) {
    throw InvalidArgument(
        fmt::format("foresight: expected a time above 0 seconds, found {}", options.foresight));
  }
  for (const std::size_t clip_idx : options.forbidden_clips) {
    if (clip_idx >= metrics.clip_count()) {
      throw InvalidArgument(fmt::format("forbidden clip: expected a clip index below {}, found {}",
                                        metrics.clip_count(), clip_idx));
    }
  }
}

std::vector<bool> allowed_transitions(const PathMetrics& metrics, const FrameId& from,
                                      const PlayOptions& options) {
  const auto is_forbidden = [&](std::size_t clip_idx) {
    return std::ranges::count(options.forbidden_clips, clip_idx) > 0;
  };
  std::vector<bool> allowed;
  for (const Transition& transition : metrics.transitions()) {
    allowed.push_back(transition.cost <= options.max_transition_cost &&
                      transition.peak_acceleration <= options.max_peak_acceleration &&
                      !is_forbidden(transition.target_clip) &&
                      (transition.source_clip == from.clip_idx || !is_forbidden(transition.source_clip)));
  }
  return allowed;
}

NoPath explain_dead_end(const PathMetrics& metrics, const FrameId& from, const std::vector<bool>& allowed,
                        const std::vector<std::string>& clip_names) {
  const std::string& name = clip_names[from.clip_idx];
  std::size_t leaving = 0;
  std::size_t within_limits = 0;
  int last = -1;
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    const Transition& transition = metrics.transitions()[i];
    if (transition.source_clip != from.clip_idx) continue;
    last = std::max(last, transition.leave());
    if (transition.leave() < static_cast<int>(from.frame_idx)) continue;
    ++leaving;
    if (allowed[i]) ++within_limits;
  }
  std::string why;
  if (last < 0) {
    why = fmt::format("no transition leaves '{}'", name);
  } else if (leaving == 0) {
    why = fmt::format("no transition leaves '{}' at or after frame {} (the last one leaves at frame {})",
                      name, from.frame_idx, last);
  } else if (within_limits == 0) {
    why = fmt::format("of the {} transitions that leave '{}' at or after frame {} none is within the limits",
                      leaving, name, from.frame_idx);
  } else {
    why = fmt::format(
        "of the {} transitions that leave '{}' at or after frame {}, {} are within the limits, and none of "
        "these leads to a loop",
        leaving, name, from.frame_idx, within_limits);
  }
  return {fmt::format("every way on from {}:{} ends in a dead end: {}", name, from.frame_idx, why)};
}

// Lays a walk out as segments while it is being made.
class PathBuilder {
 public:
  PathBuilder(const PathMetrics& metrics, const FrameId& from)
      : metrics_(metrics),
        segment_{.clip_idx = from.clip_idx,
                 .first_frame = static_cast<int>(from.frame_idx),
                 .last_frame = static_cast<int>(from.frame_idx),
                 .transition = std::nullopt} {}

  void take(std::int32_t transition_idx) {
    const auto idx = static_cast<std::size_t>(transition_idx);
    const Transition& transition = metrics_.transitions()[idx];
    play_to(transition.leave());
    segment_.transition = transition;
    path_.segments.push_back(segment_);
    path_.costs.transitions += transition.cost;
    path_.distance += metrics_.blend_distance(idx);
    steps_ += 2 * transition.half_window;
    segment_ = {.clip_idx = transition.target_clip,
                .first_frame = transition.arrive(),
                .last_frame = transition.arrive(),
                .transition = std::nullopt};
  }

  void play_to(int frame) {
    path_.distance += metrics_.clip_distance(segment_.clip_idx, segment_.last_frame, frame);
    steps_ += frame - segment_.last_frame;
    segment_.last_frame = frame;
  }

  FrameId at() const { return {segment_.clip_idx, static_cast<std::size_t>(segment_.last_frame)}; }
  int frame_count() const { return steps_ + 1; }

  MotionPath finished() && {
    path_.segments.push_back(segment_);
    path_.frame_count = frame_count();
    path_.time = path_.frame_count / metrics_.frames_per_second();
    path_.cost = path_.costs.total();
    path_.lower_bound = path_.cost;
    return std::move(path_);
  }

 private:
  const PathMetrics& metrics_;
  MotionPath path_;
  PathSegment segment_;
  int steps_ = 0;
};

void follow(PathBuilder& builder, const PlayGraph& graph, const PlayEdge& edge) {
  if (edge.transition >= 0) builder.take(edge.transition);
  builder.play_to(graph.frame_of(edge.target));
}

// The loop once. It is cut in the middle of the longest stretch that it shows as captured, where play goes on
// from frame f to f + 1 of a clip: one round starts at f + 1 and ends at f.
tl::expected<MotionPath, NoPath> one_round(const PathMetrics& metrics, const PlayWay& loop) {
  std::vector<std::int32_t> joins;
  for (const PlayEdge& edge : loop.edges) {
    if (edge.transition >= 0) joins.push_back(edge.transition);
  }
  const auto join = [&](std::size_t i) -> const Transition& {
    return metrics.transitions()[static_cast<std::size_t>(joins[i % joins.size()])];
  };
  std::size_t cut = 0;
  int longest = 0;
  for (std::size_t i = 0; i < joins.size(); ++i) {
    const int stretch = join(i + 1).leave() - join(i).arrive();
    if (stretch > longest) {
      longest = stretch;
      cut = i;
    }
  }
  if (longest == 0) {
    return tl::make_unexpected(NoPath{
        "the cheapest loop shows no two captured frames in a row between its joins, so that it cannot be "
        "cut"});
  }
  const int last = join(cut).arrive() + (longest - 1) / 2;
  PathBuilder builder(metrics, {join(cut).target_clip, static_cast<std::size_t>(last) + 1});
  for (std::size_t i = 1; i <= joins.size(); ++i) builder.take(joins[(cut + i) % joins.size()]);
  builder.play_to(last);
  return std::move(builder).finished();
}

tl::expected<EndlessPlay, NoPath> play_loop(const PathMetrics& metrics, const PlayGraph& graph,
                                            const FrameId& from, std::int32_t start,
                                            const PlayOptions& options) {
  const PlayWay loop = path_detail::cheapest_loop(graph, start);
  EndlessPlay play;
  play.period = static_cast<int>(loop.frames());
  play.loop_cost = loop.cost();

  if (options.mode == PlayOptions::Mode::period) {
    auto path = one_round(metrics, loop);
    if (!path) return tl::make_unexpected(std::move(path.error()));
    play.path = std::move(*path);
    for (const PathSegment& segment : play.path.segments) {
      if (segment.transition)
        play.start_from_next = play.start_from_next * segment.transition->source_from_target;
    }
    return play;
  }
  std::vector<bool> is_entry(static_cast<std::size_t>(graph.node_count()), false);
  is_entry[static_cast<std::size_t>(loop.start)] = true;
  const PlayWay way_in = path_detail::cheapest_way(graph, start, is_entry);
  PathBuilder builder(metrics, from);
  builder.play_to(graph.frame_of(start));
  play.loop_start = builder.frame_count() - 1 + static_cast<int>(way_in.frames());
  const double frames = options.time * metrics.frames_per_second();
  for (std::size_t i = 0; builder.frame_count() < frames; ++i) {
    follow(builder, graph,
           i < way_in.edges.size() ? way_in.edges[i]
                                   : loop.edges[(i - way_in.edges.size()) % loop.edges.size()]);
  }
  play.path = std::move(builder).finished();
  for (const PlayEdge& edge : loop.edges) {
    if (edge.transition < 0) continue;
    play.start_from_next =
        play.start_from_next *
        metrics.transitions()[static_cast<std::size_t>(edge.transition)].source_from_target;
  }
  return play;
}

// The anticipated cost of video textures (Schoedl et al. 2000, 3.2): what the cheapest way on from a node
// costs, a cost t frames away counted decay^t times. What follows a choice is taken to be the best, not
// another draw: that equation has one solution whatever the temperature, and value iteration finds it,
// because every edge lasts a frame or more.
std::vector<double> anticipated_costs(const PlayGraph& graph, double decay) {
  constexpr double tolerance = 1e-9;
  std::vector<double> cost(static_cast<std::size_t>(graph.node_count()), 0.0);
  for (double change = 1.0; change > tolerance * (1.0 - decay);) {
    throw_if_interrupted();
    change = 0.0;
    // Backwards, so that one round reaches the beginning of each clip.
    for (std::int32_t node = graph.node_count() - 1; node >= 0; --node) {
      double least = unlimited;
      for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
        least = std::min(
            least, edge->cost + std::pow(decay, edge->frames) * cost[static_cast<std::size_t>(edge->target)]);
      }
      double& known = cost[static_cast<std::size_t>(node)];
      change = std::max(change, std::abs(least - known));
      known = least;
    }
  }
  return cost;
}

// At every arrival one draw among all joins ahead in the clip: a draw at each of them would make the late
// ones rare whatever they cost.
MotionPath walk_at_random(const PathMetrics& metrics, const PlayGraph& graph, const FrameId& from,
                          const PlayOptions& options) {
  const double decay = std::exp(-1.0 / (options.foresight * metrics.frames_per_second()));
  const std::vector<double> anticipated = anticipated_costs(graph, decay);
  const RandomField random(options.seed);
  PathBuilder builder(metrics, from);
  const double frames = options.time * metrics.frames_per_second();
  struct Choice {
    const PlayEdge* edge;
    double cost;
  };
  std::vector<Choice> choices;
  for (std::uint64_t draw = 0;; ++draw) {
    const FrameId at = builder.at();
    choices.clear();
    double least = unlimited;
    for (std::int32_t node = graph.node_at(at.clip_idx, static_cast<int>(at.frame_idx));
         node < graph.node_count() && graph.clip_of(node) == at.clip_idx; ++node) {
      const double wait = std::pow(decay, graph.frame_of(node) - static_cast<int>(at.frame_idx));
      for (const PlayEdge* edge = graph.begin(node); edge != graph.end(node); ++edge) {
        if (edge->transition < 0) continue;
        const double cost = wait * (edge->cost + std::pow(decay, edge->frames) *
                                                     anticipated[static_cast<std::size_t>(edge->target)]);
        choices.push_back({edge, cost});
        least = std::min(least, cost);
      }
    }
    double total = 0.0;
    const auto weight_of = [&](const Choice& choice) {
      if (options.temperature > 0.0) return std::exp((least - choice.cost) / options.temperature);
      return choice.cost == least ? 1.0 : 0.0;
    };
    for (const Choice& choice : choices) total += weight_of(choice);
    double left = total * random.uniform(draw);
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < choices.size() && left > 0.0; ++i) {
      if (weight_of(choices[i]) > 0.0) chosen = i;
      left -= weight_of(choices[i]);
    }
    const PlayEdge& edge = *choices[chosen].edge;
    const int to_go = static_cast<int>(std::ceil(frames)) - builder.frame_count();
    const int last_frame = static_cast<int>(at.frame_idx) + std::max(to_go, 0);
    if (metrics.transitions()[static_cast<std::size_t>(edge.transition)].leave() >= last_frame) {
      builder.play_to(graph.frame_of(graph.node_at(at.clip_idx, last_frame)));
      return std::move(builder).finished();
    }
    builder.take(edge.transition);
  }
}

}  // namespace

tl::expected<EndlessPlay, NoPath> play_endlessly(const PathMetrics& metrics, const FrameId& from,
                                                 const PlayOptions& options,
                                                 const std::vector<std::string>& clip_names) {
  validate(metrics, from, options, clip_names);
  const std::vector<bool> allowed = allowed_transitions(metrics, from, options);
  const PlayGraph graph(metrics, allowed);
  const std::int32_t start = graph.node_at(from.clip_idx, static_cast<int>(from.frame_idx));
  if (start < 0) return tl::make_unexpected(explain_dead_end(metrics, from, allowed, clip_names));
  if (options.mode == PlayOptions::Mode::stochastic) {
    return EndlessPlay{.path = walk_at_random(metrics, graph, from, options)};
  }
  return play_loop(metrics, graph, from, start, options);
}

}  // namespace reprise
