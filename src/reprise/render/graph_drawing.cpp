// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gvc.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

constexpr std::size_t max_labelled_edges = 20;

// Graphviz keeps global state: one drawing at a time.
std::mutex graphviz_mutex;
std::string graphviz_messages;

int keep_message(char* text) {
  graphviz_messages += text;
  return 0;
}

struct FreeContext {
  void operator()(GVC_t* context) const { gvFreeContext(context); }
};
struct FreeGraph {
  void operator()(Agraph_t* graph) const { agclose(graph); }
};
struct FreeRendering {
  void operator()(char* data) const { gvFreeRenderData(data); }
};

// Backslashes start Graphviz' own escapes ("\N" is the name of the node); control characters are no XML.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  }
  return result;
}

void set(void* object, const char* name, const std::string& value) {
  std::string key = name;
  std::string text = value;
  std::string fallback;
  agsafeset(object, key.data(), text.data(), fallback.data());
}

// The transitions of one ordered pair of clips.
struct Pair {
  std::size_t source = 0;
  std::size_t target = 0;
  std::vector<const Transition*> active;   // best first
  std::vector<const Transition*> removed;  // and pruned ones
};

std::vector<Pair> pairs_of(const SurfaceMotionGraph& graph, const std::vector<GraphEdge>& edges) {
  std::vector<Pair> table(graph.clips.size() * graph.clips.size());
  for (const GraphEdge& edge : edges) {
    const Transition& transition = edge.transition;
    if (transition.source_clip >= graph.clips.size() || transition.target_clip >= graph.clips.size()) {
      throw InvalidArgument(fmt::format("graph: a transition from clip {} to clip {}, but there are {} clips",
                                        transition.source_clip, transition.target_clip, graph.clips.size()));
    }
    Pair& pair = table[transition.source_clip * graph.clips.size() + transition.target_clip];
    pair.source = transition.source_clip;
    pair.target = transition.target_clip;
    (edge.state == GraphEdge::State::in_force ? pair.active : pair.removed).push_back(&transition);
  }
  std::erase_if(table, [](const Pair& pair) { return pair.active.empty() && pair.removed.empty(); });
  return table;
}

std::string line_of(const Transition& transition) {
  return fmt::format("{}→{}, L {}, {:.3f} m", transition.m, transition.n, transition.half_window,
                     transition.cost);
}

std::string tooltip(const SurfaceMotionGraph& graph, const Pair& pair,
                    const std::vector<const Transition*>& transitions, const char* state) {
  std::string text = fmt::format("{} → {}{}", escaped(graph.clips[pair.source].name),
                                 escaped(graph.clips[pair.target].name), state);
  for (const Transition* transition : transitions) text += "\n" + line_of(*transition);
  return text;
}

}  // namespace

void draw_graph(const SurfaceMotionGraph& graph, const std::filesystem::path& svg) {
  const std::vector<GraphEdge> edges = graph.edges();
  const std::vector<Pair> pairs = pairs_of(graph, edges);
  const bool labelled = pairs.size() <= max_labelled_edges;
  double lowest = 0.0;
  double highest = 0.0;
  bool first = true;
  for (const Pair& pair : pairs) {
    if (pair.active.empty()) continue;
    const double cost = pair.active.front()->cost;
    lowest = first ? cost : std::min(lowest, cost);
    highest = first ? cost : std::max(highest, cost);
    first = false;
  }

  const std::lock_guard lock(graphviz_mutex);
  graphviz_messages.clear();
  agseterrf(keep_message);
  const std::unique_ptr<GVC_t, FreeContext> context(gvContext());
  std::string graph_name = "surface motion graph";
  const std::unique_ptr<Agraph_t, FreeGraph> drawing(agopen(graph_name.data(), Agdirected, nullptr));
  set(drawing.get(), "bgcolor", "white");
  set(drawing.get(), "pad", "0.3");
  set(drawing.get(), "charset", "UTF-8");
  set(drawing.get(), "fontname", "Helvetica,Arial,sans-serif");
  // A few clips read best from left to right; many, all linked with all, on a circle.
  if (labelled) {
    set(drawing.get(), "rankdir", "LR");
    set(drawing.get(), "nodesep", "0.7");
    set(drawing.get(), "ranksep", "1.6");
  } else {
    set(drawing.get(), "mindist", "2.2");
    set(drawing.get(), "splines", "true");
  }

  std::vector<Agnode_t*> nodes;
  for (std::size_t c = 0; c < graph.clips.size(); ++c) {
    const GraphClip& clip = graph.clips[c];
    std::string id = fmt::format("clip{}", c);
    Agnode_t* node = agnode(drawing.get(), id.data(), 1);
    const double seconds = clip.frames_per_second > 0.0 ? clip.frame_count / clip.frames_per_second : 0.0;
    set(node, "label", fmt::format("{}\n{} frames, {:.1f} s", escaped(clip.name), clip.frame_count, seconds));
    set(node, "tooltip", escaped(clip.name));
    set(node, "shape", "box");
    set(node, "style", "rounded,filled");
    set(node, "fillcolor", "#eaf1f8");
    set(node, "color", "#34607f");
    set(node, "penwidth", "1.4");
    set(node, "margin", "0.18,0.10");
    set(node, "fontname", "Helvetica,Arial,sans-serif");
    set(node, "fontsize", "13");
    set(node, "fontcolor", "#16303f");
    nodes.push_back(node);
  }
  for (const Pair& pair : pairs) {
    const auto add_edge = [&](const char* kind, const std::string& text) {
      std::string id = fmt::format("{}{}-{}", kind, pair.source, pair.target);
      Agedge_t* edge = agedge(drawing.get(), nodes[pair.source], nodes[pair.target], id.data(), 1);
      set(edge, "fontname", "Helvetica,Arial,sans-serif");
      set(edge, "fontsize", "10");
      set(edge, "tooltip", text);
      set(edge, "arrowsize", "0.7");
      return edge;
    };
    if (!pair.active.empty()) {
      const Transition& best = *pair.active.front();
      Agedge_t* edge = add_edge("edge", tooltip(graph, pair, pair.active, ""));
      // 1 for the cheapest, 0 for the dearest.
      const double ease = highest > lowest ? (highest - best.cost) / (highest - lowest) : 1.0;
      set(edge, "penwidth", fmt::format("{:.2f}", 0.6 + 1.9 * ease));
      // Pale steel to deep blue, so that good transitions stand out of a dense graph.
      const auto mix = [&](double pale, double deep) {
        return static_cast<int>(pale + (deep - pale) * ease);
      };
      set(edge, "color", fmt::format("#{:02x}{:02x}{:02x}", mix(185, 31), mix(199, 88), mix(212, 135)));
      if (labelled) {
        set(edge, "fontcolor", "#33475a");
        set(edge, "label", fmt::format("{} (best {})", pair.active.size(), line_of(best)));
      }
    }
    if (!pair.removed.empty()) {
      Agedge_t* edge = add_edge("removed", tooltip(graph, pair, pair.removed, " (removed)"));
      set(edge, "style", "dashed");
      set(edge, "color", "#a8a8a8");
      if (labelled) {
        set(edge, "fontcolor", "#8a8a8a");
        set(edge, "label", fmt::format("{} removed", pair.removed.size()));
      }
    }
  }

  const char* layout = labelled ? "dot" : "circo";
  if (gvLayout(context.get(), drawing.get(), layout) != 0) {
    throw FileError(svg, fmt::format("the graph cannot be drawn: Graphviz layout '{}' failed: {}", layout,
                                     graphviz_messages));
  }
  char* rendering = nullptr;
  unsigned int length = 0;
  const int status = gvRenderData(context.get(), drawing.get(), "svg", &rendering, &length);
  const std::unique_ptr<char, FreeRendering> owned(rendering);
  gvFreeLayout(context.get(), drawing.get());
  if (status != 0 || rendering == nullptr) {
    throw FileError(
        svg, fmt::format("the graph cannot be drawn: Graphviz cannot write SVG: {}", graphviz_messages));
  }
  write_text_file(svg, {rendering, length});
}

}  // namespace reprise
