// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/markup.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

void check_labels(const Markup& markup, std::int32_t vertex_count) {
  const auto n = static_cast<std::size_t>(vertex_count);
  if (markup.joint_of_vertex.size() != n) {
    throw InvalidArgument(fmt::format("the markup labels {} vertices with joints; the surface has {}",
                                      markup.joint_of_vertex.size(), n));
  }
  for (std::size_t v = 0; v < n; ++v) {
    const std::int32_t joint = markup.joint_of_vertex[v];
    if (joint < -1 || joint >= markup.skeleton.size()) {
      throw InvalidArgument(fmt::format("vertex {} is labelled with joint {}, but there are {} joints", v,
                                        joint, markup.skeleton.size()));
    }
  }
}

void check_reference(const Markup& markup, std::int32_t vertex_count) {
  if (markup.reference.rows() != vertex_count) {
    throw InvalidArgument(fmt::format("the reference surface of the markup has {} vertices; expected {}",
                                      markup.reference.rows(), vertex_count));
  }
  for (Eigen::Index v = 0; v < markup.reference.rows(); ++v) {
    if (!markup.reference.row(v).allFinite()) {
      throw InvalidArgument(
          fmt::format("vertex {} of the markup's reference surface is not at a finite position", v));
    }
  }
}

void check_layers(const Markup& markup, std::int32_t vertex_count) {
  if (markup.layers.empty() != markup.layer_of_vertex.empty()) {
    throw InvalidArgument(fmt::format("{} layers are named, but {} vertices have one", markup.layers.size(),
                                      markup.layer_of_vertex.size()));
  }
  std::set<std::string> names;
  for (const std::string& name : markup.layers) {
    if (name.empty()) throw InvalidArgument("a layer has no name");
    if (!names.insert(name).second) {
      throw InvalidArgument(fmt::format("there are two layers named '{}'", name));
    }
  }
  if (markup.layers.empty()) return;
  if (markup.layer_of_vertex.size() != static_cast<std::size_t>(vertex_count)) {
    throw InvalidArgument(fmt::format("{} vertices have a layer; the surface has {}",
                                      markup.layer_of_vertex.size(), vertex_count));
  }
  for (std::size_t v = 0; v < markup.layer_of_vertex.size(); ++v) {
    if (markup.layer_of_vertex[v] >= markup.layers.size()) {
      throw InvalidArgument(fmt::format("vertex {} has the layer {}, but there are {} layers", v,
                                        markup.layer_of_vertex[v], markup.layers.size()));
    }
  }
}

}  // namespace

std::vector<std::int32_t> Markup::vertices_of_joint(int joint_idx) const {
  std::vector<std::int32_t> vertices;
  for (std::size_t v = 0; v < joint_of_vertex.size(); ++v) {
    if (joint_of_vertex[v] == joint_idx) vertices.push_back(static_cast<std::int32_t>(v));
  }
  return vertices;
}

void validate(const std::vector<BodyPart>& parts, std::int32_t vertex_count) {
  std::set<std::string> names;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const BodyPart& part = parts[p];
    if (part.name.empty()) throw InvalidArgument(fmt::format("part {} has no name", p));
    if (!names.insert(part.name).second) {
      throw InvalidArgument(fmt::format("there are two parts named '{}'", part.name));
    }
    if (part.parent < -1 || part.parent >= static_cast<int>(p)) {
      throw InvalidArgument(
          fmt::format("part '{}' has the parent {}; expected -1 or the index of a part before it ({})",
                      part.name, part.parent, p));
    }
    if ((part.parent == -1) != (p == 0)) {
      throw InvalidArgument(
          fmt::format("part '{}' {} a parent; expected one tree of parts whose root comes first", part.name,
                      part.parent == -1 ? "lacks" : "has"));
    }
    if (part.vertices.empty()) {
      throw InvalidArgument(fmt::format("part '{}' holds no vertex", part.name));
    }
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
      const std::int32_t v = part.vertices[i];
      if (v < 0 || v >= vertex_count) {
        throw InvalidArgument(
            fmt::format("part '{}' holds vertex {}, but there are {} vertices", part.name, v, vertex_count));
      }
      if (i > 0 && v <= part.vertices[i - 1]) {
        throw InvalidArgument(fmt::format("part '{}' holds vertex {} after {}; expected ascending vertices",
                                          part.name, v, part.vertices[i - 1]));
      }
    }
  }
}

void validate(const Markup& markup, std::int32_t vertex_count) {
  if (markup.skeleton.joints.empty()) throw InvalidArgument("the markup has no joint");
  validate(markup.skeleton);
  check_reference(markup, vertex_count);
  check_labels(markup, vertex_count);
  validate(markup.parts, vertex_count);
  check_layers(markup, vertex_count);
}

void validate(const ClipTruth& truth, const Skeleton& skeleton, std::size_t frame_count) {
  if (truth.poses.size() != frame_count || truth.contacts.size() != frame_count) {
    throw InvalidArgument(
        fmt::format("the truth has {} poses and {} contact entries; expected {} of each, one a frame",
                    truth.poses.size(), truth.contacts.size(), frame_count));
  }
  const auto joint_count = static_cast<std::size_t>(skeleton.size());
  for (std::size_t f = 0; f < frame_count; ++f) {
    const SkeletonPose& pose = truth.poses[f];
    if (pose.rotation.size() != joint_count || pose.position.size() != joint_count) {
      throw InvalidArgument(fmt::format(
          "the true pose of frame {} has {} rotations and {} positions; the skeleton has {} joints", f,
          pose.rotation.size(), pose.position.size(), joint_count));
    }
    for (std::size_t j = 0; j < joint_count; ++j) {
      constexpr double tolerance = 1e-6;
      if (!pose.position[j].allFinite() || !(std::abs(pose.rotation[j].norm() - 1.0) <= tolerance)) {
        throw InvalidArgument(
            fmt::format("the true pose of frame {} has no finite position and unit rotation for joint '{}'",
                        f, skeleton.joints[j].name));
      }
    }
  }
}

}  // namespace reprise
