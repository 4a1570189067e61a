// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_deformation.h"

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "evaluate.h"
#include "reprise/core/atomic_file.h"
#include "reprise/io/database_file.h"

namespace reprise::cli {

Action add_evaluate_deformation(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path folder;
    std::string parts;
    DeformationEvaluationOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  DeformationEvaluationOptions& options = arguments->options;
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command.add_option("-o,--output", arguments->folder, "folder for tables and pictures")->required();
  command
      .add_option("--held", options.held,
                  "clips that nothing is learnt from and that are reproduced; default: the last one, or none "
                  "with --truth")
      ->delimiter(',');
  command.add_option("--truth", options.truth,
                     "another database of the same surface: all of its clips are reproduced");
  command
      .add_option("--model", options.models,
                  fmt::format("{}; repeat for several", fmt::join(deformation_models(), ", ")))
      ->delimiter(',')
      ->default_str("all");
  command.add_option("--constraints", options.constraints, "constrained vertices, such as 10,20,40")
      ->delimiter(',');
  command.add_option("--every", options.stride, "reproduce every so manieth frame")
      ->check(CLI::PositiveNumber);
  command.add_option("--pictures", options.pictures, "frames drawn beside each model's result");

  const char* const learning = "Learning, as in `reprise model learn`";
  command
      .add_option(
          "--parts", arguments->parts,
          "parts and reference of a markup, FILE.json, or made from the joints: six or limbs; default: "
          "those of the database")
      ->group(learning);
  command.add_option("--count", options.learning.selection.count, "most examples a part")
      ->check(CLI::PositiveNumber)
      ->group(learning);
  command
      .add_option("--keep", options.learning.learning.kept_variance,
                  "share of the variance that a part keeps")
      ->check(CLI::Range(0.0, 1.0))
      ->group(learning);
  return [arguments] {
    if (arguments->parts.ends_with(".json")) {
      arguments->options.learning.parts = arguments->parts;
    } else if (!arguments->parts.empty()) {
      arguments->options.learning.scheme = parse_part_scheme(arguments->parts);
    }
    const PerformanceDatabase database = load_database(arguments->database);
    evaluate_deformation(database, arguments->folder, arguments->options);
    fmt::print("{}", read_text_file(arguments->folder / "deformation.md"));
    return exit_success;
  };
}

}  // namespace reprise::cli
