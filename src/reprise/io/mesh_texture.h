// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The texture a mesh file names.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "reprise/io/parsed_mesh.h"

namespace reprise {

// A material of a Wavefront MTL file and the picture of its diffuse colour (map_Kd); empty if it has none.
struct ObjMaterial {
  std::string name;
  std::string texture_file;
};

// Options of map_Kd are left out; backslashes become slashes. Every text is an MTL file, if an empty one.
std::vector<ObjMaterial> parse_mtl(std::string_view text);

// Loads the picture that the material of an OBJ or a PLY's "comment TextureFile" names, from beside the mesh
// file, into `mesh.topology`. A mesh without texture coordinates keeps none. Captures are often passed on
// without their pictures, so a missing or unreadable one is a warning, and so are several textures on one
// surface, which a topology cannot hold.
void load_texture(ParsedMesh& mesh, const std::filesystem::path& path);

}  // namespace reprise
