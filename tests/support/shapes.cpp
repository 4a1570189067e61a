// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "support/shapes.h"

#include <cmath>
#include <map>
#include <numbers>

namespace reprise::test {

Shape sphere(int levels) {
  std::vector<Eigen::Vector3d> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(points.size()));
      if (is_new) {
        points.push_back(
            (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]).normalized());
      }
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::int32_t ab = middle(a, b);
      const std::int32_t bc = middle(b, c);
      const std::int32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  Topology topology{.vertex_count = static_cast<std::int32_t>(points.size()),
                    .triangles = std::move(triangles)};
  Positions positions(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) {
    positions.row(static_cast<Eigen::Index>(v)) =
        (points[v] + Eigen::Vector3d(0, 1, 0)).cast<float>().transpose();
  }
  return {std::make_shared<const Topology>(std::move(topology)), std::move(positions)};
}

Shape sheet(int cells) {
  Topology topology{.vertex_count = (cells + 1) * (cells + 1)};
  Positions positions(topology.vertex_count, 3);
  for (std::int32_t row = 0; row <= cells; ++row) {
    for (std::int32_t column = 0; column <= cells; ++column) {
      const std::int32_t v = row * (cells + 1) + column;
      positions.row(v) << static_cast<float>(column) / static_cast<float>(cells), 0.0F,
          static_cast<float>(row) / static_cast<float>(cells);
      if (row < cells && column < cells) {
        topology.triangles.push_back({v, v + cells + 1, v + 1});
        topology.triangles.push_back({v + 1, v + cells + 1, v + cells + 2});
      }
    }
  }
  return {std::make_shared<const Topology>(std::move(topology)), std::move(positions)};
}

Shape body() {
  Shape shape = sphere(3);
  for (Eigen::Index v = 0; v < shape.positions.rows(); ++v) {
    Eigen::Vector3f p = shape.positions.row(v).transpose() - Eigen::Vector3f(0, 1, 0);
    p = p.cwiseProduct(Eigen::Vector3f(0.25F, 0.9F, 0.18F));
    const float bump = std::exp(-20.0F * (p - Eigen::Vector3f(0.25F, 0.2F, 0.0F)).squaredNorm());
    p += bump * Eigen::Vector3f(0.3F, 0.0F, 0.15F);
    shape.positions.row(v) = (p + Eigen::Vector3f(0, 0.9F, 0)).transpose();
  }
  return shape;
}

MeshSequence walk(const std::string& name, std::size_t frame_count, double speed, double period,
                  double phase) {
  static const Shape shape = body();
  MeshSequence clip(name, shape.topology, frame_count, 25.0);
  for (std::size_t f = 0; f < frame_count; ++f) {
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(f) + phase) / period;
    auto out = clip.frame(f);
    for (Eigen::Index v = 0; v < out.rows(); ++v) {
      Eigen::Vector3d p = shape.positions.row(v).cast<double>();
      p.x() += 0.08 * std::sin(angle) * p.y();
      p.z() += 0.05 * std::cos(angle) * p.y() * p.y() + speed * static_cast<double>(f);
      out.row(v) = p.cast<float>().transpose();
    }
  }
  return clip;
}

MeshSequence moved(const MeshSequence& clip, const GroundTransform& transform, const std::string& name) {
  MeshSequence result = clip;
  result.set_name(name);
  for (std::size_t f = 0; f < clip.frame_count(); ++f)
    transform_positions(transform, clip.frame(f), result.frame(f));
  return result;
}

PerformanceDatabase database_of(std::vector<MeshSequence> clips) {
  PerformanceDatabase database;
  for (MeshSequence& clip : clips) database.add(std::move(clip));
  return database;
}

}  // namespace reprise::test
