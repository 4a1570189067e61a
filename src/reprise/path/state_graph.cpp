// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/state_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace reprise::path_detail {
namespace {

int frame_of(const FrameId& keyframe) {
  return static_cast<int>(keyframe.frame_idx);
}

// Indices of the transitions that touch no forbidden clip, for each source clip.
std::vector<std::vector<std::size_t>> allowed_transitions(const PathMetrics& metrics,
                                                          const std::vector<std::size_t>& forbidden_clips) {
  std::vector<std::vector<std::size_t>> leaving(metrics.clip_count());
  const auto forbidden = [&](std::size_t clip_idx) {
    return std::ranges::count(forbidden_clips, clip_idx) > 0;
  };
  for (std::size_t i = 0; i < metrics.transitions().size(); ++i) {
    const Transition& transition = metrics.transitions()[i];
    if (forbidden(transition.source_clip) || forbidden(transition.target_clip)) continue;
    leaving[transition.source_clip].push_back(i);
  }
  return leaving;
}

// Frames of each clip at which a walk has something to decide, ascending.
std::vector<std::vector<int>> decision_frames(const PathMetrics& metrics,
                                              const std::vector<std::vector<std::size_t>>& leaving,
                                              const std::vector<FrameId>& keyframes) {
  std::vector<std::vector<int>> frames(metrics.clip_count());
  for (std::size_t clip_idx = 0; clip_idx < leaving.size(); ++clip_idx) {
    for (const std::size_t i : leaving[clip_idx])
      frames[clip_idx].push_back(metrics.transitions()[i].leave());
  }
  for (const FrameId& keyframe : keyframes) frames[keyframe.clip_idx].push_back(frame_of(keyframe));
  for (std::vector<int>& of_clip : frames) {
    std::sort(of_clip.begin(), of_clip.end());
    of_clip.erase(std::unique(of_clip.begin(), of_clip.end()), of_clip.end());
  }
  return frames;
}

// The nearest multiple of 2^-42 (2e-13). Sums of such numbers are exact up to 2048, so that walks that take
// the same edges in another order have equal sums, and all but one of them are dropped. The error, 1e-13 an
// edge, is far below `cost_tolerance`.
double rounded(double value) {
  return std::ldexp(std::nearbyint(std::ldexp(value, 42)), -42);
}

struct RawEdge {
  std::int32_t source = 0;
  StateEdge edge;
};

constexpr std::int32_t end_of_path = -1;

// Removes the nodes from which the end cannot be reached and numbers the others, the end last.
StateGraph pruned(std::size_t node_count, const std::vector<RawEdge>& raw) {
  std::vector<std::vector<std::int32_t>> sources(node_count);
  std::vector<std::int32_t> open;
  std::vector<bool> leads_to_end(node_count, false);
  const auto mark = [&](std::int32_t node) {
    if (leads_to_end[static_cast<std::size_t>(node)]) return;
    leads_to_end[static_cast<std::size_t>(node)] = true;
    open.push_back(node);
  };
  for (const RawEdge& edge : raw) {
    if (edge.edge.target == end_of_path) {
      mark(edge.source);
    } else {
      sources[static_cast<std::size_t>(edge.edge.target)].push_back(edge.source);
    }
  }
  while (!open.empty()) {
    const std::int32_t node = open.back();
    open.pop_back();
    for (const std::int32_t source : sources[static_cast<std::size_t>(node)]) mark(source);
  }
  StateGraph graph;
  if (!leads_to_end[0]) return graph;

  std::vector<std::int32_t> new_from_old(node_count, -1);
  std::int32_t kept = 0;
  for (std::size_t i = 0; i < node_count; ++i) {
    if (leads_to_end[i]) new_from_old[i] = kept++;
  }
  // `raw` lists edges by ascending source.
  std::size_t next = 0;
  for (std::size_t i = 0; i < node_count; ++i) {
    if (leads_to_end[i]) graph.first_edge.push_back(static_cast<std::int32_t>(graph.edges.size()));
    for (; next < raw.size() && raw[next].source == static_cast<std::int32_t>(i); ++next) {
      StateEdge edge = raw[next].edge;
      edge.target = edge.target == end_of_path ? kept : new_from_old[static_cast<std::size_t>(edge.target)];
      if (leads_to_end[i] && edge.target >= 0) graph.edges.push_back(edge);
    }
  }
  graph.first_edge.insert(graph.first_edge.end(), 2, static_cast<std::int32_t>(graph.edges.size()));
  return graph;
}

}  // namespace

// Key-frames are shown greedily: whenever the next one due is met as a pure frame, it counts as shown. That
// is optimal, because showing changes neither distance nor time nor cost, and greedy stays ahead. Let any
// valid choice show key-frame i of the same walk at frame a_i of the walk, a_0 < a_1 < ...; greedy shows it
// at g_i <= a_i: true for i = 0, and if g_{i-1} <= a_{i-1} < a_i, then key-frame i is met at a_i > g_{i-1} at
// the latest, so g_i <= a_i. Hence a walk that is valid at all is valid with the greedy choice. Only the last
// key-frame is a choice: the path may end there or pass it and come back, so it gets an edge of each kind.
//
// Compulsory clips likewise: a clip counts as shown once the walk has come to it.
StateGraph build_state_graph(const PathMetrics& metrics, const KeyframeQuery& query) {
  const std::vector<FrameId>& keyframes = query.keyframes;
  const std::vector<std::vector<std::size_t>> leaving = allowed_transitions(metrics, query.forbidden_clips);
  const std::vector<std::vector<int>> frames = decision_frames(metrics, leaving, keyframes);
  const std::size_t last = keyframes.size() - 1;
  const auto with_clip = [&](std::uint32_t clips, std::size_t clip_idx) {
    for (std::size_t i = 0; i < query.compulsory_clips.size(); ++i) {
      if (query.compulsory_clips[i] == clip_idx) clips |= std::uint32_t{1} << i;
    }
    return clips;
  };
  std::uint32_t all_clips = 0;
  for (const std::size_t clip_idx : query.compulsory_clips) all_clips = with_clip(all_clips, clip_idx);

  struct Node {
    std::size_t shown = 1;
    std::uint32_t clips = 0;  // compulsory ones shown, one bit each
    std::size_t clip_idx = 0;
    std::size_t position = 0;  // in `frames` of the clip
    auto operator<=>(const Node&) const = default;
  };
  std::vector<Node> nodes;
  std::map<Node, std::int32_t> idx_from_node;
  const auto node_idx = [&](const Node& node) {
    const auto [found, inserted] = idx_from_node.try_emplace(node, static_cast<std::int32_t>(nodes.size()));
    if (inserted) nodes.push_back(node);
    return found->second;
  };
  const auto position_of = [&](std::size_t clip_idx, int frame) {
    const std::vector<int>& of_clip = frames[clip_idx];
    return static_cast<std::size_t>(std::lower_bound(of_clip.begin(), of_clip.end(), frame) -
                                    of_clip.begin());
  };

  std::vector<RawEdge> raw;
  // Adds the edge that is at `frame` of a clip after `edge` and plays on to the next decision, if there is
  // one.
  const auto add_edge = [&](std::int32_t source, std::size_t clip_idx, int frame, int first_target,
                            StateEdge edge) {
    Node target = nodes[static_cast<std::size_t>(source)];
    target.clips = with_clip(target.clips, clip_idx);
    target.clip_idx = clip_idx;
    target.position = position_of(clip_idx, first_target);
    if (target.position == frames[clip_idx].size()) return;  // nothing but the end of the clip ahead
    const int target_frame = frames[clip_idx][target.position];
    edge.steps += target_frame - frame;
    edge.distance += metrics.clip_distance(clip_idx, frame, target_frame);
    edge.distance = rounded(edge.distance);
    const FrameId due = keyframes[std::min(target.shown, last)];
    if (due.clip_idx == clip_idx && frame_of(due) == target_frame) {
      if (target.shown == last) {
        if (target.clips == all_clips) {
          edge.target = end_of_path;
          raw.push_back({source, edge});
        }
      } else {
        ++target.shown;
      }
    }
    edge.target = node_idx(target);
    raw.push_back({source, edge});
  };

  node_idx({1, with_clip(0, keyframes[0].clip_idx), keyframes[0].clip_idx,
            position_of(keyframes[0].clip_idx, frame_of(keyframes[0]))});
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node node = nodes[i];
    const auto source = static_cast<std::int32_t>(i);
    const int frame = frames[node.clip_idx][node.position];
    add_edge(source, node.clip_idx, frame, frame + 1, {});
    for (const std::size_t transition_idx : leaving[node.clip_idx]) {
      const Transition& transition = metrics.transitions()[transition_idx];
      if (transition.leave() != frame) continue;
      StateEdge edge;
      edge.steps = 2 * transition.half_window;
      edge.transition = static_cast<std::int32_t>(transition_idx);
      edge.distance = metrics.blend_distance(transition_idx);
      edge.cost = rounded(transition.cost);
      add_edge(source, transition.target_clip, transition.arrive(), transition.arrive(), edge);
    }
  }
  return pruned(nodes.size(), raw);
}

namespace {

constexpr int never = std::numeric_limits<int>::max();

// For each clip the earliest frame at which some transition enters it, once `from` has been shown.
std::vector<int> earliest_entries(const PathMetrics& metrics, const FrameId& from) {
  std::vector<int> entry(metrics.clip_count(), never);
  for (bool changed = true; changed;) {
    changed = false;
    for (const Transition& transition : metrics.transitions()) {
      const int earliest = std::min(entry[transition.source_clip],
                                    transition.source_clip == from.clip_idx ? frame_of(from) : never);
      if (transition.leave() >= earliest && transition.arrive() < entry[transition.target_clip]) {
        entry[transition.target_clip] = transition.arrive();
        changed = true;
      }
    }
  }
  return entry;
}

// For each clip the latest frame from which `to` can still be shown, or -1.
std::vector<int> latest_departures(const PathMetrics& metrics, const FrameId& to) {
  std::vector<int> latest(metrics.clip_count(), -1);
  latest[to.clip_idx] = frame_of(to);
  for (bool changed = true; changed;) {
    changed = false;
    for (const Transition& transition : metrics.transitions()) {
      if (transition.arrive() <= latest[transition.target_clip] &&
          transition.leave() > latest[transition.source_clip]) {
        latest[transition.source_clip] = transition.leave();
        changed = true;
      }
    }
  }
  return latest;
}

std::string missing_departure(const PathMetrics& metrics, const FrameId& from, const std::string& name) {
  int latest = -1;
  for (const Transition& transition : metrics.transitions()) {
    if (transition.source_clip == from.clip_idx) latest = std::max(latest, transition.leave());
  }
  if (latest < 0) return fmt::format("; no transition leaves '{}'", name);
  if (latest >= frame_of(from)) return {};
  return fmt::format("; no transition leaves '{}' at or after frame {} (the last one leaves at frame {})",
                     name, frame_of(from), latest);
}

std::string missing_arrival(const PathMetrics& metrics, const FrameId& to, const std::string& name) {
  int earliest = never;
  for (const Transition& transition : metrics.transitions()) {
    if (transition.target_clip == to.clip_idx) earliest = std::min(earliest, transition.arrive());
  }
  if (earliest == never) return fmt::format("; no transition arrives in '{}'", name);
  if (earliest <= frame_of(to)) return {};
  return fmt::format(
      "; no transition arrives in '{}' at or before frame {} (the first one arrives at frame {})", name,
      frame_of(to), earliest);
}

// Why key-frame `position` + 1 cannot be reached from the one before it; empty if it can.
std::string explain_pair(const PathMetrics& metrics, const FrameId& from, const FrameId& to,
                         std::size_t position, const std::vector<std::string>& clip_names) {
  const std::vector<int> entry = earliest_entries(metrics, from);
  const bool ahead = from.clip_idx == to.clip_idx && frame_of(to) > frame_of(from);
  if (ahead || entry[to.clip_idx] <= frame_of(to)) return {};

  const std::vector<int> departure = latest_departures(metrics, to);
  std::vector<std::string> reached, leading;
  for (std::size_t clip_idx = 0; clip_idx < metrics.clip_count(); ++clip_idx) {
    const int earliest =
        clip_idx == from.clip_idx ? std::min(entry[clip_idx], frame_of(from)) : entry[clip_idx];
    if (earliest != never)
      reached.push_back(fmt::format("'{}' from frame {}", clip_names[clip_idx], earliest));
    if (departure[clip_idx] >= 0) {
      leading.push_back(fmt::format("'{}' up to frame {}", clip_names[clip_idx], departure[clip_idx]));
    }
  }
  std::string missing = missing_departure(metrics, from, clip_names[from.clip_idx]) +
                        missing_arrival(metrics, to, clip_names[to.clip_idx]);
  if (missing.empty()) missing = "; no transition joins the one to the other";
  return fmt::format(
      "key-frame {} ({}:{}) cannot be reached from key-frame {} ({}:{}): the first leads to {}; the second "
      "is reached "
      "from {}{}",
      position + 2, clip_names[to.clip_idx], to.frame_idx, position + 1, clip_names[from.clip_idx],
      from.frame_idx, fmt::join(reached, ", "), fmt::join(leading, ", "), missing);
}

}  // namespace

std::string explain_no_path(const PathMetrics& metrics, const KeyframeQuery& query,
                            const std::vector<std::string>& clip_names) {
  std::vector<bool> barred(metrics.transitions().size(), true);
  for (const std::vector<std::size_t>& allowed : allowed_transitions(metrics, query.forbidden_clips)) {
    for (const std::size_t i : allowed) barred[i] = false;
  }
  const PathMetrics open = metrics.without(barred);
  const std::string without_forbidden = query.forbidden_clips.empty() ? "" : " without the forbidden clips";
  for (std::size_t i = 0; i + 1 < query.keyframes.size(); ++i) {
    const std::string reason = explain_pair(open, query.keyframes[i], query.keyframes[i + 1], i, clip_names);
    if (!reason.empty()) return reason + without_forbidden;
  }
  for (const std::size_t clip_idx : query.compulsory_clips) {
    KeyframeQuery alone = query;
    alone.compulsory_clips = {clip_idx};
    if (build_state_graph(metrics, alone).empty()) {
      return fmt::format("no path through the key-frames shows the compulsory clip '{}'{}",
                         clip_names[clip_idx], without_forbidden);
    }
  }
  if (query.compulsory_clips.size() > 1) {
    return fmt::format("no path through the key-frames shows all of the compulsory clips{}",
                       without_forbidden);
  }
  return "the graph has no path through the key-frames" + without_forbidden;
}

}  // namespace reprise::path_detail
