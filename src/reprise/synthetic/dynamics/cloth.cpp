// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/cloth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace reprise::dynamics {

using Eigen::Vector3d;

namespace {

constexpr double fold_width = 0.13;  // metres: what a surface of 2,500 vertices can still show

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// An edge and the corners across it: one at a border, -1 beside it.
struct Edge {
  int a = 0, b = 0;
  std::array<int, 2> across{-1, -1};
  std::array<int, 2> triangles{-1, -1};
  double length = 0.0;
};

std::vector<Edge> edges_of(const std::vector<Vector3d>& x, const std::vector<Triangle>& triangles) {
  std::map<std::pair<int, int>, std::size_t> seen;
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangles[t][k], b = triangles[t][(k + 1) % 3], c = triangles[t][(k + 2) % 3];
      const auto [found, is_new] = seen.try_emplace({std::min(a, b), std::max(a, b)}, edges.size());
      if (is_new)
        edges.push_back({std::min(a, b), std::max(a, b), {-1, -1}, {-1, -1}, (x[at(a)] - x[at(b)]).norm()});
      Edge& edge = edges[found->second];
      // A third triangle at one edge hangs on by its links; it does not bend.
      const std::size_t side = edge.triangles[0] < 0 ? 0 : 1;
      if (edge.triangles[side] >= 0) continue;
      edge.across[side] = c;
      edge.triangles[side] = static_cast<int>(t);
    }
  }
  return edges;
}

// The diagonal of a quad: the longest edge of both of its triangles.
std::vector<bool> diagonals(const std::vector<Edge>& edges, std::size_t triangle_count) {
  std::vector<int> longest(triangle_count, -1);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const int t : edges[e].triangles) {
      if (t >= 0 && (longest[at(t)] < 0 || edges[e].length > edges[at(longest[at(t)])].length))
        longest[at(t)] = static_cast<int>(e);
    }
  }
  std::vector<bool> result(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto& [t0, t1] = edges[e].triangles;
    result[e] = t0 >= 0 && t1 >= 0 && longest[at(t0)] == static_cast<int>(e) &&
                longest[at(t1)] == static_cast<int>(e);
  }
  return result;
}

std::vector<Vector3d> normals_of(const std::vector<Vector3d>& x, const std::vector<Triangle>& triangles) {
  std::vector<Vector3d> normals(x.size(), Vector3d::Zero());
  for (const Triangle& t : triangles) {
    const Vector3d normal = (x[at(t[1])] - x[at(t[0])]).cross(x[at(t[2])] - x[at(t[0])]);
    for (const int i : t) normals[at(i)] += normal;
  }
  return normals;
}

// How long the cloth is cut between two particles: by its fullness longer than they lie apart, as far as the
// way leads around the body.
class Cut {
 public:
  Cut(const std::vector<Vector3d>& x, const std::vector<Triangle>& triangles,
      const std::vector<double>& fullness)
      : x_(x), fullness_(fullness) {
    if (!fullness.empty()) normals_ = normals_of(x, triangles);
  }
  double length(int a, int b) const {
    const Vector3d way = x_[at(b)] - x_[at(a)];
    if (fullness_.empty()) return way.norm();
    const Vector3d around = Vector3d::UnitY().cross(normals_[at(a)] + normals_[at(b)]);
    const double size = around.norm();
    if (!(size > 0.0)) return way.norm();
    const double part = way.dot(around) / size;
    const double full = 0.5 * (fullness_[at(a)] + fullness_[at(b)]);
    return std::sqrt(way.squaredNorm() + (full * full - 1.0) * part * part);
  }
  // Twice the area of a triangle with these sides (Heron, in the stable order of Kahan).
  static double twice_area(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    return 0.5 * std::sqrt(std::max(0.0, (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))));
  }
  double twice_area(const Triangle& t) const {
    return twice_area(length(t[0], t[1]), length(t[1], t[2]), length(t[2], t[0]));
  }

 private:
  const std::vector<Vector3d>& x_;
  const std::vector<double>& fullness_;
  std::vector<Vector3d> normals_;
};

// Of the angle between sides `a` and `b`, opposite `c`.
double cotangent(double a, double b, double c) {
  return 0.5 * (a * a + b * b - c * c) / std::max(Cut::twice_area(a, b, c), 1e-9);
}

Hinge make_hinge(const std::vector<Vector3d>& x, const Cut& cut, const Edge& edge,
                 const ClothMaterial& material) {
  const std::array<int, 4> p = {edge.a, edge.b, edge.across[0], edge.across[1]};
  const double e0 = cut.length(p[0], p[1]), e1 = cut.length(p[0], p[2]), e2 = cut.length(p[0], p[3]),
               e3 = cut.length(p[1], p[2]), e4 = cut.length(p[1], p[3]);
  const double c01 = cotangent(e0, e1, e3), c02 = cotangent(e0, e2, e4);
  const double c03 = cotangent(e0, e3, e1), c04 = cotangent(e0, e4, e2);
  Hinge hinge;
  hinge.particles = p;
  hinge.weights = {c03 + c04, c01 + c02, -c01 - c03, -c02 - c04};
  // The bending vector is the edge's length times the sum of both triangles' directions away from it. Not
  // taken from the places themselves: where the cloth is cut wider than it lies, they would bend it by force.
  const Vector3d along = (x[at(p[1])] - x[at(p[0])]).stableNormalized();
  const auto away = [&](int corner) {
    const Vector3d side = x[at(corner)] - x[at(p[0])];
    return Vector3d((side - side.dot(along) * along).stableNormalized());
  };
  hinge.size = e0 * (away(p[2]) + away(p[3])).norm();
  const double area = 0.5 * (Cut::twice_area(e0, e1, e3) + Cut::twice_area(e0, e2, e4));
  hinge.compliance = area / (3.0 * material.bending);  // Bergou et al.: energy 3 / (2 area) * |bend|^2
  hinge.damping = material.damping;
  return hinge;
}

// Lowers the freedom of pieces that nothing holds: they would fall to the floor.
std::vector<double> held(std::vector<double> freedom, const std::vector<Edge>& edges) {
  std::vector<int> piece(freedom.size());
  for (std::size_t i = 0; i < piece.size(); ++i) piece[i] = static_cast<int>(i);
  const auto root = [&](int i) {
    while (piece[at(i)] != i) i = piece[at(i)] = piece[at(piece[at(i)])];
    return i;
  };
  for (const Edge& edge : edges) {
    const int a = root(edge.a), b = root(edge.b);
    piece[at(std::max(a, b))] = std::min(a, b);
  }
  std::vector<double> least(freedom.size(), 1.0);
  for (std::size_t i = 0; i < freedom.size(); ++i) {
    double& l = least[at(root(static_cast<int>(i)))];
    l = std::min(l, freedom[i]);
  }
  for (std::size_t i = 0; i < freedom.size(); ++i) {
    if (least[at(root(static_cast<int>(i)))] > pinned_freedom) freedom[i] = std::min(freedom[i], 0.5);
  }
  return freedom;
}

// Flown first: links near to what is held. A sweep then carries its pull all the way down.
void sort_from_held(std::vector<Link>& links, const std::vector<double>& distance) {
  std::stable_sort(links.begin(), links.end(), [&](const Link& l, const Link& r) {
    return std::min(distance[at(l.a)], distance[at(l.b)]) < std::min(distance[at(r.a)], distance[at(r.b)]);
  });
}

}  // namespace

ParticleSystem make_cloth(const Points& points, const std::vector<Triangle>& triangles,
                          const std::vector<double>& given_freedom, const ClothMaterial& material,
                          const std::vector<double>& fullness) {
  const auto count = static_cast<std::size_t>(points.rows());
  ParticleSystem system;
  system.position.resize(count);
  for (std::size_t i = 0; i < count; ++i) system.position[i] = points.row(static_cast<Eigen::Index>(i));
  const std::vector<Vector3d>& x = system.position;
  system.velocity.assign(count, Vector3d::Zero());
  system.thickness.assign(count, material.thickness);
  system.drag.assign(count, material.drag);

  std::vector<double> mass(count, 0.0);
  double area = 0.0;
  const Cut cut(x, triangles, fullness);
  for (const Triangle& t : triangles) {
    const double size = 0.5 * cut.twice_area(t);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || !(size > 1e-12)) continue;
    system.sails.push_back(t);
    for (const int i : t) mass[at(i)] += material.density * size / 3.0;
    area += size;
  }
  // Slivers would make particles so light that their neighbours throw them about.
  const double least_mass = 0.2 * material.density * area / static_cast<double>(count);
  for (double& m : mass) m = std::max(m, least_mass);

  const std::vector<Edge> edges = edges_of(x, system.sails);
  const std::vector<bool> is_diagonal = diagonals(edges, system.sails.size());
  const std::vector<double> freedom = held(given_freedom, edges);
  std::vector<int> pinned;
  system.inverse_mass.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto particle = static_cast<int>(i);
    if (freedom[i] <= pinned_freedom || !(mass[i] > 0.0)) {
      system.inverse_mass[i] = 0.0;
      pinned.push_back(particle);
    } else {
      system.inverse_mass[i] = 1.0 / mass[i];
      if (freedom[i] < 1.0) system.attachments.push_back(attachment_for(particle, freedom[i], mass[i]));
    }
  }

  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Edge& edge = edges[e];
    if (is_diagonal[e]) {
      const double other = cut.length(edge.across[0], edge.across[1]);
      system.links.push_back(
          {edge.a, edge.b, cut.length(edge.a, edge.b), 1.0 / material.shear, material.damping});
      if (edge.across[0] != edge.across[1])
        system.links.push_back(
            {edge.across[0], edge.across[1], other, 1.0 / material.shear, material.damping});
    } else {
      system.links.push_back({edge.a, edge.b, cut.length(edge.a, edge.b), 1.0 / material.stretch, 0.0});
    }
    if (edge.triangles[1] >= 0 && edge.across[0] != edge.across[1])
      system.hinges.push_back(make_hinge(x, cut, edge, material));
  }
  // What joins two held particles has nothing to do.
  const auto idle = [&](int a, int b) {
    return system.inverse_mass[at(a)] + system.inverse_mass[at(b)] <= 0.0;
  };
  const LinkDistances ways = link_distances(count, system.links, pinned);
  std::erase_if(system.links, [&](const Link& link) { return idle(link.a, link.b); });
  std::erase_if(system.hinges, [&](const Hinge& h) {
    return idle(h.particles[0], h.particles[1]) && idle(h.particles[2], h.particles[3]);
  });
  sort_from_held(system.links, ways.length);
  for (std::size_t i = 0; i < count; ++i) {
    if (system.inverse_mass[i] > 0.0 && ways.source[i] >= 0)
      system.tethers.push_back({static_cast<int>(i), ways.source[i], 1.02 * ways.length[i]});
  }
  return system;
}

std::vector<double> fold_offsets(const Points& points, const std::vector<double>& fullness, double width) {
  if (std::all_of(fullness.begin(), fullness.end(), [](double f) { return f <= 1.0; })) return {};
  Eigen::RowVector3d axis = Eigen::RowVector3d::Zero();
  double weight = 0.0, around = 0.0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double full = std::max(0.0, fullness[static_cast<std::size_t>(i)] - 1.0);
    axis += full * points.row(i);
    weight += full;
  }
  axis /= weight;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (fullness[static_cast<std::size_t>(i)] > 1.0)
      around = std::max(
          around, 2.0 * std::numbers::pi * std::hypot(points(i, 0) - axis.x(), points(i, 2) - axis.z()));
  }
  const double folds = std::max(3.0, std::round(around / width));
  std::vector<double> offsets(fullness.size());
  for (std::size_t i = 0; i < fullness.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double x = points(row, 0) - axis.x(), z = points(row, 2) - axis.z();
    // A sine of amplitude a and wave length w is longer than straight by about (pi a / w)^2.
    const double wave = 2.0 * std::numbers::pi * std::hypot(x, z) / folds;
    const double amplitude = wave / std::numbers::pi * std::sqrt(std::max(0.0, fullness[i] - 1.0));
    offsets[i] = amplitude * (1.0 - std::cos(folds * std::atan2(x, z)));
  }
  return offsets;
}

Strain strain(const ParticleSystem& particles) {
  Strain result;
  std::size_t threads = 0;
  for (const Link& link : particles.links) {
    if (link.damping > 0.0 || !(link.length > 0.0)) continue;
    const double length = (particles.position[at(link.a)] - particles.position[at(link.b)]).norm();
    const double part = std::abs(length / link.length - 1.0);
    result.greatest = std::max(result.greatest, part);
    result.mean += part;
    ++threads;
  }
  if (threads > 0) result.mean /= static_cast<double>(threads);
  return result;
}

ClothLayer::ClothLayer(const BodyLayer& layer, const ClothMaterial& material,
                       std::vector<Triangle> body_triangles, const Points& body_at_rest)
    : particle_of_(merge_coincident(layer.points)), player_(std::move(body_triangles), body_at_rest.rows()) {
  std::vector<double> freedom, fullness;
  for (std::size_t v = 0; v < particle_of_.size(); ++v) {
    if (at(particle_of_[v]) == vertex_of_.size()) {
      vertex_of_.push_back(static_cast<int>(v));
      freedom.push_back(layer.freedom[v]);
      if (!layer.fullness.empty()) fullness.push_back(layer.fullness[v]);
    } else {
      freedom[at(particle_of_[v])] = std::min(freedom[at(particle_of_[v])], layer.freedom[v]);
    }
  }
  std::vector<Triangle> triangles = layer.triangles;
  for (Triangle& triangle : triangles)
    for (std::int32_t& corner : triangle) corner = particle_of_[at(corner)];
  const Points rest = gather(layer.points);
  particles_ = make_cloth(rest, triangles, freedom, material, fullness);
  folds_ = fold_offsets(rest, fullness, fold_width);
  player_.collider().move(body_at_rest);
  set_thickness(particles_, player_.collider(), material.thickness, 0.001);
}

Points ClothLayer::gather(const Points& vertices) const {
  Points result(static_cast<Eigen::Index>(vertex_of_.size()), 3);
  for (std::size_t i = 0; i < vertex_of_.size(); ++i)
    result.row(static_cast<Eigen::Index>(i)) = vertices.row(vertex_of_[i]);
  return result;
}

void ClothLayer::start(const Points& skinned, const Points& body) {
  player_.start(particles_, gather(skinned), body);
  if (folds_.empty()) return;
  const std::vector<Vector3d> normals = normals_of(particles_.position, particles_.sails);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (particles_.inverse_mass[i] > 0.0) particles_.position[i] += folds_[i] * normals[i].stableNormalized();
  }
}

void ClothLayer::advance(const Points& skinned_after, const Points& body_after,
                         const FrameSettings& settings) {
  player_.advance(particles_, gather(skinned_after), body_after, settings);
}

Points ClothLayer::points() {
  Points result(static_cast<Eigen::Index>(particle_of_.size()), 3);
  for (std::size_t v = 0; v < particle_of_.size(); ++v)
    result.row(static_cast<Eigen::Index>(v)) = particles_.position[at(particle_of_[v])];
  return result;
}

}  // namespace reprise::dynamics
