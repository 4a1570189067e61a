// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframe_figures.h"

#include <algorithm>
#include <cmath>

namespace reprise {
namespace {

constexpr double met_distance = 0.01;  // metres
constexpr double rounding = 1e-9;

}  // namespace

Spread spread_of(std::vector<double> values) {
  Spread spread{.count = values.size()};
  if (values.empty()) return spread;
  std::ranges::sort(values);  // sums of the same values are the same bits in any order given
  const auto count = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) {
    spread.mean += value / count;
    squares += value * value;
  }
  spread.rms = std::sqrt(squares / count);
  double deviations = 0.0;
  for (const double value : values) deviations += (value - spread.mean) * (value - spread.mean);
  spread.deviation = std::sqrt(deviations / count);
  spread.min = values.front();
  spread.max = values.back();
  spread.median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  return spread;
}

GridFigures figures_of(const std::vector<const GridResult*>& results) {
  GridFigures figures;
  std::vector<double> distance, time, corrected_distance, corrected_time, all_distance, all_time;
  std::vector<double> smoothness, normalized, cpu;
  for (const GridResult* result : results) {
    figures.preparation_cpu += result->grid.preparation_cpu_seconds;
    for (const GridQuery& query : result->grid.queries) {
      ++figures.targets;
      if (query.path.gap() <= 0.0) ++figures.proved;
      figures.largest_gap = std::max(figures.largest_gap, query.path.gap());
      cpu.push_back(query.cpu_seconds);
      all_distance.push_back(query.distance_error());
      all_time.push_back(query.time_error());
      if (query.smoothness) {
        smoothness.push_back(query.smoothness->weighted);
        normalized.push_back(query.smoothness->normalized);
      }
      if (!query.is_reachable) continue;
      ++figures.reachable;
      distance.push_back(query.distance_error());
      time.push_back(query.time_error());
      corrected_distance.push_back(query.corrected_distance_error());
      corrected_time.push_back(query.corrected_time_error());
      if (query.corrected_distance_error() <= met_distance + rounding &&
          query.corrected_time_error() <= 1.0 / result->grid.frames_per_second + rounding) {
        ++figures.met;
      }
    }
  }
  figures.distance_error = spread_of(std::move(distance));
  figures.time_error = spread_of(std::move(time));
  figures.corrected_distance_error = spread_of(std::move(corrected_distance));
  figures.corrected_time_error = spread_of(std::move(corrected_time));
  figures.all_distance_error = spread_of(std::move(all_distance));
  figures.all_time_error = spread_of(std::move(all_time));
  figures.smoothness = spread_of(std::move(smoothness));
  figures.normalized_smoothness = spread_of(std::move(normalized));
  figures.cpu = spread_of(std::move(cpu));
  return figures;
}

SampleFigures sample_figures(const std::vector<const GridResult*>& results, SampleVariant variant) {
  SampleFigures figures;
  std::vector<double> distance, time, pop, drift, blend_drift, shown_drift, drift_ratio, stretch;
  for (const GridResult* result : results) {
    for (const GridSample& sample : result->samples) {
      const GridQuery& query = result->grid.queries[sample.query_idx];
      const SampleMeasures& measures = sample.variants[static_cast<std::size_t>(variant)];
      const Naturalness& natural = measures.naturalness;
      ++figures.count;
      figures.distance_difference =
          std::max(figures.distance_difference, std::abs(measures.distance - measures.predicted_distance));
      figures.frame_difference =
          std::max(figures.frame_difference, std::abs(measures.frames - measures.predicted_frames));
      pop.push_back(natural.pop_ratio);
      drift.push_back(natural.foot_drift);
      blend_drift.push_back(natural.blend_foot_drift);
      shown_drift.push_back(natural.shown_foot_drift);
      // Where nothing is captured on the ground there is nothing to compare with.
      if (natural.captured_foot_drift > 0.0)
        drift_ratio.push_back(natural.foot_drift / natural.captured_foot_drift);
      if (natural.captured_edge_stretch_p99 > 0.0)
        stretch.push_back(natural.edge_stretch_p99 / natural.captured_edge_stretch_p99);
      if (!query.is_reachable) continue;
      distance.push_back(std::abs(measures.distance - query.target_distance));
      time.push_back(std::abs(measures.frames / result->grid.frames_per_second - query.target_time));
    }
  }
  figures.distance_error = spread_of(std::move(distance));
  figures.time_error = spread_of(std::move(time));
  figures.pop_ratio = spread_of(std::move(pop));
  figures.drift = spread_of(std::move(drift));
  figures.shown_drift = spread_of(std::move(shown_drift));
  figures.drift_ratio = spread_of(std::move(drift_ratio));
  figures.blend_drift = spread_of(std::move(blend_drift));
  figures.stretch_ratio = spread_of(std::move(stretch));
  return figures;
}

}  // namespace reprise
