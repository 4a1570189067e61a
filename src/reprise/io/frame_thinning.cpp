// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/frame_thinning.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <utility>

#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

// Largest distance of a vertex, in the frames between `first` and `last`, to the straight line from one to
// the other.
double interpolation_error(const MeshSequence& sequence, std::size_t first, std::size_t last) {
  const PositionsView from = sequence.frame(first);
  const PositionsView to = sequence.frame(last);
  float squared = 0.0F;
  for (std::size_t f = first + 1; f < last; ++f) {
    const float t = static_cast<float>(f - first) / static_cast<float>(last - first);
    squared = std::max(squared,
                       ((1.0F - t) * from + t * to - sequence.frame(f)).rowwise().squaredNorm().maxCoeff());
  }
  return std::sqrt(static_cast<double>(squared));
}

}  // namespace

std::vector<std::size_t> thin_frames(const MeshSequence& sequence, std::size_t max_frames) {
  const std::size_t count = sequence.frame_count();
  std::vector<std::size_t> before(count);
  std::vector<std::size_t> after(count);
  std::vector<bool> kept(count, true);
  std::vector<double> loss(count, 0.0);  // of dropping this frame now
  std::iota(after.begin(), after.end(), std::size_t{1});
  for (std::size_t f = 1; f < count; ++f) before[f] = f - 1;

  std::size_t left = count;
  if (left > max_frames) {
    parallel_for(1, count - 1, [&](std::size_t f) { loss[f] = interpolation_error(sequence, f - 1, f + 1); });
  }
  // The cheapest first; entries whose loss has changed since are stale and passed over.
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t f = 1; f + 1 < count; ++f) queue.emplace(loss[f], f);
  while (left > max_frames && !queue.empty()) {
    throw_if_interrupted();
    const auto [cost, f] = queue.top();
    queue.pop();
    if (!kept[f] || cost != loss[f]) continue;
    kept[f] = false;
    --left;
    after[before[f]] = after[f];
    before[after[f]] = before[f];
    for (const std::size_t neighbour : {before[f], after[f]}) {
      if (neighbour == 0 || neighbour + 1 == count) continue;
      loss[neighbour] = interpolation_error(sequence, before[neighbour], after[neighbour]);
      queue.emplace(loss[neighbour], neighbour);
    }
  }
  std::vector<std::size_t> frames;
  for (std::size_t f = 0; f < count; ++f) {
    if (kept[f]) frames.push_back(f);
  }
  return frames;
}

double thinning_error(const MeshSequence& sequence, const std::vector<std::size_t>& kept) {
  std::vector<double> errors(kept.size(), 0.0);
  parallel_for(1, kept.size(),
               [&](std::size_t i) { errors[i] = interpolation_error(sequence, kept[i - 1], kept[i]); });
  return kept.empty() ? 0.0 : std::ranges::max(errors);
}

}  // namespace reprise
