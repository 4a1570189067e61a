// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A performer with feet, and motion made of its frames.

#pragma once

#include <string>

#include "reprise/synthetic/figure/figure.h"

namespace reprise::test {

// The capsule figure on few triangles.
inline const PerformanceDatabase& performer_with_feet() {
  static const PerformanceDatabase database = make_figure({.voxel_size = 0.035});
  return database;
}

// Frames first..last of a clip as an animation that shows them.
inline MeshSequence replay(const PerformanceDatabase& database, const std::string& clip_name,
                           std::int32_t first, std::int32_t last) {
  const MeshSequence& clip = database.clip(database.clip_idx(clip_name));
  MeshSequence sequence("replay", database.topology(), static_cast<std::size_t>(last - first + 1),
                        clip.frames_per_second());
  std::vector<FrameOrigin> origins;
  for (std::int32_t f = first; f <= last; ++f) {
    sequence.frame(static_cast<std::size_t>(f - first)) = clip.frame(static_cast<std::size_t>(f));
    origins.push_back({.clip = clip_name, .frame_idx = f});
  }
  sequence.set_origins(std::move(origins));
  return sequence;
}

inline MeshSequence replay(const PerformanceDatabase& database, const std::string& clip_name) {
  const auto frames = static_cast<std::int32_t>(database.clip(database.clip_idx(clip_name)).frame_count());
  return replay(database, clip_name, 0, frames - 1);
}

inline MeshSequence moved_animation(const MeshSequence& animation, const GroundTransform& transform) {
  MeshSequence result = animation;
  for (std::size_t f = 0; f < result.frame_count(); ++f)
    transform_positions(transform, animation.frame(f), result.frame(f));
  return result;
}

}  // namespace reprise::test
