// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "evaluate similarity": how well the metrics tell which frames of a database are alike (HSSMG Figure
// 4; Huang, Hilton, Starck 2010).

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/pipeline/similarity.h"
#include "reprise/render/appearance_change.h"
#include "reprise/similarity/retrieval.h"

namespace reprise {

struct SimilarityEvaluationOptions {
  std::vector<std::string> metrics;  // empty: all that the database allows
  SimilarityOptions similarity;      // everything but the metric
  // The same performance without capture effects: a database with the same clips that carries the truth.
  // Empty: the database is taken for its own truth, if it carries one.
  std::filesystem::path truth;
  int query_gap = 10;            // frames nearer than this in one clip are not judged: they are always alike
  double alike = 0.05;           // metres of true pose-and-shape distance
  double clothing_alike = 0.02;  // metres of true distance of free cloth and hair
  double looks_alike = 0.10;     // share of the picture that changes
  AppearanceChangeOptions appearance;
  int filter_half_window = 4;    // of the temporally filtered pictures (Figure 4: L = 4)
  int pictured_transitions = 8;  // pairs of frames shown side by side, a metric
  // Which transitions are pictured, SOURCE:TARGET; empty: the best, one between every two clips.
  std::vector<std::string> pairs;
};

// Means over the best transitions a metric found.
struct AppearanceSummary {
  std::size_t transitions = 0;
  double outline = 0.0;  // as `AppearanceChange`
  double color = 0.0;
  double visible = 0.0;  // share of them that change more than `looks_alike`
};

struct MetricEvaluation {
  std::string metric;
  std::size_t pairs = 0;
  std::size_t exact_pairs = 0;  // the others are upper bounds, which is what they are ranked by
  double seconds = 0.0;
  bool from_cache = false;
  std::vector<Transition> transitions;
  std::vector<AppearanceChange> changes;  // one a transition
  AppearanceSummary appearance;
  RetrievalQuality pose_and_shape;  // no queries where the truth is not known
  RetrievalQuality clothing;
  RetrievalQuality looks;
};

struct SimilarityEvaluation {
  bool has_truth = false;
  std::size_t frames = 0;
  std::size_t free_vertices = 0;  // that the clothing truth is made of
  AppearanceSummary neighbors;    // the same measure between each frame and the next, for comparison
  std::vector<MetricEvaluation> metrics;
  std::vector<std::string> notes;  // what was left out, and why
};

// Retrieval: every frame is a query that ranks all others, by the metric; what is alike is decided by three
// truths (docs/similarity.md):
//   pose and shape  `PerformanceTruth::pose_and_shape` below `alike`
//   clothing        among frames whose joints are nearer than `alike`: clothing truth below `clothing_alike`
//   looks           `AppearanceChange` of both frames below `looks_alike`; needs no truth
// Writes into `folder`, which is made if it is missing: metrics.png, transitions-METRIC.png, retrieval.png,
// similarity.md, similarity.csv, similarity.json; each whole or not at all. Throws `FileError` if the folder
// cannot be written, `InvalidArgument` for an unknown metric or pair of clips, a truth of other clips, and
// options out of range, and what `compute_similarity` throws.
SimilarityEvaluation evaluate_similarity(const PerformanceDatabase& database,
                                         const std::filesystem::path& database_path,
                                         const std::filesystem::path& folder,
                                         const SimilarityEvaluationOptions& options = {});

}  // namespace reprise
