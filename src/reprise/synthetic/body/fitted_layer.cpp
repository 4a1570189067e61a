// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/fitted_layer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace reprise::body {
namespace {

using Eigen::Vector3d;
using Edge = std::pair<std::int32_t, std::int32_t>;

Edge edge_of(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

Eigen::Index row(std::int32_t vertex) {
  return static_cast<Eigen::Index>(vertex);
}

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

void add_triangle(BodyLayer& layer, const Triangle& corners, const Triangle& uvs) {
  if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
  layer.triangles.push_back(corners);
  layer.triangle_uvs.push_back(uvs);
}

// The height of most of the hem: the median of the border below the middle between waist and lowest point.
double hem_height(const BodyLayer& layer, double waist) {
  std::map<Edge, int> edge_count;
  for (const Triangle& t : layer.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edge_count[edge_of(t[k], t[(k + 1) % 3])];
  }
  const double lowest = layer.points.col(1).minCoeff();
  std::vector<double> heights;
  for (const auto& [edge, count] : edge_count) {
    const double height = layer.points(edge.first, 1);
    if (count == 1 && height < 0.5 * (waist + lowest)) heights.push_back(height);
  }
  if (heights.empty()) return lowest;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

// Leaves out vertices that no triangle uses.
void compact(FittedLayer& fitted) {
  BodyLayer& layer = fitted.layer;
  std::vector<std::int32_t> new_idx(static_cast<std::size_t>(layer.points.rows()), -1);
  for (const Triangle& triangle : layer.triangles) {
    for (const std::int32_t corner : triangle) new_idx[static_cast<std::size_t>(corner)] = 0;
  }
  std::int32_t count = 0;
  for (std::size_t v = 0; v < new_idx.size(); ++v) {
    if (new_idx[v] < 0) continue;
    new_idx[v] = count;
    layer.points.row(row(count)) = layer.points.row(static_cast<Eigen::Index>(v)).eval();
    fitted.weights[static_cast<std::size_t>(count)] = fitted.weights[v];
    ++count;
  }
  layer.points.conservativeResize(count, 3);
  fitted.weights.resize(static_cast<std::size_t>(count));
  for (Triangle& triangle : layer.triangles) {
    for (std::int32_t& corner : triangle) corner = new_idx[static_cast<std::size_t>(corner)];
  }
}

}  // namespace

FittedLayer make_layer(const MakehumanMesh& mesh, const Points& points,
                       const std::vector<BoneWeights>& weights, const std::vector<bool>& used) {
  FittedLayer fitted;
  fitted.layer.points = points;
  fitted.layer.uvs = mesh.uvs;
  fitted.weights = weights;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!used.empty() && !used[f]) continue;
    const MakehumanMesh::Face& face = mesh.faces[f];
    const auto& c = face.corners;
    const auto& u = face.uvs;
    if (face.corner_count == 3) {
      add_triangle(fitted.layer, {c[0], c[1], c[2]}, {u[0], u[1], u[2]});
      continue;
    }
    // The shorter diagonal makes the better triangles.
    const bool first = (points.row(row(c[0])) - points.row(row(c[2]))).norm() <=
                       (points.row(row(c[1])) - points.row(row(c[3]))).norm();
    if (first) {
      add_triangle(fitted.layer, {c[0], c[1], c[2]}, {u[0], u[1], u[2]});
      add_triangle(fitted.layer, {c[0], c[2], c[3]}, {u[0], u[2], u[3]});
    } else {
      add_triangle(fitted.layer, {c[0], c[1], c[3]}, {u[0], u[1], u[3]});
      add_triangle(fitted.layer, {c[1], c[2], c[3]}, {u[1], u[2], u[3]});
    }
  }
  compact(fitted);
  return fitted;
}

void sew(FittedLayer& fitted) {
  constexpr double same_place = 2e-5;  // metres
  BodyLayer& layer = fitted.layer;
  std::map<Edge, int> edge_count;
  for (const Triangle& t : layer.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edge_count[edge_of(t[k], t[(k + 1) % 3])];
  }
  std::vector<bool> on_border(static_cast<std::size_t>(layer.points.rows()), false);
  for (const auto& [edge, count] : edge_count) {
    if (count != 1) continue;
    on_border[static_cast<std::size_t>(edge.first)] = true;
    on_border[static_cast<std::size_t>(edge.second)] = true;
  }
  std::vector<std::int32_t> order;
  for (std::size_t v = 0; v < on_border.size(); ++v) {
    if (on_border[v]) order.push_back(static_cast<std::int32_t>(v));
  }
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    const double ya = layer.points(a, 1), yb = layer.points(b, 1);
    return ya != yb ? ya < yb : a < b;
  });
  std::vector<std::int32_t> joined(on_border.size());
  for (std::size_t v = 0; v < joined.size(); ++v) joined[v] = static_cast<std::int32_t>(v);
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (layer.points(order[j], 1) - layer.points(order[i], 1) > same_place) break;
      if ((layer.points.row(order[j]) - layer.points.row(order[i])).norm() > same_place) continue;
      const auto a = static_cast<std::size_t>(order[i]), b = static_cast<std::size_t>(order[j]);
      const std::int32_t root = std::min(joined[a], joined[b]);
      joined[a] = joined[b] = root;
    }
  }
  std::vector<Triangle> triangles, triangle_uvs;
  std::swap(triangles, layer.triangles);
  std::swap(triangle_uvs, layer.triangle_uvs);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle corners = triangles[t];
    for (std::int32_t& corner : corners) corner = joined[static_cast<std::size_t>(corner)];
    add_triangle(layer, corners, triangle_uvs[t]);
  }
  compact(fitted);
}

void keep_pieces(FittedLayer& fitted, CostumePieces pieces) {
  if (pieces == CostumePieces::all) return;
  BodyLayer& layer = fitted.layer;
  const Topology topology{static_cast<std::int32_t>(layer.points.rows()), layer.triangles, {}, {}, {}};
  const ConnectedComponents components = connected_components(topology);
  std::vector<double> height(static_cast<std::size_t>(components.count), 0.0), count(height);
  for (std::size_t v = 0; v < components.of_vertex.size(); ++v) {
    const auto piece = static_cast<std::size_t>(components.of_vertex[v]);
    height[piece] += layer.points(static_cast<Eigen::Index>(v), 1);
    count[piece] += 1.0;
  }
  for (std::size_t piece = 0; piece < height.size(); ++piece) height[piece] /= count[piece];
  const auto [lowest, highest] = std::minmax_element(height.begin(), height.end());
  const double middle = 0.5 * (*lowest + *highest);
  std::vector<Triangle> triangles, triangle_uvs;
  for (std::size_t t = 0; t < layer.triangles.size(); ++t) {
    const auto corner = static_cast<std::size_t>(layer.triangles[t][0]);
    const bool is_upper = height[static_cast<std::size_t>(components.of_vertex[corner])] > middle;
    if (is_upper != (pieces == CostumePieces::upper)) continue;
    triangles.push_back(layer.triangles[t]);
    triangle_uvs.push_back(layer.triangle_uvs[t]);
  }
  layer.triangles = std::move(triangles);
  layer.triangle_uvs = std::move(triangle_uvs);
  compact(fitted);
}

void reshape_skirt(FittedLayer& fitted, double waist, double hem, double flare, const Eigen::Vector3d& axis) {
  Points& points = fitted.layer.points;
  const double end = hem_height(fitted.layer, waist);
  if (end >= waist) return;
  const double stretch = (waist - hem) / (waist - end);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    // An uneven hem becomes nearly level.
    constexpr double unevenness = 0.15;
    if (points(v, 1) < end) points(v, 1) = end + unevenness * (points(v, 1) - end);
    const double below = (waist - points(v, 1)) / (waist - end);
    if (below <= 0.0) continue;
    // The stretch sets in smoothly, so that the waist keeps its shape.
    points(v, 1) = waist - (waist - end) * below * (1.0 + (stretch - 1.0) * smooth_step(2.0 * below));
    const double widen = 1.0 + (flare - 1.0) * below * smooth_step(2.0 * below);
    points(v, 0) = axis.x() + widen * (points(v, 0) - axis.x());
    points(v, 2) = axis.z() + widen * (points(v, 2) - axis.z());
  }
}

void refine(FittedLayer& fitted, double edge_length) {
  constexpr int most_rounds = 4;
  BodyLayer& layer = fitted.layer;
  for (int round = 0; round < most_rounds; ++round) {
    std::map<Edge, std::int32_t> middle, middle_uv;  // of split edges
    std::vector<Vector3d> new_points;
    const auto is_free = [&](std::int32_t v) {
      return !layer.freedom.empty() && layer.freedom[static_cast<std::size_t>(v)] > 0.0;
    };
    auto vertex_count = static_cast<std::int32_t>(layer.points.rows());
    for (const Triangle& t : layer.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Edge edge = edge_of(t[k], t[(k + 1) % 3]);
        if (middle.contains(edge) || !(is_free(edge.first) || is_free(edge.second))) continue;
        const Vector3d a = layer.points.row(row(edge.first)), b = layer.points.row(row(edge.second));
        if ((a - b).norm() <= edge_length) continue;
        middle[edge] = vertex_count++;
        new_points.emplace_back(0.5 * (a + b));
        const BoneWeights& wa = fitted.weights[static_cast<std::size_t>(edge.first)];
        const BoneWeights& wb = fitted.weights[static_cast<std::size_t>(edge.second)];
        fitted.weights.push_back(mean({{&wa, 0.5}, {&wb, 0.5}}));
        layer.freedom.push_back(0.5 * (layer.freedom[static_cast<std::size_t>(edge.first)] +
                                       layer.freedom[static_cast<std::size_t>(edge.second)]));
      }
    }
    if (middle.empty()) return;
    const Eigen::Index old_count = layer.points.rows();
    layer.points.conservativeResize(vertex_count, 3);
    for (std::size_t i = 0; i < new_points.size(); ++i) {
      layer.points.row(old_count + static_cast<Eigen::Index>(i)) = new_points[i].transpose();
    }
    const auto uv_middle = [&](std::int32_t a, std::int32_t b) {
      const auto [it, is_new] =
          middle_uv.try_emplace(edge_of(a, b), static_cast<std::int32_t>(layer.uvs.size()));
      if (is_new) {
        const auto& ua = layer.uvs[static_cast<std::size_t>(a)];
        const auto& ub = layer.uvs[static_cast<std::size_t>(b)];
        layer.uvs.push_back({0.5F * (ua[0] + ub[0]), 0.5F * (ua[1] + ub[1])});
      }
      return it->second;
    };
    std::vector<Triangle> triangles, triangle_uvs;
    std::swap(triangles, layer.triangles);
    std::swap(triangle_uvs, layer.triangle_uvs);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Triangle t = triangles[i], u = triangle_uvs[i];
      std::array<std::int32_t, 3> m{};
      int split = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = middle.find(edge_of(t[k], t[(k + 1) % 3]));
        m[k] = found == middle.end() ? -1 : found->second;
        split += m[k] >= 0 ? 1 : 0;
      }
      // Turned so that edge 0 is split if one is, and edges 0 and 1 if two are.
      while ((split == 1 && m[0] < 0) || (split == 2 && m[2] >= 0)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(u.begin(), u.begin() + 1, u.end());
        std::rotate(m.begin(), m.begin() + 1, m.end());
      }
      if (split == 0) {
        add_triangle(layer, t, u);
        continue;
      }
      const std::int32_t u0 = uv_middle(u[0], u[1]);
      if (split == 1) {
        add_triangle(layer, {t[0], m[0], t[2]}, {u[0], u0, u[2]});
        add_triangle(layer, {m[0], t[1], t[2]}, {u0, u[1], u[2]});
        continue;
      }
      const std::int32_t u1 = uv_middle(u[1], u[2]);
      add_triangle(layer, {m[0], t[1], m[1]}, {u0, u[1], u1});
      if (split == 2) {
        const bool first = (layer.points.row(row(t[0])) - layer.points.row(row(m[1]))).norm() <=
                           (layer.points.row(row(m[0])) - layer.points.row(row(t[2]))).norm();
        if (first) {
          add_triangle(layer, {t[0], m[0], m[1]}, {u[0], u0, u1});
          add_triangle(layer, {t[0], m[1], t[2]}, {u[0], u1, u[2]});
        } else {
          add_triangle(layer, {t[0], m[0], t[2]}, {u[0], u0, u[2]});
          add_triangle(layer, {m[0], m[1], t[2]}, {u0, u1, u[2]});
        }
        continue;
      }
      const std::int32_t u2 = uv_middle(u[2], u[0]);
      add_triangle(layer, {t[0], m[0], m[2]}, {u[0], u0, u2});
      add_triangle(layer, {m[2], m[1], t[2]}, {u2, u1, u[2]});
      add_triangle(layer, {m[0], m[1], m[2]}, {u0, u1, u2});
    }
  }
}

std::vector<double> freedom_by_height(const Points& points, const CostumeFreedom& freedom) {
  if (freedom.most <= 0.0) return {};
  std::vector<double> values(static_cast<std::size_t>(points.rows()));
  for (std::size_t v = 0; v < values.size(); ++v) {
    const double y = points(static_cast<Eigen::Index>(v), 1);
    values[v] = freedom.most * smooth_step((freedom.from - y) / (freedom.from - freedom.to));
  }
  return values;
}

std::vector<double> fullness_by_height(const Points& points, double waist, double at_hem) {
  const double lowest = points.col(1).minCoeff();
  if (at_hem == 1.0 || lowest >= waist) return {};
  std::vector<double> values(static_cast<std::size_t>(points.rows()));
  for (std::size_t v = 0; v < values.size(); ++v) {
    const double below = (waist - points(static_cast<Eigen::Index>(v), 1)) / (waist - lowest);
    values[v] = 1.0 + (at_hem - 1.0) * std::max(0.0, below);
  }
  return values;
}

Points vertex_normals(const Points& points, const std::vector<Triangle>& triangles) {
  Points normals = Points::Zero(points.rows(), 3);
  for (const Triangle& t : triangles) {
    const Vector3d a = points.row(row(t[0])), b = points.row(row(t[1])), c = points.row(row(t[2]));
    const Vector3d normal = (b - a).cross(c - a);
    for (const std::int32_t corner : t) normals.row(row(corner)) += normal.transpose();
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 0.0) normals.row(v) /= length;
  }
  return normals;
}

}  // namespace reprise::body
