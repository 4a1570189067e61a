// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/log.h"
#include "reprise/core/ranks.h"
#include "reprise/core/text.h"

namespace {

using reprise::Ranks;
using reprise::cli::Action;
using reprise::cli::Command;

// In the order of the way through the house: this table is the table of contents of the program.
constexpr std::array commands = {
    Command{"perform", "make the database of the built-in synthetic performer", reprise::cli::add_perform},
    Command{"import", "read captured sequences into a database", reprise::cli::add_import},
    Command{"info", "say what a database holds", reprise::cli::add_info},
    Command{"validate", "look for what is wrong with a database or a folder of frames",
            reprise::cli::add_validate},
    Command{"markup", "say what bones and parts the vertices belong to", reprise::cli::add_markup},
    Command{"skeleton", "follow the skeleton through the clips", reprise::cli::add_skeleton},
    Command{"model", "learn how the parts deform, for editing", reprise::cli::add_model},
    Command{"similarity", "compare all pairs of frames", reprise::cli::add_similarity,
            /*shares_work=*/true},
    Command{"graph", "find transitions between clips", reprise::cli::add_graph, /*shares_work=*/true},
    Command{"keyframes", "make a new animation through key-frames", reprise::cli::add_keyframes},
    Command{"mocap", "perform skeletal motion: BVH or ASF/AMC", reprise::cli::add_mocap,
            /*shares_work=*/true},
    Command{"play", "play on without an end: a loop, or a random walk", reprise::cli::add_play},
    Command{"edit", "drag vertices of captured frames", reprise::cli::add_edit},
    Command{"export", "write a clip for other programs: glTF, PC2, MDD, OBJ, PLY", reprise::cli::add_export},
    Command{"render", "draw a clip as video or pictures", reprise::cli::add_render},
    Command{"evaluate", "measure the quality of a result", reprise::cli::add_evaluate, /*shares_work=*/true},
};

// Never throws: standard error may be closed or full, and the exit code must still tell.
void say(const std::string& text) {
  const std::string line = "reprise: " + text + "\n";
  std::fputs(line.c_str(), stderr);
}

// Of several ranks that would all say the same, the first speaks.
void complain(const std::string& text) {
  if (!Ranks::is_first()) return;
  say(text);
}

// The end of a rank that cannot go on; the others must not wait for it.
int fail(const std::string& text, int code) {
  complain(text);
  if (Ranks::all_failed()) return code;
  if (!Ranks::is_first()) say(text + " (on rank " + std::to_string(Ranks::index()) + ")");
  Ranks::abort(code);
}

// The parser only says that a command is missing; a typo deserves its name and the nearest command.
bool is_known_command(const std::string& word) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.emplace_back(command.name);
  if (word.starts_with('-') || std::ranges::count(names, word) > 0) return true;
  const std::string nearest = reprise::nearest_word(word, names);
  complain(fmt::format(
      "there is no command '{}'{}", word,
      nearest.empty() ? "; `reprise --help` lists them" : fmt::format("; did you mean '{}'?", nearest)));
  return false;
}

int run(int argc, char** argv) {
  if (argc > 1 && !is_known_command(argv[1])) return reprise::cli::exit_usage;
  CLI::App app("Reprise turns 4D performance capture into a character that can perform again.", "reprise");
  app.set_version_flag("--version", REPRISE_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  bool verbose = false;
  app.add_flag("-v,--verbose", verbose, "say more of what is being done");
  app.get_formatter()->column_width(40);

  std::vector<std::pair<CLI::App*, Action>> actions;
  for (const Command& command : commands) {
    CLI::App* subcommand = app.add_subcommand(command.name, command.summary);
    subcommand->fallthrough();  // --verbose may stand after the command as well
    actions.emplace_back(subcommand, command.add(*subcommand));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream unheard;
    const int code = Ranks::is_first() ? app.exit(error) : app.exit(error, unheard, unheard);
    return code == 0 ? reprise::cli::exit_success : reprise::cli::exit_usage;
  }
  reprise::initialize_log(verbose);
  // The others would say the same again.
  if (!Ranks::is_first()) spdlog::set_level(spdlog::level::err);
  reprise::install_interrupt_handler();
  for (std::size_t c = 0; c < actions.size(); ++c) {
    const auto& [subcommand, action] = actions[c];
    if (!subcommand->parsed()) continue;
    if (Ranks::count() > 1 && !commands[c].shares_work) {
      complain(fmt::format("error: '{}' does not share its work over MPI ranks: start it without mpirun",
                           commands[c].name));
      return reprise::cli::exit_usage;
    }
    return action();
  }
  return reprise::cli::exit_usage;
}

// Runs the command on this rank, whatever happens.
int run_rank(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0) throw reprise::Error("standard output cannot be written");
    return code;
  } catch (const reprise::Cancelled& error) {
    return fail(error.what(), reprise::cli::exit_interrupted);
  } catch (const std::bad_alloc&) {
    return fail("error: out of memory", reprise::cli::exit_failure);
  } catch (const std::exception& error) {
    return fail(std::string("error: ") + error.what(), reprise::cli::exit_failure);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Ranks ranks;
    return run_rank(argc, argv);
  } catch (const std::exception& error) {  // MPI did not start
    complain(std::string("error: ") + error.what());
    return reprise::cli::exit_failure;
  }
}
