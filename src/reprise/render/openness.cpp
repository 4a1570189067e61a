// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/openness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "reprise/core/parallel.h"

namespace reprise {
namespace {

constexpr std::size_t axis_count = 12;
constexpr int map_size = 128;
constexpr float infinity = std::numeric_limits<float>::infinity();

// Spread evenly over half a sphere; each stands for itself and its opposite.
Eigen::Matrix3f axis_frame(std::size_t axis_idx) {
  const double height = (static_cast<double>(axis_idx) + 0.5) / axis_count;
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(axis_idx);
  const double radius = std::sqrt(1.0 - height * height);
  const Eigen::Vector3d forward(radius * std::cos(turn), height, radius * std::sin(turn));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d(0.37, -0.21, 0.9)).normalized();
  Eigen::Matrix3f frame;
  frame.row(0) = right.cast<float>().transpose();
  frame.row(1) = forward.cross(right).cast<float>().transpose();
  frame.row(2) = forward.cast<float>().transpose();
  return frame;
}

struct Ball {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0.0F;
};

// Around the middle of the bounding box.
Ball ball_around(const PositionsView& positions) {
  Eigen::Array3f low = Eigen::Array3f::Constant(infinity);
  Eigen::Array3f high = Eigen::Array3f::Constant(-infinity);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!positions.row(v).allFinite()) continue;
    low = low.min(positions.row(v).transpose().array());
    high = high.max(positions.row(v).transpose().array());
  }
  if (!(low.x() < infinity)) return {};
  return {.center = 0.5F * (low + high), .radius = 0.5F * (high - low).matrix().norm()};
}

// Farthest depths along an axis and against it, per texel.
struct DepthMap {
  std::vector<float> high = std::vector<float>(static_cast<std::size_t>(map_size * map_size), -infinity);
  std::vector<float> low = std::vector<float>(static_cast<std::size_t>(map_size * map_size), infinity);

  void add(int x, int y, float depth) {
    const auto i = static_cast<std::size_t>(y * map_size + x);
    high[i] = std::max(high[i], depth);
    low[i] = std::min(low[i], depth);
  }

  // Corners in texels, with their depths. Texels whose middles the triangle covers.
  void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (!(std::abs(area) > 1e-12F)) return;
    const auto first = [](float p, float q, float r) {
      return std::max(0, static_cast<int>(std::ceil(std::min({p, q, r}) - 0.5F)));
    };
    const auto last = [](float p, float q, float r) {
      return std::min(map_size - 1, static_cast<int>(std::floor(std::max({p, q, r}) - 0.5F)));
    };
    const int right = last(a.x(), b.x(), c.x());
    const int top = last(a.y(), b.y(), c.y());
    for (int y = first(a.y(), b.y(), c.y()); y <= top; ++y) {
      for (int x = first(a.x(), b.x(), c.x()); x <= right; ++x) {
        const float p = static_cast<float>(x) + 0.5F;
        const float q = static_cast<float>(y) + 0.5F;
        const float u = ((p - a.x()) * (c.y() - a.y()) - (q - a.y()) * (c.x() - a.x())) / area;
        const float v = ((b.x() - a.x()) * (q - a.y()) - (b.y() - a.y()) * (p - a.x())) / area;
        if (u < 0.0F || v < 0.0F || u + v > 1.0F) continue;
        add(x, y, a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z()));
      }
    }
  }
};

// What one axis adds to each side of a vertex: what is seen of the weight, and the weight.
struct Share {
  std::array<float, 2> open = {0.0F, 0.0F};
  std::array<float, 2> all = {0.0F, 0.0F};
};
using Shares = std::vector<Share>;

// Part of the four texels around (x, y) that do not hide `depth`; the ramp over one texel of depth keeps
// steps of the map out of the picture. `sign`: 1 looks along the axis, -1 against it.
float seen(const DepthMap& map, float x, float y, float depth, float sign) {
  const float left = std::floor(x - 0.5F);
  const float bottom = std::floor(y - 0.5F);
  const float part_x = x - 0.5F - left;
  const float part_y = y - 0.5F - bottom;
  float result = 0.0F;
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const int column = static_cast<int>(left) + dx;
      const int row = static_cast<int>(bottom) + dy;
      float open = 1.0F;
      if (column >= 0 && row >= 0 && column < map_size && row < map_size) {
        const auto i = static_cast<std::size_t>(row * map_size + column);
        const float beyond = sign > 0.0F ? map.high[i] - depth : depth - map.low[i];
        open = std::clamp(1.5F - beyond, 0.0F, 1.0F);
      }
      result += open * (dx == 1 ? part_x : 1.0F - part_x) * (dy == 1 ? part_y : 1.0F - part_y);
    }
  }
  return result;
}

Shares shares_of_axis(std::size_t axis_idx, const Ball& ball, const Topology& topology,
                      const PositionsView& positions, const PositionsView& normals) {
  const Eigen::Matrix3f frame = axis_frame(axis_idx);
  // Everything in texels, depth too.
  const float texels_a_metre = 0.5F * (map_size - 2) / ball.radius;
  const auto count = static_cast<std::size_t>(positions.rows());
  std::vector<Eigen::Vector3f> places(count);
  DepthMap map;
  for (std::size_t v = 0; v < count; ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    places[v] = texels_a_metre * (frame * (positions.row(row).transpose() - ball.center)) +
                Eigen::Vector3f(0.5F * map_size, 0.5F * map_size, 0.0F);
    // Triangles smaller than a texel count too.
    if (places[v].allFinite())
      map.add(static_cast<int>(places[v].x()), static_cast<int>(places[v].y()), places[v].z());
  }
  for (const Triangle& t : topology.triangles) {
    const Eigen::Vector3f& a = places[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3f& b = places[static_cast<std::size_t>(t[1])];
    const Eigen::Vector3f& c = places[static_cast<std::size_t>(t[2])];
    if (a.allFinite() && b.allFinite() && c.allFinite()) map.add(a, b, c);
  }

  Shares shares(count);
  for (std::size_t v = 0; v < count; ++v) {
    const Eigen::Vector3f n = frame * normals.row(static_cast<Eigen::Index>(v)).transpose();
    const float weight = std::abs(n.z());
    if (!places[v].allFinite() || !(weight > 0.0F)) continue;
    for (const float sign : {1.0F, -1.0F}) {
      const bool is_front = sign * n.z() > 0.0F;
      // From beside the surface, so that it does not hide itself.
      const Eigen::Vector3f p = places[v] + (is_front ? 1.5F : -1.5F) * n;
      const std::size_t side = is_front ? 0 : 1;
      shares[v].open[side] += weight * seen(map, p.x(), p.y(), p.z() + sign * 0.5F, sign);
      shares[v].all[side] += weight;
    }
  }
  return shares;
}

}  // namespace

std::vector<SurfaceSide> surface_sides(const Topology& topology, const PositionsView& positions) {
  const ConnectedComponents components = connected_components(topology);
  const auto component_of = [&](std::int32_t vertex) {
    return static_cast<std::size_t>(components.of_vertex[static_cast<std::size_t>(vertex)]);
  };
  std::vector<double> volumes(static_cast<std::size_t>(components.count), 0.0);
  std::vector<bool> is_closed(static_cast<std::size_t>(components.count), true);
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const Triangle& t : topology.triangles) {
    const auto corner = [&](std::size_t i) {
      return Eigen::Vector3d(positions.row(t[i]).cast<double>() - positions.row(0).cast<double>());
    };
    volumes[component_of(t[0])] += corner(0).dot(corner(1).cross(corner(2)));
    for (std::size_t i = 0; i < 3; ++i) edges.push_back({t[i], t[(i + 1) % 3]});
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto& [a, b] = edges[e];
    const bool is_repeated = e > 0 && edges[e] == edges[e - 1];
    if (is_repeated || !std::binary_search(edges.begin(), edges.end(), std::array{b, a})) {
      is_closed[component_of(a)] = false;
    }
  }
  std::vector<SurfaceSide> sides(static_cast<std::size_t>(topology.vertex_count), SurfaceSide::both);
  for (std::size_t v = 0; v < sides.size(); ++v) {
    const std::size_t component = component_of(static_cast<std::int32_t>(v));
    if (!is_closed[component]) continue;
    if (volumes[component] > 0.0) sides[v] = SurfaceSide::normal;
    if (volumes[component] < 0.0) sides[v] = SurfaceSide::opposite;
  }
  return sides;
}

std::vector<Openness> openness(const Topology& topology, const PositionsView& positions,
                               const PositionsView& normals) {
  std::vector<Openness> result(static_cast<std::size_t>(positions.rows()));
  const Ball ball = ball_around(positions);
  if (!(ball.radius > 0.0F)) return result;
  std::array<Shares, axis_count> shares;
  parallel_for(0, axis_count,
               [&](std::size_t a) { shares[a] = shares_of_axis(a, ball, topology, positions, normals); });
  for (std::size_t v = 0; v < result.size(); ++v) {
    Share sum;
    for (const Shares& share : shares) {
      for (std::size_t side = 0; side < 2; ++side) {
        sum.open[side] += share[v].open[side];
        sum.all[side] += share[v].all[side];
      }
    }
    if (sum.all[0] > 0.0F) result[v].front = sum.open[0] / sum.all[0];
    if (sum.all[1] > 0.0F) result[v].back = sum.open[1] / sum.all[1];
  }
  return result;
}

}  // namespace reprise
