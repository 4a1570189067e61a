// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/surface_motion_graph.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {
namespace {

std::vector<std::string> names_of(const SurfaceMotionGraph& graph) {
  std::vector<std::string> names;
  for (const GraphClip& clip : graph.clips) names.push_back(clip.name);
  return names;
}

const GraphClip* find_clip(const SurfaceMotionGraph& graph, std::string_view name) {
  const auto found = std::ranges::find(graph.clips, name, &GraphClip::name);
  return found == graph.clips.end() ? nullptr : &*found;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// "walk" or "walk:12".
struct EdgeEnd {
  std::string clip;
  std::optional<std::string_view> frame;
};

EdgeEnd parse_end(std::string_view text) {
  text = trimmed(text);
  const auto colon = text.find(':');  // names hold no colon
  if (colon == std::string_view::npos) return {std::string(text), std::nullopt};
  return {std::string(text.substr(0, colon)), text.substr(colon + 1)};
}

const GraphClip& checked_clip(const SurfaceMotionGraph& graph, const std::string& name) {
  if (const GraphClip* clip = find_clip(graph, name)) return *clip;
  const std::vector<std::string> names = names_of(graph);
  const std::string nearest = nearest_word(name, names);
  throw InvalidArgument(
      nearest.empty() ? fmt::format("there is no clip '{}'; the clips are {}", name, fmt::join(names, ", "))
                      : fmt::format("there is no clip '{}'; did you mean '{}'?", name, nearest));
}

int checked_frame(const GraphClip& clip, std::string_view text) {
  int frame = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame);
  if (error != std::errc() || end != text.data() + text.size() || frame < 0 || frame >= clip.frame_count) {
    throw InvalidArgument(
        fmt::format("clip '{}' has frames 0 to {}, asked for '{}'", clip.name, clip.frame_count - 1, text));
  }
  return frame;
}

}  // namespace

bool SurfaceMotionGraph::is_removed(const Transition& transition) const {
  const std::string& source = clips.at(transition.source_clip).name;
  const std::string& target = clips.at(transition.target_clip).name;
  return std::ranges::any_of(removed, [&](const RemovedEdge& edge) {
    if (edge.source_clip != source || edge.target_clip != target) return false;
    if (edge.m < 0) return true;
    // Transitions of a pair lie at least `separation` apart, so this means one of them, also when it has
    // moved a little.
    return std::abs(edge.m - transition.m) < options.separation &&
           std::abs(edge.n - transition.n) < options.separation;
  });
}

std::vector<Transition> SurfaceMotionGraph::active_transitions() const {
  std::vector<Transition> active;
  std::ranges::copy_if(transitions, std::back_inserter(active),
                       [this](const Transition& transition) { return !is_removed(transition); });
  return active;
}

RemovedEdge parse_edge(const std::string& text, const SurfaceMotionGraph& graph) {
  constexpr std::string_view arrow = "->";
  // A name may hold an arrow of its own: take the arrow that leaves a known clip on both sides, or else the
  // first.
  const std::size_t first = text.find(arrow);
  if (first == std::string::npos) {
    throw InvalidArgument(fmt::format("'{}' is not an edge: expected CLIP->CLIP or CLIP:M->CLIP:N", text));
  }
  std::size_t split = first;
  for (std::size_t at = first; at != std::string::npos; at = text.find(arrow, at + 1)) {
    const std::string_view view = text;
    if (find_clip(graph, parse_end(view.substr(0, at)).clip) != nullptr &&
        find_clip(graph, parse_end(view.substr(at + arrow.size())).clip) != nullptr) {
      split = at;
      break;
    }
  }
  const EdgeEnd source = parse_end(std::string_view(text).substr(0, split));
  const EdgeEnd target = parse_end(std::string_view(text).substr(split + arrow.size()));
  const GraphClip& source_clip = checked_clip(graph, source.clip);
  const GraphClip& target_clip = checked_clip(graph, target.clip);
  if (source.frame.has_value() != target.frame.has_value()) {
    throw InvalidArgument(
        fmt::format("'{}' names a frame of one clip only: expected CLIP->CLIP for all transitions, or "
                    "CLIP:M->CLIP:N for one",
                    text));
  }
  RemovedEdge edge{.source_clip = source.clip, .target_clip = target.clip};
  if (source.frame) {
    edge.m = checked_frame(source_clip, *source.frame);
    edge.n = checked_frame(target_clip, *target.frame);
  }
  return edge;
}

std::string to_string(const Transition& transition, const SurfaceMotionGraph& graph) {
  return fmt::format("{}:{}->{}:{}", graph.clips.at(transition.source_clip).name, transition.m,
                     graph.clips.at(transition.target_clip).name, transition.n);
}

SurfaceMotionGraph build_graph(const PerformanceDatabase& database, std::string metric,
                               std::vector<Transition> transitions, const TransitionOptions& options) {
  SurfaceMotionGraph graph{.database_hash = database.content_hash(), .metric = std::move(metric)};
  for (const MeshSequence& clip : database.clips()) {
    graph.clips.push_back({.name = clip.name(),
                           .frame_count = static_cast<int>(clip.frame_count()),
                           .frames_per_second = clip.frames_per_second()});
  }
  graph.transitions = std::move(transitions);
  graph.options = options;
  return graph;
}

void check_graph_fits(const SurfaceMotionGraph& graph, const PerformanceDatabase& database) {
  for (const GraphClip& clip : graph.clips) {
    const std::vector<std::string> names = database.clip_names();
    const auto found = std::ranges::find(names, clip.name);
    if (found == names.end()) {
      throw InvalidArgument(
          fmt::format("the graph is of another database: it has a clip '{}', the database has {}", clip.name,
                      fmt::join(names, ", ")));
    }
    const MeshSequence& other = database.clip(static_cast<std::size_t>(found - names.begin()));
    if (static_cast<std::size_t>(clip.frame_count) != other.frame_count() ||
        clip.frames_per_second != other.frames_per_second()) {
      throw InvalidArgument(
          fmt::format("the graph is of another database: its clip '{}' has {} frames at {} a second, the "
                      "database's {} at {}",
                      clip.name, clip.frame_count, clip.frames_per_second, other.frame_count(),
                      other.frames_per_second()));
    }
  }
  if (names_of(graph) != database.clip_names()) {
    throw InvalidArgument(
        fmt::format("the graph is of another database: it has the clips {}, the database has {}",
                    fmt::join(names_of(graph), ", "), fmt::join(database.clip_names(), ", ")));
  }
  if (const std::string hash = database.content_hash(); graph.database_hash != hash) {
    throw InvalidArgument(
        fmt::format("the graph was made from other contents of the same clips (database hash {}, now {}): "
                    "make the graph anew",
                    graph.database_hash, hash));
  }
}

}  // namespace reprise
