// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Rows of c_skel, one a frame of the query, compared in parallel with the work on the rows before them.

#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "reprise/path/skeleton_comparison.h"

namespace reprise::path_detail {

class TrellisRows {
 public:
  // Keeps references. `kept`: the rows are read more than once; where they fit into 256 MB they are kept.
  TrellisRows(const SkeletonTable& table, const std::vector<QuerySkeleton>& query, bool kept);

  // Calls `use(k, row)` for each frame of the query, in order, until it returns false. It may change the row;
  // a kept one comes changed the next time.
  void for_each(const std::function<bool(std::size_t, float*)>& use);

 private:
  float* row(std::size_t k);
  bool use_rows(std::size_t first, std::size_t end, const std::function<bool(std::size_t, float*)>& use);

  const SkeletonTable& table_;
  const std::vector<QuerySkeleton>& query_;
  std::size_t stride_;
  bool kept_;
  bool filled_ = false;
  std::size_t stored_rows_;
  std::vector<float> values_;
};

}  // namespace reprise::path_detail
