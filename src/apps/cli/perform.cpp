// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/perform.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "command.h"

namespace reprise::cli {

Action add_perform(CLI::App& command) {
  struct Arguments {
    std::filesystem::path output;
    PerformOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("-o,--output", arguments->output, "database to write, such as figure.reprise")
      ->required();
  command.add_option("--costume", arguments->options.costume, "who performs: figure");
  command.add_option("--fps", arguments->options.figure.frames_per_second, "frames per second");
  command.add_option("--height", arguments->options.figure.height, "height of the figure, metres");
  command.add_option("--voxel-size", arguments->options.figure.voxel_size, "size of the triangles, metres");
  return [arguments] {
    const PerformReport report = perform(arguments->output, arguments->options);
    fmt::print("{}: {} clips, {} frames, {} vertices\n", arguments->output.string(), report.clips,
               report.frames, report.vertices);
    return exit_success;
  };
}

}  // namespace reprise::cli
