// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/surface/texture_bake.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reprise/core/parallel.h"

namespace reprise::capture {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int gutter_steps = 8;
constexpr double membrane_shade = 0.45;
// Rays that find nothing take the nearest layer up to here.
constexpr double search = 0.1;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

class Baker {
 public:
  Baker(const TriangleMesh& mesh, const UvAtlas& atlas, const std::vector<int>& layer_of_vertex,
        const VisibleLayers& layers, int size)
      : mesh_(mesh), atlas_(atlas), layer_of_vertex_(layer_of_vertex), layers_(layers), size_(size) {
    normals_.assign(mesh.points.size(), Vector3d::Zero());
    for (const Triangle& t : mesh.triangles) {
      const Vector3d area =
          (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
      for (const std::int32_t v : t) normals_[v] += area;
    }
    for (Vector3d& n : normals_) n.stableNormalize();
    // Only cloth throws its shade on a membrane.
    Vector3d sum = Vector3d::Zero();
    double count = 0.0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      const int l = layer_of_vertex[v];
      if (l < 0 || layers.layers()[l].kind != BodyLayer::Kind::garment) continue;
      const auto found = layers.nearest(mesh.points[v], normals_[v], search, search);
      if (!found || found->layer != l) continue;
      sum += layers.sample(l, found->triangle, found->weights).head<3>();
      ++count;
    }
    cloth_ = count > 0.0 ? Vector3d(sum / count) : Vector3d::Constant(96.0);
  }

  BakedTexture run() {
    const std::size_t count = static_cast<std::size_t>(size_) * size_;
    assign_owners();
    image_ = {.width = size_, .height = size_, .rgb = std::vector<std::uint8_t>(3 * count, 0)};
    parallel_for(0, static_cast<std::size_t>(size_), [&](std::size_t row) {
      for (int column = 0; column < size_; ++column) {
        const std::size_t at = row * static_cast<std::size_t>(size_) + static_cast<std::size_t>(column);
        if (owner_[at] < 0) continue;
        const Vector3d color =
            color_at(owner_[at], Vector2d(column + 0.5, size_ - 0.5 - static_cast<double>(row)));
        for (int k = 0; k < 3; ++k)
          image_.rgb[3 * at + k] = static_cast<std::uint8_t>(std::lround(std::clamp(color[k], 0.0, 255.0)));
      }
    });
    BakedTexture result{.image = {}, .colors = mean_colors()};
    fill_gutters();
    result.image = std::move(image_);
    return result;
  }

 private:
  Vector2d uv(std::int32_t t, int k) const {
    const auto& p = atlas_.uvs[atlas_.triangle_uvs[t][k]];
    return size_ * Vector2d(p[0], p[1]);
  }

  Vector3d weights_at(std::int32_t t, const Vector2d& p) const {
    const Vector2d a = uv(t, 0), b = uv(t, 1), c = uv(t, 2);
    const double area = cross(b - a, c - a);
    const double u = cross(c - b, p - b) / area, v = cross(a - c, p - c) / area;
    return {u, v, 1.0 - u - v};
  }

  // The triangle in which the middle of a texel lies, or else the nearest one that touches the texel, so that
  // filtering at a border never meets a colour from nowhere.
  void assign_owners() {
    owner_.assign(static_cast<std::size_t>(size_) * size_, -1);
    std::vector<float> outside(owner_.size(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < atlas_.triangle_uvs.size(); ++i) {
      const auto t = static_cast<std::int32_t>(i);
      const Vector2d a = uv(t, 0), b = uv(t, 1), c = uv(t, 2);
      const Vector2d low = a.cwiseMin(b).cwiseMin(c).array() - 1.0,
                     high = a.cwiseMax(b).cwiseMax(c).array() + 1.0;
      const auto clamped = [&](double x) {
        return std::clamp(static_cast<int>(std::floor(x)), 0, size_ - 1);
      };
      for (int y = clamped(low.y()); y <= clamped(high.y()); ++y) {
        for (int x = clamped(low.x()); x <= clamped(high.x()); ++x) {
          const Vector2d p(x + 0.5, y + 0.5);
          const double d =
              std::max({-cross(b - a, p - a) / (b - a).norm(), -cross(c - b, p - b) / (c - b).norm(),
                        -cross(a - c, p - c) / (a - c).norm(), 0.0});
          if (d > 1.0) continue;
          const std::size_t at =
              static_cast<std::size_t>(size_ - 1 - y) * size_ + static_cast<std::size_t>(x);
          if (static_cast<float>(d) >= outside[at]) continue;
          outside[at] = static_cast<float>(d);
          owner_[at] = t;
        }
      }
    }
  }

  Vector3d color_at(std::int32_t t, const Vector2d& pixel) const {
    Vector3d weights = weights_at(t, pixel).cwiseMax(0.0);
    weights /= weights.sum();
    const Triangle& c = mesh_.triangles[t];
    Vector3d point = Vector3d::Zero(), normal = Vector3d::Zero();
    double membrane = 0.0;
    for (int k = 0; k < 3; ++k) {
      point += weights[k] * mesh_.points[c[k]];
      normal += weights[k] * normals_[c[k]];
      if (layer_of_vertex_[c[k]] < 0) membrane += weights[k];
    }
    normal.stableNormalize();
    if (membrane > 0.999) return membrane_shade * cloth_;
    if (const auto seen = layers_.color_seen(point, normal)) return *seen;
    if (membrane > 0.0) return membrane_shade * cloth_;
    const auto found = layers_.nearest(point, normal, search, search);
    if (!found || found->layer < 0) return membrane_shade * cloth_;
    return layers_.sample(found->layer, found->triangle, found->weights).head<3>();
  }

  // Texels weigh the more the nearer they are to the vertex.
  std::vector<Color> mean_colors() const {
    std::vector<Eigen::Vector4d> sum(mesh_.points.size(), Eigen::Vector4d::Zero());
    for (int row = 0; row < size_; ++row) {
      for (int column = 0; column < size_; ++column) {
        const std::size_t at = static_cast<std::size_t>(row) * size_ + static_cast<std::size_t>(column);
        const std::int32_t t = owner_[at];
        if (t < 0) continue;
        const Vector3d weights = weights_at(t, Vector2d(column + 0.5, size_ - 0.5 - row)).cwiseMax(0.0);
        const Eigen::Vector4d color(image_.rgb[3 * at], image_.rgb[3 * at + 1], image_.rgb[3 * at + 2], 1.0);
        for (int k = 0; k < 3; ++k) {
          const double w = weights[k] * weights[k] * weights[k];
          sum[mesh_.triangles[t][k]] += w * color;
        }
      }
    }
    std::vector<Color> colors(sum.size(), Color{128, 128, 128});
    for (std::size_t v = 0; v < sum.size(); ++v) {
      if (!(sum[v][3] > 0.0)) {  // triangles smaller than a texel
        const auto found = layers_.nearest(mesh_.points[v], normals_[v], search, search);
        if (found && found->layer >= 0)
          sum[v] << layers_.sample(found->layer, found->triangle, found->weights).head<3>(), 1.0;
        else
          sum[v] << membrane_shade * cloth_, 1.0;
      }
      for (int k = 0; k < 3; ++k)
        colors[v][k] = static_cast<std::uint8_t>(std::lround(std::clamp(sum[v][k] / sum[v][3], 0.0, 255.0)));
    }
    return colors;
  }

  // Each step gives empty texels the mean of their neighbours; what is far from any chart takes the mean of
  // all, so that small versions of the texture stay true.
  void fill_gutters() {
    std::vector<std::uint8_t> filled(owner_.size());
    Vector3d sum = Vector3d::Zero();
    double count = 0.0;
    for (std::size_t i = 0; i < owner_.size(); ++i) {
      filled[i] = owner_[i] >= 0 ? 1 : 0;
      if (filled[i] == 0) continue;
      sum += Vector3d(image_.rgb[3 * i], image_.rgb[3 * i + 1], image_.rgb[3 * i + 2]);
      ++count;
    }
    for (int step = 0; step < gutter_steps; ++step) {
      std::vector<std::uint8_t> next = filled;
      parallel_for(0, static_cast<std::size_t>(size_), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < size_; ++x) {
          const std::size_t at = row * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x);
          if (filled[at] != 0) continue;
          int total[3] = {0, 0, 0}, neighbors = 0;
          for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
              if (x + dx < 0 || x + dx >= size_ || y + dy < 0 || y + dy >= size_) continue;
              const std::size_t other =
                  static_cast<std::size_t>(y + dy) * size_ + static_cast<std::size_t>(x + dx);
              if (filled[other] == 0) continue;
              for (int k = 0; k < 3; ++k) total[k] += image_.rgb[3 * other + k];
              ++neighbors;
            }
          }
          if (neighbors == 0) continue;
          for (int k = 0; k < 3; ++k)
            image_.rgb[3 * at + k] = static_cast<std::uint8_t>((total[k] + neighbors / 2) / neighbors);
          next[at] = 1;
        }
      });
      filled = std::move(next);
    }
    if (!(count > 0.0)) return;
    for (std::size_t i = 0; i < filled.size(); ++i) {
      if (filled[i] != 0) continue;
      for (int k = 0; k < 3; ++k)
        image_.rgb[3 * i + k] = static_cast<std::uint8_t>(std::lround(sum[k] / count));
    }
  }

  const TriangleMesh& mesh_;
  const UvAtlas& atlas_;
  const std::vector<int>& layer_of_vertex_;
  const VisibleLayers& layers_;
  int size_;
  std::vector<Vector3d> normals_;
  Vector3d cloth_;
  std::vector<std::int32_t> owner_;  // triangle of every texel, or -1
  Image image_;
};

}  // namespace

BakedTexture bake(const TriangleMesh& mesh, const UvAtlas& atlas, const std::vector<int>& layer_of_vertex,
                  const VisibleLayers& layers, int texture_size) {
  return Baker(mesh, atlas, layer_of_vertex, layers, texture_size).run();
}

}  // namespace reprise::capture
