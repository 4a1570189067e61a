// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/similarity.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "command.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/render/plots.h"

namespace reprise::cli {

Action add_similarity(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path picture;
    bool no_cache = false;
    SimilarityOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command.add_option("--metric", arguments->options.metric,
                     "vertex: root-mean-square vertex distance, aligned on the ground");
  command.add_option("--picture", arguments->picture,
                     "write a heat map, FILE.png, with the best transitions marked");
  command.add_flag("--no-cache", arguments->no_cache, "compute anew, keep nothing");
  return [arguments] {
    check_outputs({{arguments->picture, ".png"}}, {arguments->database});
    arguments->options.use_cache = !arguments->no_cache;
    const PerformanceDatabase database = load_database(arguments->database);
    const SimilarityResult result = compute_similarity(database, arguments->database, arguments->options);
    fmt::print("{} x {} frames, metric {}, {:.2f} s{}\n", result.matrix.frame_count(),
               result.matrix.frame_count(), result.matrix.metric(), result.seconds,
               result.from_cache ? " (kept from an earlier run)" : "");
    if (!arguments->picture.empty()) {
      plot_matrix(result.matrix, find_transitions(database, result.matrix), arguments->picture);
      fmt::print("{}\n", arguments->picture.string());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
