// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How well an order by dissimilarity finds what is alike: precision, recall and their summaries.

#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

struct RankedFrame {
  float distance = 0.0F;  // by the metric; infinite ones come last
  bool is_alike = false;  // by the truth
};

// Precision is looked at where recall is 0.05, 0.10, ... 1.
constexpr std::size_t recall_level_count = 20;

struct RetrievalQuality {
  std::size_t queries = 0;         // those that have something to find and something to mistake for it
  double average_precision = 0.0;  // 1: all that is alike comes first
  double chance = 0.0;             // share of what is alike: the precision of an order by lot
  double roc_area = 0.0;           // chance that an alike frame is nearer than one that is not; by lot: 1/2
  std::array<double, recall_level_count> precision{};
};

// One query. Frames are taken in order of distance, all of equal distance at once, so that the result does
// not depend on the order of `frames`. Average precision: sum over the steps of (gain of recall) x
// (precision after it). Precision at a level: the largest at that recall or more. No query is counted if
// nothing or everything is alike.
RetrievalQuality rank_quality(std::vector<RankedFrame> frames);

// Whether two frames are alike by the truth; nothing: the pair is not to be judged. Called from several
// threads.
using FrameJudge = std::function<std::optional<bool>(std::size_t a, std::size_t b)>;

// Means over the queries of all frames, each against all others that the judge judges. Parallel;
// deterministic.
RetrievalQuality retrieval_quality(const DissimilarityMatrix& matrix, const FrameJudge& judge);

}  // namespace reprise
