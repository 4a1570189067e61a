// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Frames of a mesh sequence from files, one at a time, from several threads.

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "reprise/mesh/mesh.h"

namespace reprise {

// Where a sequence comes from.
struct SequenceSource {
  // A folder of numbered OBJ or PLY files, a PC2 or MDD file, or a Dynamic-FAUST-style HDF5 file.
  std::filesystem::path path;
  // PC2 and MDD hold positions alone: an OBJ or PLY file with the faces (and colours, UVs) of the same
  // vertices.
  std::optional<std::filesystem::path> topology;
  // HDF5: which of the sequences in the file.
  std::string sequence_id;
  // Multiplied with all positions: 0.01 for files in centimetres. Readers deliver metres.
  double scale = 1.0;
};

// Random access to the frames of one sequence. `read` may be called from several threads at once.
class SequenceReader {
 public:
  virtual ~SequenceReader() = default;

  // Topology of the first frame (or of the topology file), with its texture.
  const TopologyPtr& topology() const { return topology_; }
  std::size_t frame_count() const { return frame_count_; }
  // Rate stated by the file, if it states one: an MDD file with even frame times does.
  std::optional<double> frames_per_second() const { return frames_per_second_; }
  // How to name a frame to the user: the file, or file and frame number.
  virtual std::string frame_name(std::size_t frame_idx) const = 0;
  // Bytes this frame takes in its files; for throughput figures.
  virtual std::size_t frame_bytes(std::size_t frame_idx) const = 0;

  // One frame on `topology()`. Throws `FileError` naming the frame and, if its vertex count or faces differ
  // from those of the first frame, both frames and the first difference; the same for NaN coordinates and
  // frames without area.
  virtual Mesh read(std::size_t frame_idx) const = 0;

 protected:
  TopologyPtr topology_;
  std::size_t frame_count_ = 0;
  std::optional<double> frames_per_second_;
};

// Opens a sequence and reads what all frames share. Throws `FileError` for a missing or foreign path, an
// empty folder, a gap in the numbering (names the missing frame), files of several kinds in one folder, a
// truncated file (says expected and found size), a PC2 or MDD without topology or with another vertex count,
// an unknown `sequence_id` (lists those there are).
std::unique_ptr<SequenceReader> open_sequence(const SequenceSource& source);

// One mesh from an OBJ or PLY file. Polygons are triangulated; UVs, the texture its material names,
// per-vertex normals and colours are kept. An OBJ with several normals at one vertex keeps their normalised
// mean. Throws `FileError` with the line or byte.
Mesh read_mesh(const std::filesystem::path& path);

}  // namespace reprise
