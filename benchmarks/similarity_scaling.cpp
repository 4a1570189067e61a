// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Cost of the default matrix over the number of frames: parts of a real database, the shape metric.

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "real_data.h"
#include "reprise/pipeline/similarity.h"

namespace reprise::benchmark {
namespace {

// The first frames of all clips in turn, so many in all, or fewer if there are not so many.
PerformanceDatabase first_frames(const PerformanceDatabase& database, std::size_t frame_count) {
  PerformanceDatabase part;
  for (const MeshSequence& clip : database.clips()) {
    const std::size_t frames = std::min(clip.frame_count(), frame_count - part.frame_count());
    if (frames == 0) break;
    MeshSequence shorter(clip.name(), clip.topology(), frames, clip.frames_per_second());
    for (std::size_t f = 0; f < frames; ++f) shorter.frame(f) = clip.frame(f);
    part.add(std::move(shorter));
  }
  return part;
}

}  // namespace
}  // namespace reprise::benchmark

int main(int argc, char** argv) {
  using namespace reprise;
  const std::size_t most = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 800;
  const PerformanceDatabase fashion = benchmark::fashion();
  fmt::print(
      "| frames | pairs | time, s | ms a pair | transport problems a pair | pairs exact, % "
      "|\n|---|---|---|---|---|---|\n");
  for (const std::size_t frames : {100, 200, 400, 800}) {
    if (frames > most) break;
    const PerformanceDatabase part = benchmark::first_frames(fashion, frames);
    const SimilarityResult result = compute_similarity(part, "", {.metric = "shape", .use_cache = false});
    const auto pairs = static_cast<double>(result.matrix.pair_count());
    fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.1f} |\n", part.frame_count(),
               result.matrix.pair_count(), result.seconds, 1e3 * result.seconds / pairs,
               static_cast<double>(result.statistics.exact_solves + result.statistics.cut_solves) / pairs,
               100.0 * static_cast<double>(result.matrix.exact_count()) / pairs);
  }
}
