// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the tests of histograms share.

#pragma once

#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "reprise/similarity/shape_color_histogram.h"
#include "support/shapes.h"

namespace reprise::test {

// The walking body: skin above, cloth below, one hand of its own colour.
inline MeshSequence dressed(const std::string& name, std::size_t frame_count, Color cloth,
                            double phase = 0.0) {
  MeshSequence clip = walk(name, frame_count, 0.04, 20.0, phase);
  const Shape shape = body();
  std::vector<Color> colors;
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    colors.push_back(shape.positions(v, 0) > 0.35F  ? Color{240, 30, 30}
                     : shape.positions(v, 1) > 0.9F ? Color{200, 160, 140}
                                                    : cloth);
  }
  clip.set_colors(std::move(colors));
  return clip;
}

// The paper's literal bins: colours as they are, each in its own.
inline HistogramOptions literal(double voxel_size = 0.02) {
  return {.voxel_size = voxel_size, .color_footprint = 0.0, .min_color_share = 0.0};
}

inline constexpr Color blue = {40, 60, 180};
inline constexpr Color green = {30, 200, 60};

inline std::map<BinId, std::int64_t> as_map(const Signature& signature) {
  std::map<BinId, std::int64_t> bins;
  for (std::size_t i = 0; i < signature.size(); ++i) bins[signature.bins[i]] += signature.masses[i];
  return bins;
}

// Voxels that two histograms do not share, as a part of all.
inline double difference(const ShapeColorHistograms& histograms, std::size_t a, std::size_t b) {
  Signature first, second;
  histograms.signature(a, 0, first);
  histograms.signature(b, 0, second);
  std::map<BinId, std::int64_t> rest = as_map(first);
  for (const auto& [bin, mass] : as_map(second)) rest[bin] -= mass;
  std::int64_t sum = 0;
  for (const auto& [bin, mass] : rest) sum += std::abs(mass);
  return static_cast<double>(sum) / static_cast<double>(first.total + second.total);
}

// Mass per cell of space, whatever its colours.
inline std::map<int, std::int64_t> shape_of(const ShapeColorHistograms& histograms, std::size_t frame) {
  Signature signature;
  histograms.signature(frame, 0, signature);
  std::map<int, std::int64_t> cells;
  for (std::size_t i = 0; i < signature.size(); ++i) {
    cells[histograms.grid().cell_of(signature.bins[i])] += signature.masses[i];
  }
  return cells;
}

}  // namespace reprise::test
