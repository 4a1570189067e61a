// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/remesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/mesh/halfedges.h"

namespace reprise {
namespace {

// Bounds about the wanted length l between which an edge is left alone (Botsch and Kobbelt).
constexpr double longest = 4.0 / 3.0;
constexpr double shortest = 4.0 / 5.0;
// An edit may turn the normal of a triangle by at most 60 degrees, lest it fold thin parts.
constexpr double min_normal_cosine = 0.5;
constexpr double min_shape = 0.12;  // of a new triangle: 1 equilateral, 0 degenerate
// How far a vertex may lie off the triangles that replace it, relative to their size: keeps the tips of thin
// parts.
constexpr double max_loss = 0.15;
constexpr int most_passes = 40;
constexpr double crease_reach = 0.35;  // relative to the size of triangles

class Remesher {
 public:
  Remesher(const TriangleMesh& dense, const std::vector<double>& relative_size,
           const std::vector<std::array<Eigen::Vector3d, 2>>& creases)
      : tree_(dense.points, dense.triangles),
        creases_(tree_of(creases)),
        dense_size_(relative_size),
        edges_(static_cast<std::int32_t>(dense.points.size()), dense.triangles),
        points_(dense.points) {
    if (dense_size_.empty()) dense_size_.assign(points_.size(), 1.0);
    size_ = dense_size_;
  }

  TriangleMesh run(const RemeshOptions& options) {
    scale_ = wanted_scale(options.vertices);
    coarsen(options.vertices);
    for (int i = 0; i < options.iterations; ++i) {
      throw_if_interrupted();
      split_long();
      collapse_short(longest);
      // The rules above settle a little off the count that equilateral triangles would give.
      const double ratio = static_cast<double>(edges_.live_vertices()) / options.vertices;
      scale_ *= std::sqrt(std::clamp(ratio, 0.8, 1.25));
      if (i + 3 >= options.iterations) meet_count(options.vertices);
      for (int k = 0; k < 2; ++k) flip_edges();
      relax();
    }
    for (int k = 0; k < 3; ++k) {
      flip_edges();
      relax();
    }
    return result();
  }

 private:
  double wanted(std::int32_t h) const { return scale_ * 0.5 * (size_[edges_.from(h)] + size_[edges_.to(h)]); }
  double length(std::int32_t h) const { return (points_[edges_.from(h)] - points_[edges_.to(h)]).norm(); }
  double relative_length(std::int32_t h) const { return length(h) / wanted(h); }
  Eigen::Vector3d area_vector(std::int32_t a, std::int32_t b, std::int32_t c) const {
    return (points_[b] - points_[a]).cross(points_[c] - points_[a]);
  }
  double shape(std::int32_t a, std::int32_t b, std::int32_t c) const {
    const double edges = (points_[a] - points_[b]).squaredNorm() + (points_[b] - points_[c]).squaredNorm() +
                         (points_[c] - points_[a]).squaredNorm();
    return 2.0 * std::numbers::sqrt3 * area_vector(a, b, c).norm() / edges;
  }

  // Equilateral triangles of edge s r cover the surface: 2 V = sum of area / (sqrt(3)/4 (s r)^2).
  double wanted_scale(int vertices) const {
    double sum = 0.0;
    for (const Triangle& t : tree_.triangles()) {
      const double r = (dense_size_[t[0]] + dense_size_[t[1]] + dense_size_[t[2]]) / 3.0;
      sum += 0.5 * area_vector(t[0], t[1], t[2]).norm() / (r * r);
    }
    return std::sqrt(sum * 2.0 / (std::numbers::sqrt3 * vertices));
  }

  // Rounds of growing size: vertices only vanish, those that stay are still on the surface.
  void coarsen(int vertices) {
    const double final_scale = scale_;
    const double growth = 1.5;
    double ratio = std::sqrt(static_cast<double>(edges_.live_vertices()) / vertices);
    while (ratio > growth) {
      throw_if_interrupted();
      ratio /= growth;
      scale_ = final_scale / ratio;
      collapse_short(longest);
      flip_edges();
    }
    scale_ = final_scale;
  }

  // Would moving from(h) into to(h) keep the triangles around it well-shaped?
  bool collapse_is_sound(std::int32_t h, double limit) const {
    const std::int32_t a = edges_.from(h), b = edges_.to(h);
    double loss = std::numeric_limits<double>::infinity();
    for (std::int32_t i = edges_.rotate(h); i != h; i = edges_.rotate(i)) {
      const std::int32_t c = edges_.to(i);
      if ((points_[c] - points_[b]).norm() > limit * scale_ * 0.5 * (size_[b] + size_[c])) return false;
      const std::int32_t d = edges_.apex(i);
      if (c == b || d == b) continue;
      const Eigen::Vector3d before = area_vector(a, c, d);
      const Eigen::Vector3d after = area_vector(b, c, d);
      if (before.dot(after) < min_normal_cosine * before.norm() * after.norm()) return false;
      if (shape(b, c, d) < min_shape) return false;
      const Eigen::Vector3d w = closest_weights(points_[a], points_[b], points_[c], points_[d]);
      loss = std::min(loss, (w[0] * points_[b] + w[1] * points_[c] + w[2] * points_[d] - points_[a]).norm());
    }
    return loss < max_loss * scale_ * size_[a];
  }

  bool try_collapse(std::int32_t h, double limit) {
    if (!edges_.can_collapse(h) || !collapse_is_sound(h, limit)) return false;
    edges_.collapse(h);
    return true;
  }

  void collapse_short(double limit) {
    for (std::int32_t h = 0; h < edges_.halfedge_count(); ++h) {
      if (edges_.is_removed(h) || edges_.twin(h) < h || relative_length(h) >= shortest) continue;
      if (!try_collapse(h, limit)) try_collapse(edges_.twin(h), limit);
    }
  }

  void split_at_middle(std::int32_t h) {
    const std::int32_t a = edges_.from(h), b = edges_.to(h);
    points_.push_back(0.5 * (points_[a] + points_[b]));
    size_.push_back(0.5 * (size_[a] + size_[b]));
    edges_.split(h);
  }

  void split_long() {
    const std::int32_t count = edges_.halfedge_count();
    for (std::int32_t h = 0; h < count; ++h) {
      if (!edges_.is_removed(h) && edges_.twin(h) > h && relative_length(h) > longest) split_at_middle(h);
    }
  }

  // Splits the relatively longest or collapses the relatively shortest edges until the count is right.
  void meet_count(int vertices) {
    for (int pass = 0; pass < most_passes && edges_.live_vertices() != vertices; ++pass) {
      const bool too_many = edges_.live_vertices() > vertices;
      std::vector<std::pair<double, std::int32_t>> order;
      for (std::int32_t h = 0; h < edges_.halfedge_count(); ++h) {
        if (edges_.is_removed(h) || edges_.twin(h) < h) continue;
        order.emplace_back(too_many ? relative_length(h) : -relative_length(h), h);
      }
      std::sort(order.begin(), order.end());
      int edits = 0;
      // Lengths change with every edit: a part at a time.
      const int most = std::max(1, std::abs(edges_.live_vertices() - vertices) / 2);
      for (const auto& [rank, h] : order) {
        if (edits == most) break;
        if (edges_.is_removed(h)) continue;
        if (!too_many) {
          split_at_middle(h);
          ++edits;
        } else if (try_collapse(h, 2.0) || try_collapse(edges_.twin(h), 2.0)) {
          ++edits;
        }
      }
      if (edits == 0) return;
    }
  }

  // Towards six edges a vertex.
  void flip_edges() {
    std::vector<int> valence(points_.size(), 0);
    for (std::int32_t h = 0; h < edges_.halfedge_count(); ++h) {
      if (!edges_.is_removed(h)) ++valence[edges_.from(h)];
    }
    const auto cost = [](int value) { return (value - 6) * (value - 6); };
    for (std::int32_t h = 0; h < edges_.halfedge_count(); ++h) {
      if (edges_.is_removed(h) || edges_.twin(h) < h) continue;
      const std::int32_t g = edges_.twin(h);
      const std::int32_t a = edges_.from(h), b = edges_.from(g), c = edges_.apex(h), d = edges_.apex(g);
      const int gain = cost(valence[a]) - cost(valence[a] - 1) + cost(valence[b]) - cost(valence[b] - 1) +
                       cost(valence[c]) - cost(valence[c] + 1) + cost(valence[d]) - cost(valence[d] + 1);
      if (gain <= 0 || !edges_.can_flip(h)) continue;
      const Eigen::Vector3d before = area_vector(a, b, c).normalized() + area_vector(b, a, d).normalized();
      const Eigen::Vector3d first = area_vector(d, c, a), second = area_vector(c, d, b);
      const double bound = 0.8 * before.norm();
      if (first.dot(before) < bound * first.norm() || second.dot(before) < bound * second.norm()) continue;
      if (std::min(shape(d, c, a), shape(c, d, b)) < min_shape) continue;
      edges_.flip(h);
      --valence[a];
      --valence[b];
      ++valence[c];
      ++valence[d];
    }
  }

  // Vertices move along the surface towards the middle of their triangles and back onto it.
  void relax() {
    std::vector<SurfacePoint> target(points_.size());
    parallel_for(
        0, points_.size(),
        [&](std::size_t i) {
          const auto v = static_cast<std::int32_t>(i);
          if (edges_.out(v) == Halfedges::removed) return;
          Eigen::Vector3d normal = Eigen::Vector3d::Zero(), center = Eigen::Vector3d::Zero();
          double sum = 0.0;
          std::int32_t h = edges_.out(v);
          do {
            const std::int32_t a = edges_.to(h), b = edges_.apex(h);
            const Eigen::Vector3d area = area_vector(v, a, b);
            const double size = (size_[v] + size_[a] + size_[b]) / 3.0;
            const double weight = area.norm() / (size * size);
            normal += area;
            center += weight * (points_[v] + points_[a] + points_[b]) / 3.0;
            sum += weight;
            h = edges_.rotate(h);
          } while (h != edges_.out(v));
          if (!(sum > 0.0) || !(normal.norm() > 0.0)) return;
          normal.normalize();
          Eigen::Vector3d shift = center / sum - points_[v];
          shift -= normal * normal.dot(shift);
          const Eigen::Vector3d moved = points_[v] + shift;
          const auto found = tree_.closest(moved, 2.0 * scale_ * size_[v], &normal);
          if (!found) return;
          target[i] = *found;
          const auto crease = creases_.closest(found->point, crease_reach * scale_ * size_[v]);
          if (!crease) return;
          const auto onto = tree_.closest(crease->point, crease_reach * scale_ * size_[v], &normal);
          if (onto) target[i] = *onto;
        },
        64);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (target[i].triangle < 0) continue;
      const Eigen::Vector3d old = points_[i];
      for (const double step : {1.0, 0.5}) {
        SurfacePoint place = target[i];
        if (step < 1.0) {
          const auto found = tree_.closest(old + step * (place.point - old));
          if (found) place = *found;
        }
        if (!move(static_cast<std::int32_t>(i), place)) continue;
        break;
      }
    }
  }

  // False, and nothing changed, if a triangle would turn over.
  bool move(std::int32_t v, const SurfacePoint& place) {
    const Eigen::Vector3d old = points_[v];
    std::int32_t h = edges_.out(v);
    do {
      const std::int32_t a = edges_.to(h), b = edges_.apex(h);
      const Eigen::Vector3d before = area_vector(v, a, b);
      points_[v] = place.point;
      const Eigen::Vector3d after = area_vector(v, a, b);
      const bool poor = shape(v, a, b) < min_shape;
      points_[v] = old;
      if (before.dot(after) < min_normal_cosine * before.norm() * after.norm() ||
          (poor && after.norm() < before.norm()))
        return false;
      h = edges_.rotate(h);
    } while (h != edges_.out(v));
    points_[v] = place.point;
    const Triangle& t = tree_.triangles()[place.triangle];
    size_[v] = place.weights[0] * dense_size_[t[0]] + place.weights[1] * dense_size_[t[1]] +
               place.weights[2] * dense_size_[t[2]];
    return true;
  }

  // Vertices from the floor upwards: an order that the shape alone decides.
  TriangleMesh result() const {
    TriangleMesh mesh;
    std::vector<std::int32_t> order;
    for (std::int32_t v = 0; v < edges_.vertex_count(); ++v) {
      if (edges_.out(v) != Halfedges::removed) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t a, std::int32_t b) { return points_[a].y() < points_[b].y(); });
    std::vector<std::int32_t> new_idx(points_.size(), -1);
    for (const std::int32_t v : order) {
      new_idx[v] = static_cast<std::int32_t>(mesh.points.size());
      mesh.points.push_back(points_[v]);
    }
    for (Triangle t : edges_.triangles()) {
      for (std::int32_t& v : t) v = new_idx[v];
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      mesh.triangles.push_back(t);
    }
    std::sort(mesh.triangles.begin(), mesh.triangles.end());
    return mesh;
  }

  static ClosestPointTree tree_of(const std::vector<std::array<Eigen::Vector3d, 2>>& segments) {
    TriangleMesh lines;  // as triangles without area
    for (const auto& [a, b] : segments) {
      const auto first = static_cast<std::int32_t>(lines.points.size());
      lines.points.push_back(a);
      lines.points.push_back(b);
      lines.triangles.push_back({first, first + 1, first + 1});
    }
    return {std::move(lines.points), std::move(lines.triangles)};
  }

  ClosestPointTree tree_;
  ClosestPointTree creases_;
  std::vector<double> dense_size_;
  Halfedges edges_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> size_;
  double scale_ = 1.0;
};

}  // namespace

TriangleMesh remesh(const TriangleMesh& dense, const std::vector<double>& relative_size,
                    const RemeshOptions& options) {
  if (options.vertices < 4)
    throw InvalidArgument(fmt::format("vertices: expected 4 or more, found {}", options.vertices));
  if (options.iterations < 1) {
    throw InvalidArgument(fmt::format("iterations: expected 1 or more, found {}", options.iterations));
  }
  if (!relative_size.empty() && relative_size.size() != dense.points.size()) {
    throw InvalidArgument(fmt::format("relative_size: expected {} values, one a point, found {}",
                                      dense.points.size(), relative_size.size()));
  }
  for (std::size_t i = 0; i < relative_size.size(); ++i) {
    if (!(relative_size[i] > 0.0) || !std::isfinite(relative_size[i])) {
      throw InvalidArgument(fmt::format("relative_size of point {}: expected a positive number, found {}", i,
                                        relative_size[i]));
    }
  }
  return Remesher(dense, relative_size, options.creases).run(options);
}

void balance(const TriangleMesh& dense, double limit, TriangleMesh& mesh) {
  const ClosestPointTree tree(dense.points, dense.triangles);
  std::vector<double> height(mesh.triangles.size(), 0.0);
  std::vector<Eigen::Vector3d> area(mesh.triangles.size());
  parallel_for(
      0, mesh.triangles.size(),
      [&](std::size_t i) {
        const Triangle& t = mesh.triangles[i];
        const Eigen::Vector3d &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        area[i] = (b - a).cross(c - a);
        const Eigen::Vector3d normal = area[i].stableNormalized();
        // Three places, each half way from the middle to a corner, stand for the triangle.
        for (const Eigen::Vector3d& corner : {a, b, c}) {
          const Eigen::Vector3d place = 0.5 * corner + (a + b + c) / 6.0;
          const auto found = tree.closest(place, std::numeric_limits<double>::infinity(), &normal);
          if (found) height[i] += (found->point - place).dot(normal) / 3.0;
        }
      },
      64);
  std::vector<Eigen::Vector3d> normals(mesh.points.size(), Eigen::Vector3d::Zero());
  std::vector<double> sum(mesh.points.size(), 0.0), weight(mesh.points.size(), 0.0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::int32_t v : mesh.triangles[i]) {
      normals[v] += area[i];
      sum[v] += area[i].norm() * height[i];
      weight[v] += area[i].norm();
    }
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (!(weight[v] > 0.0)) continue;
    mesh.points[v] += std::clamp(sum[v] / weight[v], -limit, limit) * normals[v].stableNormalized();
  }
}

std::vector<Eigen::Vector3d> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.points.size(), Eigen::Vector3d::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector3d area =
        (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
    for (const std::int32_t v : t) normals[v] += area;
  }
  for (Eigen::Vector3d& n : normals) n.stableNormalize();
  return normals;
}

double edge_length_variation(const TriangleMesh& mesh) {
  // Every edge of a closed mesh is met twice, which changes neither mean nor deviation.
  double sum = 0.0, squares = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const double squared = (mesh.points[t[k]] - mesh.points[t[(k + 1) % 3]]).squaredNorm();
      sum += std::sqrt(squared);
      squares += squared;
    }
  }
  const double count = 3.0 * static_cast<double>(mesh.triangles.size());
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean;
}

int genus(const TriangleMesh& mesh) {
  // Euler: V - E + F = 2 - 2 g with 2 E = 3 F.
  const auto vertices = static_cast<std::int64_t>(mesh.points.size());
  const auto faces = static_cast<std::int64_t>(mesh.triangles.size());
  return static_cast<int>((2 - vertices + faces / 2) / 2);
}

}  // namespace reprise
