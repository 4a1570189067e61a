// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "evaluate.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/ranks.h"

namespace reprise::cli {

Action add_evaluate(CLI::App& command) {
  command.require_subcommand(1);
  CLI::App* deformation = command.add_subcommand(
      "deformation", "how well each model of deformation makes frames that were held out, with pictures");
  CLI::App* keyframes = command.add_subcommand(
      "keyframes", "errors, certificates and CPU time over a grid of targets, with pictures");
  CLI::App* mocap = command.add_subcommand(
      "mocap", "errors of a driven character over a corpus of motion capture, with pictures");
  CLI::App* naturalness =
      command.add_subcommand("naturalness", "pops, sliding feet and stretched triangles of an animation");
  CLI::App* similarity =
      command.add_subcommand("similarity", "how well the metrics tell which frames are alike, with pictures");
  const std::vector<std::pair<CLI::App*, Action>> actions = {
      {deformation, add_evaluate_deformation(*deformation)},
      {keyframes, add_evaluate_keyframes(*keyframes)},
      {mocap, add_evaluate_mocap(*mocap)},
      {naturalness, add_evaluate_naturalness(*naturalness)},
      {similarity, add_evaluate_similarity(*similarity)}};
  return [actions] {
    for (const auto& [subcommand, action] : actions) {
      if (!subcommand->parsed()) continue;
      if (Ranks::count() > 1 && subcommand->get_name() != "mocap") {
        if (Ranks::is_first()) {
          fmt::print(stderr,
                     "reprise: error: 'evaluate {}' does not share its work over MPI ranks: start it without "
                     "mpirun\n",
                     subcommand->get_name());
        }
        return exit_usage;
      }
      return action();
    }
    return exit_usage;
  };
}

}  // namespace reprise::cli
