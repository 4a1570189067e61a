// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/markup_file.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/json_file.h"
#include "reprise/database/body_parts.h"
#include "reprise/database/part_tree.h"

namespace reprise {
namespace {

constexpr const char* markup_format = "reprise markup";
constexpr const char* landmark_format = "reprise landmarks";
constexpr int format_version = 1;

JsonField open_format(const std::filesystem::path& path, const Json& json, const char* format,
                      const char* kind) {
  if (!json.is_object() || !json.contains("format") || json["format"] != format) {
    throw FileError(path, fmt::format("is not a {}: expected \"format\": \"{}\"", kind, format));
  }
  const JsonField file(path, json);
  if (const int version = file["version"].integer(1); version > format_version) {
    file["version"].fail(
        fmt::format("the file has version {}, this program reads up to version {}", version, format_version));
  }
  return file;
}

Eigen::Vector3d read_point(const JsonField& field) {
  const std::vector<JsonField> numbers = field.items();
  if (numbers.size() != 3)
    field.fail(fmt::format("expected three numbers (x, y, z), found {}", numbers.size()));
  return {numbers[0].number(), numbers[1].number(), numbers[2].number()};
}

Positions surface_of(const JsonField& field, const std::string& frame, const PerformanceDatabase& database) {
  try {
    const FrameId id = database.parse_frame(frame);
    return database.clip(id.clip_idx).frame(id.frame_idx);
  } catch (const InvalidArgument& error) {
    field.fail(error.what());
  }
}

Positions read_reference(const JsonField& field, const PerformanceDatabase& database) {
  if (field.is_text()) return surface_of(field, field.text(), database);
  const std::vector<JsonField> points = field.items();
  const auto expected = static_cast<std::size_t>(database.topology()->vertex_count);
  if (points.size() != expected) {
    field.fail(
        fmt::format("expected CLIP:FRAME or {} positions, one a vertex; found {}", expected, points.size()));
  }
  Positions reference(database.topology()->vertex_count, 3);
  for (std::size_t v = 0; v < expected; ++v) {
    reference.row(static_cast<Eigen::Index>(v)) = read_point(points[v]).transpose().cast<float>();
  }
  return reference;
}

std::vector<std::int32_t> read_vertices(const JsonField& field, std::int32_t vertex_count) {
  std::vector<std::int32_t> vertices;
  for (const JsonField& item : field.items()) vertices.push_back(item.integer(0, vertex_count - 1));
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

// Index of the parent among the names before, or -1 for null.
int read_parent(const JsonField& field, const std::vector<std::string>& before) {
  if (field.is_null()) return -1;
  const std::string name = field.text();
  const auto found = std::ranges::find(before, name);
  if (found == before.end())
    field.fail(fmt::format("expected null or a name listed before, found '{}'", name));
  return static_cast<int>(found - before.begin());
}

// The middle of the edges between two labels, or nothing if they do not meet.
std::optional<Eigen::Vector3d> border(const Topology& topology, const Markup& markup, int a, int b) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t p = triangle[k];
      const std::int32_t q = triangle[(k + 1) % 3];
      if (markup.joint_of_vertex[static_cast<std::size_t>(p)] != a ||
          markup.joint_of_vertex[static_cast<std::size_t>(q)] != b) {
        continue;  // each edge comes once in each direction
      }
      sum += 0.5 * (markup.reference.row(p) + markup.reference.row(q)).transpose().cast<double>();
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

void place_joint(const JsonField& field, const Topology& topology, Markup& markup, int joint_idx) {
  Joint& joint = markup.skeleton.joints[static_cast<std::size_t>(joint_idx)];
  if (field.has("position")) {
    joint.rest_position = read_point(field["position"]);
    return;
  }
  if (joint.parent >= 0) {
    if (const auto middle = border(topology, markup, joint.parent, joint_idx)) {
      joint.rest_position = *middle;
      return;
    }
  }
  const std::vector<std::int32_t> vertices = markup.vertices_of_joint(joint_idx);
  if (vertices.empty()) {
    field.fail(fmt::format("joint '{}' has neither a position nor vertices to tell it", joint.name));
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t v : vertices) sum += markup.reference.row(v).transpose().cast<double>();
  joint.rest_position = sum / static_cast<double>(vertices.size());
}

void read_joints(const JsonField& field, const Topology& topology, Markup& markup) {
  markup.joint_of_vertex.assign(static_cast<std::size_t>(topology.vertex_count), -1);
  std::vector<std::string> names;
  const std::vector<JsonField> items = field.items();
  for (const JsonField& item : items) {
    item.warn_of_others({"name", "parent", "position", "vertices"});
    const std::string name = item["name"].text();
    if (std::ranges::count(names, name) > 0)
      item["name"].fail(fmt::format("there is a joint '{}' already", name));
    markup.skeleton.joints.push_back({.name = name,
                                      .parent = item.has("parent") ? read_parent(item["parent"], names) : -1,
                                      .rest_position = Eigen::Vector3d::Zero()});
    names.push_back(name);
    if (!item.has("vertices")) continue;
    for (const std::int32_t v : read_vertices(item["vertices"], topology.vertex_count)) {
      std::int32_t& label = markup.joint_of_vertex[static_cast<std::size_t>(v)];
      if (label >= 0) {
        item["vertices"].fail(fmt::format("vertex {} is labelled '{}' already; a vertex follows one joint", v,
                                          names[static_cast<std::size_t>(label)]));
      }
      label = static_cast<std::int32_t>(names.size()) - 1;
    }
  }
  for (std::size_t j = 0; j < items.size(); ++j) {
    place_joint(items[j], topology, markup, static_cast<int>(j));
  }
}

// Parts by the joints they follow: the first has none, and no part has vertices.
std::vector<BodyPart> read_joint_parts(const JsonField& field, const Topology& topology,
                                       const Markup& markup) {
  std::vector<JointPart> parts;
  for (const JsonField& item : field.items()) {
    if (item.has("vertices"))
      item["vertices"].fail("expected parts that have either all vertices or all joints");
    JointPart& part = parts.emplace_back();
    part.name = item["name"].text();
    if (item.has("parent") && !item["parent"].is_null()) part.parent = item["parent"].text();
    if (!item.has("joints")) continue;
    for (const JsonField& joint : item["joints"].items()) part.joints.push_back(joint.text());
  }
  try {
    return parts_of_joints(topology, markup.reference, markup.skeleton, markup.joint_of_vertex, parts);
  } catch (const InvalidArgument& error) {
    field.fail(error.what());
  }
}

// Parts whose tree follows from the vertices they share.
std::vector<BodyPart> derive_parts(const JsonField& field, const JsonField& root,
                                   std::vector<BodyPart> parts) {
  const std::string name = root.text();
  const auto found = std::ranges::find(parts, name, &BodyPart::name);
  if (found == parts.end()) root.fail(fmt::format("there is no part '{}'", name));
  const auto root_idx = static_cast<int>(found - parts.begin());
  try {
    return derive_hierarchy(std::move(parts), root_idx);
  } catch (const InvalidArgument& error) {
    field.fail(error.what());
  }
}

void read_parts(const JsonField& file, const Topology& topology, Markup& markup) {
  const JsonField field = file["parts"];
  const bool is_derived = file.has("root_part");
  const std::vector<JsonField> items = field.items();
  for (const JsonField& item : items) item.warn_of_others({"name", "parent", "vertices", "joints"});
  if (std::ranges::any_of(items, [](const JsonField& item) { return item.has("joints"); })) {
    if (is_derived) file["root_part"].fail("parts of joints have a tree; expected parts of vertices");
    markup.parts = read_joint_parts(field, topology, markup);
    return;
  }
  std::vector<std::string> names;
  for (const JsonField& item : items) {
    const bool has_parent = item.has("parent") && !item["parent"].is_null();
    if (has_parent && is_derived) {
      item["parent"].fail("expected no parents, since 'root_part' asks for a tree by shared vertices");
    }
    if (!has_parent && !is_derived && !names.empty()) {
      item.fail(
          fmt::format("part '{}' lacks a parent: expected the name of a part before it, or the field "
                      "'root_part' in the file for a tree by shared vertices",
                      item["name"].text()));
    }
    markup.parts.push_back({.name = item["name"].text(),
                            .parent = has_parent ? read_parent(item["parent"], names) : -1,
                            .vertices = read_vertices(item["vertices"], topology.vertex_count)});
    names.push_back(markup.parts.back().name);
  }
  if (is_derived) markup.parts = derive_parts(field, file["root_part"], std::move(markup.parts));
}

void read_layers(const JsonField& field, std::int32_t vertex_count, Markup& markup) {
  std::vector<int> layer_of_vertex(static_cast<std::size_t>(vertex_count), -1);
  const std::vector<JsonField> items = field.items();
  constexpr std::size_t most = 256;
  if (items.size() > most)
    field.fail(fmt::format("expected at most {} layers, found {}", most, items.size()));
  for (const JsonField& item : items) {
    item.warn_of_others({"name", "vertices"});
    for (const std::int32_t v : read_vertices(item["vertices"], vertex_count)) {
      int& layer = layer_of_vertex[static_cast<std::size_t>(v)];
      if (layer >= 0) {
        item["vertices"].fail(fmt::format("vertex {} has the layer '{}' already", v,
                                          markup.layers[static_cast<std::size_t>(layer)]));
      }
      layer = static_cast<int>(markup.layers.size());
    }
    markup.layers.push_back(item["name"].text());
  }
  if (items.empty()) return;
  for (std::size_t v = 0; v < layer_of_vertex.size(); ++v) {
    if (layer_of_vertex[v] < 0) field.fail(fmt::format("vertex {} is in none of the layers", v));
    markup.layer_of_vertex.push_back(static_cast<std::uint8_t>(layer_of_vertex[v]));
  }
}

Json point_json(const Eigen::Vector3d& point) {
  return Json::array({point.x(), point.y(), point.z()});
}

Json reference_json(const PerformanceDatabase& database) {
  const Positions& reference = database.markup()->reference;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const MeshSequence& clip = database.clip(c);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      if (clip.frame(f) == reference) return database.to_string({.clip_idx = c, .frame_idx = f});
    }
  }
  Json points = Json::array();
  for (Eigen::Index v = 0; v < reference.rows(); ++v) {
    points.push_back(Json::array({reference(v, 0), reference(v, 1), reference(v, 2)}));
  }
  return points;
}

// JSON of a person: one list of numbers a line, everything else spread out.
void append(std::string& out, const Json& value, int indent) {
  const bool is_flat = !value.is_structured() ||
                       (value.is_array() &&
                        std::ranges::none_of(value, [](const Json& item) { return item.is_structured(); }));
  if (is_flat || value.empty()) {
    out += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const std::string margin(static_cast<std::size_t>(indent) + 2, ' ');
  out += value.is_object() ? "{\n" : "[\n";
  bool is_first = true;
  for (const auto& [key, item] : value.items()) {
    if (!is_first) out += ",\n";
    is_first = false;
    out += margin;
    if (value.is_object()) out += Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    append(out, item, indent + 2);
  }
  out += "\n" + std::string(static_cast<std::size_t>(indent), ' ') + (value.is_object() ? "}" : "]");
}

}  // namespace

Markup read_markup_file(const std::filesystem::path& path, const PerformanceDatabase& database,
                        const std::string& frame) {
  if (!database.topology())
    throw InvalidArgument("a markup needs a database with a clip: it labels the vertices");
  const Json json = read_json_file(path);
  const JsonField file = open_format(path, json, markup_format, "markup file");
  file.warn_of_others({"format", "version", "reference", "joints", "parts", "root_part", "layers"});
  const Topology& topology = *database.topology();
  Markup markup;
  if (frame.empty()) {
    markup.reference = read_reference(file["reference"], database);
  } else {
    const FrameId id = database.parse_frame(frame);
    markup.reference = database.clip(id.clip_idx).frame(id.frame_idx);
  }
  read_joints(file["joints"], topology, markup);
  if (file.has("parts")) read_parts(file, topology, markup);
  if (file.has("layers")) read_layers(file["layers"], topology.vertex_count, markup);
  try {
    validate(markup, topology.vertex_count);
  } catch (const InvalidArgument& error) {
    throw FileError(path, error.what());
  }
  return markup;
}

void write_markup_file(const PerformanceDatabase& database, const std::filesystem::path& path) {
  if (!database.markup()) throw InvalidArgument("the database has no markup to write");
  const Markup& markup = *database.markup();
  Json joints = Json::array();
  for (int j = 0; j < markup.skeleton.size(); ++j) {
    const Joint& joint = markup.skeleton.joints[static_cast<std::size_t>(j)];
    Json parent;
    if (joint.parent >= 0) parent = markup.skeleton.joints[static_cast<std::size_t>(joint.parent)].name;
    joints.push_back({{"name", joint.name},
                      {"parent", std::move(parent)},
                      {"position", point_json(joint.rest_position)},
                      {"vertices", markup.vertices_of_joint(j)}});
  }
  Json file = {{"format", markup_format},
               {"version", format_version},
               {"reference", reference_json(database)},
               {"joints", std::move(joints)}};
  for (const BodyPart& part : markup.parts) {
    Json parent;
    if (part.parent >= 0) parent = markup.parts[static_cast<std::size_t>(part.parent)].name;
    file["parts"].push_back(
        {{"name", part.name}, {"parent", std::move(parent)}, {"vertices", part.vertices}});
  }
  for (std::size_t l = 0; l < markup.layers.size(); ++l) {
    std::vector<std::int32_t> vertices;
    for (std::size_t v = 0; v < markup.layer_of_vertex.size(); ++v) {
      if (markup.layer_of_vertex[v] == l) vertices.push_back(static_cast<std::int32_t>(v));
    }
    file["layers"].push_back({{"name", markup.layers[l]}, {"vertices", std::move(vertices)}});
  }
  std::string text;
  append(text, file, 0);
  write_text_file(path, text + "\n");
}

LandmarkFile read_landmark_file(const std::filesystem::path& path) {
  const Json json = read_json_file(path);
  const JsonField file = open_format(path, json, landmark_format, "landmark file");
  file.warn_of_others({"format", "version", "about", "frame", "landmarks"});
  LandmarkFile read;
  if (file.has("frame")) read.frame = file["frame"].text();
  for (const auto& [name, value] : file["landmarks"].entries()) read.landmarks[name] = value.integer(0);
  return read;
}

}  // namespace reprise
