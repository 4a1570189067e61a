// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframe_samples.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace reprise {
namespace {

// Fractions of successive multiples of these fill the unit square evenly (the generalised golden ratio: the
// root of x^3 = x + 1).
constexpr double golden = 1.32471795724474602596;

std::size_t part(std::size_t i, double step, int count) {
  const double place = 0.5 + static_cast<double>(i) * step;
  return std::min(static_cast<std::size_t>((place - std::floor(place)) * count),
                  static_cast<std::size_t>(count) - 1);
}

}  // namespace

const char* name_of(SampleVariant variant) {
  switch (variant) {
    case SampleVariant::path:
      return "path";
    case SampleVariant::planted:
      return "planted";
    case SampleVariant::corrected:
      return "corrected";
  }
  return "";
}

std::vector<std::vector<std::size_t>> choose_samples(std::size_t pair_count,
                                                     const EvaluateKeyframesOptions& options) {
  const auto samples = static_cast<std::size_t>(options.samples);
  const auto distances = static_cast<std::size_t>(options.max_distance);
  const std::size_t targets = distances * static_cast<std::size_t>(options.max_time);
  std::vector<std::vector<std::size_t>> chosen;
  std::size_t i = 0;
  for (std::size_t pair = 0; pair < pair_count; ++pair) {
    const std::size_t wanted =
        std::min(targets, (pair + 1) * samples / pair_count - pair * samples / pair_count);
    std::set<std::size_t> indices;
    for (; indices.size() < wanted; ++i) {
      indices.insert(part(i, 1.0 / golden, options.max_distance) +
                     distances * part(i, 1.0 / (golden * golden), options.max_time));
    }
    chosen.emplace_back(indices.begin(), indices.end());
  }
  return chosen;
}

GridSample measure_sample(const KeyframeGrid& grid, std::size_t query_idx,
                          const PerformanceDatabase& database, const Synthesizer& synthesizer,
                          BlendProfile profile) {
  const GridQuery& query = grid.queries.at(query_idx);
  GridSample sample{.query_idx = query_idx};
  for (std::size_t v = 0; v < sample_variants.size(); ++v) {
    SampleMeasures& measures = sample.variants[v];
    measures.predicted_distance = query.path.distance;
    measures.predicted_frames = query.path.frame_count;
    SynthesisOptions options{.profile = profile};
    options.plant_feet = sample_variants[v] != SampleVariant::path;
    if (sample_variants[v] == SampleVariant::corrected) {
      options.correction = query.correction;
      measures.predicted_distance = query.correction.distance;
      measures.predicted_frames = query.correction.frame_count;
    }
    const MeshSequence animation = synthesizer.synthesize(query.path, options);
    measures.frames = static_cast<int>(animation.frame_count());
    measures.distance = ground_distance(ground_trajectory(animation), 0, animation.frame_count() - 1);
    measures.naturalness = evaluate_naturalness(animation, database);
  }
  return sample;
}

}  // namespace reprise
