// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/part_hierarchy.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/deform/part_weights.h"
#include "reprise/mesh/geodesic.h"

namespace reprise {
namespace {

using Part = PartHierarchy::Part;

void check_reference(const Topology& topology, const PositionsView& reference) {
  if (reference.rows() != topology.vertex_count) {
    throw InvalidArgument(fmt::format("the reference of the parts has {} vertices; the surface has {}",
                                      reference.rows(), topology.vertex_count));
  }
  for (Eigen::Index v = 0; v < reference.rows(); ++v) {
    if (!reference.row(v).allFinite())
      throw InvalidArgument(fmt::format("vertex {} of the parts' reference is not at a finite position", v));
  }
}

void check_every_vertex_is_held(std::int32_t vertex_count, const std::vector<BodyPart>& parts) {
  VertexMask is_held(static_cast<std::size_t>(vertex_count), 0);
  for (const BodyPart& part : parts) {
    for (const std::int32_t v : part.vertices) is_held[static_cast<std::size_t>(v)] = 1;
  }
  const auto missing = std::ranges::count(is_held, 0);
  if (missing == 0) return;
  throw InvalidArgument(fmt::format("{} of {} vertices are in no part, the first is vertex {}", missing,
                                    vertex_count, std::ranges::find(is_held, 0) - is_held.begin()));
}

// The triangles inside of a part, in the indices of the whole surface.
std::vector<std::size_t> triangles_inside(const Topology& topology, const BodyPart& part) {
  VertexMask holds(static_cast<std::size_t>(topology.vertex_count), 0);
  for (const std::int32_t v : part.vertices) holds[static_cast<std::size_t>(v)] = 1;
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    if (std::ranges::all_of(topology.triangles[t],
                            [&](std::int32_t v) { return holds[static_cast<std::size_t>(v)] != 0; }))
      triangles.push_back(t);
  }
  return triangles;
}

void check_every_triangle_is_inside(const Topology& topology, const std::vector<VertexMask>& inside) {
  std::size_t missing = 0;
  std::size_t first = 0;
  for (std::size_t t = topology.triangles.size(); t-- > 0;) {
    if (std::ranges::any_of(inside, [&](const VertexMask& mask) { return mask[t] != 0; })) continue;
    ++missing;
    first = t;
  }
  if (missing == 0) return;
  throw InvalidArgument(fmt::format(
      "{} of {} triangles are inside of no part, the first is triangle {} ({}): its corners are in different "
      "parts; expected parts that overlap by a triangle or more",
      missing, topology.triangles.size(), first, fmt::join(topology.triangles[first], ", ")));
}

// Vertices and sub-topology of a part. `is_corner`: of any triangle of the surface.
void make_surface(const TopologyPtr& whole, const BodyPart& body_part,
                  const std::vector<std::size_t>& triangles, const VertexMask& is_corner, Part& part) {
  VertexMask is_kept(is_corner.size(), 0);
  for (const std::int32_t v : body_part.vertices) {
    if (is_corner[static_cast<std::size_t>(v)] == 0) is_kept[static_cast<std::size_t>(v)] = 1;
  }
  for (const std::size_t t : triangles) {
    for (const std::int32_t v : whole->triangles[t]) is_kept[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<std::int32_t> local(is_corner.size(), -1);
  for (const std::int32_t v : body_part.vertices) {
    if (is_kept[static_cast<std::size_t>(v)] == 0) continue;
    local[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(part.vertices.size());
    part.vertices.push_back(v);
  }
  if (part.vertices.size() == is_corner.size() && triangles.size() == whole->triangles.size()) {
    part.topology = whole;
    return;
  }
  const auto topology = std::make_shared<Topology>();
  topology->vertex_count = static_cast<std::int32_t>(part.vertices.size());
  topology->triangles.reserve(triangles.size());
  for (const std::size_t t : triangles) {
    Triangle& triangle = topology->triangles.emplace_back(whole->triangles[t]);
    for (std::int32_t& v : triangle) v = local[static_cast<std::size_t>(v)];
  }
  part.topology = topology;
}

// Whether the points span a plane, so that they can hold a rigid body.
bool span_a_plane(const PositionsView& reference, const std::vector<std::int32_t>& vertices) {
  if (vertices.size() < 3) return false;
  const auto point = [&](std::int32_t v) -> Eigen::Vector3d { return reference.row(v).cast<double>(); };
  const Eigen::Vector3d origin = point(vertices.front());
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (const std::int32_t v : vertices) {
    const Eigen::Vector3d to_point = point(v) - origin;
    if (to_point.squaredNorm() > axis.squaredNorm()) axis = to_point;
  }
  double widest = 0.0;  // area of the parallelogram
  for (const std::int32_t v : vertices) widest = std::max(widest, axis.cross(point(v) - origin).norm());
  constexpr double min_aspect = 1e-4;  // thinner than this, rounding of the float positions decides
  return widest > min_aspect * axis.squaredNorm();
}

void make_frontier(const PositionsView& reference, const Part& parent, const std::vector<float>& parent_share,
                   Part& part) {
  std::vector<std::int32_t> holding;
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    const std::int32_t v = part.vertices[i];
    const std::int32_t parent_local = parent.local(v);
    if (parent_local < 0) continue;
    const double share = parent_share[static_cast<std::size_t>(v)];
    part.frontier.push_back({.vertex = v,
                             .local = static_cast<std::int32_t>(i),
                             .parent_local = parent_local,
                             .parent_share = share});
    if (share > 0.0) holding.push_back(v);
  }
  if (part.frontier.empty()) {
    throw InvalidArgument(fmt::format("part '{}' does not overlap its parent '{}': they share no vertex",
                                      part.name, parent.name));
  }
  if (!span_a_plane(reference, holding)) {
    throw InvalidArgument(fmt::format(
        "part '{}' shares {} vertices with its parent '{}' that can hold it; expected three or more "
        "that do not lie in one line",
        part.name, holding.size(), parent.name));
  }
}

std::int32_t nearest_of(const PositionsView& reference, const Part& part,
                        const std::vector<std::int32_t>& from, const std::vector<std::int32_t>& candidates) {
  const auto row = [&](std::int32_t local) {
    return reference.row(part.vertices[static_cast<std::size_t>(local)]);
  };
  std::int32_t nearest = -1;
  float least = std::numeric_limits<float>::infinity();
  for (const std::int32_t candidate : candidates) {
    for (const std::int32_t v : from) {
      const float distance = (row(v) - row(candidate)).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

void find_loose_components(const PositionsView& reference, Part& part) {
  const ConnectedComponents components = connected_components(*part.topology);
  std::vector<std::vector<std::int32_t>> members(static_cast<std::size_t>(components.count));
  for (std::size_t v = 0; v < components.of_vertex.size(); ++v) {
    members[static_cast<std::size_t>(components.of_vertex[v])].push_back(static_cast<std::int32_t>(v));
  }
  VertexMask is_held(members.size(), 0);
  if (part.parent < 0) {
    const auto most = std::ranges::max_element(members, {}, &std::vector<std::int32_t>::size);
    is_held[static_cast<std::size_t>(most - members.begin())] = 1;
  }
  for (const PartHierarchy::FrontierVertex& shared : part.frontier) {
    // An anchor of no weight holds nothing.
    if (shared.parent_share > 0.0)
      is_held[static_cast<std::size_t>(components.of_vertex[static_cast<std::size_t>(shared.local)])] = 1;
  }
  std::vector<std::int32_t> held;
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (is_held[c] != 0) held.insert(held.end(), members[c].begin(), members[c].end());
  }
  std::ranges::sort(held);
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (is_held[c] != 0) continue;
    const std::int32_t carrier = nearest_of(reference, part, members[c], held);
    part.loose.push_back({.vertices = std::move(members[c]), .carrier = carrier});
  }
}

}  // namespace

std::int32_t PartHierarchy::Part::local(std::int32_t vertex) const {
  const auto found = std::ranges::lower_bound(vertices, vertex);
  return found == vertices.end() || *found != vertex ? -1
                                                     : static_cast<std::int32_t>(found - vertices.begin());
}

PartHierarchy::PartHierarchy(TopologyPtr topology, const PositionsView& reference,
                             const std::vector<BodyPart>& parts, const PartHierarchyOptions& options)
    : topology_(std::move(topology)) {
  if (!topology_) throw InvalidArgument("parts need a topology");
  if (!(options.takeover > 0.0))
    throw InvalidArgument(fmt::format("a takeover of {} m; expected more than 0", options.takeover));
  check_reference(*topology_, reference);
  if (parts.empty()) throw InvalidArgument("no part is given; expected one or more");
  validate(parts, topology_->vertex_count);
  check_every_vertex_is_held(topology_->vertex_count, parts);

  const auto vertex_count = static_cast<std::size_t>(topology_->vertex_count);
  VertexMask is_corner(vertex_count, 0);
  for (const Triangle& triangle : topology_->triangles) {
    for (const std::int32_t v : triangle) is_corner[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<PartTerritory> territories;
  std::vector<VertexMask> inside;  // by part and triangle
  for (const BodyPart& body_part : parts) {
    const std::vector<std::size_t> triangles = triangles_inside(*topology_, body_part);
    if (triangles.empty())
      throw InvalidArgument(fmt::format("part '{}' holds no triangle whole", body_part.name));
    VertexMask& mask = inside.emplace_back(topology_->triangles.size(), 0);
    for (const std::size_t t : triangles) mask[t] = 1;

    Part& part = parts_.emplace_back();
    part.name = body_part.name;
    part.parent = body_part.parent;
    if (part.parent >= 0) {
      Part& parent = parts_[static_cast<std::size_t>(part.parent)];
      parent.children.push_back(static_cast<int>(parts_.size()) - 1);
      part.level = parent.level + 1;
    }
    make_surface(topology_, body_part, triangles, is_corner, part);
    VertexMask& holds =
        territories.emplace_back(PartTerritory{.parent = part.parent, .holds = VertexMask(vertex_count, 0)})
            .holds;
    for (const std::int32_t v : part.vertices) holds[static_cast<std::size_t>(v)] = 1;
  }
  check_every_triangle_is_inside(*topology_, inside);

  const EdgeGraph graph(*topology_, reference);
  const std::vector<PartDistances> distances = part_distances(graph, territories, options.takeover);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    if (part.parent >= 0)
      make_frontier(reference, parts_[static_cast<std::size_t>(part.parent)], distances[p].parent_share,
                    part);
    find_loose_components(reference, part);
  }
  make_shares(distances);
}

int PartHierarchy::part_idx(std::string_view name) const {
  const auto found = std::ranges::find(parts_, name, &Part::name);
  if (found != parts_.end()) return static_cast<int>(found - parts_.begin());
  std::vector<std::string> names;
  for (const Part& part : parts_) names.push_back(part.name);
  const std::string nearest = nearest_word(name, names);
  throw InvalidArgument(fmt::format("there is no part '{}'{}; the parts are: {}", name,
                                    nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest),
                                    fmt::join(names, ", ")));
}

std::vector<std::vector<int>> PartHierarchy::levels() const {
  std::vector<std::vector<int>> levels;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto level = static_cast<std::size_t>(parts_[p].level);
    if (levels.size() <= level) levels.resize(level + 1);
    levels[level].push_back(static_cast<int>(p));
  }
  return levels;
}

std::vector<int> PartHierarchy::descendants(int part_idx) const {
  VertexMask is_below(parts_.size(), 0);
  is_below.at(static_cast<std::size_t>(part_idx)) = 1;
  std::vector<int> below;
  for (std::size_t p = static_cast<std::size_t>(part_idx) + 1; p < parts_.size(); ++p) {
    if (parts_[p].parent < 0 || is_below[static_cast<std::size_t>(parts_[p].parent)] == 0) continue;
    is_below[p] = 1;
    below.push_back(static_cast<int>(p));
  }
  return below;
}

}  // namespace reprise
