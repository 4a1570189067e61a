// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Headless OpenGL renderer: a character on a floor under a soft key light, without a window system.

#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "reprise/mesh/image.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

enum class CameraMode {
  follow,  // keeps beside the character, at a fixed angle, moving along with it smoothly
  orbit,   // turns once around the character over the clip while following it
  fixed,   // stands still and sees the whole ground trajectory
  front,   // follows from +Z
  side,    // follows from +X
};

enum class Appearance {
  automatic,      // the texture if there is one, else vertex colours, else plain
  texture,        // of the topology
  vertex_colors,  // of the sequence
  plain,          // `surface_color`, to judge the shape alone
};

struct RenderOptions {
  int width = 1280;
  int height = 720;
  CameraMode camera = CameraMode::follow;
  double camera_yaw_degrees =
      35.0;  // follow, orbit, fixed: direction of the camera about the character, 0 = +Z
  double camera_pitch_degrees = 12.0;   // above the horizon
  double field_of_view_degrees = 30.0;  // vertical
  // Enlarges the picture about `look_at`; 1 shows the whole character.
  double zoom = 1.0;
  // Middle of the enlarged picture, in heights of the framed character: to the right of its middle, above its
  // lowest point. (0, 0.93) is a face, (0, 0.03) the feet.
  std::array<double, 2> look_at = {0.0, 0.5};
  int samples = 4;  // multisample anti-aliasing
  bool floor = true;
  Appearance appearance = Appearance::automatic;
  Color surface_color = {196, 184, 172};  // where nothing else is drawn
};

// Draws the frames of one sequence. One object per thread: it owns its OpenGL context (EGL surfaceless, any
// Mesa).
class SequenceRenderer {
 public:
  // `sequence` must outlive the renderer. Throws `InvalidArgument` for a size, sample count or texture the
  // driver does not offer and for an appearance the sequence does not have, `Error` if there is no headless
  // OpenGL (says which library is missing).
  SequenceRenderer(const MeshSequence& sequence, const RenderOptions& options);
  ~SequenceRenderer();

  Image draw(std::size_t frame_idx);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// H.264 in MP4 (yuv420p, playable everywhere), through the `ffmpeg` program. Written whole or not at all.
class VideoWriter {
 public:
  // Width and height must be even. Throws `Error` if `ffmpeg` is not installed.
  VideoWriter(std::filesystem::path target, int width, int height, double frames_per_second);
  ~VideoWriter();
  void append(const Image& image);
  // Throws `FileError` with what ffmpeg said if encoding failed.
  void commit();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Several images side by side in rows of `columns`, for strips of frames. All images must have one size.
Image tile(const std::vector<Image>& images, int columns);

}  // namespace reprise
