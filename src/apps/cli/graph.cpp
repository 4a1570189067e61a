// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/graph.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/ranks.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/render/plots.h"
#include "similarity_options.h"

namespace reprise::cli {

namespace {

const std::map<std::string, Pruning> prunings = {
    {"none", Pruning::none}, {"dead-ends", Pruning::dead_ends}, {"both-ends", Pruning::both_ends}};

}  // namespace

Action add_graph(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::filesystem::path picture;
    SimilarityOptions similarity;
    GraphOptions options;
    bool describe = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("-o,--output", arguments->output,
                  "graph to write, FILE.json; edits in an older one are kept")
      ->required();
  add_metric_options(command, arguments->similarity);
  add_transition_options(command, arguments->similarity.transitions);
  const auto add_edits = [&](const char* name, std::vector<std::string>& edges, const char* meaning) {
    command.add_option(name, edges, meaning)->type_name("EDGE ...")->group("Edits");
  };
  GraphOptions& edits = arguments->options;
  add_edits("--remove", edits.remove, "take out edges: 'walk->run', '*->hit', or 'walk:12->run:30'");
  add_edits("--restore", edits.restore, "take back a removal");
  add_edits("--protect", edits.protect,
            "keep transitions in force, whatever removes them or does not find them again");
  add_edits("--unprotect", edits.unprotect, "let protected transitions go");
  add_edits("--add", edits.add,
            "make a transition by hand: 'walk:12->run:30', or 'walk:12->run:30@8' to blend 8 frames on "
            "either side");
  add_edits("--drop", edits.drop, "take out transitions made by hand");
  command
      .add_option_function<std::string>(
          "--prune", [&edits](const std::string& name) { edits.pruning = prunings.at(name); },
          "take out of force what leads to where every walk ends (dead-ends), and what leaves where only a "
          "start leads (both-ends); none: put it back")
      ->check(CLI::IsMember({"none", "dead-ends", "both-ends"}))
      ->group("Edits");
  command.add_flag("--components", arguments->describe,
                   "say which frames go on for ever, and which only lead there or away");
  command.add_option("--picture", arguments->picture, "draw the graph, FILE.svg");
  return [arguments] {
    check_outputs({{arguments->output, ".json"}, {arguments->picture, ".svg"}}, {arguments->database});
    const PerformanceDatabase database = load_database(arguments->database);
    std::optional<SurfaceMotionGraph> previous;
    if (std::filesystem::exists(arguments->output)) previous = load_graph(arguments->output);
    arguments->similarity.requests = requested_transitions(database, arguments->options, previous);
    const SimilarityResult similarity =
        compute_similarity(database, arguments->database, arguments->similarity);
    if (!Ranks::is_first()) return exit_success;
    const SurfaceMotionGraph graph = make_graph(database, similarity, arguments->options, previous);
    save_graph(graph, arguments->output);
    const std::size_t in_force = graph.active_transitions().size();
    const std::size_t out = graph.edges().size() - in_force;
    fmt::print("{}: {} clips, {} transitions{}\n", arguments->output.string(), graph.clips.size(), in_force,
               out > 0 ? fmt::format(" in force, {} removed or pruned", out) : "");
    if (arguments->describe) fmt::print("{}", describe_graph(graph));
    if (!arguments->picture.empty()) {
      draw_graph(graph, arguments->picture);
      fmt::print("{}\n", arguments->picture.string());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
