// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/makehuman_mesh.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "reprise/io/input_file.h"

namespace reprise::makehuman {
namespace {

using nlohmann::json;

constexpr double metres_per_unit = 0.1;

// A file's JSON, whose fields are taken with their place in the error messages.
class MeshFile {
 public:
  explicit MeshFile(const std::filesystem::path& path) : path_(path) {
    const FileBytes bytes = InputFile(path).read_all();
    try {
      root_ = json::parse(bytes.view());
    } catch (const json::parse_error& error) {
      throw FileError(path, fmt::format("byte {}", error.byte), "expected JSON, found a damaged text");
    }
    if (!root_.is_object()) fail("", "expected a JSON object, found another value");
  }

  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw FileError(path_, place, what);
  }

  const json& array(const json& object, const std::string& name) const {
    const auto found = object.find(name);
    if (found == object.end()) fail(name, "expected an array, found no such field");
    if (!found->is_array()) fail(name, fmt::format("expected an array, found {}", found->type_name()));
    return *found;
  }
  const json& array(const std::string& name) const { return array(root_, name); }

  double number(const json& value, const std::string& place) const {
    if (!value.is_number()) fail(place, fmt::format("expected a number, found {}", value.type_name()));
    const double x = value.get<double>();
    if (!std::isfinite(x) || std::abs(x) > 1e6) fail(place, fmt::format("expected a number, found {}", x));
    return x;
  }
  std::int32_t index(const json& value, std::size_t count, const std::string& place) const {
    if (!value.is_number_integer()) {
      fail(place, fmt::format("expected an index, found {}", value.is_number() ? value.dump() : "no number"));
    }
    const auto x = value.get<std::int64_t>();
    if (x < 0 || x >= static_cast<std::int64_t>(count)) {
      fail(place,
           fmt::format("expected an index from 0 to {}, found {}", static_cast<std::int64_t>(count) - 1, x));
    }
    return static_cast<std::int32_t>(x);
  }
  void expect_size(const json& values, std::size_t size, const std::string& place) const {
    if (values.size() != size) {
      fail(place, fmt::format("expected {} entries, found {}", size, values.size()));
    }
  }

  std::string text(const json& object, const std::string& name) const {
    if (!object.is_object()) return {};
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  }

  const json& root() const { return root_; }
  const json& metadata() const {
    const auto found = root_.find("metadata");
    if (found == root_.end() || !found->is_object()) {
      fail("metadata", "expected an object, found none");
    }
    return *found;
  }

 private:
  std::filesystem::path path_;
  json root_;
};

void read_faces(const MeshFile& file, MakehumanMesh& mesh) {
  constexpr int quad_bit = 1, material_bit = 2, uv_bit = 8;
  const json& flat = file.array("faces");
  const auto vertex_count = static_cast<std::size_t>(mesh.points.rows());
  for (std::size_t i = 0; i < flat.size();) {
    const std::string place = fmt::format("faces[{}]", i);
    const int type = static_cast<int>(file.index(flat[i], 256, place));
    if ((type & ~quad_bit) != (material_bit | uv_bit)) {
      file.fail(place, fmt::format("expected face type 10 or 11, found {}", type));
    }
    MakehumanMesh::Face face;
    face.corner_count = (type & quad_bit) != 0 ? 4 : 3;
    const auto corners = static_cast<std::size_t>(face.corner_count);
    if (i + 2 + 2 * corners > flat.size())
      file.fail(place, "expected a whole face, found the end of the list");
    for (std::size_t c = 0; c < corners; ++c) {
      face.corners[c] = file.index(flat[i + 1 + c], vertex_count, place);
      face.uvs[c] = file.index(flat[i + 2 + corners + c], mesh.uvs.size(), place);
    }
    face.material = static_cast<int>(file.index(flat[i + 1 + corners], 4096, place));
    mesh.faces.push_back(face);
    i += 2 + 2 * corners;
  }
}

void read_materials(const MeshFile& file, MakehumanMesh& mesh) {
  const json& materials = file.array("materials");
  for (const json& material : materials) {
    const std::string texture = file.text(material, "mapDiffuse");
    MakehumanMesh::Material read{.name = file.text(material, "DbgName")};
    if (!texture.empty()) {
      read.texture = file.path().parent_path() / texture;
      // The mesh files do not name it, but it lies beside.
      constexpr std::string_view colors = "_diffuse";
      std::string stem = read.texture.stem().string();
      if (stem.ends_with(colors)) {
        stem.resize(stem.size() - colors.size());
        std::error_code ignored;
        const auto beside = read.texture.parent_path() / (stem + "_ao.png");
        if (std::filesystem::exists(beside, ignored)) read.shading = beside;
      }
    }
    mesh.materials.push_back(std::move(read));
  }
}

void read_weights(const MeshFile& file, std::size_t node_count, MakehumanMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.points.rows());
  const auto per_vertex = file.root().find("influencesPerVertex");
  if (per_vertex == file.root().end()) file.fail("influencesPerVertex", "expected 1 to 4, found none");
  const auto influences = static_cast<std::size_t>(file.index(*per_vertex, 5, "influencesPerVertex"));
  const json& nodes = file.array("skinIndices");
  const json& weights = file.array("skinWeights");
  file.expect_size(nodes, influences * count, "skinIndices");
  file.expect_size(weights, influences * count, "skinWeights");
  mesh.nodes.resize(count);
  mesh.weights.resize(count);
  for (std::size_t v = 0; v < count; ++v) {
    double sum = 0.0;
    for (std::size_t k = 0; k < influences; ++k) {
      const std::size_t i = influences * v + k;
      mesh.nodes[v][k] = file.index(nodes[i], node_count, fmt::format("skinIndices[{}]", i));
      mesh.weights[v][k] = file.number(weights[i], fmt::format("skinWeights[{}]", i));
      sum += mesh.weights[v][k];
    }
    if (!(sum > 0.5 && sum < 1.5)) {
      file.fail(fmt::format("skinWeights[{}]", influences * v),
                fmt::format("expected weights with sum 1, found sum {}", sum));
    }
    for (double& weight : mesh.weights[v]) weight /= sum;
  }
}

MakehumanMesh read_mesh(const MeshFile& file) {
  MakehumanMesh mesh;
  mesh.path = file.path();

  const json& vertices = file.array("vertices");
  if (vertices.empty() || vertices.size() % 3 != 0) {
    file.fail("vertices", fmt::format("expected three numbers a vertex, found {} numbers", vertices.size()));
  }
  mesh.points.resize(static_cast<Eigen::Index>(vertices.size() / 3), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    mesh.points.data()[i] = metres_per_unit * file.number(vertices[i], fmt::format("vertices[{}]", i));
  }

  const json& uv_sets = file.array("uvs");
  if (uv_sets.empty() || !uv_sets[0].is_array() || uv_sets[0].size() % 2 != 0) {
    file.fail("uvs", "expected a list of pairs of numbers, found none");
  }
  for (std::size_t i = 0; i + 1 < uv_sets[0].size(); i += 2) {
    const std::string place = fmt::format("uvs[0][{}]", i);
    mesh.uvs.push_back({static_cast<float>(file.number(uv_sets[0][i], place)),
                        static_cast<float>(file.number(uv_sets[0][i + 1], place))});
  }

  read_faces(file, mesh);
  read_materials(file, mesh);

  const auto license = file.metadata().find("license");
  if (license != file.metadata().end()) {
    mesh.license = file.text(*license, "license");
    mesh.author = file.text(*license, "author");
  }
  return mesh;
}

}  // namespace

MakehumanBody read_body(const std::filesystem::path& path) {
  const MeshFile file(path);
  MakehumanBody body;
  body.mesh = read_mesh(file);
  if (body.mesh.points.rows() != MakehumanBody::vertex_count) {
    file.fail("vertices", fmt::format("expected {} vertices, found {}", MakehumanBody::vertex_count,
                                      body.mesh.points.rows()));
  }
  const auto joints = file.metadata().find("joint_pos_idxs");
  if (joints == file.metadata().end() || !joints->is_object()) {
    file.fail("metadata.joint_pos_idxs", "expected an object, found none");
  }
  const json& bones = file.array("bones");
  for (std::size_t i = 0; i < bones.size(); ++i) {
    const std::string place = fmt::format("bones[{}]", i);
    if (!bones[i].is_object()) file.fail(place, "expected an object, found another value");
    MakehumanBody::Node node;
    node.name = file.text(bones[i], "name");
    if (node.name.empty()) file.fail(place, "expected a name, found none");
    const auto parent = bones[i].find("parent");
    if (parent == bones[i].end()) file.fail(place, "expected a parent, found none");
    if (*parent != -1) node.parent = file.index(*parent, i, place + ".parent");
    // The end of bone "X" is the node "X" here and "X____tail" there.
    const bool is_head = node.name.ends_with("____head");
    const auto found = joints->find(is_head ? node.name : node.name + "____tail");
    const std::string list = "metadata.joint_pos_idxs." + node.name;
    if (found == joints->end() || !found->is_array() || found->empty()) {
      file.fail(list, "expected a list of vertices, found none");
    }
    for (const json& vertex : *found) {
      node.vertices.push_back(file.index(vertex, MakehumanBody::vertex_count, list));
    }
    body.nodes.push_back(std::move(node));
  }
  if (body.nodes.empty()) file.fail("bones", "expected the bones of the rig, found none");
  read_weights(file, body.nodes.size(), body.mesh);
  return body;
}

MakehumanProxy read_proxy(const std::filesystem::path& path) {
  const MeshFile file(path);
  MakehumanProxy proxy;
  proxy.mesh = read_mesh(file);
  const auto count = static_cast<std::size_t>(proxy.mesh.points.rows());
  read_weights(file, file.array("bones").size(), proxy.mesh);

  const json& references = file.array("ref_vIdxs");
  const json& weights = file.array("weights");
  const json& offsets = file.array("offsets");
  file.expect_size(references, count, "ref_vIdxs");
  file.expect_size(weights, count, "weights");
  file.expect_size(offsets, count, "offsets");
  proxy.references.resize(count);
  proxy.weights.resize(count);
  proxy.offsets.resize(static_cast<Eigen::Index>(count), 3);
  for (std::size_t v = 0; v < count; ++v) {
    const auto triple = [&](const json& list, const std::string& name) -> const json& {
      if (!list[v].is_array() || list[v].size() != 3) {
        file.fail(fmt::format("{}[{}]", name, v), "expected three entries, found another value");
      }
      return list[v];
    };
    const json& r = triple(references, "ref_vIdxs");
    const json& w = triple(weights, "weights");
    const json& o = triple(offsets, "offsets");
    for (std::size_t k = 0; k < 3; ++k) {
      proxy.references[v][k] = file.index(r[k], MakehumanBody::vertex_count, fmt::format("ref_vIdxs[{}]", v));
      proxy.weights[v][k] = file.number(w[k], fmt::format("weights[{}]", v));
      proxy.offsets(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k)) =
          metres_per_unit * file.number(o[k], fmt::format("offsets[{}]", v));
    }
  }

  proxy.covered.assign(MakehumanBody::vertex_count, false);
  const auto covered = file.metadata().find("deleteVerts");
  if (covered != file.metadata().end() && covered->is_array() && !covered->empty()) {
    file.expect_size(*covered, MakehumanBody::vertex_count, "metadata.deleteVerts");
    for (std::size_t v = 0; v < proxy.covered.size(); ++v) {
      const json& flag = (*covered)[v];
      proxy.covered[v] = flag.is_boolean() ? flag.get<bool>() : flag.is_number() && flag != 0;
    }
  }
  return proxy;
}

}  // namespace reprise::makehuman
