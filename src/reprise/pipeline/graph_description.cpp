// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/graph/graph_components.h"
#include "reprise/pipeline/graph.h"

namespace reprise {
namespace {

std::string frames(const FrameRange& range) {
  return range.first == range.last ? fmt::format("{}", range.first)
                                   : fmt::format("{} to {}", range.first, range.last);
}

std::string meaning(const ClipPart& part) {
  switch (part.kind) {
    case ClipPart::Kind::core:
      return fmt::format("go on for ever (component {})", *part.component + 1);
    case ClipPart::Kind::lead_in:
      return "only lead in: no walk comes back to them";
    case ClipPart::Kind::passage:
      return "lead from one component to another";
    case ClipPart::Kind::lead_out:
      return "only lead out: every walk ends";
    case ClipPart::Kind::apart:
      return "neither lead in nor out";
  }
  return {};
}

}  // namespace

std::string describe_graph(const SurfaceMotionGraph& graph) {
  const std::vector<GraphEdge> edges = graph.edges();
  const auto count = [&](const auto& is_meant) { return std::ranges::count_if(edges, is_meant); };
  using State = GraphEdge::State;
  using Origin = GraphEdge::Origin;
  std::string text =
      fmt::format("transitions: {} in force ({} protected, {} made by hand), {} removed, {} pruned\n",
                  count([](const GraphEdge& edge) { return edge.state == State::in_force; }),
                  count([](const GraphEdge& edge) { return edge.origin == Origin::kept; }),
                  count([](const GraphEdge& edge) { return edge.origin == Origin::added; }),
                  count([](const GraphEdge& edge) { return edge.state == State::removed; }),
                  count([](const GraphEdge& edge) { return edge.state == State::pruned; }));

  const std::vector<Transition> transitions = graph.active_transitions();
  std::vector<int> frame_counts;
  for (const GraphClip& clip : graph.clips) frame_counts.push_back(clip.frame_count);
  const GraphComponents components = find_components(frame_counts, transitions);
  if (components.components.empty()) text += "components: none, every walk ends\n";
  for (std::size_t c = 0; c < components.components.size(); ++c) {
    const GraphComponent& component = components.components[c];
    int frame_count = 0;
    for (const FrameRange& range : component.ranges) frame_count += range.last - range.first + 1;
    std::vector<std::size_t> next;
    for (const std::size_t other : component.leads_to) next.push_back(other + 1);
    text +=
        fmt::format("component {}: {} frames in {} of {} clips, {} transitions inside{}\n", c + 1,
                    frame_count, component.ranges.size(), graph.clips.size(), component.transitions.size(),
                    next.empty() ? "" : fmt::format(", leads to {}", fmt::join(next, ", ")));
  }
  for (const ClipPart& part : components.parts) {
    text += fmt::format("  {}: frames {} {}\n", graph.clips[part.range.clip_idx].name, frames(part.range),
                        meaning(part));
  }
  const auto dead = static_cast<std::size_t>(std::ranges::count(components.goes_on, false));
  const auto unfed = static_cast<std::size_t>(std::ranges::count(components.comes_from, false));
  text += fmt::format(
      "{} transitions lead to where every walk ends, {} leave where none comes from a component\n", dead,
      unfed);
  return text;
}

}  // namespace reprise
