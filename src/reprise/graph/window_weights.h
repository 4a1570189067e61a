// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Weights of blend windows, computed once for a search.

#pragma once

#include <algorithm>
#include <vector>

#include "reprise/graph/transition.h"

namespace reprise {

// Of the half window L. Frames at its ends are pure: no dissimilarity counts there.
struct WindowWeights {
  std::vector<float> alpha;        // alpha(k), k in [-L - 1, L + 1]
  std::vector<double> distortion;  // alpha'(k) = min(1 - alpha, alpha) of Eq. 2, k in [-L + 1, L - 1]
  double distortion_sum = 0.0;
};

inline WindowWeights window_weights(BlendProfile profile, int half_window) {
  WindowWeights weights;
  for (int k = -half_window - 1; k <= half_window + 1; ++k) {
    const double alpha = blend_weight(profile, k, half_window);
    weights.alpha.push_back(static_cast<float>(alpha));
    if (k <= -half_window || k >= half_window) continue;
    weights.distortion.push_back(std::min(1.0 - alpha, alpha));
    weights.distortion_sum += weights.distortion.back();
  }
  return weights;
}

}  // namespace reprise
