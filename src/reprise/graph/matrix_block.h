// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The part of a dissimilarity matrix that compares two clips, and how its entries become exact.

#pragma once

#include <cstddef>
#include <span>

#include "reprise/graph/transition.h"

namespace reprise {

// Frame m of the source clip and frame n of the target clip.
struct Pixel {
  int m = 0;
  int n = 0;
  auto operator<=>(const Pixel&) const = default;
};

// A matrix, and where its exact entries come from: `write` and `exact_entry` are null for a matrix that must
// decide everything as it is.
struct RefinableMatrix {
  const DissimilarityMatrix& read;
  DissimilarityMatrix* write = nullptr;
  const ExactEntry* exact_entry = nullptr;
};

// Throws `InvalidArgument` if the matrix is of other clips than the database has.
void check_matrix_fits(const PerformanceDatabase& database, const DissimilarityMatrix& matrix);

// Rows are the frames of the source, columns those of the target. Reads and writes the matrix itself, so that
// a block and its transpose know the same.
class MatrixBlock {
 public:
  MatrixBlock(const RefinableMatrix& matrix, std::size_t source_clip, std::size_t target_clip);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  float lower(int m, int n) const { return matrix_.read.lower_bound(row_frame(m), column_frame(n)); }
  float value(int m, int n) const { return matrix_.read.value(row_frame(m), column_frame(n)); }
  bool is_exact(Pixel p) const { return lower(p.m, p.n) == value(p.m, p.n); }

  // In parallel; nothing is done for entries that are exact already. Throws `InvalidArgument` if there is
  // nobody to ask, or if the answer is not exact or contradicts the bounds; what `exact_entry` throws passes.
  void make_exact(std::span<const Pixel> pixels);

 private:
  std::size_t row_frame(int m) const { return first_row_frame_ + static_cast<std::size_t>(m); }
  std::size_t column_frame(int n) const { return first_column_frame_ + static_cast<std::size_t>(n); }

  RefinableMatrix matrix_;
  std::size_t first_row_frame_;
  std::size_t first_column_frame_;
  int rows_;
  int columns_;
};

}  // namespace reprise
