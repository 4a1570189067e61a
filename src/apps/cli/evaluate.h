// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What `reprise evaluate` measures: one subcommand a file.

#pragma once

#include "command.h"

namespace reprise::cli {

Action add_evaluate_deformation(CLI::App& command);
Action add_evaluate_keyframes(CLI::App& command);
Action add_evaluate_mocap(CLI::App& command);
Action add_evaluate_naturalness(CLI::App& command);
Action add_evaluate_similarity(CLI::App& command);

}  // namespace reprise::cli
