// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/figure/figure_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "reprise/core/error.h"

namespace reprise::figure {

namespace {

using Quad = std::array<std::int32_t, 4>;

struct QuadSurface {
  std::vector<Eigen::Vector3d> points;
  std::vector<Quad> quads;
};

constexpr int relaxation_steps = 15;

QuadSurface zero_level(const DistanceFunction& distance, const Eigen::AlignedBox3d& box, double voxel_size) {
  openvdb::initialize();
  const double band = 3.0 * voxel_size;
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(static_cast<float>(band));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  openvdb::FloatGrid::Accessor accessor = grid->getAccessor();
  const Eigen::Vector3i low = (box.min() / voxel_size).array().floor().cast<int>();
  const Eigen::Vector3i high = (box.max() / voxel_size).array().ceil().cast<int>();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) {
        const double d = distance(voxel_size * Eigen::Vector3d(x, y, z));
        if (d < band) accessor.setValue({x, y, z}, static_cast<float>(std::max(d, -band)));
      }
    }
  }
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);

  QuadSurface surface;
  for (const openvdb::Vec3s& point : points) surface.points.emplace_back(point.x(), point.y(), point.z());
  for (const openvdb::Vec4I& quad : quads) {
    surface.quads.push_back({static_cast<std::int32_t>(quad[0]), static_cast<std::int32_t>(quad[1]),
                             static_cast<std::int32_t>(quad[2]), static_cast<std::int32_t>(quad[3])});
  }
  return surface;
}

// Keeps the largest connected component, in an order that depends on the geometry alone: whatever order the
// threads of the mesher delivered is forgotten.
QuadSurface largest_component_in_order(const QuadSurface& surface) {
  std::vector<std::int32_t> root(surface.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int32_t vertex) {
    while (root[vertex] != vertex) vertex = root[vertex] = root[root[vertex]];
    return vertex;
  };
  for (const Quad& quad : surface.quads) {
    for (int k = 1; k < 4; ++k) root[find(quad[k])] = find(quad[0]);
  }
  std::vector<std::size_t> size(surface.points.size(), 0);
  for (std::size_t i = 0; i < surface.points.size(); ++i) ++size[find(static_cast<std::int32_t>(i))];
  const auto largest = static_cast<std::int32_t>(std::max_element(size.begin(), size.end()) - size.begin());

  std::vector<std::int32_t> order;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    if (find(static_cast<std::int32_t>(i)) == largest) order.push_back(static_cast<std::int32_t>(i));
  }
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const Eigen::Vector3d& p = surface.points[a];
    const Eigen::Vector3d& q = surface.points[b];
    return std::tie(p.y(), p.x(), p.z()) < std::tie(q.y(), q.x(), q.z());
  });
  QuadSurface result;
  std::vector<std::int32_t> new_idx(surface.points.size(), -1);
  for (const std::int32_t i : order) {
    new_idx[i] = static_cast<std::int32_t>(result.points.size());
    result.points.push_back(surface.points[i]);
  }
  for (Quad quad : surface.quads) {
    if (new_idx[quad[0]] < 0) continue;
    for (std::int32_t& corner : quad) corner = new_idx[corner];
    std::rotate(quad.begin(), std::min_element(quad.begin(), quad.end()), quad.end());
    result.quads.push_back(quad);
  }
  std::sort(result.quads.begin(), result.quads.end());
  return result;
}

Eigen::Vector3d gradient(const DistanceFunction& distance, const Eigen::Vector3d& point, double value) {
  constexpr double step = 1e-5;
  return Eigen::Vector3d(distance(point + step * Eigen::Vector3d::UnitX()) - value,
                         distance(point + step * Eigen::Vector3d::UnitY()) - value,
                         distance(point + step * Eigen::Vector3d::UnitZ()) - value) /
         step;
}

// Moves vertices along the surface towards the middle of their neighbours and back onto the zero level.
void relax(QuadSurface& surface, const DistanceFunction& distance, double voxel_size,
           const std::vector<Eigen::Vector3d>& pins) {
  const std::size_t count = surface.points.size();
  std::vector<std::set<std::int32_t>> neighbors(count);
  for (const Quad& quad : surface.quads) {
    for (int k = 0; k < 4; ++k) {
      neighbors[quad[k]].insert(quad[(k + 1) % 4]);
      neighbors[quad[(k + 1) % 4]].insert(quad[k]);
    }
  }
  std::vector<bool> pinned(count, false);
  for (const Eigen::Vector3d& pin : pins) {
    std::size_t nearest = count;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      const double d = (surface.points[i] - pin).squaredNorm();
      if (!pinned[i] && d < best) {
        best = d;
        nearest = i;
      }
    }
    pinned[nearest] = true;
    surface.points[nearest] = pin;
  }
  for (int step = 0; step < relaxation_steps; ++step) {
    std::vector<Eigen::Vector3d> moved = surface.points;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d& point = surface.points[i];
      const double value = distance(point);
      const Eigen::Vector3d slope = gradient(distance, point, value);
      const double squared = std::max(slope.squaredNorm(), 0.1);
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      if (!pinned[i]) {
        for (const std::int32_t other : neighbors[i]) shift += surface.points[other] - point;
        shift *= 0.5 / static_cast<double>(neighbors[i].size());
        shift -= slope * (slope.dot(shift) / squared);
      }
      // Creases turn the slope abruptly: a bounded step back to the level keeps vertices from jumping across
      // them.
      shift -= slope * (std::clamp(value, -0.5 * voxel_size, 0.5 * voxel_size) / squared);
      moved[i] = point + shift;
    }
    surface.points = std::move(moved);
  }
}

std::vector<Triangle> triangles_of_quads(const QuadSurface& surface) {
  std::vector<Triangle> triangles;
  for (const Quad& q : surface.quads) {
    const auto& p = surface.points;
    if ((p[q[0]] - p[q[2]]).squaredNorm() <= (p[q[1]] - p[q[3]]).squaredNorm()) {
      triangles.push_back({q[0], q[1], q[2]});
      triangles.push_back({q[0], q[2], q[3]});
    } else {
      triangles.push_back({q[0], q[1], q[3]});
      triangles.push_back({q[1], q[2], q[3]});
    }
  }
  double six_volumes = 0.0;
  for (const Triangle& t : triangles) {
    six_volumes += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]]));
  }
  if (six_volumes < 0.0) {
    for (Triangle& t : triangles) std::swap(t[1], t[2]);
  }
  return triangles;
}

bool is_closed_sphere(const Surface& surface) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const Triangle& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : uses) {
    const auto opposite = uses.find({edge.second, edge.first});
    if (count != 1 || opposite == uses.end()) return false;
  }
  const auto vertices = static_cast<std::int64_t>(surface.points.size());
  const auto faces = static_cast<std::int64_t>(surface.triangles.size());
  return vertices - static_cast<std::int64_t>(uses.size() / 2) + faces == 2;
}

}  // namespace

Surface surface_from_distance(const DistanceFunction& distance, const Eigen::AlignedBox3d& box,
                              double voxel_size, const std::vector<Eigen::Vector3d>& pins) {
  QuadSurface quads = largest_component_in_order(zero_level(distance, box, voxel_size));
  if (quads.points.size() > pins.size()) relax(quads, distance, voxel_size, pins);
  Surface surface{.points = quads.points, .triangles = triangles_of_quads(quads)};
  if (surface.points.empty() || !is_closed_sphere(surface)) {
    throw InvalidArgument(fmt::format(
        "voxel_size: expected voxels fine enough for one closed surface without handles, found {} m",
        voxel_size));
  }
  return surface;
}

}  // namespace reprise::figure
