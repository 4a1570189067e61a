// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/markup.h"

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.h"

namespace reprise::cli {

Action add_markup(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::string parts;
    MarkupOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  MarkupOptions& options = arguments->options;
  command.add_option("database", arguments->database, "a .reprise file")->required();
  CLI::Option* landmarks = command.add_option(
      "--landmarks", options.landmarks, "propose a markup from named vertices, FILE.json (docs/markup.md)");
  CLI::Option* file = command.add_option("--file", options.file, "take the markup from FILE.json");
  file->excludes(landmarks);
  command.add_option("--frame", options.frame,
                     "frame that is marked up, CLIP:FRAME, instead of the one the file names");
  command.add_flag(
      "--keep-joints", options.keep_joints,
      "leave the proposed joints where the landmarks put them, instead of moving them to where the "
      "bones agree best through all clips");
  command.add_option("--parts", arguments->parts,
                     "make the parts anew from the joint labels: six (torso, head, arms, legs), limbs (upper "
                     "arm, forearm, hand, thigh, shin and foot each a part) or whole (one part)");
  command.add_option("-o,--output", arguments->output, "database to write, with the markup");
  command.add_option("--write-json", options.write_json,
                     "write the markup as FILE.json; alone: the one the database has");
  return [arguments] {
    if (!arguments->parts.empty()) arguments->options.parts = parse_part_scheme(arguments->parts);
    const Markup markup = mark_up(arguments->database, arguments->options, arguments->output);
    for (const std::filesystem::path& path : {arguments->output, arguments->options.write_json}) {
      if (path.empty()) continue;
      fmt::print("{}: {} joints, {} parts, {} layers, {} of {} vertices follow a joint\n", path.string(),
                 markup.skeleton.size(), markup.parts.size(), markup.layers.size(),
                 markup.joint_of_vertex.size() - markup.vertices_of_joint(-1).size(),
                 markup.joint_of_vertex.size());
    }
    return exit_success;
  };
}

}  // namespace reprise::cli
