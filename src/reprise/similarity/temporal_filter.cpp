// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/temporal_filter.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

// Where a frame stands in its clip.
struct Place {
  int before = 0;  // frames of the clip before it
  int after = 0;
};

std::vector<Place> places(const DissimilarityMatrix& matrix) {
  std::vector<Place> result;
  for (const std::size_t count : matrix.clip_frame_counts()) {
    for (std::size_t f = 0; f < count; ++f) {
      result.push_back({static_cast<int>(f), static_cast<int>(count - 1 - f)});
    }
  }
  return result;
}

}  // namespace

DissimilarityMatrix temporally_filtered(const DissimilarityMatrix& matrix, int half_window) {
  if (half_window < 1) {
    throw InvalidArgument(
        fmt::format("a temporal filter of half window {}: expected at least 1", half_window));
  }
  // alpha'(k) of Eq. 2, times 2L: the scale cancels. Frames at the very ends of the window have none.
  const auto weight = [&](int k) { return static_cast<double>(half_window - std::abs(k)); };
  const std::vector<Place> at = places(matrix);
  DissimilarityMatrix filtered(matrix.metric(), fmt::format("{} filtered {}", matrix.key(), half_window),
                               matrix.clip_names(), matrix.clip_frame_counts());
  parallel_for(0, matrix.frame_count(), [&](std::size_t a) {
    for (std::size_t b = a + 1; b < matrix.frame_count(); ++b) {
      const int before = std::min({half_window - 1, at[a].before, at[b].before});
      const int after = std::min({half_window - 1, at[a].after, at[b].after});
      double lower = 0.0;
      double value = 0.0;
      double weights = 0.0;
      for (int k = -before; k <= after; ++k) {
        const auto shift = static_cast<std::size_t>(k);  // wraps around, and back again in the sum
        lower += weight(k) * static_cast<double>(matrix.lower_bound(a + shift, b + shift));
        value += weight(k) * static_cast<double>(matrix.value(a + shift, b + shift));
        weights += weight(k);
      }
      filtered.set(a, b,
                   {.lower = static_cast<float>(lower / weights),
                    .value = static_cast<float>(value / weights),
                    .yaw = matrix.yaw(a, b)});
    }
  });
  return filtered;
}

}  // namespace reprise
