// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Wavefront OBJ text: vertices with optional colours, texture coordinates, normals, polygons.

#pragma once

#include <array>
#include <optional>

#include "reprise/io/parsed_mesh.h"

namespace reprise {

// The faces of one frame, kept so that frames with the same faces need not parse theirs.
struct ObjFaces {
  std::string text;  // from the first face to the end of the file; empty if frames cannot share it
  std::size_t vertex_count = 0, uv_count = 0, normal_count = 0;
  std::vector<std::array<std::int32_t, 2>>
      normal_corners;  // (vertex, normal) of every face corner with a normal
};

// Reads the text of an OBJ file: v (x y z, optionally with a weight, which is ignored, or r g b), vt, vn, and
// f with polygons of three or more corners v, v/vt, v//vn or v/vt/vn, counted from 1 or, if negative, from
// the latest, and the names of mtllib and usemtl. Understands comments, line continuation and all line ends
// but a lone CR; skips every other statement.
//
// Vertices without colour in a file with colours become white. Several normals of one vertex become their
// normalised mean; vertices without one get (0, 0, 0). Corners without texture coordinate in a file with some
// get (0, 0). `path` is named in errors. `faces`, if given, receives what `parse_obj_frame` needs. Throws
// `FileError` naming the line, also for a file without a vertex or face.
ParsedMesh parse_obj(std::string_view text, const std::filesystem::path& path, ObjFaces* faces = nullptr);

// The same for another frame of a sequence, without `topology.triangles` and UVs. Nothing if the faces of
// this frame are not those of `faces`, byte for byte: then use `parse_obj`. Throws `FileError` like
// `parse_obj`.
std::optional<ParsedMesh> parse_obj_frame(std::string_view text, const std::filesystem::path& path,
                                          const ObjFaces& faces);

}  // namespace reprise
