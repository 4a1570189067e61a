// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Single frames of a sequence as OBJ and PLY files. What frames share is prepared once; any thread may ask
// for frames.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "reprise/io/uv_seams.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// Normals of a frame as its source gave them, else computed.
Positions export_normals(const MeshSequence& sequence, std::size_t frame_idx);

// True if the file carries the mark that both writers below put in: it may be replaced.
// `naming`: if not empty, it also must name this file.
bool is_exported_frame(const std::filesystem::path& path, std::string_view naming = {});

// Names of the files beside the frames of a textured sequence, from the stem of theirs.
std::string material_file_name(const std::string& stem);
std::string texture_file_name(const std::string& stem);
// MTL text of the one material, that of the sequence's texture.
std::string material_text(const std::string& texture_file);

// OBJ text: "v x y z" or "v x y z r g b" with colours from 0 to 1, "vt", "vn", "f v/vt/vn". Floats have the
// fewest digits that read back as the same float.
class ObjFrameWriter {
 public:
  // Keeps a reference to `sequence`. `material_file`: what frames name as their material, if not empty.
  explicit ObjFrameWriter(const MeshSequence& sequence, std::string material_file = {});
  std::string text(std::size_t frame_idx) const;

 private:
  const MeshSequence& sequence_;
  std::string material_file_;
  std::string uvs_;
  std::string faces_;
};

// PLY: x y z nx ny nz, red green blue as bytes, faces. Texture coordinates are "s t" of the vertices if each
// has but one, else a list "texcoord" of every face. A texture is named as MeshLab does, by a comment.
class PlyFrameWriter {
 public:
  // `binary`: little-endian binary rather than ASCII. Keeps a reference to `sequence`.
  PlyFrameWriter(const MeshSequence& sequence, bool binary, const std::string& texture_file = {});
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
