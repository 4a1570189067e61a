// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/trellis_rows.h"

#include <algorithm>

#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"

namespace reprise::path_detail {
namespace {

// Rows compared at a time: a block of the table is read once for all of them.
constexpr std::size_t batch = 16;
constexpr std::size_t part_blocks = 16;                   // blocks of a piece of parallel work
constexpr std::size_t most_kept = std::size_t{64} << 20;  // numbers

}  // namespace

TrellisRows::TrellisRows(const SkeletonTable& table, const std::vector<QuerySkeleton>& query, bool kept)
    : table_(table),
      query_(query),
      stride_(table.block_count() * SkeletonTable::lanes),
      kept_(kept && query.size() <= most_kept / stride_),
      stored_rows_(kept_ ? query.size() : std::min(query.size(), 2 * batch)),
      values_(stored_rows_ * stride_) {}

float* TrellisRows::row(std::size_t k) {
  return values_.data() + (k % stored_rows_) * stride_;
}

bool TrellisRows::use_rows(std::size_t first, std::size_t end,
                           const std::function<bool(std::size_t, float*)>& use) {
  for (std::size_t k = first; k < end; ++k) {
    if (!use(k, row(k))) return false;
  }
  return true;
}

void TrellisRows::for_each(const std::function<bool(std::size_t, float*)>& use) {
  const std::size_t row_count = query_.size();
  Progress progress("retrieval", row_count);
  if (filled_) {
    for (std::size_t k = 0; k < row_count; ++k) {
      if (!use(k, row(k))) return;
      progress.advance();
    }
    return;
  }
  const std::size_t parts = (table_.block_count() + part_blocks - 1) / part_blocks;
  bool goes_on = true;
  std::size_t used = 0;
  // The first piece of each round uses the rows of the round before.
  for (std::size_t first = 0; used < row_count && goes_on; first += batch) {
    const std::size_t begin = std::min(first, row_count);
    const std::size_t end = std::min(first + batch, row_count);
    parallel_for(0, begin < end ? parts + 1 : 1, [&](std::size_t piece) {
      if (piece == 0) {
        goes_on = use_rows(used, begin, use);
        return;
      }
      const std::size_t last = std::min(piece * part_blocks, table_.block_count());
      for (std::size_t block = (piece - 1) * part_blocks; block < last; ++block) {
        for (std::size_t k = begin; k < end; ++k) {
          table_.compare(query_[k], block, row(k) + block * SkeletonTable::lanes);
        }
      }
    });
    progress.advance(begin - used);
    used = begin;
  }
  filled_ = kept_ && goes_on;
}

}  // namespace reprise::path_detail
