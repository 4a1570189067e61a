// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The JSON file of a surface motion graph (docs/surface-motion-graph.md).

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/json_file.h"
#include "reprise/core/text.h"
#include "reprise/graph/surface_motion_graph.h"

namespace reprise {
namespace {

constexpr const char* format_name = "reprise surface motion graph";
constexpr int format_version = 2;

constexpr std::pair<BlendProfile, const char*> profiles[] = {{BlendProfile::linear, "linear"},
                                                             {BlendProfile::smooth, "smooth"}};
constexpr std::pair<WindowCriterion, const char*> criteria[] = {{WindowCriterion::blend_speed, "blend_speed"},
                                                                {WindowCriterion::paper_sum, "paper_sum"}};

constexpr std::pair<Pruning, const char*> prunings[] = {
    {Pruning::none, "none"}, {Pruning::dead_ends, "dead_ends"}, {Pruning::both_ends, "both_ends"}};

template <typename Enum, std::size_t count>
const char* name_of(const std::pair<Enum, const char*> (&names)[count], Enum value) {
  return std::ranges::find(names, value, &std::pair<Enum, const char*>::first)->second;
}

Json to_json(const TransitionOptions& options) {
  return {{"transitions_per_pair", options.transitions_per_pair},
          {"max_half_window", options.max_half_window},
          {"min_half_window", options.min_half_window},
          {"self_min_gap", options.self_min_gap},
          {"separation", options.separation},
          {"criterion", name_of(criteria, options.criterion)},
          {"acceleration_weight", options.acceleration_weight},
          {"profile", name_of(profiles, options.profile)},
          {"sample_vertices", options.sample_vertices},
          {"max_pop_ratio", std::isinf(options.max_pop_ratio) ? Json(nullptr) : Json(options.max_pop_ratio)}};
}

using Field = JsonField;

TransitionOptions read_options(const Field& field, int version) {
  field.warn_of_others({"transitions_per_pair", "max_half_window", "min_half_window", "self_min_gap",
                        "separation", "criterion", "acceleration_weight", "profile", "sample_vertices",
                        "max_pop_ratio"});
  TransitionOptions options{.transitions_per_pair = field["transitions_per_pair"].integer(1),
                            .max_half_window = field["max_half_window"].integer(1),
                            .min_half_window = field["min_half_window"].integer(1),
                            .self_min_gap = field["self_min_gap"].integer(1),
                            .separation = field["separation"].integer(1),
                            .criterion = field["criterion"].choice(criteria),
                            .acceleration_weight = field["acceleration_weight"].number_from(0.0),
                            .profile = field["profile"].choice(profiles),
                            .sample_vertices = field["sample_vertices"].integer(1)};
  // Version 1 knew no limit; null stands for none.
  options.max_pop_ratio = std::numeric_limits<double>::infinity();
  if (version > 1 && !field["max_pop_ratio"].is_null())
    options.max_pop_ratio = field["max_pop_ratio"].number();
  try {
    validate(options);
  } catch (const InvalidArgument& error) {
    field.fail(error.what());
  }
  return options;
}

std::vector<GraphClip> read_clips(const Field& field) {
  std::vector<GraphClip> clips;
  std::set<std::string> names;
  for (const Field& item : field.items()) {
    item.warn_of_others({"name", "frame_count", "frames_per_second"});
    const GraphClip clip{.name = item["name"].text(),
                         .frame_count = item["frame_count"].integer(1),
                         .frames_per_second = item["frames_per_second"].number_from(0.0)};
    if (clip.frames_per_second == 0.0) item["frames_per_second"].fail("expected a rate above 0, found 0");
    if (clip.name.empty()) item["name"].fail("expected a name, found an empty text");
    if (!names.insert(clip.name).second)
      item["name"].fail(fmt::format("there is a clip '{}' already", clip.name));
    clips.push_back(clip);
  }
  return clips;
}

std::size_t read_clip_idx(const Field& field, const std::vector<GraphClip>& clips) {
  const std::string name = field.text();
  const auto found = std::ranges::find(clips, name, &GraphClip::name);
  if (found != clips.end()) return static_cast<std::size_t>(found - clips.begin());
  std::vector<std::string> names;
  for (const GraphClip& clip : clips) names.push_back(clip.name);
  const std::string nearest = nearest_word(name, names);
  field.fail(nearest.empty()
                 ? fmt::format("there is no clip '{}'; the clips are {}", name, fmt::join(names, ", "))
                 : fmt::format("there is no clip '{}'; did you mean '{}'?", name, nearest));
}

Transition read_transition(const Field& field, const std::vector<GraphClip>& clips) {
  field.warn_of_others({"source", "m", "target", "n", "half_window", "yaw", "translation", "distortion",
                        "peak_acceleration", "cost"});
  Transition transition{.source_clip = read_clip_idx(field["source"], clips),
                        .target_clip = read_clip_idx(field["target"], clips)};
  const GraphClip& source = clips[transition.source_clip];
  const GraphClip& target = clips[transition.target_clip];
  transition.m = field["m"].integer(0, source.frame_count - 1);
  transition.n = field["n"].integer(0, target.frame_count - 1);
  transition.half_window = field["half_window"].integer(1);
  const auto check_window = [&](const char* name, int centre, const GraphClip& clip) {
    const int room = std::min(centre, clip.frame_count - 1 - centre);
    if (transition.half_window > room) {
      field["half_window"].fail(fmt::format(
          "expected at most {}, found {}: the window about frame {} ({}) must lie inside the {} frames of "
          "clip '{}'",
          room, transition.half_window, centre, name, clip.frame_count, clip.name));
    }
  };
  check_window("m", transition.m, source);
  check_window("n", transition.n, target);
  transition.source_from_target.yaw = field["yaw"].number();
  const std::vector<Field> translation = field["translation"].items();
  if (translation.size() != 2) {
    field["translation"].fail(fmt::format("expected two numbers (x, z), found {}", translation.size()));
  }
  transition.source_from_target.translation = {translation[0].number(), translation[1].number()};
  transition.distortion = field["distortion"].number_from(0.0);
  transition.peak_acceleration = field["peak_acceleration"].number_from(0.0);
  transition.cost = field["cost"].number_from(0.0);
  return transition;
}

// The name of a clip, or a pattern of names.
std::string read_clip_name(const Field& field, const std::vector<GraphClip>& clips) {
  std::string name = field.text();
  if (name.find('*') == std::string::npos) (void)read_clip_idx(field, clips);
  return name;
}

EdgePattern read_pattern(const Field& field, const std::vector<GraphClip>& clips, int separation) {
  field.warn_of_others({"source", "m", "target", "n", "within"});
  EdgePattern pattern{.source_clip = read_clip_name(field["source"], clips),
                      .target_clip = read_clip_name(field["target"], clips)};
  if (field.has("m") || field.has("n")) {
    pattern.m = field["m"].integer(0, clips[read_clip_idx(field["source"], clips)].frame_count - 1);
    pattern.n = field["n"].integer(0, clips[read_clip_idx(field["target"], clips)].frame_count - 1);
    pattern.within = field.has("within") ? field["within"].integer(1) : separation;
  }
  return pattern;
}

Json to_json(const EdgePattern& pattern) {
  Json json = {{"source", pattern.source_clip}};
  if (pattern.m >= 0) json["m"] = pattern.m;
  json["target"] = pattern.target_clip;
  if (pattern.m >= 0) {
    json["n"] = pattern.n;
    json["within"] = pattern.within;
  }
  return json;
}

Json to_json(const std::vector<Transition>& transitions, const std::vector<GraphClip>& clips) {
  Json json = Json::array();
  for (const Transition& transition : transitions) {
    const Eigen::Vector2d& translation = transition.source_from_target.translation;
    json.push_back({{"source", clips.at(transition.source_clip).name},
                    {"m", transition.m},
                    {"target", clips.at(transition.target_clip).name},
                    {"n", transition.n},
                    {"half_window", transition.half_window},
                    {"yaw", transition.source_from_target.yaw},
                    {"translation", Json::array({translation.x(), translation.y()})},
                    {"distortion", transition.distortion},
                    {"peak_acceleration", transition.peak_acceleration},
                    {"cost", transition.cost}});
  }
  return json;
}

// A list that may be missing: edits may be written by hand.
std::vector<Field> items_of(const Field& file, const char* name) {
  return file.has(name) ? file[name].items() : std::vector<Field>();
}

}  // namespace

void save_graph(const SurfaceMotionGraph& graph, const std::filesystem::path& path) {
  Json clips = Json::array();
  for (const GraphClip& clip : graph.clips) {
    clips.push_back({{"name", clip.name},
                     {"frame_count", clip.frame_count},
                     {"frames_per_second", clip.frames_per_second}});
  }
  Json removed = Json::array();
  for (const EdgePattern& pattern : graph.removed) removed.push_back(to_json(pattern));
  const Json file = {{"format", format_name},
                     {"version", format_version},
                     {"database_hash", graph.database_hash},
                     {"metric", graph.metric},
                     {"captured_acceleration", graph.captured_acceleration},
                     {"options", to_json(graph.options)},
                     {"clips", std::move(clips)},
                     {"removed", std::move(removed)},
                     {"protected", to_json(graph.kept, graph.clips)},
                     {"added", to_json(graph.added, graph.clips)},
                     {"pruning", name_of(prunings, graph.pruning)},
                     {"transitions", to_json(graph.transitions, graph.clips)}};
  write_text_file(path, file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

SurfaceMotionGraph load_graph(const std::filesystem::path& path) {
  const Json json = read_json_file(path);
  if (!json.is_object() || !json.contains("format") || json["format"] != format_name) {
    throw FileError(path,
                    fmt::format("is not a surface motion graph: expected \"format\": \"{}\"", format_name));
  }
  const Field file(path, json, "");
  const int version = file["version"].integer(1);
  if (version > format_version) {
    file["version"].fail(
        fmt::format("the file has version {}, this program reads up to version {}", version, format_version));
  }
  file.warn_of_others({"format", "version", "database_hash", "metric", "captured_acceleration", "options",
                       "clips", "removed", "protected", "added", "pruning", "transitions"});
  SurfaceMotionGraph graph{.database_hash = file["database_hash"].text(),
                           .metric = file["metric"].text(),
                           .clips = read_clips(file["clips"])};
  graph.options = read_options(file["options"], version);
  if (version > 1) graph.captured_acceleration = file["captured_acceleration"].number_from(0.0);
  for (const Field& item : file["transitions"].items()) {
    graph.transitions.push_back(read_transition(item, graph.clips));
  }
  for (const Field& item : items_of(file, "removed")) {
    graph.removed.push_back(read_pattern(item, graph.clips, graph.options.separation));
  }
  for (const Field& item : items_of(file, "protected")) {
    graph.kept.push_back(read_transition(item, graph.clips));
  }
  for (const Field& item : items_of(file, "added")) {
    graph.added.push_back(read_transition(item, graph.clips));
  }
  if (file.has("pruning")) graph.pruning = file["pruning"].choice(prunings);
  return graph;
}

}  // namespace reprise
