// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/surface_motion_graph.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/graph/graph_components.h"

namespace reprise {
namespace {

std::vector<std::string> names_of(const SurfaceMotionGraph& graph) {
  std::vector<std::string> names;
  for (const GraphClip& clip : graph.clips) names.push_back(clip.name);
  return names;
}

std::vector<Transition> in_force(const std::vector<GraphEdge>& edges) {
  std::vector<Transition> transitions;
  for (const GraphEdge& edge : edges) {
    if (edge.state == GraphEdge::State::in_force) transitions.push_back(edge.transition);
  }
  return transitions;
}

void prune(const SurfaceMotionGraph& graph, std::vector<GraphEdge>& edges) {
  std::vector<int> frame_counts;
  for (const GraphClip& clip : graph.clips) frame_counts.push_back(clip.frame_count);
  const GraphComponents components = find_components(frame_counts, in_force(edges));
  std::size_t i = 0;
  for (GraphEdge& edge : edges) {
    if (edge.state != GraphEdge::State::in_force) continue;
    const bool is_end =
        !components.goes_on[i] || (graph.pruning == Pruning::both_ends && !components.comes_from[i]);
    ++i;
    if (is_end && edge.origin == GraphEdge::Origin::found) edge.state = GraphEdge::State::pruned;
  }
}

}  // namespace

bool SurfaceMotionGraph::is_removed(const Transition& transition) const {
  return std::ranges::any_of(removed,
                             [&](const EdgePattern& pattern) { return matches(pattern, transition, *this); });
}

std::vector<GraphEdge> SurfaceMotionGraph::edges() const {
  std::vector<GraphEdge> edges;
  std::set<std::tuple<std::size_t, int, std::size_t, int>> places;
  const auto take = [&](const std::vector<Transition>& list, GraphEdge::Origin origin) {
    for (const Transition& t : list) {
      if (places.emplace(t.source_clip, t.m, t.target_clip, t.n).second)
        edges.push_back({.transition = t, .origin = origin});
    }
  };
  take(added, GraphEdge::Origin::added);
  take(kept, GraphEdge::Origin::kept);
  take(transitions, GraphEdge::Origin::found);
  std::ranges::stable_sort(edges, {}, [](const GraphEdge& edge) {
    return std::tuple(edge.transition.source_clip, edge.transition.target_clip, edge.transition.cost);
  });
  for (GraphEdge& edge : edges) {
    if (edge.origin == GraphEdge::Origin::found && is_removed(edge.transition))
      edge.state = GraphEdge::State::removed;
  }
  if (pruning != Pruning::none) prune(*this, edges);
  return edges;
}

std::vector<Transition> SurfaceMotionGraph::active_transitions() const {
  return in_force(edges());
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
  graph.captured_acceleration = captured_acceleration(database);
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
