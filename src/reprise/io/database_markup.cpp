// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/database_markup.h"

#include <array>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/hdf5_contents.h"
#include "reprise/io/image_file.h"

namespace reprise {
namespace {

std::vector<std::string> read_names(const Hdf5Group& group, const char* name) {
  return group.dataset(name).read_texts();
}

void write_skeleton(Hdf5Group& group, const Skeleton& skeleton) {
  std::vector<std::string> names;
  std::vector<std::int32_t> parents;
  std::vector<double> positions;
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
    positions.insert(positions.end(), joint.rest_position.begin(), joint.rest_position.end());
  }
  group.write_text_dataset("joint_names", std::span<const std::string>(names));
  group.write<std::int32_t>("joint_parents", {parents.size()}, parents);
  group.write<double>("joint_positions", {parents.size(), 3}, positions);
}

Skeleton read_skeleton(const Hdf5Group& group) {
  const std::vector<std::string> names = read_names(group, "joint_names");
  const auto parents = read_column<std::int32_t>(group, "joint_parents", names.size());
  const Hdf5Dataset dataset = group.dataset("joint_positions");
  dataset.check_shape({names.size(), 3});
  const auto positions = dataset.read<double>();
  Skeleton skeleton;
  for (std::size_t j = 0; j < names.size(); ++j) {
    skeleton.joints.push_back({.name = names[j],
                               .parent = parents[j],
                               .rest_position = Eigen::Map<const Eigen::Vector3d>(&positions[3 * j])});
  }
  return skeleton;
}

}  // namespace

void write_texture(Hdf5Group& topology, const Image& texture) {
  const std::vector<std::byte> png = encode_png(texture);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(png.data()), png.size());
  topology.write<std::uint8_t>("texture", {bytes.size()}, bytes);
}

Image read_texture(const Hdf5Group& topology) {
  const Hdf5Dataset dataset = topology.dataset("texture");
  const auto bytes = read_column<std::uint8_t>(topology, "texture", dataset.size());
  try {
    return decode_png(std::as_bytes(std::span(bytes)));
  } catch (const InvalidArgument& error) {
    throw FileError(topology.file_path(), dataset.name(), error.what());
  }
}

void write_parts(Hdf5Group& group, const std::vector<BodyPart>& parts) {
  std::vector<std::string> names;
  std::vector<std::int32_t> parents;
  std::vector<std::int32_t> sizes;
  std::vector<std::int32_t> vertices;
  for (const BodyPart& part : parts) {
    names.push_back(part.name);
    parents.push_back(part.parent);
    sizes.push_back(static_cast<std::int32_t>(part.vertices.size()));
    vertices.insert(vertices.end(), part.vertices.begin(), part.vertices.end());
  }
  group.write_text_dataset("part_names", std::span<const std::string>(names));
  group.write<std::int32_t>("part_parents", {parents.size()}, parents);
  group.write<std::int32_t>("part_sizes", {sizes.size()}, sizes);
  group.write<std::int32_t>("part_vertices", {vertices.size()}, vertices);
}

std::vector<BodyPart> read_parts(const Hdf5Group& group) {
  const std::vector<std::string> names = read_names(group, "part_names");
  const auto parents = read_column<std::int32_t>(group, "part_parents", names.size());
  const auto sizes = read_column<std::int32_t>(group, "part_sizes", names.size());
  const Hdf5Dataset dataset = group.dataset("part_vertices");
  const std::span<const std::int32_t> claimed(sizes);
  std::size_t expected = 0;
  for (const std::int32_t size : claimed) {
    if (size < 0)
      throw FileError(group.file_path(), group.name(), fmt::format("a part has {} vertices", size));
    expected += static_cast<std::size_t>(size);
  }
  dataset.check_shape({expected});
  const auto vertices = dataset.read<std::int32_t>();
  std::vector<BodyPart> parts;
  auto first = vertices.begin();
  for (std::size_t p = 0; p < names.size(); ++p) {
    parts.push_back({.name = names[p], .parent = parents[p], .vertices = {first, first + sizes[p]}});
    first += sizes[p];
  }
  return parts;
}

void write_markup(Hdf5Group& group, const Markup& markup) {
  write_skeleton(group, markup.skeleton);
  const auto n = static_cast<std::size_t>(markup.reference.rows());
  group.write<float>("reference", {n, 3}, std::span(markup.reference.data(), n * 3));
  group.write<std::int32_t>("joint_of_vertex", {n}, markup.joint_of_vertex);
  if (!markup.parts.empty()) write_parts(group, markup.parts);
  if (!markup.layers.empty()) {
    group.write_text_dataset("layer_names", std::span<const std::string>(markup.layers));
    group.write<std::uint8_t>("layer_of_vertex", {n}, markup.layer_of_vertex);
  }
}

Markup read_markup(const Hdf5Group& group, std::int32_t vertex_count) {
  const auto n = static_cast<std::size_t>(vertex_count);
  Markup markup{.skeleton = read_skeleton(group)};
  const Hdf5Dataset reference = group.dataset("reference");
  reference.check_shape({n, 3});
  markup.reference.resize(vertex_count, 3);
  reference.read<float>({0, 0}, {n, 3}, std::span(markup.reference.data(), n * 3));
  markup.joint_of_vertex = read_column<std::int32_t>(group, "joint_of_vertex", n);
  if (group.has("part_names")) markup.parts = read_parts(group);
  if (group.has("layer_names")) {
    markup.layers = read_names(group, "layer_names");
    markup.layer_of_vertex = read_column<std::uint8_t>(group, "layer_of_vertex", n);
  }
  check_contents(group, [&] { validate(markup, vertex_count); });
  return markup;
}

void write_truth(Hdf5Group& group, const ClipTruth& truth) {
  const std::size_t frames = truth.poses.size();
  const std::size_t joints = frames == 0 ? 0 : truth.poses.front().position.size();
  std::vector<double> positions;
  std::vector<double> rotations;
  std::vector<std::uint8_t> contacts;
  for (const SkeletonPose& pose : truth.poses) {
    for (std::size_t j = 0; j < joints; ++j) {
      positions.insert(positions.end(), pose.position[j].begin(), pose.position[j].end());
      const Eigen::Quaterniond& q = pose.rotation[j];
      rotations.insert(rotations.end(), {q.w(), q.x(), q.y(), q.z()});
    }
  }
  for (const FootContacts& feet : truth.contacts) {
    for (const bool stands : feet) contacts.push_back(stands ? 1 : 0);
  }
  group.write<double>("positions", {frames, joints, 3}, positions);
  group.write<double>("rotations", {frames, joints, 4}, rotations);
  group.write<std::uint8_t>("contacts", {frames, 2}, contacts);
}

ClipTruth read_truth(const Hdf5Group& group, const Skeleton& skeleton, std::size_t frame_count) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  const auto values = [&](const char* name, const Hdf5Shape& shape) {
    const Hdf5Dataset dataset = group.dataset(name);
    dataset.check_shape(shape);
    return dataset.read<double>();
  };
  const std::vector<double> positions = values("positions", {frame_count, joints, 3});
  const std::vector<double> rotations = values("rotations", {frame_count, joints, 4});
  const std::vector<double> contacts = values("contacts", {frame_count, 2});
  ClipTruth truth;
  for (std::size_t f = 0; f < frame_count; ++f) {
    SkeletonPose pose;
    for (std::size_t j = 0; j < joints; ++j) {
      const double* p = &positions[(f * joints + j) * 3];
      const double* q = &rotations[(f * joints + j) * 4];
      pose.position.emplace_back(p[0], p[1], p[2]);
      pose.rotation.emplace_back(q[0], q[1], q[2], q[3]);
    }
    truth.poses.push_back(std::move(pose));
    truth.contacts.push_back({contacts[f * 2] != 0.0, contacts[f * 2 + 1] != 0.0});
  }
  check_contents(group, [&] { validate(truth, skeleton, frame_count); });
  return truth;
}

}  // namespace reprise
