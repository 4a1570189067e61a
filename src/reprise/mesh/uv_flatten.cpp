// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/uv_flatten.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace reprise {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int rigid_steps = 8;
constexpr double min_projected_cosine = 0.02;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double twice_area(const FlatChart& chart, const Triangle& t) {
  return cross(chart.points[t[1]] - chart.points[t[0]], chart.points[t[2]] - chart.points[t[0]]);
}

// The border's vertices in order; empty unless the triangles are one disc.
std::vector<std::int32_t> border(const FlatChart& chart) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const Triangle& t : chart.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  std::vector<std::int32_t> next(chart.points.size(), -1);
  std::size_t border_edges = 0, inner_edges = 0;
  for (const auto& [edge, uses] : edges) {
    if (uses != 1) return {};
    if (edges.contains({edge.second, edge.first})) {
      ++inner_edges;
      continue;
    }
    if (next[edge.first] >= 0) return {};  // the border touches itself
    next[edge.first] = edge.second;
    ++border_edges;
  }
  const auto euler = static_cast<std::int64_t>(chart.points.size() + chart.triangles.size()) -
                     static_cast<std::int64_t>(border_edges + inner_edges / 2);
  if (euler != 1) return {};
  std::vector<std::int32_t> loop;
  const auto start = std::find_if(next.begin(), next.end(), [](std::int32_t v) { return v >= 0; });
  if (start == next.end()) return {};
  auto v = static_cast<std::int32_t>(start - next.begin());
  do {
    loop.push_back(v);
    v = next[v];
  } while (v != loop.front() && loop.size() <= border_edges);
  if (loop.size() != border_edges) return {};
  return loop;
}

bool segments_meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y()))
    return false;
  return cross(b - a, c - a) * cross(b - a, d - a) <= 0.0 && cross(d - c, a - c) * cross(d - c, b - c) <= 0.0;
}

// Counter-clockwise triangles inside of a border that does not meet itself do not overlap.
bool is_sound(const FlatChart& chart, const std::vector<std::int32_t>& loop) {
  for (const Triangle& t : chart.triangles) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (chart.points[t[k]] - chart.points[t[(k + 1) % 3]]).squaredNorm());
    if (!(twice_area(chart, t) > 1e-3 * longest)) return false;
  }
  // Segments sorted by their left end: only those that begin before one ends can meet it.
  const std::size_t count = loop.size();
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < count; ++i) {
    order.emplace_back(std::min(chart.points[loop[i]].x(), chart.points[loop[(i + 1) % count]].x()), i);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t s = order[i].second;
    const Vector2d &a = chart.points[loop[s]], &b = chart.points[loop[(s + 1) % count]];
    for (std::size_t j = i + 1; j < count && order[j].first <= std::max(a.x(), b.x()); ++j) {
      const std::size_t r = order[j].second;
      if ((s + 1) % count == r || (r + 1) % count == s) continue;
      if (segments_meet(a, b, chart.points[loop[r]], chart.points[loop[(r + 1) % count]])) return false;
    }
  }
  return true;
}

// Steps of: turn every triangle as the flat one is turned; then solve for points whose edges fit best.
class RigidFlattening {
 public:
  RigidFlattening(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles, FlatChart& chart)
      : chart_(chart) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Triangle& source = mesh.triangles[triangles[i]];
      const Vector3d ab = mesh.points[source[1]] - mesh.points[source[0]];
      const Vector3d ac = mesh.points[source[2]] - mesh.points[source[0]];
      const double length = ab.norm(), along = ab.dot(ac) / length;
      const std::array<Vector2d, 3> flat{Vector2d(0, 0), Vector2d(length, 0),
                                         Vector2d(along, ab.cross(ac).norm() / length)};
      flat_.push_back(flat);
      std::array<double, 3> weights{};
      for (int k = 0; k < 3; ++k) {
        // Cotangent of the angle opposite to the edge k, k + 1; kept positive so that the system stays
        // definite at obtuse corners.
        const Vector2d p = flat[k] - flat[(k + 2) % 3], q = flat[(k + 1) % 3] - flat[(k + 2) % 3];
        weights[k] = std::clamp(p.dot(q) / std::max(cross(p, q), 1e-300), 0.05, 20.0);
        const std::int32_t a = chart.triangles[i][k], b = chart.triangles[i][(k + 1) % 3];
        entries.emplace_back(a, a, weights[k]);
        entries.emplace_back(b, b, weights[k]);
        entries.emplace_back(a, b, -weights[k]);
        entries.emplace_back(b, a, -weights[k]);
      }
      weights_.push_back(weights);
    }
    entries.emplace_back(0, 0, 1.0);  // holds the first point where it is
    const auto count = static_cast<Eigen::Index>(chart.points.size());
    Eigen::SparseMatrix<double> L(count, count);
    L.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(L);
  }

  void step() {
    Eigen::MatrixX2d b = Eigen::MatrixX2d::Zero(static_cast<Eigen::Index>(chart_.points.size()), 2);
    b.row(0) = chart_.points[0].transpose();
    for (std::size_t i = 0; i < flat_.size(); ++i) {
      const Triangle& t = chart_.triangles[i];
      // The best rotation in the plane has a closed form: the angle of the sum of products of complex
      // numbers.
      double cosine = 0.0, sine = 0.0;
      for (int k = 0; k < 3; ++k) {
        const Vector2d u = flat_[i][k] - flat_[i][(k + 1) % 3];
        const Vector2d v = chart_.points[t[k]] - chart_.points[t[(k + 1) % 3]];
        cosine += weights_[i][k] * u.dot(v);
        sine += weights_[i][k] * cross(u, v);
      }
      const double norm = std::hypot(cosine, sine);
      if (norm > 0.0) {
        cosine /= norm;
        sine /= norm;
      } else {
        cosine = 1.0;
      }
      for (int k = 0; k < 3; ++k) {
        const Vector2d u = flat_[i][k] - flat_[i][(k + 1) % 3];
        const Vector2d turned =
            weights_[i][k] * Vector2d(cosine * u.x() - sine * u.y(), sine * u.x() + cosine * u.y());
        b.row(t[k]) += turned.transpose();
        b.row(t[(k + 1) % 3]) -= turned.transpose();
      }
    }
    const Eigen::MatrixX2d x = solver_.solve(b);
    for (std::size_t v = 0; v < chart_.points.size(); ++v)
      chart_.points[v] = x.row(static_cast<Eigen::Index>(v)).transpose();
  }

 private:
  FlatChart& chart_;
  std::vector<std::array<Vector2d, 3>> flat_;
  std::vector<std::array<double, 3>> weights_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

// Turns the chart so that its box is smallest and lies on its side, at the origin.
void lay_down(FlatChart& chart) {
  const auto box_of = [&](double angle) {
    const Eigen::Rotation2Dd turn(angle);
    Eigen::AlignedBox2d box;
    for (const Vector2d& p : chart.points) box.extend(Vector2d(turn * p));
    return box;
  };
  double best_angle = 0.0, best_area = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 36; ++i) {
    const double angle = i * std::numbers::pi / 72.0;
    const double area = box_of(angle).volume();
    if (area < best_area * (1.0 - 1e-9)) {
      best_area = area;
      best_angle = angle;
    }
  }
  const Vector2d sizes = box_of(best_angle).sizes();
  if (sizes.y() > sizes.x()) best_angle += 0.5 * std::numbers::pi;
  const Eigen::Rotation2Dd turn(best_angle);
  const Vector2d corner = box_of(best_angle).min();
  for (Vector2d& p : chart.points) p = turn * p - corner;
}

// Boxes of whole pixels, each put where it lies lowest on those before. False if they are too high.
bool place(const std::vector<Eigen::Vector2i>& boxes, const std::vector<std::size_t>& order, int size,
           std::vector<Eigen::Vector2i>& corners) {
  std::vector<int> skyline(static_cast<std::size_t>(size), 0);
  for (const std::size_t i : order) {
    const int width = boxes[i].x(), height = boxes[i].y();
    int best_x = -1, best_y = size;
    // Candidates: where the skyline steps.
    for (int x = 0; x + width <= size; ++x) {
      if (x > 0 && skyline[x] == skyline[x - 1]) continue;
      const int y = *std::max_element(skyline.begin() + x, skyline.begin() + x + width);
      if (y < best_y) {
        best_y = y;
        best_x = x;
      }
    }
    if (best_x < 0 || best_y + height > size) return false;
    corners[i] = {best_x, best_y};
    std::fill(skyline.begin() + best_x, skyline.begin() + best_x + width, best_y + height);
  }
  return true;
}

}  // namespace

std::optional<FlatChart> flatten(const TriangleMesh& mesh, const std::vector<std::int32_t>& triangles,
                                 const Vector3d& direction) {
  FlatChart chart;
  const Vector3d x = direction.unitOrthogonal(), y = direction.cross(x);
  std::map<std::int32_t, std::int32_t> new_idx;
  for (const std::int32_t t : triangles) {
    Triangle corners = mesh.triangles[t];
    const Vector3d area = (mesh.points[corners[1]] - mesh.points[corners[0]])
                              .cross(mesh.points[corners[2]] - mesh.points[corners[0]]);
    // One triangle always lies flat along its own plane.
    if (!(area.dot(direction) > min_projected_cosine * area.norm())) return std::nullopt;
    for (std::int32_t& v : corners) {
      const auto [entry, is_new] = new_idx.try_emplace(v, static_cast<std::int32_t>(chart.points.size()));
      if (is_new) chart.points.emplace_back(mesh.points[v].dot(x), mesh.points[v].dot(y));
      v = entry->second;
    }
    chart.triangles.push_back(corners);
  }
  const std::vector<std::int32_t> loop = border(chart);
  if (loop.empty()) return std::nullopt;
  if (triangles.size() > 1 && !is_sound(chart, loop)) return std::nullopt;
  // The projection is sound but squeezes what is steep. Go as far towards rigid as stays sound.
  const std::vector<Vector2d> projected = chart.points;
  RigidFlattening rigid(mesh, triangles, chart);
  for (int i = 0; i < rigid_steps; ++i) rigid.step();
  const std::vector<Vector2d> target = chart.points;
  for (const double share : {1.0, 0.85, 0.7, 0.5, 0.3}) {
    for (std::size_t v = 0; v < projected.size(); ++v)
      chart.points[v] = (1.0 - share) * projected[v] + share * target[v];
    if (is_sound(chart, loop)) return chart;
  }
  chart.points = projected;
  return chart;
}

void pack(std::vector<FlatChart>& charts, int size, int gutter) {
  std::vector<Vector2d> sizes;
  double area = 0.0, longest = 0.0;
  for (FlatChart& chart : charts) {
    lay_down(chart);
    Eigen::AlignedBox2d box;
    for (const Vector2d& p : chart.points) box.extend(p);
    sizes.push_back(box.sizes());
    area += box.volume();
    longest = std::max(longest, box.sizes().x());
  }
  std::vector<std::size_t> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a].y() > sizes[b].y(); });
  std::vector<Eigen::Vector2i> boxes(charts.size()), corners(charts.size()), best;
  const auto fits = [&](double scale) {
    for (std::size_t i = 0; i < charts.size(); ++i) {
      boxes[i] = (scale * sizes[i]).array().ceil().cast<int>() + gutter;
      if (boxes[i].x() > size) return false;
    }
    return place(boxes, order, size, corners);
  };
  // Pixels a unit of the charts. Far below the bound from the area everything fits, unless the gutters alone
  // fill the square: then they give way.
  double high = std::min(size / std::sqrt(area), size / longest), low = 0.0;
  for (double scale = 0.9 * high; scale > 1e-3 * high; scale *= 0.7) {
    if (fits(scale)) {
      low = scale;
      best = corners;
      break;
    }
    high = scale;
  }
  if (best.empty()) {
    if (gutter > 0) pack(charts, size, 0);
    return;
  }
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    if (fits(middle)) {
      low = middle;
      best = corners;
    } else {
      high = middle;
    }
  }
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const Vector2d corner = best[i].cast<double>() + Vector2d::Constant(0.5 * gutter);
    for (Vector2d& p : charts[i].points) p = (low * p + corner) / size;
  }
}

}  // namespace reprise
