// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "similarity": the dissimilarity matrix of a database, computed once and kept beside it.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

struct SimilarityOptions {
  std::string metric = "vertex";  // root-mean-square vertex distance after alignment on the ground
  bool use_cache = true;          // keep the matrix in DATABASE.cache/ and use one that is there
};

struct SimilarityResult {
  DissimilarityMatrix matrix;
  bool from_cache = false;
  double seconds = 0.0;
};

// `database_path`: where `database` was read from; the cache lies beside it, keyed by a hash of contents and
// options, so that a stale matrix is never used. An unreadable cache file is computed anew, with a warning.
// Throws `InvalidArgument` for an unknown metric.
SimilarityResult compute_similarity(const PerformanceDatabase& database,
                                    const std::filesystem::path& database_path,
                                    const SimilarityOptions& options = {});

}  // namespace reprise
