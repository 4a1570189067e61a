// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/surface/capture_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/mesh/geodesic.h"
#include "reprise/mesh/remesh.h"
#include "reprise/mesh/uv_atlas.h"
#include "reprise/synthetic/surface/layer_solid.h"
#include "reprise/synthetic/surface/texture_bake.h"

namespace reprise {
namespace {

using capture::LayerPoint;
using capture::VisibleLayers;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Kind = BodyLayer::Kind;

constexpr int min_vertices = 1000, max_vertices = 50000;
constexpr int min_texture = 256, max_texture = 8192;
constexpr double voxel_size = 0.003;
constexpr double max_variation = 0.34;
constexpr double bind_distance = 0.03, bind_hair_distance = 0.05;
constexpr double tight = 0.05;  // freedom up to which a vertex follows its bone

// Wanted edge lengths relative to the rest of the body.
constexpr double finger_size = 0.3, palm_size = 0.45, face_size = 0.45;
constexpr double balance_limit = 0.003;
constexpr double finger_distance = 0.085;  // of the fingers from the wrist, metres
constexpr double transition = 0.07;        // from fine to coarse, metres over the surface

Positions positions_of(const TriangleMesh& mesh) {
  Positions positions(static_cast<Eigen::Index>(mesh.points.size()), 3);
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    positions.row(static_cast<Eigen::Index>(i)) = mesh.points[i].cast<float>().transpose();
  return positions;
}

// Columns: along the first edge, across it in the plane, outwards.
Matrix3d triangle_frame(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Matrix3d frame;
  frame.col(0) = (b - a).stableNormalized();
  frame.col(2) = (b - a).cross(c - a).stableNormalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// Which part of the body that deserves smaller triangles a place belongs to.
enum class Part { other, face, palm, fingers };

class PartFinder {
 public:
  explicit PartFinder(const DressedBody& body) : body_(body), skeleton_(body.skeleton()) {
    head_ = skeleton_.joint_idx("head");
    hands_ = {skeleton_.joint_idx("left_hand"), skeleton_.joint_idx("right_hand")};
  }

  Part part(const LayerPoint& place, const Vector3d& normal) const {
    if (place.layer < 0) return Part::other;
    const BodyLayer& layer = body_.layers()[place.layer];
    if (layer.kind == Kind::face) return Part::face;
    if (layer.kind != Kind::skin) return Part::other;
    Eigen::Index heaviest = 0;
    place.weights.maxCoeff(&heaviest);
    const int joint = body_.dominant_joints(place.layer)[layer.triangles[place.triangle][heaviest]];
    const Vector3d offset = place.point - skeleton_.joints[joint].rest_position;
    if (joint == head_) {
      // The head's joint lies below the ears: the face is in front of it.
      return offset.z() > 0.015 && normal.z() > -0.2 ? Part::face : Part::other;
    }
    if (joint == hands_[0] || joint == hands_[1])
      return offset.norm() > finger_distance ? Part::fingers : Part::palm;
    return Part::other;
  }

 private:
  const DressedBody& body_;
  const Skeleton& skeleton_;
  int head_ = -1;
  std::array<int, 2> hands_{};
};

std::vector<double> sizing(const TriangleMesh& dense, const std::vector<Part>& parts) {
  const Topology topology{.vertex_count = static_cast<std::int32_t>(dense.points.size()),
                          .triangles = dense.triangles};
  const Positions positions = positions_of(dense);
  const EdgeGraph graph(topology, PositionsView(positions.data(), positions.rows(), 3));
  std::vector<double> size(dense.points.size(), 1.0);
  for (const auto& [part, fine] : {std::pair(Part::face, face_size), std::pair(Part::palm, palm_size),
                                   std::pair(Part::fingers, finger_size)}) {
    std::vector<std::int32_t> sources;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i] == part) sources.push_back(static_cast<std::int32_t>(i));
    }
    if (sources.empty()) continue;
    const std::vector<float> distance = graph.distances(sources, static_cast<float>(transition));
    for (std::size_t i = 0; i < size.size(); ++i) {
      const double x = std::min(1.0, static_cast<double>(distance[i]) / transition);
      size[i] = std::min(size[i], fine + (1.0 - fine) * x);
    }
  }
  return size;
}

// Harmonic weights of the free vertices on the others: each free vertex is the mean of its neighbours,
// weighted by cotangents.
Eigen::SparseMatrix<double, Eigen::RowMajor> harmonic_weights(const TriangleMesh& mesh,
                                                              const std::vector<std::int32_t>& free) {
  const auto rows = static_cast<Eigen::Index>(free.size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights(rows, static_cast<Eigen::Index>(mesh.points.size()));
  if (free.empty()) return weights;
  std::vector<std::int32_t> row_of(mesh.points.size(), -1), column_of(mesh.points.size(), -1);
  for (std::size_t i = 0; i < free.size(); ++i) row_of[free[i]] = static_cast<std::int32_t>(i);
  std::vector<std::int32_t> fixed;
  std::vector<Eigen::Triplet<double>> inner, outer;
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (row_of[a] < 0 && row_of[b] < 0) continue;
      const Vector3d u = mesh.points[a] - mesh.points[c], v = mesh.points[b] - mesh.points[c];
      const double weight = std::clamp(u.dot(v) / std::max(u.cross(v).norm(), 1e-300), 0.02, 50.0);
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        if (row_of[from] < 0) continue;
        inner.emplace_back(row_of[from], row_of[from], weight);
        if (row_of[to] >= 0) {
          inner.emplace_back(row_of[from], row_of[to], -weight);
          continue;
        }
        if (column_of[to] < 0) {
          column_of[to] = static_cast<std::int32_t>(fixed.size());
          fixed.push_back(to);
        }
        outer.emplace_back(row_of[from], column_of[to], weight);
      }
    }
  }
  Eigen::SparseMatrix<double> L(rows, rows), B(rows, static_cast<Eigen::Index>(fixed.size()));
  L.setFromTriplets(inner.begin(), inner.end());
  B.setFromTriplets(outer.begin(), outer.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(L);
  const Eigen::MatrixXd W = solver.solve(Eigen::MatrixXd(B));
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index r = 0; r < rows; ++r) {
    double sum = 0.0;
    for (Eigen::Index c = 0; c < W.cols(); ++c) sum += std::abs(W(r, c)) > 1e-5 ? W(r, c) : 0.0;
    for (Eigen::Index c = 0; c < W.cols(); ++c) {
      if (std::abs(W(r, c)) > 1e-5) entries.emplace_back(r, fixed[c], W(r, c) / sum);
    }
  }
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

}  // namespace

void validate(const CaptureSurfaceOptions& options) {
  if (options.vertices < min_vertices || options.vertices > max_vertices) {
    throw InvalidArgument(
        fmt::format("vertices: expected {} to {}, found {}", min_vertices, max_vertices, options.vertices));
  }
  const int size = options.texture_size;
  if (size < min_texture || size > max_texture || (size & (size - 1)) != 0) {
    throw InvalidArgument(fmt::format("texture_size: expected a power of two from {} to {}, found {}",
                                      min_texture, max_texture, size));
  }
}

CaptureSurface::CaptureSurface(const DressedBody& body, const CaptureSurfaceOptions& options) {
  validate(options);
  const std::vector<BodyLayer>& body_layers = body.layers();
  const VisibleLayers visible(body_layers);
  const TriangleMesh dense = capture::solid_of_layers(visible, voxel_size);
  const PartFinder finder(body);

  const auto places_of = [&](const TriangleMesh& mesh) {
    const std::vector<Vector3d> normals = vertex_normals(mesh);
    std::vector<std::optional<LayerPoint>> places(mesh.points.size());
    parallel_for(
        0, places.size(),
        [&](std::size_t i) {
          places[i] = visible.nearest(mesh.points[i], normals[i], bind_distance, bind_hair_distance);
        },
        64);
    return places;
  };
  const auto parts_of = [&](const TriangleMesh& mesh, const std::vector<std::optional<LayerPoint>>& places) {
    const std::vector<Vector3d> normals = vertex_normals(mesh);
    std::vector<Part> parts(places.size(), Part::other);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i]) parts[i] = finder.part(*places[i], normals[i]);
    }
    return parts;
  };

  // Smaller triangles on face and hands, as far as edge lengths stay near uniform.
  std::vector<double> size = sizing(dense, parts_of(dense, places_of(dense)));
  RemeshOptions remesh_options{.vertices = options.vertices};
  for (const BodyLayer& layer : body_layers) {
    const auto lines = capture::border_lines(layer);
    remesh_options.creases.insert(remesh_options.creases.end(), lines.begin(), lines.end());
  }
  TriangleMesh mesh = remesh(dense, size, remesh_options);
  for (int attempt = 0; attempt < 4 && edge_length_variation(mesh) > max_variation; ++attempt) {
    for (double& s : size) s = std::pow(s, 0.88);
    mesh = remesh(dense, size, remesh_options);
  }
  balance(dense, balance_limit, mesh);

  const std::vector<std::optional<LayerPoint>> places = places_of(mesh);
  const std::vector<Part> parts = parts_of(mesh, places);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    Binding binding;
    int joint = -1;
    if (places[v] && places[v]->layer >= 0) {
      const LayerPoint& place = *places[v];
      const BodyLayer& layer = body_layers[place.layer];
      const Triangle& c = layer.triangles[place.triangle];
      binding.layer = place.layer;
      binding.corners = {c[0], c[1], c[2]};
      binding.weights = place.weights;
      const Matrix3d frame =
          triangle_frame(layer.points.row(c[0]).transpose(), layer.points.row(c[1]).transpose(),
                         layer.points.row(c[2]).transpose());
      binding.offset = frame.transpose() * (mesh.points[v] - place.point);
      double freedom = 0.0;
      for (int k = 0; k < 3; ++k) {
        if (!layer.freedom.empty()) freedom += place.weights[k] * layer.freedom[c[k]];
      }
      Eigen::Index heaviest = 0;
      place.weights.maxCoeff(&heaviest);
      if (freedom <= tight) joint = body.dominant_joints(place.layer)[c[heaviest]];
    } else {
      membrane_vertices_.push_back(static_cast<std::int32_t>(v));
    }
    bindings_.push_back(binding);
    layers_.push_back(binding.layer);
    joints_.push_back(joint);
  }
  membrane_weights_ = harmonic_weights(mesh, membrane_vertices_);

  std::vector<Points> rest;
  for (const BodyLayer& layer : body_layers) {
    rest.push_back(layer.points);
    layer_sizes_.push_back(layer.points.rows());
  }
  rest_ = pose(rest);
  // Membranes hang flat from here on.
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    mesh.points[v] = rest_.row(static_cast<Eigen::Index>(v)).cast<double>().transpose();

  UvAtlasOptions atlas_options{.texture_size = options.texture_size,
                               .gutter = std::max(2, options.texture_size / 512)};
  for (const Triangle& t : mesh.triangles) {
    int face = 0, hand = 0;
    for (const std::int32_t v : t) {
      face += parts[v] == Part::face ? 1 : 0;
      hand += parts[v] == Part::palm || parts[v] == Part::fingers ? 1 : 0;
    }
    atlas_options.group_of_triangle.push_back(face >= 2 ? 1 : hand >= 2 ? 2 : 0);
  }
  atlas_options.density = {1.0, 2.2, 1.2};
  UvAtlas atlas = make_uv_atlas(mesh, atlas_options);
  capture::BakedTexture baked = capture::bake(mesh, atlas, layers_, visible, options.texture_size);
  colors_ = std::move(baked.colors);

  auto topology = std::make_shared<Topology>();
  topology->vertex_count = static_cast<std::int32_t>(mesh.points.size());
  topology->triangles = mesh.triangles;
  topology->uvs = std::move(atlas.uvs);
  topology->triangle_uvs = std::move(atlas.triangle_uvs);
  topology->texture = std::make_shared<const Image>(std::move(baked.image));
  validate(*topology);
  topology_ = std::move(topology);
}

void CaptureSurface::place_membranes(Points& points) const {
  for (std::size_t i = 0; i < membrane_vertices_.size(); ++i) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (decltype(membrane_weights_)::InnerIterator it(membrane_weights_, static_cast<Eigen::Index>(i)); it;
         ++it)
      sum += it.value() * points.row(it.col());
    points.row(membrane_vertices_[i]) = sum;
  }
}

Positions CaptureSurface::pose(const std::vector<Points>& layer_points) const {
  if (layer_points.size() != layer_sizes_.size()) {
    throw InvalidArgument(
        fmt::format("layer_points: expected {} layers, found {}", layer_sizes_.size(), layer_points.size()));
  }
  for (std::size_t l = 0; l < layer_sizes_.size(); ++l) {
    if (layer_points[l].rows() != layer_sizes_[l]) {
      throw InvalidArgument(fmt::format("layer_points of layer {}: expected {} points, found {}", l,
                                        layer_sizes_[l], layer_points[l].rows()));
    }
  }
  Points points(static_cast<Eigen::Index>(bindings_.size()), 3);
  for (std::size_t v = 0; v < bindings_.size(); ++v) {
    const Binding& binding = bindings_[v];
    if (binding.layer == membrane) continue;
    const Points& layer = layer_points[static_cast<std::size_t>(binding.layer)];
    const Vector3d a = layer.row(binding.corners[0]).transpose(),
                   b = layer.row(binding.corners[1]).transpose(),
                   c = layer.row(binding.corners[2]).transpose();
    points.row(static_cast<Eigen::Index>(v)) =
        (binding.weights[0] * a + binding.weights[1] * b + binding.weights[2] * c +
         triangle_frame(a, b, c) * binding.offset)
            .transpose();
  }
  place_membranes(points);
  return points.cast<float>();
}

}  // namespace reprise
