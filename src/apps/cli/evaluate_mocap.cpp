// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_mocap.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "evaluate.h"
#include "mocap_options.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/ranks.h"

namespace reprise::cli {
namespace {

// CLIP=TRIAL
void add_held(const std::vector<std::string>& pairs, std::map<std::string, std::string>& held) {
  for (const std::string& pair : pairs) {
    const std::size_t sign = pair.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == pair.size()) {
      throw InvalidArgument(fmt::format("--held: expected CLIP=TRIAL, such as walk=07_01, found '{}'", pair));
    }
    const std::string trial = pair.substr(sign + 1);
    if (!held.emplace(trial, pair.substr(0, sign)).second) {
      throw InvalidArgument(fmt::format("--held: trial '{}' is named twice", trial));
    }
  }
}

}  // namespace

Action add_evaluate_mocap(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path folder;
    std::filesystem::path held_file;
    std::vector<std::string> held;
    MocapEvaluationOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  MocapEvaluationOptions& options = arguments->options;
  command.add_option("database", arguments->database, "a .reprise file with markup")->required();
  command.add_option("--corpus", options.corpus, "trials to perform, INDEX.csv (docs/mocap.md)")->required();
  command.add_option("-o,--output", arguments->folder, "folder for tables and pictures")->required();
  command.add_option("--tiers", options.tiers, "of the corpus, such as core,core-stop; default: all")
      ->delimiter(',');
  command.add_option("--trials", options.trials, "of the corpus, such as 07_01,08_07; default: all")
      ->delimiter(',');
  command
      .add_option("--truth", options.truth,
                  "other databases of the same surface: a clip TRIAL is what the performer does in it")
      ->delimiter(',');
  command
      .add_option("--held", arguments->held,
                  "CLIP=TRIAL: that clip shows this very trial; for it, it is left out and is the truth")
      ->delimiter(',');
  command.add_option("--held-file", arguments->held_file, "the same as JSON, {\"CLIP\": \"TRIAL\", ...}");
  const std::function<void()> complete = add_mocap_options(command, options.mocap);
  return [arguments, complete] {
    complete();
    MocapEvaluationOptions& asked = arguments->options;
    if (!arguments->held_file.empty()) asked.held = read_held_clips(arguments->held_file);
    add_held(arguments->held, asked.held);
    const std::vector<MocapTrial> trials = evaluate_mocap(arguments->database, arguments->folder, asked);
    if (!Ranks::is_first()) return exit_success;
    fmt::print("{}", read_text_file(arguments->folder / "mocap.md"));
    const bool has_failed =
        std::ranges::any_of(trials, [](const MocapTrial& trial) { return !trial.failure.empty(); });
    return has_failed ? exit_failure : exit_success;
  };
}

}  // namespace reprise::cli
