// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stanford PLY: ASCII, and binary of either byte order.

#pragma once

#include "reprise/io/parsed_mesh.h"

namespace reprise {

// Reads the bytes of a PLY file. Elements and properties may come in any order and of any type; those not
// named here are skipped.
//   vertex: x y z; nx ny nz; red green blue, r g b or diffuse_red ... (integers 0 to 255, 16 bits 0 to 65535,
//   floats
//           0 to 1); s t, u v or texture_u texture_v
//   face:   the list vertex_indices or vertex_index, three or more corners; the list texcoord, u v for each
//   corner,
//           which is preferred to coordinates of the vertices
// `path` is named in errors. Throws `FileError`: not a PLY file; a bad header, with its line; a bad value,
// with its element; a truncated file, with expected and found bytes; a file without vertices or faces.
ParsedMesh parse_ply(std::string_view bytes, const std::filesystem::path& path);

}  // namespace reprise
