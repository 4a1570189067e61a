// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The capsule figure as a character to be driven, and motions for it.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/graph/surface_motion_graph.h"
#include "reprise/io/bvh.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/learn_model.h"
#include "reprise/pipeline/similarity.h"
#include "reprise/synthetic/figure/figure.h"

namespace reprise::test {

// Marked up, with models learnt from few examples.
inline const PerformanceDatabase& driven_figure() {
  static const PerformanceDatabase made = [] {
    PerformanceDatabase figure = make_figure({.voxel_size = 0.07});
    figure.set_models(learn_models(figure, {.selection = {.count = 6}}).models);
    return figure;
  }();
  return made;
}

inline const SurfaceMotionGraph& driven_figure_graph() {
  static const SurfaceMotionGraph made = make_graph(
      driven_figure(), compute_similarity(driven_figure(), {}, {.use_cache = false}), {}, std::nullopt);
  return made;
}

// The true motion of a clip, as a file.
inline void write_true_motion(const std::string& clip, const std::filesystem::path& bvh) {
  const PerformanceDatabase& figure = driven_figure();
  const std::size_t clip_idx = figure.clip_idx(clip);
  write_bvh({.name = clip,
             .skeleton = figure.markup()->skeleton,
             .frames_per_second = figure.frames_per_second(),
             .frames = figure.truth(clip_idx)->poses},
            bvh);
}

}  // namespace reprise::test
