// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "similarity": the dissimilarity matrix of a database, computed once and kept beside it.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/graph/measure_transition.h"
#include "reprise/similarity/bin_grid.h"
#include "reprise/similarity/dissimilarity_matrix.h"
#include "reprise/similarity/shape_color_metric.h"

namespace reprise {

// Names of the metrics of HSSMG Figure 4: "shape-colour", "shape", "vertex", "skeleton".
const std::vector<std::string>& similarity_metrics();

struct SimilarityOptions {
  std::string metric = "vertex";  // one of `similarity_metrics`; shape-color is understood as well
  HistogramOptions histogram;     // of the metrics shape-colour and shape
  // The transitions that the matrix must decide: entries they cannot depend on may stay bounds.
  TransitionOptions transitions;
  std::vector<TransitionRequest> requests;  // transitions made by hand, which it must decide as well
  bool exact = false;                       // every entry exact
  bool use_cache = true;  // keep the matrix in DATABASE.cache/ and use or continue one that is there
};

struct SimilarityResult {
  DissimilarityMatrix matrix;
  std::vector<Transition> transitions;
  TransitionOptions transition_options;  // what they were found with
  bool from_cache = false;               // nothing was left to compute
  double seconds = 0.0;
  SearchStatistics statistics;  // of this run alone
};

// `database_path`: where `database` was read from; the cache lies beside it, keyed by a hash of contents and
// options of the metric, so that a stale matrix is never used. What is done is kept every few seconds: a run
// that was killed continues, to the same result. An unreadable or damaged cache file is computed anew, with a
// warning. Work is shared over threads and over MPI ranks; the result is the same for any number of either.
// Throws `InvalidArgument` for an unknown metric (offers the nearest), what `ShapeColorHistograms` and
// `check_request` throw, and for the metric "skeleton" if the database has no markup (says how to make one).
SimilarityResult compute_similarity(const PerformanceDatabase& database,
                                    const std::filesystem::path& database_path,
                                    const SimilarityOptions& options = {});

}  // namespace reprise
