// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/retrieval.h"

#include <algorithm>

#include "reprise/core/parallel.h"

namespace reprise {

RetrievalQuality rank_quality(std::vector<RankedFrame> frames) {
  std::ranges::sort(frames, {}, &RankedFrame::distance);
  const auto alike = static_cast<double>(std::ranges::count(frames, true, &RankedFrame::is_alike));
  const double other = static_cast<double>(frames.size()) - alike;
  RetrievalQuality result;
  if (alike == 0.0 || other == 0.0) return result;
  result.queries = 1;
  result.chance = alike / static_cast<double>(frames.size());

  struct Step {
    double recall;
    double precision;
  };
  std::vector<Step> steps;
  double found = 0.0;
  double taken = 0.0;
  for (std::size_t i = 0; i < frames.size();) {
    const double found_before = found;
    const double mistaken_before = taken - found;
    const float distance = frames[i].distance;
    for (; i < frames.size() && frames[i].distance == distance; ++i) {
      taken += 1.0;
      found += frames[i].is_alike ? 1.0 : 0.0;
    }
    const double gain = found - found_before;
    const double mistakes = (taken - found) - mistaken_before;
    const double precision = found / taken;
    result.average_precision += gain * precision;
    // Each mistake beats the alike frames that come after it; ties count half.
    result.roc_area += mistakes * (found_before + 0.5 * gain);
    if (gain > 0.0) steps.push_back({.recall = found / alike, .precision = precision});
  }

  result.average_precision /= alike;
  result.roc_area /= alike * other;

  double best = 0.0;
  std::size_t level = recall_level_count;
  for (std::size_t s = steps.size(); s-- > 0;) {
    // Levels that lie above the recall of this step are served by the steps after it alone.
    while (level > 0 && static_cast<double>(level) / recall_level_count > steps[s].recall + 1e-12) {
      result.precision[--level] = best;
    }
    best = std::max(best, steps[s].precision);
  }
  while (level > 0) result.precision[--level] = best;
  return result;
}

RetrievalQuality retrieval_quality(const DissimilarityMatrix& matrix, const FrameJudge& judge) {
  const std::size_t frame_count = matrix.frame_count();
  std::vector<RetrievalQuality> queries(frame_count);
  parallel_for(0, frame_count, [&](std::size_t query) {
    std::vector<RankedFrame> frames;
    for (std::size_t other = 0; other < frame_count; ++other) {
      if (other == query) continue;
      const std::optional<bool> is_alike = judge(query, other);
      if (is_alike) frames.push_back({.distance = matrix.value(query, other), .is_alike = *is_alike});
    }
    queries[query] = rank_quality(std::move(frames));
  });

  RetrievalQuality mean;
  for (const RetrievalQuality& query : queries) {
    mean.queries += query.queries;
    mean.average_precision += query.average_precision;
    mean.chance += query.chance;
    mean.roc_area += query.roc_area;
    for (std::size_t i = 0; i < recall_level_count; ++i) mean.precision[i] += query.precision[i];
  }
  if (mean.queries == 0) return mean;
  const auto count = static_cast<double>(mean.queries);
  mean.average_precision /= count;
  mean.chance /= count;
  mean.roc_area /= count;
  for (double& precision : mean.precision) precision /= count;
  return mean;
}

}  // namespace reprise
