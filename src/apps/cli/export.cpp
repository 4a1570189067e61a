// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.h"
#include "reprise/io/sequence_writer.h"
#include "reprise/pipeline/open.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {

Action add_export(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::string clip;
    std::string format;
    bool ascii = false;
    bool no_topology = false;
    SequenceWriteOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("-o,--output", arguments->output,
                  "FILE.glb, FILE.pc2, FILE.mdd, or a folder of OBJ or PLY files")
      ->required();
  command.add_option("--format", arguments->format, "glb, pc2, mdd, obj or ply; needed for a folder");
  command.add_option("--clip", arguments->clip, "which clip, if the file has several");
  command.add_flag("--ascii", arguments->ascii, "ply: text rather than binary");
  command.add_flag("--no-topology", arguments->no_topology,
                   "pc2, mdd: do not write the faces to a PLY file beside it");
  command.add_flag("--quantize", arguments->options.quantize, "glb: 16-bit positions, about half the size");
  command.add_flag("--interpolate", arguments->options.interpolate, "glb: blend linearly between frames");
  command.add_option("--max-morph-targets", arguments->options.max_morph_targets,
                     "glb: longer clips keep the frames that say most, as viewers hold no more");
  return [arguments] {
    arguments->options.binary_ply = !arguments->ascii;
    arguments->options.write_topology = !arguments->no_topology;
    const SequenceFormat format = parse_sequence_format(arguments->format, arguments->output);
    check_outputs({{arguments->output, file_extension(format)}}, {arguments->database});
    const MeshSequence clip = open_clip(arguments->database, arguments->clip);
    const SequenceWriteReport report = write_sequence(clip, arguments->output, format, arguments->options);
    fmt::print("{}: {} of {} frames", report.path.string(), report.frames_written, clip.frame_count());
    if (report.max_error > 0.0) fmt::print(", at most {:.2g} m off", report.max_error);
    fmt::print("\n");
    for (const std::filesystem::path& beside : report.files_beside) fmt::print("{}\n", beside.string());
    return exit_success;
  };
}

}  // namespace reprise::cli
