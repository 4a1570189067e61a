// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the parsers of mesh files make of bytes, before it becomes a mesh on a shared topology.

#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reprise/mesh/mesh.h"

namespace reprise {

struct ParsedMesh {
  Topology topology;
  Positions positions;                // as in the file: not scaled
  Positions normals;                  // empty, or one per vertex
  std::vector<Color> colors;          // empty, or one per vertex
  std::size_t dropped_triangles = 0;  // triangles with two equal corners, which have no area and no normal
  // As the file names them: material files and used materials of an OBJ, pictures of a PLY.
  std::vector<std::string> material_files;
  std::vector<std::string> materials;
  std::vector<std::string> texture_files;
};

// Removes triangles with two equal corners from `mesh`, and their texture coordinates, and counts them.
void drop_repeated_corners(ParsedMesh& mesh);

// N colours from three channels each, in [0, 1] or, if any exceeds 1, in [0, 255]. NaN counts as 0.
std::vector<Color> colors_from_channels(std::span<const float> channels);

// "12" for the line of text `bytes` that holds the byte at `offset`; the first line is 1.
std::string line_at(std::string_view bytes, std::size_t offset);

}  // namespace reprise
