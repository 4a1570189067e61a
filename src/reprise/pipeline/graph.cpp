// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/graph.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/log.h"

namespace reprise {

SurfaceMotionGraph make_graph(const PerformanceDatabase& database, const SimilarityResult& similarity,
                              const GraphOptions& options,
                              const std::optional<SurfaceMotionGraph>& previous) {
  SurfaceMotionGraph graph = build_graph(database, similarity.matrix.metric(), similarity.transitions,
                                         similarity.transition_options);
  if (previous) {
    const auto exists = [&](const std::string& clip) {
      return std::ranges::count(graph.clips, clip, &GraphClip::name) > 0;
    };
    for (const RemovedEdge& edge : previous->removed) {
      if (!exists(edge.source_clip) || !exists(edge.target_clip)) {
        throw InvalidArgument(
            fmt::format("the graph that is there removes {}->{}, clips this database does not have: it "
                        "belongs to another one, and its "
                        "removals would be lost; write to another file, or delete it",
                        edge.source_clip, edge.target_clip));
      }
      graph.removed.push_back(edge);
    }
  }
  for (const std::string& text : options.remove) {
    const RemovedEdge edge = parse_edge(text, graph);
    const std::size_t active = graph.active_transitions().size();
    if (std::ranges::count(graph.removed, edge) == 0) graph.removed.push_back(edge);
    if (graph.active_transitions().size() == active)
      spdlog::warn("'{}' matches no transition that was still there", text);
  }
  for (const std::string& text : options.restore) {
    if (std::erase(graph.removed, parse_edge(text, graph)) == 0) {
      throw InvalidArgument(fmt::format("'{}' was not removed, so it cannot be restored", text));
    }
  }
  return graph;
}

}  // namespace reprise
