// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframes.h"

#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "command.h"
#include "keyframe_options.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {
namespace {

void print_answer(const KeyframesOptions& options, const KeyframesResult& result) {
  const MotionPath& path = result.path;
  fmt::print("{}: {} frames, {} transitions\n", result.animation.name(), result.animation.frame_count(),
             path.segments.size() - 1);
  fmt::print("distance {:.3f} m (asked {:g}), time {:.2f} s (asked {:g}), cost {:.6g}, {}\n", path.distance,
             options.distance, path.time, options.time, path.cost,
             path.gap() > 0.0 ? fmt::format("lower bound {:.6g} (search limit reached)", path.lower_bound)
                              : "proved optimal");
  if (result.report.contains("correction")) {
    const nlohmann::json& correction = result.report["correction"];
    fmt::print("corrected: distance {:.3f} m, time {:.2f} s\n", correction["distance"].get<double>(),
               correction["time"].get<double>());
  }
  if (options.goal || options.route) {
    const nlohmann::json& end = result.report["end"];
    fmt::print("ends at {:.2f},{:.2f} m, turned by {:.0f} degrees\n", end["position"][0].get<double>(),
               end["position"][1].get<double>(), end["turn"].get<double>() * 180.0 / std::numbers::pi);
  }
}

}  // namespace

Action add_keyframes(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path graph;
    std::filesystem::path output;
    std::filesystem::path report;
    std::filesystem::path program;
    std::filesystem::path top_view;
    KeyframesOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("--graph", arguments->graph, "surface motion graph of the database, from `reprise graph`")
      ->required();
  const std::function<void()> complete = add_keyframe_options(command, arguments->options);
  command.add_option("-o,--output", arguments->output, "animation to write, such as new.reprise")->required();
  command.add_option("--report", arguments->report, "write the path and its certificate, FILE.json");
  command.add_option("--top-view", arguments->top_view, "draw the way over the ground from above, FILE.png");
  command.add_option("--lp", arguments->program, "write the query as an integer program, FILE.lp");
  return [arguments, complete] {
    check_outputs({{arguments->output, ".reprise"},
                   {arguments->report, ".json"},
                   {arguments->program, ".lp"},
                   {arguments->top_view, ".png"}},
                  {arguments->database, arguments->graph});
    complete();
    const KeyframesOptions& options = arguments->options;
    const SurfaceMotionGraph graph = load_graph(arguments->graph);
    const PerformanceDatabase database = load_database(arguments->database);
    const auto results = run_keyframe_alternatives(database, graph, options);
    if (!results) throw Error("no path: " + results.error().reason);
    std::string program;
    if (!arguments->program.empty()) {
      program = keyframe_program(database, graph, options, results->front().path.cost);
    }

    // One answer reports itself, several are a list.
    nlohmann::json report = results->front().report;
    if (results->size() > 1) {
      report = nlohmann::json::array();
      for (const KeyframesResult& result : *results) report.push_back(result.report);
    }
    DatabaseWriter writer(arguments->output, database.topology());
    if (database.markup()) writer.set_markup(*database.markup());
    writer.set_models(database.models());
    for (const KeyframesResult& result : *results) writer.write_clip(result.animation);
    writer.set_note(report.dump());
    writer.commit();
    if (!arguments->report.empty()) write_text_file(arguments->report, report.dump(2) + "\n");
    if (!program.empty()) write_text_file(arguments->program, program);
    if (!arguments->top_view.empty()) draw_top_view(options, *results, arguments->top_view);

    fmt::print("{}\n", arguments->output.string());
    for (const KeyframesResult& result : *results) print_answer(options, result);
    if (results->size() < options.alternatives.count) {
      fmt::print("there are no more paths that differ enough\n");
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
