// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "render": a clip as video, as numbered pictures, or as one picture of several frames side by side.

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "reprise/render/renderer.h"

namespace reprise {

// Frames first, first + step, ... up to last.
struct FrameRange {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t step = 1;
};

// Parses "FIRST:LAST" or "FIRST:LAST:STEP". Throws `InvalidArgument`.
FrameRange parse_frame_range(const std::string& text);

struct RenderStageOptions {
  RenderOptions view;
  std::optional<FrameRange> frames;  // all, unless given
  int columns = 0;                   // of a strip; 0: all frames in one row
};

// Parses "1280x720" into width and height. Throws `InvalidArgument`.
void parse_size(const std::string& text, RenderOptions& view);
// "follow", "orbit", "fixed", "front", "side". Throws `InvalidArgument` listing them.
CameraMode parse_camera(const std::string& text);
// "auto", "texture", "colors", "plain". Throws `InvalidArgument` listing them.
Appearance parse_appearance(const std::string& text);
// "ACROSS,UP", such as "0,0.93", into `look_at`. Throws `InvalidArgument`.
void parse_look_at(const std::string& text, RenderOptions& view);

struct RenderReport {
  std::size_t frames = 0;
  double seconds = 0.0;
};

// `target`: FILE.mp4 for a video, FILE.png for a strip, anything without an extension for a folder of
// FRAME.png files. Whole or not at all. Throws `FileError`, `InvalidArgument` (another extension; a frame
// beyond the clip), `Error`.
RenderReport render_sequence(const MeshSequence& sequence, const std::filesystem::path& target,
                             const RenderStageOptions& options = {});

}  // namespace reprise
