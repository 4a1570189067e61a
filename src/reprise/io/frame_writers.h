// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Single frames of a sequence as OBJ and PLY files. What frames share is prepared once; any thread may ask
// for frames.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/io/uv_seams.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// Normals of a frame as its source gave them, else computed.
Positions export_normals(const MeshSequence& sequence, std::size_t frame_idx);

// True if the file carries the mark that both writers below put in: it may be replaced.
bool is_exported_frame(const std::filesystem::path& path);

// OBJ text: "v x y z" or "v x y z r g b" with colours from 0 to 1, "vt", "vn", "f v/vt/vn". Floats have the
// fewest digits that read back as the same float.
class ObjFrameWriter {
 public:
  // Keeps a reference to `sequence`.
  explicit ObjFrameWriter(const MeshSequence& sequence);
  std::string text(std::size_t frame_idx) const;

 private:
  const MeshSequence& sequence_;
  std::string uvs_;
  std::string faces_;
};

// PLY: x y z nx ny nz, red green blue as bytes, faces. Texture coordinates are "s t" of the vertices if each
// has but one, else a list "texcoord" of every face.
class PlyFrameWriter {
 public:
  // `binary`: little-endian binary rather than ASCII. Keeps a reference to `sequence`.
  PlyFrameWriter(const MeshSequence& sequence, bool binary);
  std::string bytes(std::size_t frame_idx) const;

 private:
  const MeshSequence& sequence_;
  bool binary_;
  bool has_vertex_uvs_ = false;
  SeamCut cut_;
  std::string header_;
  std::string faces_;
};

}  // namespace reprise
