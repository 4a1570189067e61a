// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/captured_acceleration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reprise/core/parallel.h"

namespace reprise {

double captured_acceleration(const PerformanceDatabase& database) {
  std::vector<double> squares;
  for (const MeshSequence& clip : database.clips()) {
    if (clip.frame_count() < 3) continue;
    const std::size_t first = squares.size();
    squares.resize(first + clip.frame_count() - 2);
    parallel_for(0, clip.frame_count() - 2, [&](std::size_t f) {
      const PositionsView before = clip.frame(f);
      const PositionsView at = clip.frame(f + 1);
      const PositionsView after = clip.frame(f + 2);
      squares[first + f] =
          static_cast<double>((after - 2.0F * at + before).rowwise().squaredNorm().maxCoeff());
    });
  }
  if (squares.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.99 * static_cast<double>(squares.size())));
  const auto at = squares.begin() + (rank - 1);
  std::ranges::nth_element(squares, at);
  return std::sqrt(*at);
}

}  // namespace reprise
