// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The commands of `reprise`: each has a file of its own with options -> stage -> exit code, and nothing else.

#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace reprise::cli {

// Exit codes of the program.
inline constexpr int exit_success = 0;
inline constexpr int exit_failure = 1;        // bad input, or an outcome that is not what was asked for
inline constexpr int exit_usage = 2;          // the command line itself is wrong
inline constexpr int exit_interrupted = 130;  // Ctrl-C, as shells expect

// Runs after the command line was parsed; returns an exit code.
using Action = std::function<int()>;

struct Command {
  const char* name;
  const char* summary;
  Action (*add)(CLI::App& command);  // declares the options on `command`
  bool shares_work = false;          // over MPI ranks
};

Action add_perform(CLI::App& command);
Action add_import(CLI::App& command);
Action add_info(CLI::App& command);
Action add_validate(CLI::App& command);
Action add_markup(CLI::App& command);
Action add_skeleton(CLI::App& command);
Action add_model(CLI::App& command);
Action add_similarity(CLI::App& command);
Action add_graph(CLI::App& command);
Action add_keyframes(CLI::App& command);
Action add_mocap(CLI::App& command);
Action add_play(CLI::App& command);
Action add_edit(CLI::App& command);
Action add_export(CLI::App& command);
Action add_render(CLI::App& command);
Action add_evaluate(CLI::App& command);

}  // namespace reprise::cli
