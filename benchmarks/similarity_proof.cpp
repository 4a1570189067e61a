// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Proof on a part of a database that nothing is lost by bounds: the default matrix and its transitions beside
// brute force, every pair solved at every turn.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>

#include <fmt/format.h>

#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/similarity.h"

namespace reprise {
namespace {

// The first frames of the first clips, so many in all; colours, markup and texture stay.
PerformanceDatabase part_of(const PerformanceDatabase& database, std::size_t clip_count,
                            std::size_t frame_count) {
  PerformanceDatabase part;
  for (std::size_t c = 0; c < std::min(clip_count, database.clips().size()); ++c) {
    const MeshSequence& clip = database.clip(c);
    const std::size_t frames = std::min(frame_count / clip_count, clip.frame_count());
    MeshSequence shorter(clip.name(), clip.topology(), frames, clip.frames_per_second());
    for (std::size_t f = 0; f < frames; ++f) shorter.frame(f) = clip.frame(f);
    if (clip.has_colors() && !clip.has_colors_per_frame()) {
      const auto colors = clip.colors(0);
      shorter.set_colors({colors.begin(), colors.end()});
    }
    part.add(std::move(shorter));
  }
  return part;
}

int prove(const std::string& path, const std::string& metric, std::size_t frames) {
  const PerformanceDatabase database = part_of(load_database(path), 2, frames);
  SimilarityOptions options{.metric = metric, .use_cache = false};
  options.histogram.use_color = metric != "shape";
  const SimilarityResult result = compute_similarity(database, path, options);

  const ShapeColorMetric brute(database, options.histogram);
  DissimilarityMatrix truth(metric, database);
  const std::size_t count = database.frame_count();
  const auto start = std::chrono::steady_clock::now();
  {
    Progress progress("brute force", count * (count - 1) / 2);
    parallel_for(0, count, [&](std::size_t a) {
      for (std::size_t b = a + 1; b < count; ++b) {
        truth.set(a, b, brute.brute_force(a, b));
        progress.advance();
      }
    });
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::size_t wrong_exact = 0;
  std::size_t wrong_bounds = 0;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      const MatrixEntry found = result.matrix.entry(a, b);
      const MatrixEntry expected = truth.entry(a, b);
      if (found.is_exact() && found != expected) ++wrong_exact;
      if (found.lower > expected.value || found.value < expected.value) ++wrong_bounds;
    }
  }
  const std::vector<Transition> expected = find_transitions(database, truth, options.transitions);
  const auto same = [](const Transition& a, const Transition& b) {
    return a.source_clip == b.source_clip && a.target_clip == b.target_clip && a.m == b.m && a.n == b.n &&
           a.half_window == b.half_window && a.distortion == b.distortion && a.cost == b.cost;
  };
  const bool same_transitions = std::ranges::equal(result.transitions, expected, same);
  const std::size_t pairs = result.matrix.pair_count();
  fmt::print("{} frames, {} pairs, metric {}\n", count, pairs, metric);
  fmt::print("default: {:.1f} s, {} transport problems solved; brute force: {:.1f} s, {} solved\n",
             result.seconds, result.statistics.exact_solves, seconds,
             pairs * static_cast<std::size_t>(brute.histograms().grid().turn_count()));
  fmt::print("{} entries exact, {} of them differ from brute force; {} bounds do not hold\n",
             result.matrix.exact_count(), wrong_exact, wrong_bounds);
  fmt::print("{} transitions, {} those of brute force\n", expected.size(),
             same_transitions ? "exactly" : "NOT");
  return wrong_exact == 0 && wrong_bounds == 0 && same_transitions ? 0 : 1;
}

}  // namespace
}  // namespace reprise

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: similarity_proof DATABASE.reprise [shape-colour|shape] [FRAMES, 60]\n");
    return 2;
  }
  return reprise::prove(argv[1], argc > 2 ? argv[2] : "shape-colour",
                        argc > 3 ? static_cast<std::size_t>(std::atoi(argv[3])) : 60);
}
