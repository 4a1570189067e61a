// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/body_collider.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace reprise::dynamics {

using Eigen::Vector3d;

// Nearest point of one triangle. `feature`: 0 inside; 1, 2, 3 on edge (0,1), (1,2), (2,0); 4, 5, 6 at corner
// 0, 1, 2.
struct BodyCollider::Nearest {
  Vector3d offset;  // from the surface to the particle
  Vector3d weights;
  int feature = 0;
  double squared = std::numeric_limits<double>::infinity();
};

BodyCollider::BodyCollider(std::vector<Triangle> triangles, Eigen::Index vertex_count)
    : triangles_(std::move(triangles)) {
  const auto vertices = static_cast<std::size_t>(vertex_count);
  std::map<std::pair<std::int32_t, std::int32_t>, std::pair<std::int32_t, int>> edges;
  across_.assign(triangles_.size(), {-1, -1, -1});
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangles_[t][static_cast<std::size_t>(k)];
      const std::int32_t b = triangles_[t][static_cast<std::size_t>((k + 1) % 3)];
      const auto other = edges.find({b, a});
      if (other != edges.end()) {
        across_[t][static_cast<std::size_t>(k)] = other->second.first;
        across_[static_cast<std::size_t>(other->second.first)]
               [static_cast<std::size_t>(other->second.second)] = static_cast<std::int32_t>(t);
      }
      edges.try_emplace({a, b}, static_cast<std::int32_t>(t), k);
    }
  }
  open_vertex_.assign(vertices, false);
  fan_begin_.assign(vertices + 1, 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++fan_begin_[static_cast<std::size_t>(triangles_[t][k]) + 1];
      if (across_[t][k] < 0) {
        open_vertex_[static_cast<std::size_t>(triangles_[t][k])] = true;
        open_vertex_[static_cast<std::size_t>(triangles_[t][(k + 1) % 3])] = true;
      }
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) fan_begin_[v + 1] += fan_begin_[v];
  fan_.resize(static_cast<std::size_t>(fan_begin_.back()));
  std::vector<std::int32_t> next(fan_begin_.begin(), fan_begin_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const std::int32_t v : triangles_[t])
      fan_[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] = static_cast<std::int32_t>(t);
  }
}

void BodyCollider::move(const Points& points) {
  if (before_.rows() == points.rows()) {
    before_.swap(points_);
    points_ = points;
  } else {
    points_ = before_ = points;
  }
}

Eigen::Array3i BodyCollider::cell_of(const Vector3d& point) const {
  const auto cell = [&](int axis) {
    const double place =
        std::clamp((point[axis] - low_[axis]) * cells_per_metre_, -1.0, static_cast<double>(cells_[axis]));
    return static_cast<int>(std::floor(place));
  };
  return {cell(0), cell(1), cell(2)};
}

void BodyCollider::prepare_search(const Vector3d& low, const Vector3d& high, double radius) {
  radius_ = radius;
  cells_per_metre_ = 1.0 / radius;
  low_ = low.array() - radius;
  cells_ = (((high - low).array() + 2.0 * radius) / radius).ceil().cast<int>().max(1).min(1000);
  balls_.resize(triangles_.size());

  // Triangles into the cells that their boxes overlap: counted first, then filed.
  std::vector<Eigen::Array3i> last_cells(triangles_.size());
  cell_begin_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
  const auto for_cells = [&](std::size_t t, const auto& act) {
    const Eigen::Array3i first(balls_[t].first_cell[0], balls_[t].first_cell[1], balls_[t].first_cell[2]);
    const Eigen::Array3i& last = last_cells[t];
    for (int z = first.z(); z <= last.z(); ++z)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int x = first.x(); x <= last.x(); ++x) act(cell_idx({x, y, z}));
  };
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto i = static_cast<std::int32_t>(t);
    const Vector3d a = corner(i, 0), b = corner(i, 1), c = corner(i, 2);
    const Eigen::Array3i first = cell_of(a.cwiseMin(b).cwiseMin(c)).max(0);
    last_cells[t] = cell_of(a.cwiseMax(b).cwiseMax(c)).min(cells_ - 1);
    Ball& ball = balls_[t];
    ball.first_cell = {static_cast<std::int16_t>(first.x()), static_cast<std::int16_t>(first.y()),
                       static_cast<std::int16_t>(first.z())};
    if ((first > last_cells[t]).any()) continue;
    ball.normal = (b - a).cross(c - a);
    ball.centre = (a + b + c) / 3.0;
    ball.radius = std::sqrt(std::max(
        {(a - ball.centre).squaredNorm(), (b - ball.centre).squaredNorm(), (c - ball.centre).squaredNorm()}));
    for_cells(t, [&](std::size_t cell) { ++cell_begin_[cell + 1]; });
  }
  for (std::size_t c = 0; c + 1 < cell_begin_.size(); ++c) cell_begin_[c + 1] += cell_begin_[c];
  cell_triangles_.resize(static_cast<std::size_t>(cell_begin_.back()));
  std::vector<std::int32_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for_cells(t, [&](std::size_t cell) {
      cell_triangles_[static_cast<std::size_t>(next[cell]++)] = static_cast<std::int32_t>(t);
    });
  }
}

// After Ericson, Real-Time Collision Detection, 5.1.5: the Voronoi region of the triangle that holds the
// point.
BodyCollider::Nearest BodyCollider::nearest(const Vector3d& particle, std::int32_t triangle) const {
  const Vector3d a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
  const Vector3d ab = b - a, ac = c - a, ap = particle - a;
  Nearest result;
  const auto at = [&](double wa, double wb, double wc, int feature) {
    result.weights = {wa, wb, wc};
    result.offset = ap - wb * ab - wc * ac;
    result.squared = result.offset.squaredNorm();
    result.feature = feature;
    return result;
  };
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return at(1, 0, 0, 4);
  const Vector3d bp = particle - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return at(0, 1, 0, 5);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return at(1 - v, v, 0, 1);
  }
  const Vector3d cp = particle - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return at(0, 0, 1, 6);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return at(1 - w, 0, w, 3);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(0, 1 - w, w, 2);
  }
  const double sum = va + vb + vc;
  return at(va / sum, vb / sum, vc / sum, 0);
}

bool BodyCollider::on_open_edge(std::int32_t triangle, int feature) const {
  const auto t = static_cast<std::size_t>(triangle);
  if (feature == 0) return false;
  if (feature <= 3) return across_[t][static_cast<std::size_t>(feature - 1)] < 0;
  return open_vertex_[static_cast<std::size_t>(triangles_[t][static_cast<std::size_t>(feature - 4)])];
}

// Unit, or zero for a triangle without area.
Vector3d BodyCollider::face_normal(std::int32_t triangle) const {
  const Vector3d a = corner(triangle, 0);
  return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a).stableNormalized();
}

// The normal that tells inside from outside where the nearest point lies on that feature: of the face, the
// mean of two faces at an edge, weighted by angles at a corner (Baerentzen and Aanaes 2005). Others err at
// sharp places.
Vector3d BodyCollider::outward(std::int32_t triangle, int feature) const {
  if (feature == 0) return face_normal(triangle);
  if (feature <= 3) {
    const std::int32_t other =
        across_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(feature - 1)];
    return other < 0 ? face_normal(triangle)
                     : (face_normal(triangle) + face_normal(other)).stableNormalized();
  }
  const auto vertex = triangles_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(feature - 4)];
  const auto v = static_cast<std::size_t>(vertex);
  Vector3d sum = Vector3d::Zero();
  for (std::int32_t i = fan_begin_[v]; i < fan_begin_[v + 1]; ++i) {
    const std::int32_t face = fan_[static_cast<std::size_t>(i)];
    const Triangle& corners = triangles_[static_cast<std::size_t>(face)];
    const int k = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
    const Vector3d to_next = corner(face, (k + 1) % 3) - corner(face, k),
                   to_last = corner(face, (k + 2) % 3) - corner(face, k);
    const Vector3d normal = to_next.cross(to_last);
    const double size = normal.norm();
    if (size > 0.0) sum += std::atan2(size, to_next.dot(to_last)) / size * normal;
  }
  return sum.stableNormalized();
}

Candidates BodyCollider::find(const Vector3d& particle, std::int32_t guess) const {
  Candidates found = no_candidates;
  // Kept from call to call: allocating it anew took longer than filling it. One a thread, emptied here.
  thread_local std::vector<std::int32_t> near;
  near.clear();
  Nearest best;
  best.squared = radius_ * radius_;
  // Equal distances (at shared edges) go to the lower index, whatever was tried first.
  const auto try_as_nearest = [&](std::int32_t triangle) {
    const Nearest place = nearest(particle, triangle);
    if ((place.squared < best.squared ||
         (place.squared == best.squared && found[0] >= 0 && triangle < found[0])) &&
        !on_open_edge(triangle, place.feature)) {  // the rim of a shoe must not hide the ankle in it
      best = place;
      found[0] = triangle;
    }
  };
  if (guess >= 0) try_as_nearest(guess);
  double reach = std::sqrt(best.squared);
  const Vector3d margin = Vector3d::Constant(radius_);
  const Eigen::Array3i first = cell_of(particle - margin).max(0),
                       last = cell_of(particle + margin).min(cells_ - 1);
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const std::size_t cell = cell_idx({x, y, z});
        for (std::int32_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
          const std::int32_t triangle = cell_triangles_[static_cast<std::size_t>(i)];
          const Ball& ball = balls_[static_cast<std::size_t>(triangle)];
          // A triangle lies in several cells: here only in the first one that is searched.
          const auto& cells = ball.first_cell;
          if (x != std::max<int>(cells[0], first.x()) || y != std::max<int>(cells[1], first.y()) ||
              z != std::max<int>(cells[2], first.z()))
            continue;
          const Vector3d offset = particle - ball.centre;
          const double squared = offset.squaredNorm(), far = radius_ + ball.radius;
          if (squared >= far * far) continue;
          if (offset.dot(ball.normal) > 0.0) near.push_back(triangle);
          const double nearer = reach + ball.radius;
          if (triangle == guess || squared > nearer * nearer * (1.0 + 1e-9)) continue;
          try_as_nearest(triangle);
          reach = std::sqrt(best.squared);
        }
      }
  if (found[0] < 0) return found;

  // The nearest sheet counts on either side. Others only from outside (from inside they are the far wall of
  // something thin), met squarely, and from another direction: half-spaces that look alike say the same.
  std::array<Vector3d, 3> directions;
  directions[0] = best.offset.normalized();
  if (best.offset.dot(outward(found[0], best.feature)) < 0.0) directions[0] *= -1.0;
  for (std::size_t slot = 1; slot < found.size(); ++slot) {
    double least = radius_ * radius_;
    for (const std::int32_t triangle : near) {
      const Ball& ball = balls_[static_cast<std::size_t>(triangle)];
      const Vector3d to_ball = particle - ball.centre;
      const double nearer = std::sqrt(least) + ball.radius;
      const double squared = to_ball.squaredNorm();
      if (squared > nearer * nearer) continue;
      bool other_side = true;
      const double length = std::sqrt(squared);
      // Nowhere on the ball is the direction another one.
      for (std::size_t k = 0; k < slot; ++k)
        other_side &= to_ball.dot(directions[k]) - 1.5 * ball.radius < 0.5 * length;
      if (!other_side) continue;
      const Nearest place = nearest(particle, triangle);
      const double distance = std::sqrt(place.squared);
      for (std::size_t k = 0; k < slot; ++k) other_side &= place.offset.dot(directions[k]) < 0.5 * distance;
      if (!other_side || place.squared > least || (place.squared == least && triangle > found[slot]) ||
          on_open_edge(triangle, place.feature))
        continue;
      if (place.offset.dot(outward(triangle, place.feature)) < 0.7 * distance) continue;
      least = place.squared;
      found[slot] = triangle;
      directions[slot] = place.offset / std::max(distance, 1e-12);
    }
    if (found[slot] < 0) break;
  }
  return found;
}

Touch BodyCollider::touch(const Vector3d& particle, std::int32_t& triangle) const {
  Touch result;
  Nearest here = nearest(particle, triangle);
  for (int step = 0; step < 16 && here.feature != 0; ++step) {
    std::int32_t better = -1;
    Nearest there = here;
    const auto try_triangle = [&](std::int32_t candidate) {
      if (candidate < 0 || candidate == triangle) return;
      const Nearest place = nearest(particle, candidate);
      if (place.squared < there.squared * (1.0 - 1e-12)) {
        there = place;
        better = candidate;
      }
    };
    const Triangle& corners = triangles_[static_cast<std::size_t>(triangle)];
    if (here.feature <= 3) {
      try_triangle(across_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(here.feature - 1)]);
    } else {
      const auto v = static_cast<std::size_t>(corners[static_cast<std::size_t>(here.feature - 4)]);
      for (std::int32_t i = fan_begin_[v]; i < fan_begin_[v + 1]; ++i)
        try_triangle(fan_[static_cast<std::size_t>(i)]);
    }
    if (better < 0) break;
    triangle = better;
    here = there;
  }
  const Triangle& corners = triangles_[static_cast<std::size_t>(triangle)];
  if (on_open_edge(triangle, here.feature)) return result;

  const Vector3d normal = outward(triangle, here.feature);
  const double length = std::sqrt(here.squared);
  const bool inside = here.offset.dot(normal) < 0.0;
  if (length <= 1e-7 && normal.isZero(0.0)) return result;
  result.normal = length > 1e-7 ? Vector3d((inside ? -1.0 : 1.0) / length * here.offset) : normal;
  result.distance = inside ? -length : length;
  if (result.distance < -deepest) return result;
  result.movement.setZero();
  for (int k = 0; k < 3; ++k) {
    const std::int32_t v = corners[static_cast<std::size_t>(k)];
    result.movement += here.weights[k] * (points_.row(v) - before_.row(v)).transpose();
  }
  result.valid = true;
  return result;
}

}  // namespace reprise::dynamics
