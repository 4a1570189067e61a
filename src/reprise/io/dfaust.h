// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Sequences in an HDF5 file as Dynamic FAUST publishes them: a dataset `faces` and one dataset a sequence.

#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "reprise/io/hdf5.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// Which dimension of a three-dimensional array counts what.
struct DfaustLayout {
  std::size_t frame = 0, vertex = 1, coordinate = 2;
  bool operator==(const DfaustLayout&) const = default;
};

// The layouts that `shape` may have: (frames, vertices, 3), (vertices, 3, frames) as published, or (frames,
// 3, vertices); vertices at least `min_vertices`, and exactly that many if one layout has.
std::vector<DfaustLayout> dfaust_layouts(const std::array<std::size_t, 3>& shape, std::size_t min_vertices);

// One sequence of the file. Reading is safe from several threads.
class DfaustFile {
 public:
  // `sequence_id`: name of a dataset; may be empty if there is only one. `topology`: faces for a file without
  // `faces`. Throws `FileError`: not an HDF5 file, no such sequence (lists those there are), no faces, faces
  // out of range, or an array whose shape has no or several readings.
  DfaustFile(const std::filesystem::path& path, const std::string& sequence_id, TopologyPtr topology);

  const std::string& sequence_id() const { return sequence_id_; }
  const TopologyPtr& topology() const { return topology_; }
  std::size_t frame_count() const { return shape_[layout_.frame]; }

  // Positions as in the file: not scaled.
  Positions read(std::size_t frame_idx) const;

 private:
  struct Block {
    std::size_t first_frame = 0, frame_count = 0;
    std::vector<float> values;  // in the order of the file
  };
  std::shared_ptr<const Block> block_of(std::size_t frame_idx) const;

  std::unique_ptr<const Hdf5Dataset> dataset_;
  std::string sequence_id_;
  TopologyPtr topology_;
  std::array<std::size_t, 3> shape_{};
  DfaustLayout layout_;
  std::size_t frames_per_block_ = 1;

  // Where frames are not contiguous, reading one costs as much as reading many: the last blocks are kept.
  mutable std::mutex mutex_;
  mutable std::array<std::shared_ptr<const Block>, 2> recent_;
};

}  // namespace reprise
