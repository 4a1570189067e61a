// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_similarity.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "evaluate.h"
#include "reprise/core/atomic_file.h"
#include "reprise/io/database_file.h"
#include "similarity_options.h"

namespace reprise::cli {

Action add_evaluate_similarity(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path folder;
    bool no_cache = false;
    bool json = false;
    SimilarityEvaluationOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  SimilarityEvaluationOptions& options = arguments->options;
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command.add_option("-o,--output", arguments->folder, "folder for tables and pictures")->required();
  command
      .add_option("--metric", options.metrics, "shape-colour, shape, vertex, skeleton; repeat for several")
      ->default_str("all");
  command.add_option("--truth", options.truth,
                     "the same performance without capture effects; default: the database itself");
  command.add_flag("--exact", options.similarity.exact, "every entry of the matrices exact");
  command.add_flag("--no-cache", arguments->no_cache, "compute anew, keep nothing");
  command.add_flag("--json", arguments->json, "print the JSON instead of the tables");

  const char* const retrieval = "What counts as alike";
  command.add_option("--alike", options.alike, "true pose-and-shape distance, metres")->group(retrieval);
  command
      .add_option("--clothing-alike", options.clothing_alike, "true distance of free cloth and hair, metres")
      ->group(retrieval);
  command.add_option("--looks-alike", options.looks_alike, "share of the picture that changes")
      ->group(retrieval);
  command.add_option("--query-gap", options.query_gap, "frames nearer than this in one clip are not judged")
      ->group(retrieval);

  const char* const pictures = "Pictures";
  command.add_option("--filter", options.filter_half_window, "half window L of the filtered matrices")
      ->group(pictures);
  command.add_option("--pictures", options.pictured_transitions, "transitions shown side by side, a metric")
      ->group(pictures);
  command
      .add_option("--pairs", options.pairs,
                  "only transitions SOURCE:TARGET, such as walk:run; repeat for more")
      ->group(pictures);
  add_histogram_options(command, options.similarity.histogram);
  add_transition_options(command, options.similarity.transitions);
  return [arguments] {
    arguments->options.similarity.use_cache = !arguments->no_cache;
    const PerformanceDatabase database = load_database(arguments->database);
    evaluate_similarity(database, arguments->database, arguments->folder, arguments->options);
    fmt::print("{}",
               read_text_file(arguments->folder / (arguments->json ? "similarity.json" : "similarity.md")));
    return exit_success;
  };
}

}  // namespace reprise::cli
