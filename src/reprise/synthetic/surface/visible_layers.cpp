// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/surface/visible_layers.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace reprise::capture {
namespace {

using Eigen::Vector3d;
using Kind = BodyLayer::Kind;

// Layers nearer to each other than this lie together.
constexpr double together = 0.0015;
// A cap counts only where it spans more than a gap between cloth and skin.
constexpr double cap_lead = 0.012;
// Texels to either side that hair is averaged over, and between which means it fades in: cards often have
// stray lines along their edges.
constexpr int density_radius = 4;
constexpr double least_density = 0.25, full_density = 0.5;
// Cards seen nearly edge-on would show as lines.
constexpr double min_card_cosine = 0.15;
// How far outside of and below the surface a camera's ray looks for layers: surfaces of few vertices cut
// corners, hair is a loose volume.
constexpr double look_out = 0.015, look_out_hair = 0.03, look_in = 0.03;
constexpr double opaque = 0.98;
constexpr std::size_t shortest_border = 6;

std::vector<Vector3d> points_of(const BodyLayer& layer) {
  std::vector<Vector3d> points;
  points.reserve(static_cast<std::size_t>(layer.points.rows()));
  for (Eigen::Index v = 0; v < layer.points.rows(); ++v) points.emplace_back(layer.points.row(v).transpose());
  return points;
}

// Loops of edges that have a triangle on one side only.
std::vector<std::vector<std::int32_t>> borders(const BodyLayer& layer) {
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Triangle& t : layer.triangles) {
    for (int k = 0; k < 3; ++k) edges.emplace(t[k], t[(k + 1) % 3]);
  }
  std::set<std::pair<std::int32_t, std::int32_t>> open;
  for (const auto& edge : edges) {
    if (!edges.contains({edge.second, edge.first})) open.insert(edge);
  }
  std::vector<std::vector<std::int32_t>> loops;
  while (!open.empty()) {
    std::vector<std::int32_t> loop;
    auto edge = open.begin();
    while (edge != open.end()) {
      loop.push_back(edge->first);
      const std::int32_t to = edge->second;
      open.erase(edge);
      edge = open.lower_bound({to, 0});
      if (edge != open.end() && edge->first != to) edge = open.end();
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

// Larger lies further out.
int outwardness(Kind kind) {
  switch (kind) {
    case Kind::skin:
      return 0;
    case Kind::face:
      return 1;
    case Kind::shoes:
      return 2;
    case Kind::garment:
      return 3;
    case Kind::hair:
      return 4;
  }
  return 0;
}

// Mean over a square about every texel.
std::vector<float> box_mean(const std::vector<std::uint8_t>& alpha, int width, int height, int radius) {
  std::vector<float> rows(alpha.size()), result(alpha.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int sum = 0;
      for (int d = -radius; d <= radius; ++d)
        sum += alpha[static_cast<std::size_t>(y) * width + std::clamp(x + d, 0, width - 1)];
      rows[static_cast<std::size_t>(y) * width + x] = static_cast<float>(sum);
    }
  }
  const float scale = 1.0F / (255.0F * static_cast<float>((2 * radius + 1) * (2 * radius + 1)));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0.0F;
      for (int d = -radius; d <= radius; ++d)
        sum += rows[static_cast<std::size_t>(std::clamp(y + d, 0, height - 1)) * width + x];
      result[static_cast<std::size_t>(y) * width + x] = scale * sum;
    }
  }
  return result;
}

}  // namespace

bool has_shape(const BodyLayer& layer) {
  return layer.kind != Kind::face || layer.alpha.empty();
}

std::vector<std::array<Vector3d, 2>> border_lines(const BodyLayer& layer) {
  std::vector<std::array<Vector3d, 2>> lines;
  if (layer.kind != Kind::garment) return lines;
  for (const std::vector<std::int32_t>& loop : borders(layer)) {
    if (loop.size() < shortest_border) continue;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      lines.push_back(
          {layer.points.row(loop[i]).transpose(), layer.points.row(loop[(i + 1) % loop.size()]).transpose()});
    }
  }
  return lines;
}

TriangleMesh border_caps(const BodyLayer& layer) {
  TriangleMesh caps;
  if (layer.kind != Kind::garment && layer.kind != Kind::shoes) return caps;
  for (const std::vector<std::int32_t>& loop : borders(layer)) {
    if (loop.size() < shortest_border) continue;
    const auto first = static_cast<std::int32_t>(caps.points.size());
    const auto count = static_cast<std::int32_t>(loop.size());
    Vector3d center = Vector3d::Zero();
    for (const std::int32_t v : loop) {
      caps.points.emplace_back(layer.points.row(v).transpose());
      center += caps.points.back() / count;
    }
    caps.points.push_back(center);
    for (std::int32_t i = 0; i < count; ++i)
      caps.triangles.push_back({first + (i + 1) % count, first + i, first + count});
  }
  return caps;
}

VisibleLayers::VisibleLayers(const std::vector<BodyLayer>& layers) : layers_(layers) {
  std::vector<Vector3d> all_points;
  std::vector<Triangle> all_triangles;
  TriangleMesh caps;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const BodyLayer& layer = layers[l];
    std::vector<Vector3d> points = points_of(layer);
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> sources;
    const auto first = static_cast<std::int32_t>(all_points.size());
    for (std::size_t t = 0; t < layer.triangles.size(); ++t) {
      if (!layer.hidden.empty() && layer.hidden[t]) continue;
      const Triangle& c = layer.triangles[t];
      triangles.push_back(c);
      sources.push_back(static_cast<std::int32_t>(t));
      all_triangles.push_back({first + c[0], first + c[1], first + c[2]});
      all_sources_.push_back({static_cast<int>(l), static_cast<std::int32_t>(t)});
    }
    all_points.insert(all_points.end(), points.begin(), points.end());
    const TriangleMesh cap = border_caps(layer);
    const auto first_cap = static_cast<std::int32_t>(caps.points.size());
    caps.points.insert(caps.points.end(), cap.points.begin(), cap.points.end());
    for (const Triangle& c : cap.triangles)
      caps.triangles.push_back({first_cap + c[0], first_cap + c[1], first_cap + c[2]});
    const bool strands = layer.kind == Kind::hair && !layer.alpha.empty();
    density_.push_back(strands
                           ? box_mean(layer.alpha, layer.texture.width, layer.texture.height, density_radius)
                           : std::vector<float>());
    if (!has_shape(layer)) continue;
    trees_.emplace_back(std::move(points), std::move(triangles));
    layer_of_tree_.push_back(static_cast<int>(l));
    sources_.push_back(std::move(sources));
  }
  trees_.emplace_back(std::move(caps.points), std::move(caps.triangles));
  layer_of_tree_.push_back(-1);
  sources_.emplace_back();
  all_.emplace(std::move(all_points), std::move(all_triangles));
}

std::optional<LayerPoint> VisibleLayers::nearest(const Vector3d& point, const Vector3d& normal,
                                                 double max_distance, double max_hair_distance) const {
  std::optional<LayerPoint> best;
  int best_outwardness = -2;
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    const int l = layer_of_tree_[i];
    const bool hair = l >= 0 && layers_[l].kind == Kind::hair;
    const double limit = hair ? max_hair_distance : max_distance;
    // Hair cards and caps have no outside.
    const auto found = trees_[i].closest(point, limit, hair || l < 0 ? nullptr : &normal);
    if (!found) continue;
    if (l < 0) {  // comes last
      if (best && best->distance < found->distance + cap_lead) continue;
      best = {.layer = -1,
              .triangle = found->triangle,
              .weights = found->weights,
              .point = found->point,
              .distance = found->distance};
      continue;
    }
    const int out = outwardness(layers_[l].kind);
    if (best && (found->distance > best->distance + together ||
                 (found->distance > best->distance - together && out < best_outwardness)))
      continue;
    best = {.layer = l,
            .triangle = sources_[i][found->triangle],
            .weights = found->weights,
            .point = found->point,
            .distance = found->distance};
    best_outwardness = out;
  }
  return best;
}

Eigen::Vector4d VisibleLayers::sample(int l, std::int32_t triangle, const Vector3d& weights) const {
  const BodyLayer& layer = layers_[l];
  if (layer.texture.empty() || layer.triangle_uvs.empty()) return {128.0, 128.0, 128.0, 1.0};
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto& corner = layer.uvs[layer.triangle_uvs[triangle][k]];
    uv += weights[k] * Eigen::Vector2d(corner[0], corner[1]);
  }
  const int width = layer.texture.width, height = layer.texture.height;
  const double x = std::clamp(uv.x() * width - 0.5, 0.0, width - 1.0);
  const double y = std::clamp((1.0 - uv.y()) * height - 0.5, 0.0, height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const double fx = x - x0, fy = y - y0;
  Eigen::Vector4d result = Eigen::Vector4d::Zero();
  const auto add = [&](int column, int row, double weight) {
    const std::size_t at = static_cast<std::size_t>(row) * width + column;
    const double alpha = layer.alpha.empty() ? 1.0 : layer.alpha[at] / 255.0;
    result += weight * Eigen::Vector4d(layer.texture.rgb[3 * at], layer.texture.rgb[3 * at + 1],
                                       layer.texture.rgb[3 * at + 2], alpha);
  };
  add(x0, y0, (1.0 - fx) * (1.0 - fy));
  add(x1, y0, fx * (1.0 - fy));
  add(x0, y1, (1.0 - fx) * fy);
  add(x1, y1, fx * fy);
  return result;
}

double VisibleLayers::alpha_at(const Source& source, const Vector3d& weights, double sampled) const {
  const BodyLayer& layer = layers_[source.layer];
  if (layer.kind == Kind::skin) return 1.0;
  if (density_[source.layer].empty()) return sampled;
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto& corner = layer.uvs[layer.triangle_uvs[source.triangle][k]];
    uv += weights[k] * Eigen::Vector2d(corner[0], corner[1]);
  }
  const int width = layer.texture.width, height = layer.texture.height;
  const int x = std::clamp(static_cast<int>(uv.x() * width), 0, width - 1);
  const int y = std::clamp(static_cast<int>((1.0 - uv.y()) * height), 0, height - 1);
  const double density =
      density_[source.layer][static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
  return sampled * std::clamp((density - least_density) / (full_density - least_density), 0.0, 1.0);
}

std::optional<Vector3d> VisibleLayers::color_seen(const Vector3d& point, const Vector3d& normal) const {
  thread_local std::vector<RayHit> hits;
  all_->hits(point + look_out_hair * normal, -normal, look_out_hair + look_in, hits);
  // The camera stands on this side of whatever shows its back outside of the point: another limb.
  std::size_t begin = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const BodyLayer& layer = layers_[all_sources_[hits[i].triangle].layer];
    if (hits[i].t < look_out_hair - 0.002 && !hits[i].front && layer.kind != Kind::hair &&
        layer.kind != Kind::face)
      begin = i + 1;
  }
  Vector3d color = Vector3d::Zero();
  double covered = 0.0;
  for (std::size_t i = begin; i < hits.size() && covered < opaque; ++i) {
    const Source& source = all_sources_[hits[i].triangle];
    const BodyLayer& layer = layers_[source.layer];
    const bool card = layer.kind == Kind::hair || (layer.kind == Kind::face && !layer.alpha.empty());
    if (!hits[i].front && !card) continue;
    if (card && std::abs(all_->normal(hits[i].triangle).dot(normal)) < min_card_cosine) continue;
    if (!card && hits[i].t < look_out_hair - look_out) continue;
    const Eigen::Vector4d seen = sample(source.layer, source.triangle, hits[i].weights);
    const double alpha = alpha_at(source, hits[i].weights, seen[3]);
    color += (1.0 - covered) * alpha * seen.head<3>();
    covered += (1.0 - covered) * alpha;
  }
  if (covered < 0.2) return std::nullopt;
  return color / covered;
}

}  // namespace reprise::capture
