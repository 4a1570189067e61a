// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/body_parts.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/mesh/geodesic.h"

namespace reprise {

namespace {

struct PartDefinition {
  const char* name;
  std::array<std::string_view, 2> first_joints;  // the part holds these and what hangs on them
};
constexpr std::array<PartDefinition, 6> definitions = {{{"torso", {"", ""}},
                                                        {"head", {"neck", "head"}},
                                                        {"left_arm", {"left_upper_arm", ""}},
                                                        {"right_arm", {"right_upper_arm", ""}},
                                                        {"left_leg", {"left_thigh", ""}},
                                                        {"right_leg", {"right_thigh", ""}}}};
constexpr int torso = 0;

int part_of_joint(const Skeleton& skeleton, int joint_idx) {
  for (int joint = joint_idx; joint >= 0; joint = skeleton.joints[static_cast<std::size_t>(joint)].parent) {
    const std::string& name = skeleton.joints[static_cast<std::size_t>(joint)].name;
    for (std::size_t part = 1; part < definitions.size(); ++part) {
      const auto& first = definitions[part].first_joints;
      if (std::find(first.begin(), first.end(), name) != first.end()) return static_cast<int>(part);
    }
  }
  return torso;
}

}  // namespace

std::vector<BodyPart> body_parts(const Topology& topology, const Positions& reference,
                                 const Skeleton& skeleton, const std::vector<std::int32_t>& joint_of_vertex,
                                 const BodyPartOptions& options) {
  const auto vertex_count = static_cast<std::size_t>(topology.vertex_count);
  if (joint_of_vertex.size() != vertex_count) {
    throw InvalidArgument(
        fmt::format("{} joint labels for {} vertices", joint_of_vertex.size(), vertex_count));
  }
  const EdgeGraph graph(topology, PositionsView(reference.data(), reference.rows(), 3));

  std::vector<std::int32_t> labelled;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (joint_of_vertex[v] >= skeleton.size()) {
      throw InvalidArgument(fmt::format("vertex {} is labelled with joint {}, but there are {} joints", v,
                                        joint_of_vertex[v], skeleton.size()));
    }
    if (joint_of_vertex[v] >= 0) labelled.push_back(static_cast<std::int32_t>(v));
  }
  if (labelled.empty()) throw InvalidArgument("no vertex is labelled with a joint");

  const std::vector<std::int32_t> nearest = graph.nearest_source(labelled);
  std::vector<int> part_of_vertex(vertex_count, torso);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (nearest[v] < 0) continue;  // a component without any label
    const std::int32_t label =
        joint_of_vertex[static_cast<std::size_t>(labelled[static_cast<std::size_t>(nearest[v])])];
    part_of_vertex[v] = part_of_joint(skeleton, label);
  }

  const double ease = options.overlap / options.free_overlap;
  const auto is_free = [&](std::int32_t v) { return joint_of_vertex[static_cast<std::size_t>(v)] < 0; };
  std::vector<BodyPart> parts;
  for (std::size_t part = 0; part < definitions.size(); ++part) {
    std::vector<std::int32_t> core;
    for (std::size_t v = 0; v < vertex_count; ++v) {
      if (part_of_vertex[v] == static_cast<int>(part)) core.push_back(static_cast<std::int32_t>(v));
    }
    if (core.empty()) continue;
    const std::vector<float> distances = graph.distances(
        core, static_cast<float>(options.overlap),
        [&](std::int32_t a, std::int32_t b) { return is_free(a) && is_free(b) ? ease : 1.0; });
    BodyPart grown{.name = definitions[part].name, .parent = parts.empty() ? -1 : 0, .vertices = {}};
    for (std::size_t v = 0; v < vertex_count; ++v) {
      if (distances[v] < EdgeGraph::unreached) grown.vertices.push_back(static_cast<std::int32_t>(v));
    }
    parts.push_back(std::move(grown));
  }
  return parts;
}

}  // namespace reprise
