// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/uv_atlas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/mesh/uv_flatten.h"

namespace reprise {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

class Atlas {
 public:
  Atlas(const TriangleMesh& mesh, const UvAtlasOptions& options) : mesh_(mesh), options_(options) {
    const std::size_t count = mesh.triangles.size();
    neighbors_.assign(count, {-1, -1, -1});
    std::vector<std::tuple<std::int32_t, std::int32_t, std::int32_t, int>> edges;
    for (std::size_t t = 0; t < count; ++t) {
      const Triangle& c = mesh.triangles[t];
      area_vectors_.push_back(
          0.5 * (mesh.points[c[1]] - mesh.points[c[0]]).cross(mesh.points[c[2]] - mesh.points[c[0]]));
      for (int k = 0; k < 3; ++k) {
        edges.emplace_back(std::min(c[k], c[(k + 1) % 3]), std::max(c[k], c[(k + 1) % 3]),
                           static_cast<std::int32_t>(t), k);
      }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const auto& [a, b, t, k] = edges[i];
      const auto& [c, d, u, l] = edges[i + 1];
      if (a != c || b != d) continue;
      neighbors_[t][k] = u;
      neighbors_[u][l] = t;
    }
    chart_.assign(count, unassigned);
    used_by_.assign(mesh.points.size(), unassigned);
  }

  UvAtlas run() {
    std::vector<std::int32_t> all(mesh_.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    std::stable_sort(all.begin(), all.end(),
                     [&](std::int32_t a, std::int32_t b) { return group(a) < group(b); });
    for (std::size_t begin = 0; begin < all.size();) {
      std::size_t end = begin;
      while (end < all.size() && group(all[end]) == group(all[begin])) ++end;
      cover(
          {all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end)},
          std::cos(options_.max_angle_degrees * std::numbers::pi / 180.0), all.size());
      begin = end;
    }
    merge_small();
    return assemble();
  }

 private:
  static constexpr std::int32_t unassigned = -1;
  static constexpr double nearly_flat = 0.9;   // cosine of a chart's widest angle
  static constexpr std::int32_t in_hand = -2;  // waits to be given to a chart

  struct Chart {
    std::vector<std::int32_t> triangles;
    FlatChart flat;
    bool alive = true;
  };

  int group(std::int32_t t) const {
    return options_.group_of_triangle.empty() ? 0 : options_.group_of_triangle[t];
  }

  // Cuts the set into charts of up to `most` triangles that can be flattened.
  void cover(const std::vector<std::int32_t>& triangles, double min_cosine, std::size_t most) {
    for (const std::int32_t t : triangles) chart_[t] = in_hand;
    std::vector<std::vector<std::int32_t>> rejected;
    while (true) {
      const std::int32_t seed = innermost(triangles);
      if (seed < 0) break;
      std::vector<std::int32_t> grown = grow(seed, min_cosine, most);
      std::optional<FlatChart> flat = flatten(mesh_, grown, mean_direction(grown));
      const auto id = static_cast<std::int32_t>(charts_.size());
      if (flat) {
        for (const std::int32_t t : grown) chart_[t] = id;
        charts_.push_back({.triangles = std::move(grown), .flat = std::move(*flat)});
      } else if (grown.size() == 1) {
        throw InvalidArgument(fmt::format("triangle {}: expected one with an area", seed));
      } else {
        for (const std::int32_t t : grown) chart_[t] = unassigned;
        rejected.push_back(std::move(grown));
      }
    }
    // Flatter pieces, and where they are flat already smaller ones: down to single triangles, which always
    // can be flattened.
    for (const auto& piece : rejected) {
      const std::size_t next = min_cosine < nearly_flat ? piece.size() : (piece.size() + 1) / 2;
      cover(piece, std::min(0.999, 0.5 * (min_cosine + 1.0)), next);
    }
  }

  // The triangle in hand that is most edges away from those that are not.
  std::int32_t innermost(const std::vector<std::int32_t>& triangles) {
    std::vector<std::int32_t> queue;
    distance_.resize(mesh_.triangles.size());
    for (const std::int32_t t : triangles) {
      if (chart_[t] != in_hand) continue;
      distance_[t] = -1;
      for (const std::int32_t u : neighbors_[t]) {
        if (u < 0 || chart_[u] != in_hand) distance_[t] = 0;
      }
      if (distance_[t] == 0) queue.push_back(t);
    }
    if (queue.empty()) {  // a closed surface: from anywhere
      for (const std::int32_t t : triangles) {
        if (chart_[t] == in_hand) return t;
      }
      return -1;
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (const std::int32_t u : neighbors_[queue[i]]) {
        if (u < 0 || chart_[u] != in_hand || distance_[u] >= 0) continue;
        distance_[u] = distance_[queue[i]] + 1;
        queue.push_back(u);
      }
    }
    return queue.back();
  }

  Vector3d mean_direction(const std::vector<std::int32_t>& triangles) const {
    Vector3d sum = Vector3d::Zero();
    for (const std::int32_t t : triangles) sum += area_vectors_[t];
    return sum.stableNormalized();
  }

  // Adds neighbours while the set stays a disc, those first that look most like it.
  std::vector<std::int32_t> grow(std::int32_t seed, double min_cosine, std::size_t most) {
    const std::int32_t mark = ++grow_mark_;
    std::vector<std::int32_t> grown{seed};
    Vector3d sum = area_vectors_[seed];
    // A wide look round gives a first direction that one odd triangle does not spoil.
    {
      std::vector<std::int32_t> ring{seed};
      for (std::size_t i = 0; i < ring.size() && ring.size() < 60; ++i) {
        for (const std::int32_t u : neighbors_[ring[i]]) {
          if (u >= 0 && chart_[u] == in_hand && std::find(ring.begin(), ring.end(), u) == ring.end())
            ring.push_back(u);
        }
      }
      Vector3d wide = Vector3d::Zero();
      for (const std::int32_t t : ring) wide += area_vectors_[t];
      if (wide.dot(sum) > 0.5 * wide.norm() * sum.norm()) sum = wide;
    }
    chart_[seed] = -10 - mark;
    for (const std::int32_t v : mesh_.triangles[seed]) used_by_[v] = mark;
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    const auto push = [&](std::int32_t t) {
      for (const std::int32_t u : neighbors_[t]) {
        if (u < 0 || chart_[u] != in_hand) continue;
        queue.emplace(1.0 - cosine(u, sum), u);
      }
    };
    push(seed);
    while (!queue.empty() && grown.size() < most) {
      const std::int32_t t = queue.top().second;
      queue.pop();
      if (chart_[t] != in_hand || cosine(t, sum) < min_cosine) continue;
      int shared = 0, lone = 0;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t u = neighbors_[t][k];
        if (u >= 0 && chart_[u] == -10 - mark) {
          ++shared;
          lone = (k + 2) % 3;
        }
      }
      // Over one edge the far corner must be new, or the set would close a ring.
      if (shared == 3 || (shared == 1 && used_by_[mesh_.triangles[t][lone]] == mark)) continue;
      chart_[t] = -10 - mark;
      for (const std::int32_t v : mesh_.triangles[t]) used_by_[v] = mark;
      grown.push_back(t);
      sum += area_vectors_[t];
      push(t);
    }
    return grown;
  }

  double cosine(std::int32_t t, const Vector3d& direction) const {
    const double length = area_vectors_[t].norm() * direction.norm();
    return length > 0.0 ? area_vectors_[t].dot(direction) / length : 1.0;
  }

  double area(const Chart& chart) const {
    double sum = 0.0;
    for (const std::int32_t t : chart.triangles) sum += area_vectors_[t].norm();
    return sum;
  }

  // Small charts join the neighbour they share the longest border with, if the two make a good chart.
  void merge_small() {
    double total = 0.0;
    for (const Vector3d& a : area_vectors_) total += a.norm();
    bool changed = true;
    while (changed) {
      changed = false;
      std::vector<std::pair<double, std::int32_t>> order;
      for (std::size_t i = 0; i < charts_.size(); ++i) {
        if (charts_[i].alive) order.emplace_back(area(charts_[i]), static_cast<std::int32_t>(i));
      }
      std::sort(order.begin(), order.end());
      for (const auto& [size, id] : order) {
        if (size > 0.03 * total) break;
        if (!charts_[id].alive) continue;
        std::vector<std::pair<double, std::int32_t>> partners;
        for (const std::int32_t t : charts_[id].triangles) {
          for (int k = 0; k < 3; ++k) {
            const std::int32_t u = neighbors_[t][k];
            if (u < 0 || chart_[u] == id || group(u) != group(t)) continue;
            const double length =
                (mesh_.points[mesh_.triangles[t][k]] - mesh_.points[mesh_.triangles[t][(k + 1) % 3]]).norm();
            const auto found = std::find_if(partners.begin(), partners.end(),
                                            [&](const auto& p) { return p.second == chart_[u]; });
            if (found == partners.end()) {
              partners.emplace_back(-length, chart_[u]);
            } else {
              found->first -= length;
            }
          }
        }
        std::sort(partners.begin(), partners.end());
        for (const auto& [length, other] : partners) {
          if (!join(id, other)) continue;
          changed = true;
          break;
        }
      }
    }
  }

  bool join(std::int32_t id, std::int32_t other) {
    std::vector<std::int32_t> both = charts_[other].triangles;
    both.insert(both.end(), charts_[id].triangles.begin(), charts_[id].triangles.end());
    std::optional<FlatChart> flat = flatten(mesh_, both, mean_direction(both));
    if (!flat) return false;
    for (const std::int32_t t : charts_[id].triangles) chart_[t] = other;
    charts_[other].triangles = std::move(both);
    charts_[other].flat = std::move(*flat);
    charts_[id] = {.triangles = {}, .flat = {}, .alive = false};
    return true;
  }

  UvAtlas assemble() {
    std::vector<FlatChart> flats;
    UvAtlas atlas;
    atlas.triangle_uvs.resize(mesh_.triangles.size());
    atlas.chart_of_triangle.resize(mesh_.triangles.size());
    for (Chart& chart : charts_) {
      if (!chart.alive) continue;
      const double density = options_.density.empty() ? 1.0 : options_.density[group(chart.triangles[0])];
      for (Vector2d& p : chart.flat.points) p *= density;
      for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
        atlas.chart_of_triangle[chart.triangles[i]] = static_cast<int>(flats.size());
        atlas.triangle_uvs[chart.triangles[i]] = chart.flat.triangles[i];
      }
      flats.push_back(std::move(chart.flat));
    }
    atlas.chart_count = static_cast<int>(flats.size());
    pack(flats, options_.texture_size, options_.gutter);
    std::vector<std::int32_t> first;
    for (const FlatChart& flat : flats) {
      first.push_back(static_cast<std::int32_t>(atlas.uvs.size()));
      for (const Vector2d& p : flat.points)
        atlas.uvs.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
    }
    for (std::size_t t = 0; t < atlas.triangle_uvs.size(); ++t) {
      for (std::int32_t& uv : atlas.triangle_uvs[t]) uv += first[atlas.chart_of_triangle[t]];
    }
    return atlas;
  }

  const TriangleMesh& mesh_;
  const UvAtlasOptions& options_;
  std::vector<Vector3d> area_vectors_;
  std::vector<std::array<std::int32_t, 3>> neighbors_;  // over the edge from corner k
  std::vector<std::int32_t> chart_;
  std::vector<std::int32_t> used_by_;  // last growth that reached the point
  std::vector<int> distance_;
  std::int32_t grow_mark_ = 0;
  std::vector<Chart> charts_;
};

}  // namespace

UvAtlas make_uv_atlas(const TriangleMesh& mesh, const UvAtlasOptions& options) {
  if (options.texture_size < 16 || options.texture_size > 32768) {
    throw InvalidArgument(fmt::format("texture_size: expected 16 to 32768, found {}", options.texture_size));
  }
  if (options.gutter < 0 || options.gutter > options.texture_size / 8) {
    throw InvalidArgument(
        fmt::format("gutter: expected 0 to {}, found {}", options.texture_size / 8, options.gutter));
  }
  if (!(options.max_angle_degrees > 0.0) || !(options.max_angle_degrees <= 88.0)) {
    throw InvalidArgument(
        fmt::format("max_angle_degrees: expected above 0, at most 88, found {}", options.max_angle_degrees));
  }
  if (!options.group_of_triangle.empty() && options.group_of_triangle.size() != mesh.triangles.size()) {
    throw InvalidArgument(fmt::format("group_of_triangle: expected {} entries, found {}",
                                      mesh.triangles.size(), options.group_of_triangle.size()));
  }
  for (const int group : options.group_of_triangle) {
    if (group < 0 ||
        (!options.density.empty() && static_cast<std::size_t>(group) >= options.density.size())) {
      throw InvalidArgument(fmt::format("group {}: expected one that has a density", group));
    }
  }
  for (const double density : options.density) {
    if (!(density > 0.0)) throw InvalidArgument(fmt::format("density: expected positive, found {}", density));
  }
  if (mesh.triangles.empty()) return {};
  return Atlas(mesh, options).run();
}

}  // namespace reprise
