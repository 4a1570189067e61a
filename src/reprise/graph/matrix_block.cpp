// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/matrix_block.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

// Bounds and exact values may come from different sums.
constexpr double rounding_share = 1e-5;

std::string name_of(const DissimilarityMatrix& matrix, std::size_t frame) {
  std::size_t clip = 0;
  while (clip + 1 < matrix.clip_names().size() && matrix.first_frame(clip + 1) <= frame) ++clip;
  return fmt::format("{}:{}", matrix.clip_names()[clip], frame - matrix.first_frame(clip));
}

void check_answer(const DissimilarityMatrix& matrix, std::size_t a, std::size_t b,
                  const MatrixEntry& answer) {
  const MatrixEntry known = matrix.entry(a, b);
  const double rounding = rounding_share * static_cast<double>(answer.value);
  if (answer.is_exact() && answer.value >= 0.0F && answer.value + rounding >= known.lower &&
      answer.value - rounding <= known.value) {
    return;
  }
  throw InvalidArgument(fmt::format(
      "exact dissimilarity of {} and {}: expected one value from {} to {} m, found {} to {} m",
      name_of(matrix, a), name_of(matrix, b), known.lower, known.value, answer.lower, answer.value));
}

}  // namespace

void check_matrix_fits(const PerformanceDatabase& database, const DissimilarityMatrix& matrix) {
  if (matrix.clip_names() != database.clip_names()) {
    throw InvalidArgument(fmt::format("the dissimilarity matrix is of the clips {}, the database has {}",
                                      fmt::join(matrix.clip_names(), ", "),
                                      fmt::join(database.clip_names(), ", ")));
  }
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    if (matrix.clip_frame_counts()[c] != database.clip(c).frame_count()) {
      throw InvalidArgument(fmt::format(
          "clip '{}' has {} frames in the dissimilarity matrix and {} in the database",
          database.clip(c).name(), matrix.clip_frame_counts()[c], database.clip(c).frame_count()));
    }
  }
}

MatrixBlock::MatrixBlock(const RefinableMatrix& matrix, std::size_t source_clip, std::size_t target_clip)
    : matrix_(matrix),
      first_row_frame_(matrix.read.first_frame(source_clip)),
      first_column_frame_(matrix.read.first_frame(target_clip)),
      rows_(static_cast<int>(matrix.read.clip_frame_counts()[source_clip])),
      columns_(static_cast<int>(matrix.read.clip_frame_counts()[target_clip])) {}

void MatrixBlock::make_exact(std::span<const Pixel> pixels) {
  std::vector<std::pair<std::size_t, std::size_t>> entries;
  for (const Pixel& p : pixels) {
    if (!is_exact(p)) entries.push_back(std::minmax({row_frame(p.m), column_frame(p.n)}));
  }
  // Where a clip is compared with itself, (m, n) and (n, m) are one entry.
  std::ranges::sort(entries);
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  if (entries.empty()) return;
  if (matrix_.exact_entry == nullptr) {
    const auto [a, b] = entries.front();
    throw InvalidArgument(fmt::format(
        "the dissimilarity matrix leaves the transitions undecided: of {} and {} it only knows {} to {} m; "
        "compute it with these transition options, or exactly",
        name_of(matrix_.read, a), name_of(matrix_.read, b), matrix_.read.lower_bound(a, b),
        matrix_.read.value(a, b)));
  }
  parallel_for(0, entries.size(), [&](std::size_t e) {
    const auto [a, b] = entries[e];
    const MatrixEntry answer = (*matrix_.exact_entry)(a, b);
    check_answer(matrix_.read, a, b, answer);
    matrix_.write->set(a, b, answer);
  });
  // Where another pair of clips has failed, loops are left without a word.
  const bool is_done =
      std::ranges::all_of(entries, [&](const auto& e) { return matrix_.read.is_exact(e.first, e.second); });
  if (!is_done) throw Cancelled();
}

}  // namespace reprise
