// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How much of a character looks different in two frames: measured on small pictures, by what the eye would
// compare.

#pragma once

#include <array>
#include <vector>

#include "reprise/math/ground_transform.h"
#include "reprise/render/renderer.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

struct AppearanceChangeOptions {
  double pixel_size = 0.015;  // metres
  double reach = 0.03;        // metres on the picture: what moved no farther has not changed
  double color_difference =
      10.0;  // CIE L*a*b* (1976): visible at a glance; 2.3 is just noticeable side by side
};

// Shares of the pixels that show the character, over both frames and all views.
struct AppearanceChange {
  double outline = 0.0;  // within reach the other frame shows no character at all
  double color = 0.0;    // it shows the character, but no colour like it
  double total() const { return outline + color; }
};

// A frame from four sides, without perspective and without light: the surface's own colours.
struct FrameViews {
  struct View {
    int left = 0;  // of the pixel grid that all views of this side share
    int bottom = 0;
    int width = 0;  // with a rim of empty pixels, twice the reach wide
    int height = 0;
    std::vector<std::array<float, 3>> lab;  // rows from the bottom; NaN where no character is
    std::size_t covered_count = 0;
  };
  std::array<View, 4> views;  // from +Z, +X, -Z, -X
};

class FrameViewer {
 public:
  // `clip` tells topology and size of texels. Throws `InvalidArgument` for an option out of range and an
  // appearance the clip does not have.
  explicit FrameViewer(const MeshSequence& clip, const AppearanceChangeOptions& options = {},
                       Appearance appearance = Appearance::automatic);

  // A frame of a clip of the same topology, moved to where `placed_from_clip` puts it. Thread-safe.
  FrameViews look(const MeshSequence& clip, std::size_t frame_idx,
                  const GroundTransform& placed_from_clip = {}) const;

  // Symmetric; zero for equal views. Thread-safe.
  AppearanceChange change(const FrameViews& a, const FrameViews& b) const;
  // Whether the total change is less than `share`; decided as soon as it can be. Thread-safe.
  bool is_less(const FrameViews& a, const FrameViews& b, double share) const;

 private:
  struct Counts {
    std::size_t seen = 0;
    std::size_t outline = 0;
    std::size_t color = 0;
  };
  // Counts until `outline` and `color` together reach `enough`.
  Counts count(const FrameViews& a, const FrameViews& b, double enough) const;
  std::array<float, 3> texel(float u, float v) const;

  AppearanceChangeOptions options_;
  TopologyPtr topology_;
  Appearance appearance_ = Appearance::plain;  // never automatic
  int texture_width_ = 0;
  int texture_height_ = 0;
  std::vector<std::array<float, 3>> texture_;  // linear light, averaged to about the size of a sample
  std::vector<std::array<int, 2>> reach_;      // offsets of pixels within reach, nearest first
};

}  // namespace reprise
