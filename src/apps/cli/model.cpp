// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/atomic_file.h"
#include "reprise/pipeline/learn_model.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {
namespace {

void print_model(const char* model, const nlohmann::json& learnt) {
  if (learnt.is_null()) return;
  fmt::print("{} model: examples in {:.2f} s, learnt in {:.2f} s\n", model,
             learnt["choosing_seconds"].get<double>(), learnt["learning_seconds"].get<double>());
  for (const nlohmann::json& part : learnt["parts"]) {
    fmt::print("  {:<20} {:>6} vertices  {:>4} examples within {:.1f} mm  {:>4} components keep {:.1f} %\n",
               part["name"].get<std::string>(), part["vertices"].get<std::size_t>(),
               part["examples"].get<std::size_t>(), 1000.0 * part["covering_radius"].get<double>(),
               part["components"].get<std::size_t>(), 100.0 * part["kept_variance"].get<double>());
  }
}

Action add_model_learn(CLI::App& command) {
  using Model = LearnModelOptions::Model;
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::filesystem::path report;
    std::filesystem::path write_examples;
    std::string parts;
    std::string examples = "auto";
    LearnModelOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  LearnModelOptions& options = arguments->options;
  const std::map<std::string, Model> models = {
      {"both", Model::both}, {"part", Model::part}, {"whole", Model::whole}};
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option(
          "--model", options.model,
          "what to learn: part (each part on its own), whole (the body as one part, needs no markup) or both")
      ->transform(CLI::CheckedTransformer(models))
      ->default_str("both");
  command.add_option(
      "--parts", arguments->parts,
      "take parts and reference surface from a markup, FILE.json, or make the parts from the "
      "joints: six (torso, head, arms, legs) or limbs (upper arm, forearm, hand, ...); default: "
      "those of the database");
  command.add_option("--examples", arguments->examples,
                     "frames to learn from: auto (extreme poses of each part) or a list, FILE.json");
  command.add_option("--count", options.selection.count, "most examples a part, chosen automatically")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--radius", options.selection.smallest_radius,
                  "enough examples once every frame is this near to one, metres")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--without", options.without, "clips held out: nothing is learnt from them")
      ->delimiter(',');
  command.add_option("--keep", options.learning.kept_variance, "share of the variance that a part keeps")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--most-components", options.learning.most_components, "of a part; 0: no limit")
      ->check(CLI::NonNegativeNumber);
  command.add_option("-o,--output", arguments->output,
                     "database to write, with the model; default: DATABASE itself is replaced");
  command.add_option("--report", arguments->report, "write what was learnt, FILE.json");
  command.add_option("--write-examples", arguments->write_examples,
                     "write the examples as a list to look through and edit, FILE.json");
  return [arguments] {
    LearnModelOptions& learn = arguments->options;
    if (arguments->parts.ends_with(".json")) {
      learn.parts = arguments->parts;
    } else if (!arguments->parts.empty()) {
      learn.scheme = parse_part_scheme(arguments->parts);
    }
    if (arguments->examples != "auto") learn.examples = arguments->examples;
    check_outputs({{arguments->report, ".json"}, {arguments->write_examples, ".json"}},
                  {arguments->database, learn.parts, learn.examples});
    const LearnModelResult result =
        learn_models(arguments->database, learn, arguments->output, arguments->write_examples);
    if (!arguments->report.empty()) {
      write_text_file(arguments->report,
                      result.report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    }
    fmt::print("{}\n", result.report["output"].get<std::string>());
    for (const char* model : {"part", "whole"}) print_model(model, result.report["models"][model]);
    return exit_success;
  };
}

}  // namespace

Action add_model(CLI::App& command) {
  command.require_subcommand(1);
  CLI::App* learn = command.add_subcommand("learn", "from example frames of the clips, into the database");
  return add_model_learn(*learn);
}

}  // namespace reprise::cli
