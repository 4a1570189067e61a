// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/graph.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/log.h"

namespace reprise {
namespace {

bool is_same_place(const Transition& a, const Transition& b) {
  return std::tie(a.source_clip, a.m, a.target_clip, a.n) == std::tie(b.source_clip, b.m, b.target_clip, b.n);
}

bool is_same_edit(const EdgePattern& a, const EdgePattern& b) {
  return std::tie(a.source_clip, a.m, a.target_clip, a.n) == std::tie(b.source_clip, b.m, b.target_clip, b.n);
}

bool has_edits(const SurfaceMotionGraph& graph) {
  return !graph.removed.empty() || !graph.kept.empty() || !graph.added.empty();
}

[[noreturn]] void fail_carrying(const std::string& edit, const std::string& reason) {
  throw InvalidArgument(
      fmt::format("the graph that is there {}: {}. It belongs to another database, and its edits would be "
                  "lost; write to another file, or delete it",
                  edit, reason));
}

// A transition of another graph at its place in this database.
TransitionRequest carried(const Transition& transition, const SurfaceMotionGraph& previous, const char* what,
                          const PerformanceDatabase& database, const TransitionOptions& options) {
  const std::string edit =
      fmt::format("{} {}@{}", what, to_string(transition, previous), transition.half_window);
  try {
    const auto clip_idx = [&](std::size_t previous_idx) {
      return database.parse_frame(previous.clips.at(previous_idx).name + ":0").clip_idx;
    };
    const TransitionRequest request{.source_clip = clip_idx(transition.source_clip),
                                    .target_clip = clip_idx(transition.target_clip),
                                    .m = transition.m,
                                    .n = transition.n,
                                    .half_window = transition.half_window};
    check_request(request, database, options);
    return request;
  } catch (const InvalidArgument& error) {
    fail_carrying(edit, error.what());
  }
}

// A removal of another graph, if this one has its clips and frames.
EdgePattern carried(const EdgePattern& pattern, const SurfaceMotionGraph& graph) {
  const auto check = [&](const std::string& name, int frame) {
    if (name.find('*') != std::string::npos) return;
    const auto clip = std::ranges::find(graph.clips, name, &GraphClip::name);
    if (clip == graph.clips.end()) {
      fail_carrying("removes " + to_string(pattern), fmt::format("there is no clip '{}'", name));
    }
    if (frame >= clip->frame_count) {
      fail_carrying("removes " + to_string(pattern),
                    fmt::format("clip '{}' has frames 0 to {}", name, clip->frame_count - 1));
    }
  };
  check(pattern.source_clip, pattern.m);
  check(pattern.target_clip, pattern.n);
  return pattern;
}

class Editor {
 public:
  Editor(SurfaceMotionGraph& graph, const PerformanceDatabase& database, const DissimilarityMatrix& matrix)
      : graph_(graph), database_(database), matrix_(matrix) {}

  void carry_over(const SurfaceMotionGraph& previous) {
    if (has_edits(previous) && previous.database_hash != graph_.database_hash) {
      spdlog::warn("the graph that is there was made from other contents; its edits are kept");
    }
    for (const EdgePattern& pattern : previous.removed) graph_.removed.push_back(carried(pattern, graph_));
    for (const Transition& t : previous.kept) {
      graph_.kept.push_back(measure(carried(t, previous, "protects", database_, graph_.options)));
    }
    for (const Transition& t : previous.added) {
      graph_.added.push_back(measure(carried(t, previous, "has", database_, graph_.options)));
    }
    graph_.pruning = previous.pruning;
  }

  void restore(const std::string& text) {
    const EdgePattern pattern = parse_edge(text, graph_);
    if (std::erase_if(graph_.removed,
                      [&](const EdgePattern& other) { return is_same_edit(pattern, other); }) == 0) {
      std::string removals;
      for (const EdgePattern& other : graph_.removed) {
        removals += (removals.empty() ? "; removed are " : ", ") + to_string(other);
      }
      throw InvalidArgument(fmt::format("'{}' was not removed, so it cannot be restored{}", text, removals));
    }
  }

  void remove(const std::string& text) {
    const EdgePattern pattern = parse_edge(text, graph_);
    std::size_t in_force = 0;
    std::size_t staying = 0;
    for (const GraphEdge& edge : graph_.edges()) {
      if (!matches(pattern, edge.transition, graph_)) continue;
      if (edge.origin != GraphEdge::Origin::found) {
        ++staying;
      } else if (edge.state != GraphEdge::State::removed) {
        ++in_force;
      }
    }
    if (std::ranges::none_of(graph_.removed,
                             [&](const EdgePattern& other) { return is_same_edit(pattern, other); })) {
      graph_.removed.push_back(pattern);
    }
    if (staying > 0) {
      spdlog::warn(
          "'{}' does not take out what is protected or made by hand, {} here: unprotect or drop that", text,
          staying);
    } else if (in_force == 0) {
      spdlog::warn("'{}' matches no transition that was still there", text);
    }
  }

  void unprotect(const std::string& text) {
    if (erase(graph_.kept, text) == 0) {
      throw InvalidArgument(
          fmt::format("'{}' is not protected{}", text, list("; protected are ", graph_.kept)));
    }
  }

  void drop(const std::string& text) {
    if (erase(graph_.added, text) == 0) {
      throw InvalidArgument(fmt::format("'{}' was not made by hand, so it cannot be dropped{}{}", text,
                                        list("; made by hand are ", graph_.added),
                                        "; --remove takes out what was found"));
    }
  }

  void add(const std::string& text) {
    const Transition transition = measure(parse_transition(text, graph_));
    const auto is_there = [&](const Transition& other) { return is_same_place(other, transition); };
    std::erase_if(graph_.added, is_there);  // the newer window counts
    if (std::erase_if(graph_.kept, is_there) > 0) {
      spdlog::warn("'{}' takes the place of a protected transition", text);
    }
    graph_.added.push_back(transition);
  }

  void protect(const std::string& text) {
    const EdgePattern pattern = parse_edge(text, graph_);
    std::size_t matching = 0;
    std::size_t removed = 0;
    for (const GraphEdge& edge : graph_.edges()) {
      if (!matches(pattern, edge.transition, graph_)) continue;
      // Who names frames means these, though all else of the pair be removed.
      if (edge.state != GraphEdge::State::in_force && pattern.m < 0) {
        ++removed;
        continue;
      }
      ++matching;
      if (edge.origin == GraphEdge::Origin::found) graph_.kept.push_back(edge.transition);
    }
    if (matching > 0) return;
    throw InvalidArgument(
        removed > 0
            ? fmt::format("'{}' means {} transitions, none of them in force: name the frames of those to "
                          "bring back, or restore them",
                          text, removed)
            : fmt::format("'{}' matches no transition, so it cannot be protected; --add makes one by hand",
                          text));
  }

 private:
  Transition measure(const TransitionRequest& request) const {
    return measure_transition(database_, matrix_, request, graph_.options);
  }

  std::size_t erase(std::vector<Transition>& transitions, const std::string& text) const {
    const EdgePattern pattern = parse_edge(text, graph_);
    return std::erase_if(transitions, [&](const Transition& t) { return matches(pattern, t, graph_); });
  }

  std::string list(const char* lead, const std::vector<Transition>& transitions) const {
    std::string text;
    for (const Transition& t : transitions) text += (text.empty() ? lead : ", ") + to_string(t, graph_);
    return text;
  }

  SurfaceMotionGraph& graph_;
  const PerformanceDatabase& database_;
  const DissimilarityMatrix& matrix_;
};

}  // namespace

std::vector<TransitionRequest> requested_transitions(const PerformanceDatabase& database,
                                                     const GraphOptions& options,
                                                     const std::optional<SurfaceMotionGraph>& previous) {
  // Shortest of all windows: what does not even fit then is of another database, not of other options.
  const TransitionOptions any{.min_half_window = 1};
  std::vector<TransitionRequest> requests;
  if (previous) {
    for (const Transition& t : previous->kept)
      requests.push_back(carried(t, *previous, "protects", database, any));
    for (const Transition& t : previous->added)
      requests.push_back(carried(t, *previous, "has", database, any));
  }
  if (options.add.empty()) return requests;
  const SurfaceMotionGraph graph = build_graph(database, {}, {});
  for (const std::string& text : options.add) requests.push_back(parse_transition(text, graph));
  return requests;
}

SurfaceMotionGraph make_graph(const PerformanceDatabase& database, const SimilarityResult& similarity,
                              const GraphOptions& options,
                              const std::optional<SurfaceMotionGraph>& previous) {
  SurfaceMotionGraph graph = build_graph(database, similarity.matrix.metric(), similarity.transitions,
                                         similarity.transition_options);
  Editor editor(graph, database, similarity.matrix);
  if (previous) editor.carry_over(*previous);
  for (const std::string& text : options.restore) editor.restore(text);
  for (const std::string& text : options.remove) editor.remove(text);
  for (const std::string& text : options.unprotect) editor.unprotect(text);
  for (const std::string& text : options.drop) editor.drop(text);
  for (const std::string& text : options.add) editor.add(text);
  for (const std::string& text : options.protect) editor.protect(text);
  if (options.pruning) graph.pruning = *options.pruning;
  return graph;
}

SurfaceMotionGraph open_graph(const PerformanceDatabase& database, const std::filesystem::path& database_path,
                              const std::filesystem::path& graph) {
  if (graph.empty())
    return make_graph(database, compute_similarity(database, database_path), {}, std::nullopt);
  SurfaceMotionGraph opened = load_graph(graph);
  check_graph_fits(opened, database);
  return opened;
}

}  // namespace reprise
