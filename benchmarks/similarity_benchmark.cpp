// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Time of the vertex dissimilarity matrix of a real database, beside the straightforward way: one alignment a
// pair. The latter is measured on a sample of the pairs and extrapolated to all of them on as many threads.

#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "real_data.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise::benchmark {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const char* name, const PerformanceDatabase& database) {
  const std::size_t F = database.frame_count();
  const std::size_t pairs = F * (F - 1) / 2;
  double best = 1e30;
  DissimilarityMatrix matrix;
  for (int run = 0; run < 3; ++run) {
    const auto start = std::chrono::steady_clock::now();
    matrix = vertex_dissimilarity(database);
    best = std::min(best, seconds_since(start));
  }

  // Every so-many-th pair in reading order: a fixed sample without favourites.
  struct Pair {
    std::size_t a;
    std::size_t b;
    double difference;
  };
  const std::size_t stride = std::max<std::size_t>(1, pairs / 4000) | 1;
  std::vector<PositionsView> frames;
  for (const MeshSequence& clip : database.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) frames.push_back(clip.frame(f));
  }
  std::vector<Pair> sample;
  std::size_t number = 0;
  for (std::size_t a = 0; a < F; ++a) {
    for (std::size_t b = a + 1; b < F; ++b, ++number) {
      if (number % stride == 0) sample.push_back({a, b, 0.0});
    }
  }
  const auto start = std::chrono::steady_clock::now();
  parallel_for(0, sample.size(), [&](std::size_t i) {
    Pair& pair = sample[i];
    const double direct = align_on_ground(frames[pair.a], frames[pair.b]).rms_distance;
    pair.difference = std::abs(direct - static_cast<double>(matrix.value(pair.a, pair.b)));
  });
  const double direct =
      seconds_since(start) * static_cast<double>(pairs) / static_cast<double>(sample.size());
  double difference = 0.0;
  for (const Pair& pair : sample) difference = std::max(difference, pair.difference);
  fmt::print("| {} | {} | {} | {} | {:.2f} | {:.1f} | {:.1f} | {:.1e} |\n", name, F,
             database.topology()->vertex_count, pairs, best, direct, direct / best, difference);
}

}  // namespace
}  // namespace reprise::benchmark

int main() {
  fmt::print("{} threads; blocked: best of 3 runs; pairwise: extrapolated from about 4,000 pairs\n\n",
             tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  fmt::print(
      "| data | frames | vertices | pairs | blocked, s | pairwise, s (extrapolated) | times faster | largest "
      "difference, m "
      "|\n|---|---|---|---|---|---|---|---|\n");
  reprise::benchmark::measure("ama", reprise::benchmark::ama());
  reprise::benchmark::measure("fashion", reprise::benchmark::fashion());
}
