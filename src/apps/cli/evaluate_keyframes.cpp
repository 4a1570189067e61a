// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_keyframes.h"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "evaluate.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"

namespace reprise::cli {

Action add_evaluate_keyframes(CLI::App& command) {
  struct Arguments {
    std::vector<std::filesystem::path> databases;
    std::vector<std::filesystem::path> graphs;
    std::vector<std::pair<std::string, std::string>> pairs;
    std::filesystem::path folder;
    bool anew = false;
    EvaluateKeyframesOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  EvaluateKeyframesOptions& options = arguments->options;
  command.add_option("databases", arguments->databases, "one or more .reprise files")->required();
  command.add_option("-o,--output", arguments->folder, "folder for tables and pictures")->required();
  command
      .add_option("--graph", arguments->graphs,
                  "surface motion graphs, one a database, in their order; default: made with default options")
      ->take_all();
  command
      .add_option("--pair", arguments->pairs,
                  "FROM TO, key-frames CLIP:FRAME, in each database; repeat for more; default: those of the "
                  "paper's table")
      ->take_all();
  command.add_option("--max-distance", options.max_distance, "targets of 1 m to this, metres");
  command.add_option("--max-time", options.max_time, "targets of 1 s to this, seconds");
  command.add_option("--samples", options.samples, "queries whose frames are made and measured");
  command.add_option("--reach-distance", options.reach_distance,
                     "a target that the optimum misses by more is out of reach, metres");
  command.add_option("--reach-time", options.reach_time, "the same, seconds");
  command.add_option("--max-retiming", options.correction.max_retiming,
                     "share by which the correction may change the duration");
  command.add_option("--max-stretch", options.correction.max_stretch,
                     "share by which the correction may change the way over the ground");
  command.add_option("--distance-weight", options.optimizer.distance_weight,
                     "cost of a metre beside the target");
  command.add_option("--time-weight", options.optimizer.time_weight, "cost of a frame beside the target");
  command
      .add_option("--max-labels", options.optimizer.max_labels,
                  "partial paths a query may look at before the best so far is given with its gap")
      ->check(CLI::PositiveNumber);
  command.add_flag("--anew", arguments->anew, "compute everything anew, whatever an earlier run finished");
  return [arguments] {
    arguments->options.resume = !arguments->anew;
    const std::size_t count = arguments->databases.size();
    if (!arguments->graphs.empty() && arguments->graphs.size() != count) {
      throw InvalidArgument(fmt::format("--graph: expected one a database, {}, or none, found {}", count,
                                        arguments->graphs.size()));
    }
    std::vector<GridDatabase> databases(count);
    for (std::size_t d = 0; d < count; ++d) {
      databases[d].database = arguments->databases[d];
      if (!arguments->graphs.empty()) databases[d].graph = arguments->graphs[d];
      for (const auto& [from, to] : arguments->pairs) databases[d].pairs.push_back({from, to});
    }
    evaluate_keyframes(databases, arguments->folder, arguments->options);
    fmt::print("{}", read_text_file(arguments->folder / "table.md"));
    return exit_success;
  };
}

}  // namespace reprise::cli
