// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/finished_pairs.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/hash.h"
#include "reprise/core/log.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Part of every key: raised when what is kept, or how it is computed, changes.
constexpr const char* format = "reprise key-frame grid 1";

constexpr double Naturalness::*naturalness_fields[] = {
    &Naturalness::pop_ratio,           &Naturalness::captured_pop_ratio,       &Naturalness::foot_drift,
    &Naturalness::captured_foot_drift, &Naturalness::shown_foot_drift,         &Naturalness::blend_foot_drift,
    &Naturalness::edge_stretch_p99,    &Naturalness::captured_edge_stretch_p99};

constexpr double PathCosts::*cost_fields[] = {&PathCosts::transitions, &PathCosts::distance,
                                              &PathCosts::time,        &PathCosts::position,
                                              &PathCosts::turn,        &PathCosts::route};

void write_json(const fs::path& path, const Json& json) {
  write_text_file(path, json.dump() + "\n");
}

// The content of a file of that key, or null.
Json read_kept(const fs::path& path, const std::string& key) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return nullptr;
  Json json = Json::parse(read_text_file(path));
  if (json.at("key").get<std::string>() != key) return nullptr;
  return json;
}

// Whatever is wrong with a kept file: it costs the time to do its work again, no more.
bool try_to_use(const fs::path& path, const std::function<bool()>& use) {
  try {
    return use();
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    spdlog::warn("{}: is damaged and not used: {}", path.string(), error.what());
    return false;
  }
}

}  // namespace

std::string file_name_of(const KeyframeGrid& grid) {
  std::string name = fmt::format("{}-{}-{}", grid.database, grid.pair.from, grid.pair.to);
  std::ranges::replace(name, ':', '_');
  return name;
}

std::string grid_key(const GridPair& pair, const std::string& database_hash, const PathMetrics& metrics,
                     BlendProfile profile, const EvaluateKeyframesOptions& options) {
  ContentHash hash;
  hash.add(format).add(pair.from).add(pair.to).add(database_hash);
  hash.add_number(options.max_distance).add_number(options.max_time).add_number(static_cast<int>(profile));
  // An option that is added here must be added to the key: then this no longer compiles.
  const auto& [distance_weight, time_weight, position_weight, turn_weight, route_weight, max_labels] =
      options.optimizer;
  for (const double value : {distance_weight, time_weight, position_weight, turn_weight, route_weight,
                             static_cast<double>(max_labels)}) {
    hash.add_number(value);
  }
  for (const Transition& t : metrics.transitions()) {
    for (const double value :
         {static_cast<double>(t.source_clip), static_cast<double>(t.target_clip), static_cast<double>(t.m),
          static_cast<double>(t.n), static_cast<double>(t.half_window), t.source_from_target.yaw,
          t.source_from_target.translation.x(), t.source_from_target.translation.y(), t.cost}) {
      hash.add_number(value);
    }
  }
  return hash.hex();
}

std::string samples_key(const std::string& grid_key, const std::vector<std::size_t>& query_indices,
                        const CorrectionOptions& correction) {
  const auto& [max_retiming, max_stretch] = correction;
  ContentHash hash;
  hash.add(grid_key).add(std::span<const std::size_t>(query_indices));
  return hash.add_number(max_retiming).add_number(max_stretch).hex();
}

void FinishedPairs::save(const KeyframeGrid& grid, const SmoothnessOfTransition& smoothness,
                         const std::string& key) const {
  Json queries = Json::array();
  SmoothnessOfTransition used;
  for (const GridQuery& query : grid.queries) {
    Json costs = Json::array();
    for (const auto field : cost_fields) costs.push_back(query.path.costs.*field);
    queries.push_back({{"transitions", query.transitions},
                       {"costs", std::move(costs)},
                       {"cost", query.path.cost},
                       {"lower_bound", query.path.lower_bound},
                       {"distance", query.path.distance},
                       {"frames", query.path.frame_count},
                       {"time", query.path.time},
                       {"labels", query.path.labels},
                       {"cpu_seconds", query.cpu_seconds}});
    for (const int transition : query.transitions) used.insert(*smoothness.find(transition));
  }
  Json of_transitions = Json::array();
  for (const auto& [transition, value] : used)
    of_transitions.push_back({transition, value.weighted, value.normalized});
  write_json(folder_ / (file_name_of(grid) + ".paths.json"),
             {{"key", key},
              {"preparation_cpu_seconds", grid.preparation_cpu_seconds},
              {"smoothness", std::move(of_transitions)},
              {"queries", std::move(queries)}});
}

bool FinishedPairs::load(KeyframeGrid& grid, SmoothnessOfTransition& smoothness,
                         const PerformanceDatabase& database, const PathMetrics& metrics,
                         const EvaluateKeyframesOptions& options, const std::string& key) const {
  const fs::path path = folder_ / (file_name_of(grid) + ".paths.json");
  return try_to_use(path, [&] {
    const Json json = read_kept(path, key);
    if (json.is_null()) return false;
    const std::vector<FrameId> keyframes = keyframes_of(grid.pair, database);
    const auto distances = static_cast<std::size_t>(options.max_distance);
    std::vector<GridQuery> queries(distances * static_cast<std::size_t>(options.max_time));
    if (json.at("queries").size() != queries.size()) {
      throw InvalidArgument(
          fmt::format("expected {} queries, found {}", queries.size(), json.at("queries").size()));
    }
    SmoothnessOfTransition known;
    for (const Json& entry : json.at("smoothness"))
      known[entry.at(0).get<int>()] = {.weighted = entry.at(1).get<double>(),
                                       .normalized = entry.at(2).get<double>()};
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Json& kept = json.at("queries").at(i);
      GridQuery& query = queries[i];
      query.target_distance = static_cast<int>(i % distances) + 1;
      query.target_time = static_cast<int>(i / distances) + 1;
      kept.at("transitions").get_to(query.transitions);
      for (const int transition : query.transitions) static_cast<void>(known.at(transition));
      MotionPath& motion = query.path;
      motion.segments = path_segments(keyframes, metrics, query.transitions);
      for (std::size_t c = 0; c < std::size(cost_fields); ++c)
        kept.at("costs").at(c).get_to(motion.costs.*cost_fields[c]);
      kept.at("cost").get_to(motion.cost);
      kept.at("lower_bound").get_to(motion.lower_bound);
      kept.at("distance").get_to(motion.distance);
      kept.at("frames").get_to(motion.frame_count);
      kept.at("time").get_to(motion.time);
      kept.at("labels").get_to(motion.labels);
      kept.at("cpu_seconds").get_to(query.cpu_seconds);
    }
    const double preparation = json.at("preparation_cpu_seconds").get<double>();
    smoothness.insert(known.begin(), known.end());
    grid.preparation_cpu_seconds = preparation;
    grid.queries = std::move(queries);
    return true;
  });
}

void FinishedPairs::save(const KeyframeGrid& grid, const std::vector<GridSample>& samples,
                         const std::string& key) const {
  Json list = Json::array();
  for (const GridSample& sample : samples) {
    Json variants = Json::array();
    for (const SampleMeasures& measures : sample.variants) {
      Json naturalness = Json::array();
      for (const auto field : naturalness_fields) naturalness.push_back(measures.naturalness.*field);
      variants.push_back({{"predicted_distance", measures.predicted_distance},
                          {"predicted_frames", measures.predicted_frames},
                          {"distance", measures.distance},
                          {"frames", measures.frames},
                          {"naturalness", std::move(naturalness)}});
    }
    list.push_back({{"query", sample.query_idx}, {"variants", std::move(variants)}});
  }
  write_json(folder_ / (file_name_of(grid) + ".samples.json"), {{"key", key}, {"samples", std::move(list)}});
}

std::optional<std::vector<GridSample>> FinishedPairs::load_samples(
    const KeyframeGrid& grid, const std::vector<std::size_t>& query_indices, const std::string& key) const {
  const fs::path path = folder_ / (file_name_of(grid) + ".samples.json");
  std::vector<GridSample> samples(query_indices.size());
  const bool is_used = try_to_use(path, [&] {
    const Json json = read_kept(path, key);
    if (json.is_null()) return false;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Json& kept = json.at("samples").at(s);
      samples[s].query_idx = query_indices[s];
      if (kept.at("query").get<std::size_t>() != query_indices[s])
        throw InvalidArgument("expected other queries");
      for (std::size_t v = 0; v < sample_variants.size(); ++v) {
        const Json& variant = kept.at("variants").at(v);
        SampleMeasures& measures = samples[s].variants[v];
        variant.at("predicted_distance").get_to(measures.predicted_distance);
        variant.at("predicted_frames").get_to(measures.predicted_frames);
        variant.at("distance").get_to(measures.distance);
        variant.at("frames").get_to(measures.frames);
        for (std::size_t f = 0; f < std::size(naturalness_fields); ++f)
          variant.at("naturalness").at(f).get_to(measures.naturalness.*naturalness_fields[f]);
      }
    }
    return true;
  });
  if (!is_used) return std::nullopt;
  return samples;
}

}  // namespace reprise
