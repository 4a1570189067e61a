// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/similarity.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/ranks.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/render/plots.h"
#include "similarity_options.h"

namespace reprise::cli {
namespace {

void print_report(const SimilarityResult& result, const HistogramOptions& histogram) {
  const DissimilarityMatrix& matrix = result.matrix;
  fmt::print("{} x {} frames, metric {}, {:.2f} s{}\n", matrix.frame_count(), matrix.frame_count(),
             matrix.metric(), result.seconds, result.from_cache ? " (kept from an earlier run)" : "");
  fmt::print("{} of {} pairs exact{}\n", matrix.exact_count(), matrix.pair_count(),
             matrix.exact_count() < matrix.pair_count() ? ", the others between bounds" : "");
  if (matrix.metric().starts_with("shape") && !result.from_cache) {
    const int turns = histogram.azimuth_bins * histogram.azimuth_refinement;
    fmt::print("{} of {} x {} transport problems solved, {} more left when they were decided\n",
               result.statistics.exact_solves, matrix.pair_count(), turns, result.statistics.cut_solves);
  }
  fmt::print("{} transitions\n", result.transitions.size());
}

}  // namespace

Action add_similarity(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path picture;
    bool no_cache = false;
    SimilarityOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  add_metric_options(command, arguments->options);
  command.add_option("--picture", arguments->picture,
                     "write a heat map, FILE.png, with the best transitions marked");
  command.add_flag("--no-cache", arguments->no_cache, "compute anew, keep nothing");
  return [arguments] {
    check_outputs({{arguments->picture, ".png"}}, {arguments->database});
    arguments->options.use_cache = !arguments->no_cache;
    const PerformanceDatabase database = load_database(arguments->database);
    const SimilarityResult result = compute_similarity(database, arguments->database, arguments->options);
    if (!Ranks::is_first()) return exit_success;
    print_report(result, arguments->options.histogram);
    if (!arguments->picture.empty()) {
      plot_matrix(result.matrix, result.transitions, arguments->picture);
      fmt::print("{}\n", arguments->picture.string());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
