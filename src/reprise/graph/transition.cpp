// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/transition.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/graph/transition_search.h"

namespace reprise {
namespace {

// Both directions of a pair of clips are one piece of work: they read and refine the same entries.
struct ClipPair {
  std::size_t first;
  std::size_t second;
};

std::vector<Transition> search_all(const PerformanceDatabase& database, const RefinableMatrix& matrix,
                                   const TransitionOptions& options, const ClipPairFilter& share) {
  validate(options);
  check_matrix_fits(database, matrix.read);
  if (database.empty()) return {};
  (void)database.frames_per_second();  // frames of one duration, or accelerations cannot be compared
  const TransitionSearch search(database, matrix, options);

  const std::size_t clip_count = database.clips().size();
  std::vector<ClipPair> pairs;
  for (std::size_t first = 0; first < clip_count; ++first) {
    for (std::size_t second = first; second < clip_count; ++second) {
      if (!share || share(first, second)) pairs.push_back({first, second});
    }
  }
  std::vector<std::vector<Transition>> of_pair(clip_count * clip_count);
  Progress progress("finding transitions", pairs.size());
  parallel_for(0, pairs.size(), [&](std::size_t p) {
    const auto [first, second] = pairs[p];
    of_pair[first * clip_count + second] = PairSearch(search, first, second).run();
    if (first != second) of_pair[second * clip_count + first] = PairSearch(search, second, first).run();
    progress.advance();
  });
  std::vector<Transition> transitions;
  for (const std::vector<Transition>& found : of_pair) {
    transitions.insert(transitions.end(), found.begin(), found.end());
  }
  return transitions;
}

}  // namespace

double blend_weight(BlendProfile profile, int k, int half_window) {
  if (half_window < 1) {
    throw InvalidArgument(fmt::format("a blend of half window {}: expected at least 1", half_window));
  }
  const double t = std::clamp((k + half_window) / (2.0 * half_window), 0.0, 1.0);
  return profile == BlendProfile::linear ? t : t * t * (3.0 - 2.0 * t);
}

void validate(const TransitionOptions& options) {
  const auto check = [](const char* name, int value, int least) {
    if (value < least) {
      throw InvalidArgument(fmt::format("{} is {}, expected at least {}", name, value, least));
    }
  };
  check("transitions_per_pair", options.transitions_per_pair, 1);
  check("min_half_window", options.min_half_window, 1);
  check("self_min_gap", options.self_min_gap, 1);
  check("separation", options.separation, 1);
  check("sample_vertices", options.sample_vertices, 1);
  if (options.max_half_window < options.min_half_window) {
    throw InvalidArgument(fmt::format("max_half_window is {}, expected at least min_half_window, which is {}",
                                      options.max_half_window, options.min_half_window));
  }
  if (!(options.acceleration_weight >= 0.0) || std::isinf(options.acceleration_weight)) {
    throw InvalidArgument(
        fmt::format("acceleration_weight is {}, expected a number from 0", options.acceleration_weight));
  }
  if (!(options.max_pop_ratio > 0.0)) {
    throw InvalidArgument(
        fmt::format("max_pop_ratio is {}, expected a number above 0", options.max_pop_ratio));
  }
}

std::vector<Transition> find_transitions(const PerformanceDatabase& database,
                                         const DissimilarityMatrix& matrix,
                                         const TransitionOptions& options) {
  return search_all(database, {.read = matrix}, options, {});
}

std::vector<Transition> find_transitions(const PerformanceDatabase& database, DissimilarityMatrix& matrix,
                                         const ExactEntry& exact_entry, const TransitionOptions& options,
                                         const ClipPairFilter& share) {
  return search_all(database, {.read = matrix, .write = &matrix, .exact_entry = &exact_entry}, options,
                    share);
}

}  // namespace reprise
