// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Sub-graphs of surface motion graphs that were found in moving surfaces, for the tests of paths.

#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "reprise/graph/transition.h"
#include "reprise/path/keyframe_case_test_support.h"
#include "reprise/similarity/vertex_metric.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise::test {

// The clips of a database and transitions that were found in it.
struct RealGraph {
  RealGraph(PerformanceDatabase source, int transitions_per_pair)
      : database(std::move(source)),
        transitions(find_transitions(database, vertex_dissimilarity(database),
                                     {.transitions_per_pair = transitions_per_pair})) {}

  // A query on the best `per_pair` transitions between some clips, numbered anew in this order. Key-frames as
  // the database parses them.
  Case sub_graph(const std::vector<std::string>& clips, int per_pair,
                 const std::vector<std::string>& keyframes) const {
    Case result;
    std::map<std::size_t, std::size_t> new_from_old;
    for (const std::string& name : clips) {
      const std::size_t clip_idx = database.clip_idx(name);
      new_from_old[clip_idx] = result.trajectories.size();
      result.trajectories.push_back(ground_trajectory(database.clips()[clip_idx]));
    }
    std::map<std::pair<std::size_t, std::size_t>, int> taken;
    for (Transition transition : transitions) {  // best first within a pair
      const auto source = new_from_old.find(transition.source_clip);
      const auto target = new_from_old.find(transition.target_clip);
      if (source == new_from_old.end() || target == new_from_old.end()) continue;
      transition.source_clip = source->second;
      transition.target_clip = target->second;
      if (taken[{source->second, target->second}]++ < per_pair) result.transitions.push_back(transition);
    }
    for (const std::string& text : keyframes) {
      const FrameId frame = database.parse_frame(text);
      result.query.keyframes.push_back({new_from_old.at(frame.clip_idx), frame.frame_idx});
    }
    return result;
  }

  PerformanceDatabase database;
  std::vector<Transition> transitions;
};

// The capsule figure, coarse, with four transitions a pair.
inline const RealGraph& figure_graph() {
  static const RealGraph graph(make_figure({.voxel_size = 0.05}), 4);
  return graph;
}

}  // namespace reprise::test
