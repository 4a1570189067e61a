// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/play.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {

Action add_play(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path graph;
    std::filesystem::path output;
    std::filesystem::path report;
    PlayStageOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  PlayStageOptions& options = arguments->options;
  const std::map<std::string, PlayOptions::Mode> modes = {{"loop", PlayOptions::Mode::loop},
                                                          {"period", PlayOptions::Mode::period},
                                                          {"stochastic", PlayOptions::Mode::stochastic}};
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("--graph", arguments->graph, "surface motion graph of the database, from `reprise graph`")
      ->required();
  command.add_option("--from", options.from, "first frame, CLIP:FRAME")->required();
  command
      .add_option(
          "--mode", options.play.mode,
          "loop: the cheapest loop again and again; period: that loop once, its last frame leads back to "
          "its first; stochastic: a random walk")
      ->transform(CLI::CheckedTransformer(modes))
      ->default_str("stochastic");
  command.add_option("--time", options.play.time, "seconds to play");
  command.add_option("--seed", options.play.seed, "of the random walk");
  command.add_option("--temperature", options.play.temperature,
                     "metres of cost: how much dearer a way may be and still be taken often");
  command.add_option("--foresight", options.play.foresight,
                     "seconds: how far ahead the random walk looks for what is dear");
  command.add_option("--without", options.without, "clips not to show");
  command.add_option(
      "--max-pop", options.max_pop_ratio,
      "greatest acceleration in a join, in times that of the captured clips (99th percentile)");
  command.add_option("--max-cost", options.play.max_transition_cost, "greatest cost of a join, metres");
  command.add_option("-o,--output", arguments->output, "animation to write, such as new.reprise")->required();
  command.add_option("--report", arguments->report, "write what is played, FILE.json");
  command.add_option("--name", options.name, "name of the resulting clip");
  return [arguments] {
    check_outputs({{arguments->output, ".reprise"}, {arguments->report, ".json"}},
                  {arguments->database, arguments->graph});
    const SurfaceMotionGraph graph = load_graph(arguments->graph);
    const PerformanceDatabase database = load_database(arguments->database);
    const auto result = run_play(database, graph, arguments->options);
    if (!result) throw Error("no play: " + result.error().reason);

    DatabaseWriter writer(arguments->output, database.topology());
    if (database.markup()) writer.set_markup(*database.markup());
    writer.set_models(database.models());
    writer.write_clip(result->animation);
    writer.set_note(result->report.dump());
    writer.commit();
    if (!arguments->report.empty()) write_text_file(arguments->report, result->report.dump(2) + "\n");

    const MotionPath& path = result->play.path;
    fmt::print("{}: {} frames, {:.2f} s, {} transitions, {} clips\n", arguments->output.string(),
               path.frame_count, path.time, path.segments.size() - 1, result->report["clips"].size());
    if (result->play.period > 0) {
      fmt::print("the loop lasts {} frames, begins with frame {} and costs {:.4g} m a second\n",
                 result->play.period, result->play.loop_start,
                 result->report["loop"]["cost_per_second"].get<double>());
    }
    if (!result->report["pop_ratio"].is_null()) {
      fmt::print("pop ratio {:.3f}\n", result->report["pop_ratio"].get<double>());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
