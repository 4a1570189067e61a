// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/import.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"

namespace reprise::cli {

Action add_import(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::vector<std::string> sequences;
    ImportOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "database to write, such as ama.reprise")->required();
  command
      .add_option("--sequence", arguments->sequences,
                  "a clip: NAME=PATH[,fps=25][,topology=FILE][,scale=0.01][,id=SEQUENCE]. PATH is a folder "
                  "of numbered "
                  "OBJ or PLY files, a PC2 or MDD file (with topology=FILE.ply or .obj), or an HDF5 file "
                  "with a 'faces' "
                  "array (with id=); repeat for more clips")
      ->required()
      ->take_all();
  command.add_flag("--append", arguments->options.append,
                   "keep the clips of an existing database and add these");
  return [arguments] {
    for (const std::string& text : arguments->sequences) {
      arguments->options.sequences.push_back(parse_import_sequence(text));
    }
    const ImportReport report = import_sequences(arguments->database, arguments->options);
    const double megabytes = static_cast<double>(report.bytes) / 1e6;
    fmt::print("{}: {} clips imported, {} frames, {:.1f} MB read in {:.2f} s ({:.0f} MB/s)\n",
               arguments->database.string(), report.clips, report.frames, megabytes, report.seconds,
               megabytes / report.seconds);
    return exit_success;
  };
}

}  // namespace reprise::cli
