// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/render.h"

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "command.h"
#include "reprise/pipeline/open.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/pipeline/part_colors.h"

namespace reprise::cli {

Action add_render(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::string clip;
    std::string size = "1280x720";
    std::string camera = "follow";
    std::string appearance = "auto";
    std::string look_at;
    std::string frames;
    bool no_floor = false;
    RenderStageOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  RenderOptions& view = arguments->options.view;
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("-o,--output", arguments->output,
                  "FILE.mp4 for a video, FILE.png for frames side by side, or a folder for numbered pictures")
      ->required();
  command.add_option("--clip", arguments->clip, "which clip, if the file has several");
  command.add_option("--size", arguments->size, "width and height in pixels (of one frame)");
  command.add_option("--camera", arguments->camera, "follow, orbit, fixed, front or side");
  command.add_option("--yaw", view.camera_yaw_degrees,
                     "direction of the camera about the character, degrees; 0: from +Z");
  command.add_option("--pitch", view.camera_pitch_degrees, "height of the camera above the horizon, degrees");
  command.add_option("--field-of-view", view.field_of_view_degrees, "vertical, degrees");
  command.add_option("--zoom", view.zoom, "enlarges the picture; 1 shows the whole character");
  command.add_option("--look-at", arguments->look_at,
                     "middle of the enlarged picture, ACROSS,UP in heights of the character, from below its "
                     "middle: 0,0.93 is the face, 0,0.03 the feet");
  command.add_option(
      "--appearance", arguments->appearance,
      "auto (texture if there is one, else vertex colours, else plain), texture, colors, plain or parts (the "
      "body parts, mixed by their weights)");
  command.add_option("--samples", view.samples, "samples per pixel against jagged edges");
  command.add_flag("--no-floor", arguments->no_floor, "draw no floor");
  command.add_option("--frames", arguments->frames, "which frames: FIRST:LAST or FIRST:LAST:STEP");
  command.add_option("--columns", arguments->options.columns, "png: frames in one row; 0: all")
      ->check(CLI::NonNegativeNumber);
  return [arguments] {
    check_outputs({{arguments->output, ""}}, {arguments->database});
    RenderStageOptions& options = arguments->options;
    parse_size(arguments->size, options.view);
    options.view.camera = parse_camera(arguments->camera);
    options.view.floor = !arguments->no_floor;
    const bool show_parts = arguments->appearance == "parts";
    options.view.appearance =
        show_parts ? Appearance::vertex_colors : parse_appearance(arguments->appearance);
    if (!arguments->look_at.empty()) parse_look_at(arguments->look_at, options.view);
    if (!arguments->frames.empty()) options.frames = parse_frame_range(arguments->frames);
    MeshSequence clip = open_clip(arguments->database, arguments->clip);
    if (show_parts) color_parts(clip, arguments->database);
    const RenderReport report = render_sequence(clip, arguments->output, options);
    fmt::print("{}: {} frames, {:.1f} frames/s\n", arguments->output.string(), report.frames,
               static_cast<double>(report.frames) / report.seconds);
    return exit_success;
  };
}

}  // namespace reprise::cli
