// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/body_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/mesh/geodesic.h"

namespace reprise {

namespace {

// The part that names each joint itself, -1 for none.
std::vector<int> named_parts(const Skeleton& skeleton, std::span<const JointPart> parts) {
  std::vector<int> named(skeleton.joints.size(), -1);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const std::string& name : parts[p].joints) {
      int& part = named[static_cast<std::size_t>(skeleton.joint_idx(name))];
      if (part >= 0) {
        throw InvalidArgument(fmt::format("the parts '{}' and '{}' both name the joint '{}'",
                                          parts[static_cast<std::size_t>(part)].name, parts[p].name, name));
      }
      part = static_cast<int>(p);
    }
  }
  return named;
}

// Index of every part's parent, -1 for the root.
std::vector<int> check_tree(std::span<const JointPart> parts) {
  if (parts.empty()) throw InvalidArgument("no part is given; expected one or more");
  std::map<std::string_view, int> known;
  std::vector<int> parents;
  for (const JointPart& part : parts) {
    if (part.name.empty()) throw InvalidArgument(fmt::format("part {} has no name", parents.size()));
    if (part.parent.empty() != parents.empty() || part.joints.empty() != parents.empty()) {
      throw InvalidArgument(fmt::format(
          "part '{}' has {} and {} joints; expected a root without parent and joints first, then "
          "parts with both",
          part.name, part.parent.empty() ? "no parent" : fmt::format("the parent '{}'", part.parent),
          part.joints.size()));
    }
    const auto parent = known.find(part.parent);
    if (!part.parent.empty() && parent == known.end()) {
      throw InvalidArgument(fmt::format(
          "part '{}' has the parent '{}'; expected the name of a part before it", part.name, part.parent));
    }
    parents.push_back(parent == known.end() ? -1 : parent->second);
    if (!known.emplace(part.name, static_cast<int>(parents.size()) - 1).second)
      throw InvalidArgument(fmt::format("there are two parts named '{}'", part.name));
  }
  return parents;
}

void check_labels(std::size_t vertex_count, const Skeleton& skeleton,
                  const std::vector<std::int32_t>& joint_of_vertex) {
  if (joint_of_vertex.size() != vertex_count) {
    throw InvalidArgument(
        fmt::format("{} joint labels for {} vertices", joint_of_vertex.size(), vertex_count));
  }
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (joint_of_vertex[v] >= skeleton.size()) {
      throw InvalidArgument(fmt::format("vertex {} is labelled with joint {}, but there are {} joints", v,
                                        joint_of_vertex[v], skeleton.size()));
    }
  }
}

// The part to which each vertex belongs before parts overlap.
std::vector<int> divide(const EdgeGraph& graph, const Skeleton& skeleton,
                        const std::vector<std::int32_t>& joint_of_vertex, std::span<const JointPart> parts) {
  const std::vector<int> named = named_parts(skeleton, parts);
  std::vector<int> part_of_joint;
  for (std::size_t j = 0; j < named.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const int inherited = parent < 0 ? 0 : part_of_joint[static_cast<std::size_t>(parent)];
    part_of_joint.push_back(named[j] >= 0 ? named[j] : inherited);
  }
  std::vector<std::int32_t> labelled;
  for (std::size_t v = 0; v < joint_of_vertex.size(); ++v) {
    if (joint_of_vertex[v] >= 0) labelled.push_back(static_cast<std::int32_t>(v));
  }
  if (labelled.empty()) throw InvalidArgument("no vertex is labelled with a joint");
  const std::vector<std::int32_t> nearest = graph.nearest_source(labelled);
  std::vector<int> part_of_vertex(joint_of_vertex.size(), 0);
  for (std::size_t v = 0; v < part_of_vertex.size(); ++v) {
    if (nearest[v] < 0) continue;  // a component without any label
    const std::int32_t joint =
        joint_of_vertex[static_cast<std::size_t>(labelled[static_cast<std::size_t>(nearest[v])])];
    part_of_vertex[v] = part_of_joint[static_cast<std::size_t>(joint)];
  }
  return part_of_vertex;
}

bool has_joint(const Skeleton& skeleton, const std::string& name) {
  return skeleton.find(name).has_value();
}

}  // namespace

std::vector<BodyPart> parts_of_joints(const Topology& topology, const Positions& reference,
                                      const Skeleton& skeleton,
                                      const std::vector<std::int32_t>& joint_of_vertex,
                                      std::span<const JointPart> parts, const BodyPartOptions& options) {
  const auto vertex_count = static_cast<std::size_t>(topology.vertex_count);
  if (!(options.overlap > 0.0) || !(options.free_overlap > 0.0)) {
    throw InvalidArgument(fmt::format("overlaps of {} m and {} m; expected more than 0", options.overlap,
                                      options.free_overlap));
  }
  check_labels(vertex_count, skeleton, joint_of_vertex);
  const std::vector<int> parents = check_tree(parts);
  const EdgeGraph graph(topology, PositionsView(reference.data(), reference.rows(), 3));
  const std::vector<int> part_of_vertex = divide(graph, skeleton, joint_of_vertex, parts);

  const double ease = options.overlap / options.free_overlap;
  const auto is_free = [&](std::int32_t v) { return joint_of_vertex[static_cast<std::size_t>(v)] < 0; };
  std::vector<BodyPart> grown_parts;
  std::vector<int> grown_idx(parts.size(), -1);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<std::int32_t> core;
    for (std::size_t v = 0; v < vertex_count; ++v) {
      if (part_of_vertex[v] == static_cast<int>(part)) core.push_back(static_cast<std::int32_t>(v));
    }
    if (core.empty()) continue;
    // The nearest part above that has vertices; the first of all if there is none.
    int above = parents[part];
    while (above >= 0 && grown_idx[static_cast<std::size_t>(above)] < 0)
      above = parents[static_cast<std::size_t>(above)];
    const int parent = above >= 0 ? grown_idx[static_cast<std::size_t>(above)] : 0;
    const std::vector<float> distances = graph.distances(
        core, static_cast<float>(options.overlap),
        [&](std::int32_t a, std::int32_t b) { return is_free(a) && is_free(b) ? ease : 1.0; });
    BodyPart grown{.name = parts[part].name, .parent = grown_parts.empty() ? -1 : parent, .vertices = {}};
    for (std::size_t v = 0; v < vertex_count; ++v) {
      if (distances[v] < EdgeGraph::unreached) grown.vertices.push_back(static_cast<std::int32_t>(v));
    }
    grown_idx[part] = static_cast<int>(grown_parts.size());
    grown_parts.push_back(std::move(grown));
  }
  return grown_parts;
}

std::vector<JointPart> human_parts(const Skeleton& skeleton, int levels) {
  if (levels != 1 && levels != 2)
    throw InvalidArgument(fmt::format("{} levels of body parts; expected 1 or 2", levels));
  std::vector<JointPart> parts = {{.name = "torso", .parent = "", .joints = {}}};
  // Parts whose joints the skeleton lacks are passed over by their children.
  const auto add = [&](const std::string& name, std::string_view parent, std::vector<std::string> joints) {
    std::erase_if(joints, [&](const std::string& joint) { return !has_joint(skeleton, joint); });
    if (joints.empty()) return false;
    parts.push_back({.name = name, .parent = std::string(parent), .joints = std::move(joints)});
    return true;
  };
  add("head", "torso", {"neck", "head"});
  struct Limb {
    std::string_view name;
    std::vector<std::string_view> bones;
  };
  for (const Limb& limb :
       {Limb{"arm", {"upper_arm", "forearm", "hand"}}, Limb{"leg", {"thigh", "shin", "foot"}}}) {
    for (const std::string_view side : {"left", "right"}) {
      if (levels == 1) {
        add(fmt::format("{}_{}", side, limb.name), "torso", {fmt::format("{}_{}", side, limb.bones.front())});
        continue;
      }
      std::string parent = "torso";
      for (const std::string_view bone : limb.bones) {
        const std::string name = fmt::format("{}_{}", side, bone);
        if (add(name, parent, {name})) parent = name;
      }
    }
  }
  return parts;
}

std::vector<BodyPart> body_parts(const Topology& topology, const Positions& reference,
                                 const Skeleton& skeleton, const std::vector<std::int32_t>& joint_of_vertex,
                                 const BodyPartOptions& options) {
  return parts_of_joints(topology, reference, skeleton, joint_of_vertex,
                         human_parts(skeleton, options.levels), options);
}

BodyPart whole_body_part(std::int32_t vertex_count) {
  if (vertex_count < 1) throw InvalidArgument(fmt::format("a body of {} vertices", vertex_count));
  BodyPart body{.name = "body", .parent = -1, .vertices = {}};
  body.vertices.resize(static_cast<std::size_t>(vertex_count));
  std::iota(body.vertices.begin(), body.vertices.end(), 0);
  return body;
}

}  // namespace reprise
