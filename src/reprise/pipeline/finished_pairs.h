// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What `evaluate_keyframes` keeps of the pairs it has finished, so that a run that was stopped continues.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/pipeline/keyframe_samples.h"

namespace reprise {

// Everything that a grid of paths depends on: options of the search, targets, database, graph, key-frames.
std::string grid_key(const GridPair& pair, const std::string& database_hash, const PathMetrics& metrics,
                     BlendProfile profile, const EvaluateKeyframesOptions& options);
// The same for the frames of some of its queries.
std::string samples_key(const std::string& grid_key, const std::vector<std::size_t>& query_indices,
                        const CorrectionOptions& correction);

// A folder of JSON files, two a pair: its paths and its samples. A file that is missing or of another key is
// not used; one that is damaged neither, with a warning. Numbers come back to the last bit.
class FinishedPairs {
 public:
  explicit FinishedPairs(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // `grid`: names the pair. Both throw `FileError` if the file cannot be written.
  void save(const KeyframeGrid& grid, const SmoothnessOfTransition& smoothness, const std::string& key) const;
  void save(const KeyframeGrid& grid, const std::vector<GridSample>& samples, const std::string& key) const;

  // True: `grid`, which names the pair, is filled but for what `complete_grid` fills in, and what the file
  // knows of transitions is added to `smoothness`.
  bool load(KeyframeGrid& grid, SmoothnessOfTransition& smoothness, const PerformanceDatabase& database,
            const PathMetrics& metrics, const EvaluateKeyframesOptions& options,
            const std::string& key) const;
  std::optional<std::vector<GridSample>> load_samples(const KeyframeGrid& grid,
                                                      const std::vector<std::size_t>& query_indices,
                                                      const std::string& key) const;

 private:
  std::filesystem::path folder_;
};

// "DATABASE-FROM-TO" with frames after '_', as file names have it.
std::string file_name_of(const KeyframeGrid& grid);

}  // namespace reprise
