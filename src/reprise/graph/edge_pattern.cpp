// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How edits name transitions: "walk->run", "walk*->hit", "walk:12->run:30@8".

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/graph/surface_motion_graph.h"

namespace reprise {
namespace {

constexpr std::string_view arrow = "->";

// '*' stands for any letters, or none.
bool matches_name(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == name;
  if (name.substr(0, star) != pattern.substr(0, star)) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t from = star; from <= name.size(); ++from) {
    if (matches_name(rest, name.substr(from))) return true;
  }
  return false;
}

bool is_wild(std::string_view name) {
  return name.find('*') != std::string_view::npos;
}

bool matches_some_clip(const SurfaceMotionGraph& graph, std::string_view pattern) {
  return std::ranges::any_of(graph.clips,
                             [&](const GraphClip& clip) { return matches_name(pattern, clip.name); });
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

struct EdgeText {
  EdgeEnd source;
  EdgeEnd target;
};

EdgeText split_edge(std::string_view text, const SurfaceMotionGraph& graph) {
  const std::size_t first = text.find(arrow);
  if (first == std::string_view::npos) {
    throw InvalidArgument(fmt::format("'{}' is not an edge: expected CLIP->CLIP or CLIP:M->CLIP:N", text));
  }
  // A name may hold an arrow of its own: take the arrow that leaves known clips on both sides, or else the
  // first.
  std::size_t split = first;
  for (std::size_t at = first; at != std::string_view::npos; at = text.find(arrow, at + 1)) {
    if (matches_some_clip(graph, parse_end(text.substr(0, at)).clip) &&
        matches_some_clip(graph, parse_end(text.substr(at + arrow.size())).clip)) {
      split = at;
      break;
    }
  }
  return {parse_end(text.substr(0, split)), parse_end(text.substr(split + arrow.size()))};
}

std::size_t checked_clip(const SurfaceMotionGraph& graph, const std::string& name) {
  const auto found = std::ranges::find(graph.clips, name, &GraphClip::name);
  if (found != graph.clips.end()) return static_cast<std::size_t>(found - graph.clips.begin());
  std::vector<std::string> names;
  for (const GraphClip& clip : graph.clips) names.push_back(clip.name);
  const std::string nearest = is_wild(name) ? "" : nearest_word(name, names);
  throw InvalidArgument(
      nearest.empty() ? fmt::format("there is no clip '{}'; the clips are {}", name, fmt::join(names, ", "))
                      : fmt::format("there is no clip '{}'; did you mean '{}'?", name, nearest));
}

void check_pattern(const SurfaceMotionGraph& graph, const EdgeEnd& end) {
  if (!is_wild(end.clip) || !matches_some_clip(graph, end.clip)) checked_clip(graph, end.clip);
}

int parse_number(std::string_view text) {
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? number : -1;
}

int checked_frame(const GraphClip& clip, std::string_view text) {
  const int frame = parse_number(text);
  if (frame < 0 || frame >= clip.frame_count) {
    throw InvalidArgument(
        fmt::format("clip '{}' has frames 0 to {}, asked for '{}'", clip.name, clip.frame_count - 1, text));
  }
  return frame;
}

}  // namespace

bool matches(const EdgePattern& pattern, const Transition& transition, const SurfaceMotionGraph& graph) {
  if (transition.source_clip >= graph.clips.size() || transition.target_clip >= graph.clips.size())
    return false;
  if (pattern.m >= 0 && (std::abs(pattern.m - transition.m) >= pattern.within ||
                         std::abs(pattern.n - transition.n) >= pattern.within)) {
    return false;
  }
  return matches_name(pattern.source_clip, graph.clips[transition.source_clip].name) &&
         matches_name(pattern.target_clip, graph.clips[transition.target_clip].name);
}

EdgePattern parse_edge(const std::string& text, const SurfaceMotionGraph& graph) {
  const auto [source, target] = split_edge(text, graph);
  check_pattern(graph, source);
  check_pattern(graph, target);
  if (source.frame.has_value() != target.frame.has_value()) {
    throw InvalidArgument(
        fmt::format("'{}' names a frame of one clip only: expected CLIP->CLIP for all transitions, or "
                    "CLIP:M->CLIP:N for one",
                    text));
  }
  EdgePattern edge{.source_clip = source.clip, .target_clip = target.clip};
  if (source.frame) {
    if (is_wild(source.clip) || is_wild(target.clip)) {
      throw InvalidArgument(
          fmt::format("'{}' names frames of more than one clip: expected a name without '*'", text));
    }
    edge.m = checked_frame(graph.clips[checked_clip(graph, source.clip)], *source.frame);
    edge.n = checked_frame(graph.clips[checked_clip(graph, target.clip)], *target.frame);
    edge.within = graph.options.separation;
  }
  return edge;
}

TransitionRequest parse_transition(const std::string& text, const SurfaceMotionGraph& graph) {
  auto [source, target] = split_edge(text, graph);
  TransitionRequest request{.source_clip = checked_clip(graph, source.clip),
                            .target_clip = checked_clip(graph, target.clip)};
  if (!source.frame || !target.frame) {
    throw InvalidArgument(
        fmt::format("'{}' does not say which frames meet: expected CLIP:M->CLIP:N, or CLIP:M->CLIP:N@L for "
                    "a half window of L frames",
                    text));
  }
  if (const auto at = target.frame->find('@'); at != std::string_view::npos) {
    const std::string_view window = target.frame->substr(at + 1);
    request.half_window = parse_number(window);
    if (request.half_window < 1) {
      throw InvalidArgument(fmt::format(
          "'{}': expected a half window of at least 1 frame after '@', found '{}'", text, window));
    }
    target.frame = target.frame->substr(0, at);
  }
  request.m = checked_frame(graph.clips[request.source_clip], *source.frame);
  request.n = checked_frame(graph.clips[request.target_clip], *target.frame);
  return request;
}

std::string to_string(const Transition& transition, const SurfaceMotionGraph& graph) {
  return fmt::format("{}:{}->{}:{}", graph.clips.at(transition.source_clip).name, transition.m,
                     graph.clips.at(transition.target_clip).name, transition.n);
}

std::string to_string(const EdgePattern& pattern) {
  if (pattern.m < 0) return fmt::format("{}->{}", pattern.source_clip, pattern.target_clip);
  return fmt::format("{}:{}->{}:{}", pattern.source_clip, pattern.m, pattern.target_clip, pattern.n);
}

}  // namespace reprise
