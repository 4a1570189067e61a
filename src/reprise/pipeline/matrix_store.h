// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A dissimilarity matrix kept in a file while it is being computed, so that a run that was killed continues.

#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// An entry with its place, a < b.
struct PairEntry {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  MatrixEntry entry;
};

// The file of a matrix, and beside it the exact entries that a search for transitions has found but not yet
// finished with: the search starts from the matrix as it was and is given them again, so that it ends as it
// would have ended. Under MPI the first rank reads for all and writes the matrix; each writes what it found.
// Files that are missing or of another key are not used; unreadable or damaged ones neither, with a warning.
// What cannot be written costs the file, not the result: one warning, then nothing is kept any more.
class MatrixStore {
 public:
  // `file`: FOLDER/NAME.matrix, the folder is made when it is needed; empty: nothing is kept.
  MatrixStore(std::filesystem::path file, std::string key);

  // All ranks must call these two. `matrix`: an unknown one of the clips; false: it stays that.
  bool load(DissimilarityMatrix& matrix) const;
  std::vector<PairEntry> load_found(std::size_t frame_count) const;

  // The matrix with everything known: files of found entries are removed.
  void save(const DissimilarityMatrix& matrix);
  void save_found(std::span<const PairEntry> found);

  // Whether it is time to save again: some seconds have passed, more each time up to ten, and at least
  // nineteen times as long as the last save took, so that saving is at most a twentieth of the work.
  bool is_due() const;
  // How long to work before asking again.
  std::chrono::duration<double> pause() const { return pause_; }

 private:
  template <typename Write>
  void keep(const Write& write);
  std::vector<std::filesystem::path> found_files() const;

  std::filesystem::path file_;
  std::string key_;
  std::chrono::steady_clock::time_point last_save_;
  std::chrono::duration<double> pause_;
  bool is_broken_ = false;
};

}  // namespace reprise
