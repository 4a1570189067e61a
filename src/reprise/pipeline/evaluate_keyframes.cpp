// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_keyframes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/finished_pairs.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/keyframe_table.h"
#include "reprise/pipeline/keyframes.h"
#include "reprise/pipeline/outputs.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

constexpr int most_targets = 1000;  // either way: a million queries are days

void check(const std::vector<GridDatabase>& databases, const EvaluateKeyframesOptions& options) {
  if (databases.empty()) throw InvalidArgument("expected at least one database, found none");
  const auto within = [](const char* name, int value, int least, int most) {
    if (value < least || value > most)
      throw InvalidArgument(fmt::format("{}: expected {} to {}, found {}", name, least, most, value));
  };
  within("max_distance", options.max_distance, 1, most_targets);
  within("max_time", options.max_time, 1, most_targets);
  within("samples", options.samples, 0, most_targets * most_targets);
  const auto not_negative = [](const char* name, double value) {
    if (!(value >= 0.0) || !std::isfinite(value))
      throw InvalidArgument(fmt::format("{}: expected a number from 0, found {}", name, value));
  };
  not_negative("reach_distance", options.reach_distance);
  not_negative("reach_time", options.reach_time);
  not_negative("distance_weight", options.optimizer.distance_weight);
  not_negative("time_weight", options.optimizer.time_weight);
  // The options of the correction are checked where they are used: before the long work as well.
  static_cast<void>(
      plan_correction({.distance = 1.0, .frame_count = 25}, 1.0, 1.0, 25.0, options.correction));
}

// A database with its graph, and the rows of the table it gives.
struct OpenDatabase {
  std::string name;
  PerformanceDatabase database;
  SurfaceMotionGraph graph;
  std::vector<GridPair> pairs;
  std::vector<const PaperRow*> paper;  // one a pair; null: none
};

std::vector<GridPair> pairs_of(OpenDatabase& open, const GridDatabase& asked) {
  const std::span<const PaperRow> printed = paper_rows(open.database, open.name);
  std::vector<GridPair> pairs = asked.pairs;
  if (pairs.empty()) {
    for (const PaperRow& row : printed) pairs.push_back({row.from, row.to});
  }
  if (pairs.empty()) {
    throw InvalidArgument(
        fmt::format("{}: has not the key-frames of the paper's table (such as {} and {}): name pairs of "
                    "key-frames (--pair FROM TO)",
                    asked.database.string(), paper_table().front().from, paper_table().front().to));
  }
  for (const GridPair& pair : pairs) {
    static_cast<void>(keyframes_of(pair, open.database));
    const auto row = std::ranges::find_if(
        printed, [&](const PaperRow& r) { return pair.from == r.from && pair.to == r.to; });
    open.paper.push_back(row == printed.end() ? nullptr : &*row);
  }
  return pairs;
}

std::unique_ptr<OpenDatabase> open_database(const GridDatabase& asked) {
  auto open = std::make_unique<OpenDatabase>();
  open->name = asked.database.stem().string();
  open->database = load_database(asked.database);
  open->pairs = pairs_of(*open, asked);
  open->graph = open_graph(open->database, asked.database, asked.graph);
  return open;
}

// Everything that is wrong is said before the long work.
std::vector<std::unique_ptr<OpenDatabase>> open_databases(const std::vector<GridDatabase>& databases) {
  std::vector<std::unique_ptr<OpenDatabase>> opened;
  std::set<std::tuple<std::string, std::string, std::string>> seen;
  for (const GridDatabase& asked : databases) {
    opened.push_back(open_database(asked));
    for (const GridPair& pair : opened.back()->pairs) {
      if (seen.emplace(opened.back()->name, pair.from, pair.to).second) continue;
      throw InvalidArgument(
          fmt::format("{}: {} -> {} is listed twice (databases are told apart by the names "
                      "of their files)",
                      opened.back()->name, pair.from, pair.to));
    }
  }
  return opened;
}

// Pairs of one database: `samples` has the queries to be sampled, one list a pair.
void evaluate_database(const OpenDatabase& open, const std::vector<std::vector<std::size_t>>& samples,
                       const FinishedPairs& finished, const EvaluateKeyframesOptions& options,
                       std::vector<GridResult>& results) {
  const PathMetrics metrics = path_metrics(open.database, open.graph);
  const BlendProfile profile = open.graph.options.profile;
  const std::string database_hash = open.database.content_hash();
  SmoothnessOfTransition smoothness;
  std::unique_ptr<Synthesizer> synthesizer;  // made when a sample is
  for (std::size_t p = 0; p < open.pairs.size(); ++p) {
    const GridPair& pair = open.pairs[p];
    const std::string key = grid_key(pair, database_hash, metrics, profile, options);
    GridResult result{
        .grid = {.database = open.name, .pair = pair, .frames_per_second = metrics.frames_per_second()},
        .paper = open.paper[p]};
    KeyframeGrid& grid = result.grid;
    if (!options.resume || !finished.load(grid, smoothness, open.database, metrics, options, key)) {
      grid = search_grid(open.name, pair, open.database, metrics, options);
      add_smoothness(grid, open.database, metrics, smoothness);
      finished.save(grid, smoothness, key);
    }
    complete_grid(grid, smoothness, options);

    const std::string sampled = samples_key(key, samples[p], options.correction);
    std::optional<std::vector<GridSample>> kept;
    if (options.resume) kept = finished.load_samples(grid, samples[p], sampled);
    if (kept) {
      result.samples = std::move(*kept);
    } else if (!samples[p].empty()) {
      if (!synthesizer) synthesizer = std::make_unique<Synthesizer>(open.database);
      Progress progress(fmt::format("{} {} -> {}: frames", open.name, pair.from, pair.to), samples[p].size());
      for (const std::size_t query_idx : samples[p]) {
        result.samples.push_back(measure_sample(grid, query_idx, open.database, *synthesizer, profile));
        progress.advance();
      }
      finished.save(grid, result.samples, sampled);
    }
    results.push_back(std::move(result));
  }
}

}  // namespace

void evaluate_keyframes(const std::vector<GridDatabase>& databases, const fs::path& folder,
                        const EvaluateKeyframesOptions& options) {
  check(databases, options);
  const std::vector<std::unique_ptr<OpenDatabase>> opened = open_databases(databases);
  prepare_folder(folder / "finished");
  const FinishedPairs finished(folder / "finished");

  std::size_t pair_count = 0;
  for (const auto& open : opened) pair_count += open->pairs.size();
  const std::vector<std::vector<std::size_t>> samples = choose_samples(pair_count, options);
  std::vector<GridResult> results;
  for (const auto& open : opened) {
    const auto first = samples.begin() + static_cast<std::ptrdiff_t>(results.size());
    evaluate_database(*open, {first, first + static_cast<std::ptrdiff_t>(open->pairs.size())}, finished,
                      options, results);
  }

  for (const GridResult& result : results)
    draw_errors(result.grid, options, folder / fmt::format("errors-{}.png", file_name_of(result.grid)));
  draw_table(results, folder / "table.png");
  write_text_file(folder / "queries.csv", queries_csv(results));
  write_text_file(folder / "times.csv", times_csv(results));
  write_text_file(folder / "unreachable.csv", unreachable_csv(results, options.optimizer));
  write_text_file(folder / "samples.csv", samples_csv(results));
  write_text_file(folder / "table.csv", keyframe_table_csv(results));
  write_text_file(folder / "table.md", keyframe_markdown(results, options));
}

}  // namespace reprise
