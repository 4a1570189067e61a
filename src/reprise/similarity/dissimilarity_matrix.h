// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Dissimilarities of all pairs of frames of a database (HSSMG 4.1), with the yaw that aligns each pair best.

#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

// One entry: bounds of the dissimilarity of two frames, metres, and the yaw of a_from_b at which the upper
// one was found, radians: it turns frame b onto frame a.
struct MatrixEntry {
  float lower = 0.0F;
  float value = std::numeric_limits<float>::infinity();  // upper bound; infinite: not looked at yet
  float yaw = 0.0F;

  bool is_exact() const { return lower == value; }
  bool operator==(const MatrixEntry&) const = default;
};

// Symmetric, zero diagonal; only the upper triangle is kept (float32, 12 bytes a pair: 0.6 GB for 10,000
// frames). Frames of all clips lie one after the other, as in `PerformanceDatabase::first_frame`.
class DissimilarityMatrix {
 public:
  DissimilarityMatrix() = default;
  // All pairs unknown: lower bound 0, value infinite. `clip_names`, `clip_frame_counts`: the clips in order;
  // throws `InvalidArgument` unless of the same size.
  // `metric`: name, such as "vertex". `key`: content hash of the database and of the options the values were
  // computed with.
  DissimilarityMatrix(std::string metric, std::string key, std::vector<std::string> clip_names,
                      std::vector<std::size_t> clip_frame_counts);
  // Of the clips of a database, all pairs unknown; its content hash is the key.
  DissimilarityMatrix(std::string metric, const PerformanceDatabase& database);

  std::size_t frame_count() const { return frame_count_; }
  const std::string& metric() const { return metric_; }
  const std::string& key() const { return key_; }
  void set_key(std::string key) { key_ = std::move(key); }
  const std::vector<std::string>& clip_names() const { return clip_names_; }
  const std::vector<std::size_t>& clip_frame_counts() const { return clip_frame_counts_; }
  std::size_t first_frame(std::size_t clip_idx) const { return first_frames_.at(clip_idx); }

  // Dissimilarity of two frames, metres: exact, or an upper bound. Indices over all frames, below
  // `frame_count`.
  float value(std::size_t a, std::size_t b) const;
  float lower_bound(std::size_t a, std::size_t b) const;
  bool is_exact(std::size_t a, std::size_t b) const { return lower_bound(a, b) == value(a, b); }
  // Yaw of a_from_b, radians: turns frame b onto frame a. yaw(b, a) = -yaw(a, b).
  float yaw(std::size_t a, std::size_t b) const;
  // An exact entry. Requires a < b < frame_count.
  void set(std::size_t a, std::size_t b, float value, float yaw_a_from_b);
  // Entries may be written by several threads, each its own. Requires a < b < frame_count.
  void set(std::size_t a, std::size_t b, const MatrixEntry& entry);
  MatrixEntry entry(std::size_t a, std::size_t b) const;

  std::size_t pair_count() const { return values_.size(); }
  std::size_t exact_count() const;    // pairs whose entry is exact
  std::size_t unknown_count() const;  // pairs not looked at yet (value infinite)

  // Writes or reads the cache file (HDF5), whole or not at all. `load` throws `FileError` if the file is
  // missing, truncated, of another program or of another version, or holds values no metric gives.
  void save(const std::filesystem::path& path) const;
  static DissimilarityMatrix load(const std::filesystem::path& path);

 private:
  std::size_t index(std::size_t a, std::size_t b) const;

  std::string metric_;
  std::string key_;
  std::vector<std::string> clip_names_;
  std::vector<std::size_t> clip_frame_counts_;
  std::vector<std::size_t> first_frames_;
  std::size_t frame_count_ = 0;
  std::vector<float> lower_bounds_;  // packed upper triangle without the diagonal
  std::vector<float> values_;
  std::vector<float> yaws_;
};

}  // namespace reprise
