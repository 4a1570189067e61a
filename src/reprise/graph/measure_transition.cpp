// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/measure_transition.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/graph/transition_search.h"

namespace reprise {
namespace {

Transition measure(const PerformanceDatabase& database, const RefinableMatrix& matrix,
                   const TransitionRequest& request, TransitionOptions options) {
  validate(options);
  check_matrix_fits(database, matrix.read);
  check_request(request, database, options);
  (void)database.frames_per_second();
  const auto look = [&] {
    const TransitionSearch search(database, matrix, options);
    return PairSearch(search, request.source_clip, request.target_clip).measure({request.m, request.n});
  };
  if (request.half_window > 0) {
    options.min_half_window = request.half_window;
    options.max_half_window = request.half_window;
  } else if (const std::optional<Transition> calm = look()) {
    return *calm;
  }
  options.max_pop_ratio = std::numeric_limits<double>::infinity();  // who asks by hand has looked
  return *look();
}

}  // namespace

void check_request(const TransitionRequest& request, const PerformanceDatabase& database,
                   const TransitionOptions& options) {
  const auto frame_count = [&](std::size_t clip_idx, int frame) {
    if (clip_idx >= database.clips().size()) {
      throw InvalidArgument(
          fmt::format("a transition of clip {}, but there are {} clips", clip_idx, database.clips().size()));
    }
    const MeshSequence& clip = database.clip(clip_idx);
    const auto count = static_cast<int>(clip.frame_count());
    if (frame < 0 || frame >= count) {
      throw InvalidArgument(
          fmt::format("clip '{}' has frames 0 to {}, asked for {}", clip.name(), count - 1, frame));
    }
    return count;
  };
  const int source_count = frame_count(request.source_clip, request.m);
  const int target_count = frame_count(request.target_clip, request.n);
  const std::string place = fmt::format("{}:{}->{}:{}", database.clip(request.source_clip).name(), request.m,
                                        database.clip(request.target_clip).name(), request.n);
  if (request.source_clip == request.target_clip && request.m == request.n) {
    throw InvalidArgument(fmt::format("'{}' leads from a frame to itself", place));
  }
  if (request.half_window < 0) {
    throw InvalidArgument(fmt::format("'{}': the half window is {}, expected at least 1, or 0 for the best",
                                      place, request.half_window));
  }
  const int room =
      std::min({request.m, source_count - 1 - request.m, request.n, target_count - 1 - request.n});
  const int least = request.half_window > 0 ? request.half_window : options.min_half_window;
  if (least > room) {
    throw InvalidArgument(fmt::format(
        "'{}': a blend of half window {} does not fit into both clips, '{}' with {} frames and '{}' with {}: "
        "{}",
        place, least, database.clip(request.source_clip).name(), source_count,
        database.clip(request.target_clip).name(), target_count,
        room < 1 ? "none does at the first or last frame of a clip"
                 : fmt::format("the longest that does is {}", room)));
  }
}

Transition measure_transition(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                              const TransitionRequest& request, const TransitionOptions& options) {
  return measure(database, {.read = matrix}, request, options);
}

Transition measure_transition(const PerformanceDatabase& database, DissimilarityMatrix& matrix,
                              const ExactEntry& exact_entry, const TransitionRequest& request,
                              const TransitionOptions& options) {
  return measure(database, {.read = matrix, .write = &matrix, .exact_entry = &exact_entry}, request, options);
}

}  // namespace reprise
