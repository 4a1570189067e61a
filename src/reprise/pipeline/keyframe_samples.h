// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Some queries of a grid as frames: what was predicted is measured.

#pragma once

#include <array>
#include <vector>

#include "reprise/pipeline/keyframe_grid.h"
#include "reprise/synthesis/naturalness.h"
#include "reprise/synthesis/synthesize.h"

namespace reprise {

// How a path is made into frames.
enum class SampleVariant { path, planted, corrected };
inline constexpr std::array sample_variants = {SampleVariant::path, SampleVariant::planted,
                                               SampleVariant::corrected};
// "path": captured frames and blends alone; "planted": feet planted; "corrected": retimed and stretched to
// the targets, feet planted.
const char* name_of(SampleVariant variant);

struct SampleMeasures {
  double predicted_distance = 0.0;  // metres
  int predicted_frames = 0;
  double distance = 0.0;  // of the frames
  int frames = 0;
  Naturalness naturalness;
};

struct GridSample {
  std::size_t query_idx = 0;  // in `KeyframeGrid::queries`
  std::array<SampleMeasures, sample_variants.size()> variants;
};

// Which queries of each pair are sampled: `samples` in all, as many (to one) from each pair of
// `options.max_distance` x `options.max_time` targets, spread evenly over the targets of all pairs together.
// Ascending; fewer if there are not as many queries.
std::vector<std::vector<std::size_t>> choose_samples(std::size_t pair_count,
                                                     const EvaluateKeyframesOptions& options);

GridSample measure_sample(const KeyframeGrid& grid, std::size_t query_idx,
                          const PerformanceDatabase& database, const Synthesizer& synthesizer,
                          BlendProfile profile);

}  // namespace reprise
