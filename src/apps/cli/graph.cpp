// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/graph.h"

#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/ranks.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/render/plots.h"
#include "similarity_options.h"

namespace reprise::cli {

Action add_graph(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::filesystem::path picture;
    SimilarityOptions similarity;
    GraphOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("-o,--output", arguments->output,
                  "graph to write, FILE.json; removals in an older one are kept")
      ->required();
  add_metric_options(command, arguments->similarity);
  add_transition_options(command, arguments->similarity.transitions);
  command.add_option("--remove", arguments->options.remove,
                     "take out an edge: 'walk->run', or 'walk:12->run:30'");
  command.add_option("--restore", arguments->options.restore, "bring back a removed edge");
  command.add_option("--picture", arguments->picture, "draw the graph, FILE.svg");
  return [arguments] {
    check_outputs({{arguments->output, ".json"}, {arguments->picture, ".svg"}}, {arguments->database});
    const PerformanceDatabase database = load_database(arguments->database);
    const SimilarityResult similarity =
        compute_similarity(database, arguments->database, arguments->similarity);
    if (!Ranks::is_first()) return exit_success;
    std::optional<SurfaceMotionGraph> previous;
    if (std::filesystem::exists(arguments->output)) previous = load_graph(arguments->output);
    const SurfaceMotionGraph graph = make_graph(database, similarity, arguments->options, previous);
    save_graph(graph, arguments->output);
    fmt::print("{}: {} clips, {} transitions, {} of them removed\n", arguments->output.string(),
               graph.clips.size(), graph.transitions.size(),
               graph.transitions.size() - graph.active_transitions().size());
    if (!arguments->picture.empty()) {
      draw_graph(graph, arguments->picture);
      fmt::print("{}\n", arguments->picture.string());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
