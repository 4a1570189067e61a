// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/surface/layer_solid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/mesh/halfedges.h"
#include "reprise/mesh/handles.h"
#include "reprise/mesh/remesh.h"

namespace reprise::capture {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using Kind = BodyLayer::Kind;

constexpr double band_voxels = 4.0;
// Half of a voxel's edge keeps the outside from leaking through a sheet of triangles; a little more for
// safety.
constexpr double sheet_voxels = 0.6;
constexpr double hair_thickness = 0.003;
// Gaps narrower than twice this are filled: within the hair, and between hair and body.
constexpr double hair_closing = 0.012, skin_closing = 0.012;
constexpr double min_hair_alpha = 0.25;
constexpr int smoothing_steps = 3;

struct Soup {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;

  void add(const std::vector<Vector3d>& more, const std::vector<Triangle>& corners) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Vector3d& p : more)
      points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    for (const Triangle& t : corners) {
      triangles.emplace_back(first + static_cast<std::uint32_t>(t[0]),
                             first + static_cast<std::uint32_t>(t[1]),
                             first + static_cast<std::uint32_t>(t[2]));
    }
  }
};

// Values at the corners of a lattice, z fastest.
struct Lattice {
  Vector3i low, size;  // in voxels
  std::vector<float> values;

  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * size.y() + y) * size.z() + z;
  }
  std::size_t count() const { return static_cast<std::size_t>(size.x()) * size.y() * size.z(); }
};

// Distance to the triangles, up to `band` metres and the same beyond.
Lattice distance_to(const Soup& soup, double voxel_size, double band, const Vector3i& low,
                    const Vector3i& size) {
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  std::vector<openvdb::Vec3s> points = soup.points;
  for (openvdb::Vec3s& p : points) p = transform->worldToIndex(p);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points,
                                                                                        soup.triangles);
  const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      mesh, *transform, static_cast<float>(band / voxel_size), 0.0F, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  Lattice lattice{.low = low, .size = size, .values = {}};
  lattice.values.resize(lattice.count());
  const openvdb::Coord first(low.x(), low.y(), low.z());
  const openvdb::Coord last = first + openvdb::Coord(size.x() - 1, size.y() - 1, size.z() - 1);
  openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(openvdb::CoordBBox(first, last),
                                                                lattice.values.data());
  openvdb::tools::copyToDense(*grid, dense);
  return lattice;
}

// Squared distance transform along one line, in voxels: lower envelope of parabolas (Felzenszwalb and
// Huttenlocher, Distance transforms of sampled functions, 2012).
void transform_line(std::vector<double>& f, std::vector<int>& v, std::vector<double>& z,
                    std::vector<double>& out) {
  const int n = static_cast<int>(f.size());
  int k = -1;
  for (int q = 0; q < n; ++q) {
    if (!std::isfinite(f[q])) continue;
    double s = -std::numeric_limits<double>::infinity();
    while (k >= 0) {
      s = ((f[q] + q * q) - (f[v[k]] + v[k] * v[k])) / (2.0 * (q - v[k]));
      if (s > z[k]) break;
      --k;
    }
    if (k < 0) s = -std::numeric_limits<double>::infinity();
    v[++k] = q;
    z[k] = s;
  }
  if (k < 0) {
    out = f;
    return;
  }
  for (int q = 0, j = 0; q < n; ++q) {
    while (j < k && z[j + 1] < q) ++j;
    out[q] = (q - v[j]) * (q - v[j]) + f[v[j]];
  }
}

// Distance in voxels to the nearest lattice point where `inside` is set.
std::vector<double> distance_transform(const Lattice& shape, const std::vector<bool>& inside) {
  std::vector<double> field(shape.count());
  for (std::size_t i = 0; i < field.size(); ++i)
    field[i] = inside[i] ? 0.0 : std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, w = (axis + 2) % 3, n = shape.size[axis];
    std::vector<double> line(n), out(n), z(n + 1);
    std::vector<int> v(n + 1);
    for (int i = 0; i < shape.size[u]; ++i) {
      for (int j = 0; j < shape.size[w]; ++j) {
        Vector3i p;
        p[u] = i;
        p[w] = j;
        for (int k = 0; k < n; ++k) {
          p[axis] = k;
          line[k] = field[shape.at(p.x(), p.y(), p.z())];
        }
        transform_line(line, v, z, out);
        for (int k = 0; k < n; ++k) {
          p[axis] = k;
          field[shape.at(p.x(), p.y(), p.z())] = out[k];
        }
      }
    }
  }
  for (double& value : field) value = std::sqrt(value);
  return field;
}

// Negative inside of what is farther than `radius` from all places that are farther than it from the shapes:
// the shapes and the gaps they leave that are narrower than twice the radius. Only near hair.
void add_closing(const Lattice& to_hair, const std::vector<float>& to_shapes, double step, double radius,
                 std::vector<float>& closing) {
  std::vector<bool> far(to_shapes.size());
  for (std::size_t i = 0; i < far.size(); ++i) far[i] = to_shapes[i] > radius;
  const std::vector<double> to_far = distance_transform(to_hair, far);
  for (std::size_t i = 0; i < far.size(); ++i) {
    if (to_hair.values[i] < 1.5 * radius)
      closing[i] = std::min(closing[i], static_cast<float>(radius - step * to_far[i]));
  }
}

// Lowers `field` to hair as a volume: cards with a thickness, and what lies in narrow gaps between them or
// between them and the body.
void add_hair(const Soup& hair, const Soup& rest, double voxel_size, Lattice& field) {
  const double coarse = 2.0 * voxel_size;
  const double margin = 2.0 * hair_closing + 2.0 * coarse;
  Eigen::AlignedBox3d box;
  for (const openvdb::Vec3s& p : hair.points) box.extend(Vector3d(p.x(), p.y(), p.z()));
  const Vector3i low = ((box.min().array() - margin) / coarse).floor().cast<int>();
  const Vector3i size =
      ((box.max().array() + margin) / coarse).ceil().cast<int>().matrix() - low + Vector3i::Ones();
  const double band = 2.0 * hair_closing;
  const Lattice to_hair = distance_to(hair, coarse, band, low, size);
  Lattice to_both = distance_to(rest, coarse, band, low, size);
  for (std::size_t i = 0; i < to_both.values.size(); ++i)
    to_both.values[i] = std::min(to_both.values[i], to_hair.values[i]);
  std::vector<float> closing(to_hair.count(), static_cast<float>(hair_closing));
  add_closing(to_hair, to_hair.values, coarse, hair_closing, closing);
  add_closing(to_hair, to_both.values, coarse, skin_closing, closing);
  const Vector3i fine_low = (2 * low).cwiseMax(field.low);
  const Vector3i fine_size = (2 * (low + size)).cwiseMin(field.low + field.size) - fine_low;
  const Lattice cards = distance_to(hair, voxel_size, band_voxels * voxel_size, fine_low, fine_size);
  const Vector3i first = fine_low - field.low;
  parallel_for(0, static_cast<std::size_t>(fine_size.x()), [&](std::size_t i) {
    const int x = first.x() + static_cast<int>(i);
    for (int y = first.y(); y < first.y() + fine_size.y(); ++y) {
      for (int z = first.z(); z < first.z() + fine_size.z(); ++z) {
        float& value = field.values[field.at(x, y, z)];
        const float card = cards.values[cards.at(x - first.x(), y - first.y(), z - first.z())];
        value = std::min(value, card - static_cast<float>(hair_thickness));
        const Vector3d p = 0.5 * (field.low + Vector3i(x, y, z)).cast<double>() - low.cast<double>();
        const Vector3i c = p.array().floor().cast<int>();
        if ((c.array() < 0).any() || (c.array() + 1 >= size.array()).any()) continue;
        const Vector3d f = p - c.cast<double>();
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          const Vector3i d(corner & 1, (corner >> 1) & 1, corner >> 2);
          const double weight =
              (d.x() ? f.x() : 1 - f.x()) * (d.y() ? f.y() : 1 - f.y()) * (d.z() ? f.z() : 1 - f.z());
          sum += weight * closing[to_hair.at(c.x() + d.x(), c.y() + d.y(), c.z() + d.z())];
        }
        value = std::min(value, static_cast<float>(sum));
      }
    }
  });
}

// Makes everything negative that cannot be reached from the lattice's corner over positive values.
void fill_inside(Lattice& field, float depth) {
  std::vector<std::uint8_t> outside(field.count(), 0);
  std::vector<std::uint32_t> queue{0};
  outside[0] = 1;
  const auto plane = static_cast<std::int64_t>(field.size.y()) * field.size.z();
  while (!queue.empty()) {
    const std::uint32_t i = queue.back();
    queue.pop_back();
    const int x = static_cast<int>(i / plane), y = static_cast<int>(i % plane / field.size.z()),
              z = static_cast<int>(i % field.size.z());
    const auto visit = [&](bool exists, std::int64_t j) {
      if (!exists || outside[j] != 0 || field.values[j] <= 0.0F) return;
      outside[j] = 1;
      queue.push_back(static_cast<std::uint32_t>(j));
    };
    visit(x > 0, i - plane);
    visit(x + 1 < field.size.x(), i + plane);
    visit(y > 0, static_cast<std::int64_t>(i) - field.size.z());
    visit(y + 1 < field.size.y(), static_cast<std::int64_t>(i) + field.size.z());
    visit(z > 0, static_cast<std::int64_t>(i) - 1);
    visit(z + 1 < field.size.z(), static_cast<std::int64_t>(i) + 1);
  }
  for (std::size_t i = 0; i < outside.size(); ++i) {
    float& value = field.values[i];
    if (outside[i] == 0) value = value > 0.0F ? -depth : std::min(value, -1e-3F * depth);
    value = std::clamp(value, -depth, depth);
  }
}

// Adds lattice points where inside ones meet only over an edge or a corner: the surface about the others is a
// manifold. Each point is added once, so this ends.
void separate(Lattice& field, float depth) {
  const auto inside = [&](int x, int y, int z) { return field.values[field.at(x, y, z)] < 0.0F; };
  // True if the 2 x 2 x 2 block at the corner has parts that meet only so; then one of its points is added.
  const auto mend = [&](int x, int y, int z) {
    unsigned in = 0;
    for (unsigned i = 0; i < 8; ++i) {
      if (inside(x + static_cast<int>(i & 1U), y + static_cast<int>((i >> 1U) & 1U),
                 z + static_cast<int>(i >> 2U)))
        in |= 1U << i;
    }
    if (in == 0 || in == 255) return false;
    const auto add = [&](unsigned i) {
      float& value = field.values[field.at(x + static_cast<int>(i & 1U), y + static_cast<int>((i >> 1U) & 1U),
                                           z + static_cast<int>(i >> 2U))];
      value = -1e-3F * depth;
    };
    const auto has = [&](unsigned i) { return ((in >> i) & 1U) != 0; };
    for (const unsigned axis : {1U, 2U, 4U}) {
      const unsigned u = axis == 1U ? 2U : 1U, v = axis == 4U ? 2U : 4U;
      for (const unsigned base : {0U, axis}) {
        if (has(base) == has(base + u + v) && has(base + u) == has(base + v) && has(base) != has(base + u)) {
          add(has(base) ? base + u : base);
          return true;
        }
      }
    }
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned pair = (1U << i) | (1U << (7U - i));
      if (in == pair || in == 255U - pair) {
        add(in == pair ? i ^ 1U : i);
        return true;
      }
    }
    return false;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int x = 0; x + 1 < field.size.x(); ++x) {
      for (int y = 0; y + 1 < field.size.y(); ++y) {
        for (int z = 0; z + 1 < field.size.z(); ++z) {
          // Values are clamped: the surface does not pass by a corner that is so far from it.
          if (std::abs(field.values[field.at(x, y, z)]) > 0.9F * depth) continue;
          while (mend(x, y, z)) changed = true;
        }
      }
    }
  }
}

TriangleMesh mesh_of(const Lattice& field, double voxel_size, float depth) {
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(depth);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const openvdb::Coord first(field.low.x(), field.low.y(), field.low.z());
  const openvdb::Coord last =
      first + openvdb::Coord(field.size.x() - 1, field.size.y() - 1, field.size.z() - 1);
  const openvdb::tools::Dense<const float, openvdb::tools::LayoutZYX> dense(openvdb::CoordBBox(first, last),
                                                                            field.values.data());
  openvdb::tools::copyFromDense(dense, *grid, 0.0F);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  TriangleMesh mesh;
  mesh.points.reserve(points.size());
  for (const openvdb::Vec3s& p : points) mesh.points.emplace_back(p.x(), p.y(), p.z());
  for (const openvdb::Vec4I& q : quads) {
    std::array<std::int32_t, 4> c{};
    for (int k = 0; k < 4; ++k) c[k] = static_cast<std::int32_t>(q[k]);
    const bool first_diagonal = (mesh.points[c[0]] - mesh.points[c[2]]).squaredNorm() <=
                                (mesh.points[c[1]] - mesh.points[c[3]]).squaredNorm();
    // OpenVDB's quads run clockwise seen from outside.
    if (first_diagonal) {
      mesh.triangles.push_back({c[0], c[2], c[1]});
      mesh.triangles.push_back({c[0], c[3], c[2]});
    } else {
      mesh.triangles.push_back({c[0], c[3], c[1]});
      mesh.triangles.push_back({c[1], c[3], c[2]});
    }
  }
  return mesh;
}

// The largest piece, in an order that the geometry alone decides: the mesher's threads are forgotten.
TriangleMesh largest_piece(const TriangleMesh& mesh) {
  Topology topology{.vertex_count = static_cast<std::int32_t>(mesh.points.size()),
                    .triangles = mesh.triangles};
  const ConnectedComponents pieces = connected_components(topology);
  std::vector<double> volume(static_cast<std::size_t>(pieces.count), 0.0);
  for (const Triangle& t : mesh.triangles) {
    volume[pieces.of_vertex[t[0]]] += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]])) / 6.0;
  }
  const auto largest =
      static_cast<std::int32_t>(std::max_element(volume.begin(), volume.end()) - volume.begin());
  std::vector<std::int32_t> order;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (pieces.of_vertex[i] == largest) order.push_back(static_cast<std::int32_t>(i));
  }
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const Vector3d &p = mesh.points[a], &q = mesh.points[b];
    return std::tie(p.y(), p.x(), p.z()) < std::tie(q.y(), q.x(), q.z());
  });
  TriangleMesh result;
  std::vector<std::int32_t> new_idx(mesh.points.size(), -1);
  for (const std::int32_t i : order) {
    new_idx[i] = static_cast<std::int32_t>(result.points.size());
    result.points.push_back(mesh.points[i]);
  }
  for (Triangle t : mesh.triangles) {
    if (new_idx[t[0]] < 0) continue;
    for (std::int32_t& v : t) v = new_idx[v];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    result.triangles.push_back(t);
  }
  std::sort(result.triangles.begin(), result.triangles.end());
  return result;
}

// From the level that was meshed, a little outside, onto the layers.
void settle(const VisibleLayers& layers, double voxel_size, TriangleMesh& mesh) {
  const double reach = (sheet_voxels + 1.0) * voxel_size;
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  std::vector<Vector3d> shift(mesh.points.size());
  parallel_for(
      0, mesh.points.size(),
      [&](std::size_t i) {
        const auto found = layers.nearest(mesh.points[i], normals[i], reach, reach);
        const bool onto = found && found->layer >= 0 && layers.layers()[found->layer].kind != Kind::hair;
        shift[i] = onto ? Vector3d(found->point - mesh.points[i])
                        : Vector3d(-sheet_voxels * voxel_size * normals[i]);
      },
      256);
  // Neighbours that settle on different layers would fold: shifts are smoothed over the surface.
  std::vector<int> degree(mesh.points.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::int32_t v : t) ++degree[v];
  }
  for (int step = 0; step < smoothing_steps; ++step) {
    std::vector<Vector3d> sum(shift.size(), Vector3d::Zero());
    for (const Triangle& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) sum[t[k]] += shift[t[(k + 1) % 3]];
    }
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = 0.5 * shift[i] + 0.5 * sum[i] / degree[i];
  }
  for (std::size_t i = 0; i < shift.size(); ++i) mesh.points[i] += shift[i];
}

}  // namespace

TriangleMesh solid_of_layers(const VisibleLayers& visible, double voxel_size) {
  openvdb::initialize();
  Soup rest, hair;
  Eigen::AlignedBox3d box;
  for (std::size_t l = 0; l < visible.layers().size(); ++l) {
    const BodyLayer& layer = visible.layers()[l];
    if (!has_shape(layer)) continue;
    std::vector<Vector3d> points;
    for (Eigen::Index v = 0; v < layer.points.rows(); ++v) {
      points.emplace_back(layer.points.row(v).transpose());
      box.extend(points.back());
    }
    if (layer.kind != Kind::hair) {
      // Hidden skin too: it closes the body under its clothes.
      rest.add(points, layer.triangles);
      const TriangleMesh caps = border_caps(layer);
      rest.add(caps.points, caps.triangles);
      continue;
    }
    std::vector<Triangle> dense;
    for (std::size_t t = 0; t < layer.triangles.size(); ++t) {
      const auto index = static_cast<std::int32_t>(t);
      double alpha = 0.0;
      for (const Vector3d& w : {Vector3d(1, 1, 1), Vector3d(4, 1, 1), Vector3d(1, 4, 1), Vector3d(1, 1, 4)})
        alpha += 0.25 * visible.sample(static_cast<int>(l), index, w / w.sum())[3];
      if (alpha > min_hair_alpha) dense.push_back(layer.triangles[t]);
    }
    hair.add(points, dense);
  }
  if (rest.triangles.empty()) throw InvalidArgument("body: expected layers with triangles, found none");

  const double margin = 8.0 * voxel_size;
  const Vector3i low = ((box.min().array() - margin) / voxel_size).floor().cast<int>();
  const Vector3i size =
      ((box.max().array() + margin) / voxel_size).ceil().cast<int>().matrix() - low + Vector3i::Ones();
  Lattice field = distance_to(rest, voxel_size, band_voxels * voxel_size, low, size);
  for (float& value : field.values) value -= static_cast<float>(sheet_voxels * voxel_size);
  if (!hair.triangles.empty()) add_hair(hair, rest, voxel_size, field);
  const auto depth = static_cast<float>(3.0 * voxel_size);
  fill_inside(field, depth);
  separate(field, depth);

  TriangleMesh mesh = without_handles(largest_piece(mesh_of(field, voxel_size, depth)));
  settle(visible, voxel_size, mesh);
  return mesh;
}

}  // namespace reprise::capture
