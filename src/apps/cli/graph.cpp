// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/graph.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/render/plots.h"

namespace reprise::cli {
namespace {

void add_transition_options(CLI::App& command, TransitionOptions& options) {
  command.add_option("--transitions-per-pair", options.transitions_per_pair,
                     "best transitions kept per ordered pair of clips");
  command.add_option("--max-half-window", options.max_half_window,
                     "longest blend, frames on either side of its centre");
  command.add_option("--min-half-window", options.min_half_window, "shortest blend");
  command.add_option("--self-min-gap", options.self_min_gap,
                     "a clip links to itself only over this many frames");
  command.add_option("--separation", options.separation, "frames between transitions of one pair");
  command
      .add_option_function<std::string>(
          "--criterion",
          [&options](const std::string& name) {
            options.criterion =
                name == "paper-sum" ? WindowCriterion::paper_sum : WindowCriterion::blend_speed;
          },
          "how the length of a blend is chosen: blend-speed, or paper-sum (Eq. 5 literally)")
      ->check(CLI::IsMember({"blend-speed", "paper-sum"}))
      ->default_str("blend-speed");
  command.add_option("--acceleration-weight", options.acceleration_weight,
                     "blend-speed: weight of the peak acceleration, frames^2");
  command
      .add_option_function<std::string>(
          "--profile",
          [&options](const std::string& name) {
            options.profile = name == "linear" ? BlendProfile::linear : BlendProfile::smooth;
          },
          "blend weight along the window: smooth, or linear (Eq. 2)")
      ->check(CLI::IsMember({"smooth", "linear"}))
      ->default_str("smooth");
}

}  // namespace

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
  command.add_option("--metric", arguments->similarity.metric, "which dissimilarity: vertex");
  add_transition_options(command, arguments->options.transitions);
  command.add_option("--remove", arguments->options.remove,
                     "take out an edge: 'walk->run', or 'walk:12->run:30'");
  command.add_option("--restore", arguments->options.restore, "bring back a removed edge");
  command.add_option("--picture", arguments->picture, "draw the graph, FILE.svg");
  return [arguments] {
    check_outputs({{arguments->output, ".json"}, {arguments->picture, ".svg"}}, {arguments->database});
    const PerformanceDatabase database = load_database(arguments->database);
    const SimilarityResult similarity =
        compute_similarity(database, arguments->database, arguments->similarity);
    std::optional<SurfaceMotionGraph> previous;
    if (std::filesystem::exists(arguments->output)) previous = load_graph(arguments->output);
    const SurfaceMotionGraph graph = make_graph(database, similarity.matrix, arguments->options, previous);
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
