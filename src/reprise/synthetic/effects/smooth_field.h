// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Gaussian random fields over a surface and over time.

#pragma once

#include <vector>

#include "reprise/core/random.h"
#include "reprise/mesh/geodesic.h"

namespace reprise {

struct SmoothFieldOptions {
  double length = 0.1;  // metres, the correlation's standard deviation along the surface
  double time = 0.1;    // seconds, likewise
  int components = 1;   // independent numbers a vertex
};

// Mean 0 and variance 1 at every vertex, component and frame.
class SmoothField {
 public:
  SmoothField(const EdgeGraph& surface, std::size_t frame_count, double frames_per_second,
              const RandomField& random, const SmoothFieldOptions& options);

  // N x components.
  Eigen::MatrixXf frame(std::size_t frame_idx) const;

 private:
  struct Weight {
    std::int32_t vertex = 0;
    float weight = 0.0F;
  };

  int components_;
  std::vector<float> time_weights_;             // odd number, symmetric
  std::vector<Eigen::MatrixXf> white_;          // N x components, from half a window before the first frame
  std::vector<std::vector<Weight>> smoothing_;  // of every vertex
};

}  // namespace reprise
