// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "evaluate.h"

#include <utility>
#include <vector>

namespace reprise::cli {

Action add_evaluate(CLI::App& command) {
  command.require_subcommand(1);
  CLI::App* deformation = command.add_subcommand(
      "deformation", "how well each model of deformation makes frames that were held out, with pictures");
  CLI::App* keyframes = command.add_subcommand(
      "keyframes", "errors, certificates and CPU time over a grid of targets, with pictures");
  CLI::App* naturalness =
      command.add_subcommand("naturalness", "pops, sliding feet and stretched triangles of an animation");
  CLI::App* similarity =
      command.add_subcommand("similarity", "how well the metrics tell which frames are alike, with pictures");
  const std::vector<std::pair<CLI::App*, Action>> actions = {
      {deformation, add_evaluate_deformation(*deformation)},
      {keyframes, add_evaluate_keyframes(*keyframes)},
      {naturalness, add_evaluate_naturalness(*naturalness)},
      {similarity, add_evaluate_similarity(*similarity)}};
  return [actions] {
    for (const auto& [subcommand, action] : actions) {
      if (subcommand->parsed()) return action();
    }
    return exit_usage;
  };
}

}  // namespace reprise::cli
