// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/graph_components.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr std::int32_t none = -1;

// The frames at which something happens: a transition leaves or arrives. Between them a walk plays on.
struct Node {
  std::size_t clip_idx = 0;
  int frame = 0;
  auto operator<=>(const Node&) const = default;
};

class DecisionGraph {
 public:
  explicit DecisionGraph(std::span<const Transition> transitions) {
    for (const Transition& t : transitions) {
      nodes_.push_back({t.source_clip, t.leave()});
      nodes_.push_back({t.target_clip, t.arrive()});
    }
    std::ranges::sort(nodes_);
    nodes_.erase(std::ranges::unique(nodes_).begin(), nodes_.end());
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    for (std::int32_t node = 0; node + 1 < size(); ++node) {
      if (at(node).clip_idx == at(node + 1).clip_idx) edges.emplace_back(node, node + 1);
    }
    for (const Transition& t : transitions) edges.emplace_back(leave(t), arrive(t));
    std::ranges::sort(edges);
    first_.assign(nodes_.size() + 1, 0);
    for (const auto& [from, to] : edges) {
      ++first_[static_cast<std::size_t>(from) + 1];
      targets_.push_back(to);
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
  }

  std::int32_t size() const { return static_cast<std::int32_t>(nodes_.size()); }
  const Node& at(std::int32_t node) const { return nodes_[static_cast<std::size_t>(node)]; }
  std::span<const std::int32_t> targets(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return std::span(targets_).subspan(first_[n], first_[n + 1] - first_[n]);
  }
  std::int32_t leave(const Transition& t) const { return find({t.source_clip, t.leave()}); }
  std::int32_t arrive(const Transition& t) const { return find({t.target_clip, t.arrive()}); }
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::int32_t find(const Node& node) const {
    return static_cast<std::int32_t>(std::ranges::lower_bound(nodes_, node) - nodes_.begin());
  }

  std::vector<Node> nodes_;
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> targets_;
};

// Tarjan's algorithm, without recursion. Numbers of components; an edge leads to the same or a lower one.
std::vector<std::int32_t> strong_components(const DecisionGraph& graph) {
  struct Visit {
    std::int32_t node;
    std::size_t next = 0;  // edge to follow
  };
  const auto size = static_cast<std::size_t>(graph.size());
  std::vector<std::int32_t> component(size, none);
  std::vector<std::int32_t> order(size, none);
  std::vector<std::int32_t> low(size, none);
  std::vector<std::int32_t> open;
  std::vector<Visit> visits;
  std::int32_t count = 0;
  std::int32_t clock = 0;
  const auto index = [](std::int32_t node) { return static_cast<std::size_t>(node); };
  for (std::int32_t root = 0; root < graph.size(); ++root) {
    if (order[index(root)] != none) continue;
    visits.push_back({root});
    while (!visits.empty()) {
      const std::int32_t node = visits.back().node;
      if (visits.back().next == 0 && order[index(node)] == none) {
        order[index(node)] = low[index(node)] = clock++;
        open.push_back(node);
      }
      const auto targets = graph.targets(node);
      if (visits.back().next < targets.size()) {
        const std::int32_t target = targets[visits.back().next++];
        if (order[index(target)] == none) {
          visits.push_back({target});
        } else if (component[index(target)] == none) {
          low[index(node)] = std::min(low[index(node)], order[index(target)]);
        }
        continue;
      }
      visits.pop_back();
      if (!visits.empty()) {
        std::int32_t& parent = low[index(visits.back().node)];
        parent = std::min(parent, low[index(node)]);
      }
      if (low[index(node)] != order[index(node)]) continue;
      for (std::int32_t member = none; member != node;) {
        member = open.back();
        open.pop_back();
        component[index(member)] = count;
      }
      ++count;
    }
  }
  return component;
}

void check(std::span<const int> frame_counts, std::span<const Transition> transitions) {
  for (const Transition& t : transitions) {
    if (t.source_clip >= frame_counts.size() || t.target_clip >= frame_counts.size()) {
      throw InvalidArgument(fmt::format("a transition from clip {} to clip {}, but there are {} clips",
                                        t.source_clip, t.target_clip, frame_counts.size()));
    }
    if (t.leave() < 0 || t.arrive() >= frame_counts[t.target_clip] ||
        t.leave() >= frame_counts[t.source_clip] || t.arrive() < 0) {
      throw InvalidArgument(fmt::format(
          "a transition leaves clip {} at frame {} of {} and arrives in clip {} at frame {} of {}",
          t.source_clip, t.leave(), frame_counts[t.source_clip], t.target_clip, t.arrive(),
          frame_counts[t.target_clip]));
    }
  }
}

class Analysis {
 public:
  Analysis(std::span<const int> frame_counts, std::span<const Transition> transitions)
      : frame_counts_(frame_counts),
        transitions_(transitions),
        graph_(transitions),
        strong_(strong_components(graph_)) {
    find_cores();
    spread();
  }

  GraphComponents result() {
    GraphComponents result;
    for (const Transition& t : transitions_) {
      result.goes_on.push_back(goes_on_[index(graph_.arrive(t))]);
      result.comes_from.push_back(comes_from_[index(graph_.leave(t))]);
    }
    collect_components(result);
    collect_parts(result);
    return result;
  }

 private:
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  bool is_core(std::int32_t node) const { return is_core_[index(strong_[index(node)])]; }

  // A component has a way from a node to itself.
  void find_cores() {
    is_core_.assign(strong_.size(), false);
    for (std::int32_t node = 0; node < graph_.size(); ++node) {
      for (const std::int32_t target : graph_.targets(node)) {
        if (strong_[index(target)] == strong_[index(node)]) is_core_[index(strong_[index(node)])] = true;
      }
    }
  }

  // What is true of one node of a component is true of all.
  void spread() {
    std::vector<std::int32_t> nodes(strong_.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    std::ranges::stable_sort(nodes, {}, [&](std::int32_t node) { return strong_[index(node)]; });
    std::vector<bool> on(strong_.size());
    std::vector<bool> from(strong_.size());
    // Edges lead to lower numbers: those first.
    for (const std::int32_t node : nodes) {
      const std::size_t own = index(strong_[index(node)]);
      if (is_core_[own]) on[own] = true;
      for (const std::int32_t target : graph_.targets(node)) {
        if (on[index(strong_[index(target)])]) on[own] = true;
      }
    }
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
      const std::size_t own = index(strong_[index(*node)]);
      if (!is_core_[own] && !from[own]) continue;
      from[own] = true;
      for (const std::int32_t target : graph_.targets(*node)) from[index(strong_[index(target)])] = true;
    }
    for (const std::int32_t own : strong_) {
      goes_on_.push_back(on[index(own)]);
      comes_from_.push_back(from[index(own)]);
    }
  }

  void collect_components(GraphComponents& result) {
    std::vector<GraphComponent> components(strong_.size());
    for (std::int32_t node = 0; node < graph_.size(); ++node) {
      if (!is_core(node)) continue;
      // Frames between two of a component belong to it, and nodes come in order.
      std::vector<FrameRange>& ranges = components[index(strong_[index(node)])].ranges;
      const auto& [clip_idx, frame] = graph_.at(node);
      if (ranges.empty() || ranges.back().clip_idx != clip_idx) ranges.push_back({clip_idx, frame, frame});
      ranges.back().last = frame;
    }
    for (std::size_t i = 0; i < transitions_.size(); ++i) {
      const std::int32_t from = strong_[index(graph_.leave(transitions_[i]))];
      if (from == strong_[index(graph_.arrive(transitions_[i]))] && is_core_[index(from)]) {
        components[index(from)].transitions.push_back(i);
      }
    }
    std::vector<std::int32_t> ranked;
    for (std::int32_t c = 0; index(c) < components.size(); ++c) {
      if (is_core_[index(c)]) ranked.push_back(c);
    }
    std::ranges::sort(ranked, {}, [&](std::int32_t c) {
      int frames = 0;
      const std::vector<FrameRange>& ranges = components[index(c)].ranges;
      for (const FrameRange& range : ranges) frames += range.last - range.first + 1;
      return std::tuple(-frames, ranges.front().clip_idx, ranges.front().first);
    });
    number_.assign(components.size(), none);
    for (std::size_t i = 0; i < ranked.size(); ++i) number_[index(ranked[i])] = static_cast<std::int32_t>(i);
    for (const std::int32_t c : ranked) result.components.push_back(std::move(components[index(c)]));
    for (GraphComponent& component : result.components) component.leads_to = ways_out(component);
  }

  std::vector<std::size_t> ways_out(const GraphComponent& component) const {
    const FrameRange& range = component.ranges.front();
    const auto start = std::ranges::lower_bound(graph_.nodes(), Node{range.clip_idx, range.first});
    std::vector<std::int32_t> stack = {static_cast<std::int32_t>(start - graph_.nodes().begin())};
    const std::int32_t own = strong_[index(stack.front())];
    std::vector<bool> is_seen(strong_.size());
    is_seen[index(stack.front())] = true;
    std::vector<std::size_t> reached;
    while (!stack.empty()) {
      const std::int32_t node = stack.back();
      stack.pop_back();
      if (is_core(node) && strong_[index(node)] != own)
        reached.push_back(index(number_[index(strong_[index(node)])]));
      for (const std::int32_t target : graph_.targets(node)) {
        if (is_seen[index(target)]) continue;
        is_seen[index(target)] = true;
        stack.push_back(target);
      }
    }
    std::ranges::sort(reached);
    reached.erase(std::ranges::unique(reached).begin(), reached.end());
    return reached;
  }

  void collect_parts(GraphComponents& result) const {
    std::int32_t next = 0;  // first node at or after the frame
    for (std::size_t clip_idx = 0; clip_idx < frame_counts_.size(); ++clip_idx) {
      const std::int32_t first_of_clip = next;
      const std::size_t first_part = result.parts.size();
      for (int frame = 0; frame < frame_counts_[clip_idx]; ++frame) {
        const auto is_of_clip = [&](std::int32_t node) {
          return node >= first_of_clip && node < graph_.size() && graph_.at(node).clip_idx == clip_idx;
        };
        while (is_of_clip(next) && graph_.at(next).frame < frame) ++next;
        const std::int32_t at_or_before =
            is_of_clip(next) && graph_.at(next).frame == frame ? next : next - 1;
        const std::int32_t at_or_after = is_of_clip(next) ? next : none;
        const bool goes_on = at_or_after != none && goes_on_[index(at_or_after)];
        const bool comes_from = is_of_clip(at_or_before) && comes_from_[index(at_or_before)];
        ClipPart part{.range = {clip_idx, frame, frame}, .kind = kind(goes_on, comes_from)};
        if (goes_on && comes_from && is_core(at_or_after) &&
            strong_[index(at_or_after)] == strong_[index(at_or_before)]) {
          part.kind = ClipPart::Kind::core;
          part.component = index(number_[index(strong_[index(at_or_after)])]);
        }
        if (result.parts.size() > first_part && result.parts.back().kind == part.kind &&
            result.parts.back().component == part.component) {
          result.parts.back().range.last = frame;
        } else {
          result.parts.push_back(part);
        }
      }
      while (next < graph_.size() && graph_.at(next).clip_idx == clip_idx) ++next;
    }
  }

  static ClipPart::Kind kind(bool goes_on, bool comes_from) {
    if (goes_on) return comes_from ? ClipPart::Kind::passage : ClipPart::Kind::lead_in;
    return comes_from ? ClipPart::Kind::lead_out : ClipPart::Kind::apart;
  }

  std::span<const int> frame_counts_;
  std::span<const Transition> transitions_;
  DecisionGraph graph_;
  std::vector<std::int32_t> strong_;  // component of each node, by Tarjan's number
  std::vector<bool> is_core_;         // of each component
  std::vector<bool> goes_on_;         // of each node
  std::vector<bool> comes_from_;
  std::vector<std::int32_t> number_;  // of each component, as the user sees it
};

}  // namespace

GraphComponents find_components(std::span<const int> frame_counts, std::span<const Transition> transitions) {
  check(frame_counts, transitions);
  return Analysis(frame_counts, transitions).result();
}

}  // namespace reprise
