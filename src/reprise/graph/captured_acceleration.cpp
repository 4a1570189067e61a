// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/captured_acceleration.h"

#include <algorithm>
#include <cmath>

#include "reprise/core/parallel.h"

namespace reprise {

double peak_acceleration(const PositionsView& before, const PositionsView& here, const PositionsView& after) {
  return std::sqrt(static_cast<double>((after - 2.0F * here + before).rowwise().squaredNorm().maxCoeff()));
}

double peak_acceleration(const MeshSequence& sequence, std::size_t frame_idx) {
  return peak_acceleration(sequence.frame(frame_idx - 1), sequence.frame(frame_idx),
                           sequence.frame(frame_idx + 1));
}

std::vector<double> captured_peak_accelerations(const PerformanceDatabase& database) {
  std::vector<double> peaks;
  for (const MeshSequence& clip : database.clips()) {
    if (clip.frame_count() < 3) continue;
    const std::size_t first = peaks.size();
    peaks.resize(first + clip.frame_count() - 2);
    parallel_for(0, clip.frame_count() - 2,
                 [&](std::size_t f) { peaks[first + f] = peak_acceleration(clip, f + 1); });
  }
  return peaks;
}

double captured_acceleration(const PerformanceDatabase& database) {
  std::vector<double> peaks = captured_peak_accelerations(database);
  if (peaks.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.99 * static_cast<double>(peaks.size())));
  const auto at = peaks.begin() + (rank - 1);
  std::ranges::nth_element(peaks, at);
  return *at;
}

}  // namespace reprise
