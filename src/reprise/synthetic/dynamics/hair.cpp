// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/hair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "reprise/core/parallel.h"

namespace reprise::dynamics {

using Eigen::Vector3d;

namespace {

constexpr double link_reach = 1.8;      // in spacings: guides nearer than this are linked
constexpr double binding_reach = 2.2;   // in spacings: guides nearer than this move a vertex
constexpr double along_strand = 0.75;   // part of a link's length that leads away from the scalp
constexpr double vertex_gap = 0.003;    // metres that vertices keep from the body
constexpr double loose_freedom = 0.15;  // from here on vertices follow the guides alone

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Points sorted into cells, for neighbours within one cell size.
class Buckets {
 public:
  explicit Buckets(double size) : size_(size) {}
  void insert(int i, const Vector3d& p) { cells_[key(p)].push_back(i); }
  template <typename Act>
  void near(const Vector3d& p, const Act& act) const {
    const auto centre = key(p);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const auto found = cells_.find({centre[0] + x, centre[1] + y, centre[2] + z});
          if (found == cells_.end()) continue;
          for (const int i : found->second) act(i);
        }
  }

 private:
  std::array<int, 3> key(const Vector3d& p) const {
    return {static_cast<int>(std::floor(p.x() / size_)), static_cast<int>(std::floor(p.y() / size_)),
            static_cast<int>(std::floor(p.z() / size_))};
  }
  double size_;
  std::map<std::array<int, 3>, std::vector<int>> cells_;
};

Vector3d row(const Points& points, std::size_t i) {
  return points.row(static_cast<Eigen::Index>(i));
}

}  // namespace

HairLayer::HairLayer(const BodyLayer& layer, const HairMaterial& material,
                     std::vector<Triangle> body_triangles, const Points& body_at_rest)
    : player_(std::move(body_triangles), body_at_rest.rows()) {
  // Every vertex that is farther than the spacing from all guides so far becomes one.
  Buckets taken(material.spacing);
  std::vector<double> freedom;
  const auto vertices = static_cast<std::size_t>(layer.points.rows());
  for (std::size_t v = 0; v < vertices; ++v) {
    const Vector3d p = row(layer.points, v);
    bool is_free = true;
    taken.near(
        p, [&](int g) { is_free &= (p - row(layer.points, at(guides_[at(g)]))).norm() >= material.spacing; });
    if (!is_free) continue;
    taken.insert(static_cast<int>(guides_.size()), p);
    guides_.push_back(static_cast<int>(v));
    freedom.push_back(layer.freedom[v]);
  }
  const Points rest = gather(layer.points);
  const std::size_t count = guides_.size();
  particles_.position.resize(count);
  for (std::size_t g = 0; g < count; ++g) particles_.position[g] = row(rest, g);
  particles_.velocity.assign(count, Vector3d::Zero());
  particles_.drag.assign(count, material.drag);
  particles_.inverse_mass.assign(count, static_cast<double>(count) / material.mass);
  link_guides(freedom, material);
  bind_vertices(layer.points, material.spacing);
  for (const double f : layer.freedom) looseness_.push_back(std::clamp(f / loose_freedom, 0.0, 1.0));

  player_.collider().move(body_at_rest);
  set_thickness(particles_, player_.collider(), material.thickness, 0.002);
  clearance_.assign(vertices, vertex_gap);
  for (std::size_t v = 0; v < vertices; ++v) {
    std::int32_t triangle = player_.collider().find(row(layer.points, v))[0];
    if (triangle < 0) continue;
    const Touch touch = player_.collider().touch(row(layer.points, v), triangle);
    if (touch.valid) clearance_[v] = std::clamp(touch.distance, -vertex_gap, vertex_gap);
  }
}

void HairLayer::link_guides(const std::vector<double>& freedom, const HairMaterial& material) {
  const std::size_t count = guides_.size();
  const double reach = link_reach * material.spacing;
  const double mass = material.mass / static_cast<double>(count);
  Buckets buckets(reach);
  neighbours_.resize(count);
  std::vector<Link> all;
  for (std::size_t g = 0; g < count; ++g) {
    const Vector3d& p = particles_.position[g];
    std::vector<int> near;
    buckets.near(p, [&](int other) {
      if ((particles_.position[at(other)] - p).norm() < reach) near.push_back(other);
    });
    std::sort(near.begin(), near.end());
    for (const int other : near) {
      all.push_back({other, static_cast<int>(g), (particles_.position[at(other)] - p).norm(), 0.0, 0.0});
      neighbours_[g].push_back(other);
      neighbours_[at(other)].push_back(static_cast<int>(g));
    }
    buckets.insert(static_cast<int>(g), p);
  }
  std::vector<int> roots;
  for (std::size_t g = 0; g < count; ++g) {
    if (freedom[g] <= pinned_freedom) roots.push_back(static_cast<int>(g));
  }
  const LinkDistances ways = link_distances(count, all, roots);
  for (std::size_t g = 0; g < count; ++g) {
    const auto guide = static_cast<int>(g);
    if (freedom[g] <= pinned_freedom || ways.source[g] < 0) {
      particles_.inverse_mass[g] = 0.0;
    } else {
      Attachment attachment = attachment_for(guide, freedom[g], mass);
      const double combed = 1.0 / (mass * material.combing * material.combing);
      if (attachment.compliance > combed) attachment = {guide, combed, 1.0 / material.combing};
      particles_.attachments.push_back(attachment);
      particles_.tethers.push_back({guide, ways.source[g], 1.01 * ways.length[g]});
    }
  }
  const auto spring = [&](double rate) { return 1.0 / (mass * rate * rate); };
  for (Link& link : all) {
    if (particles_.inverse_mass[at(link.a)] + particles_.inverse_mass[at(link.b)] <= 0.0) continue;
    const double down = std::abs(ways.length[at(link.a)] - ways.length[at(link.b)]);
    if (down < along_strand * link.length) {
      link.compliance = spring(material.cohesion);
      link.damping = material.damping;
    }
    particles_.links.push_back(link);
  }
  // Bending: a strand of three links resists being folded up.
  for (std::size_t g = 0; g < count; ++g) {
    int back = ways.previous[g];
    for (int step = 0; step < 2 && back >= 0; ++step) back = ways.previous[at(back)];
    if (back < 0 || particles_.inverse_mass[g] <= 0.0) continue;
    const double length = (particles_.position[g] - particles_.position[at(back)]).norm();
    particles_.links.push_back(
        {back, static_cast<int>(g), length, spring(material.bending), material.damping});
  }
  std::stable_sort(particles_.links.begin(), particles_.links.end(), [&](const Link& l, const Link& r) {
    return std::min(ways.length[at(l.a)], ways.length[at(l.b)]) <
           std::min(ways.length[at(r.a)], ways.length[at(r.b)]);
  });
}

void HairLayer::bind_vertices(const Points& rest, double spacing) {
  const double reach = binding_reach * spacing;
  Buckets buckets(reach);
  for (std::size_t g = 0; g < guides_.size(); ++g)
    buckets.insert(static_cast<int>(g), row(rest, at(guides_[g])));
  binding_begin_.push_back(0);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const Vector3d p = rest.row(v);
    double sum = 0.0;
    buckets.near(p, [&](int g) {
      const double squared = (row(rest, at(guides_[at(g)])) - p).squaredNorm() / (reach * reach);
      if (squared >= 1.0) return;
      bindings_.push_back({g, (1.0 - squared) * (1.0 - squared)});
      sum += bindings_.back().weight;
    });
    for (std::size_t i = at(binding_begin_.back()); i < bindings_.size(); ++i) bindings_[i].weight /= sum;
    binding_begin_.push_back(static_cast<int>(bindings_.size()));
  }
}

Points HairLayer::gather(const Points& vertices) const {
  Points result(static_cast<Eigen::Index>(guides_.size()), 3);
  for (std::size_t g = 0; g < guides_.size(); ++g)
    result.row(static_cast<Eigen::Index>(g)) = vertices.row(guides_[g]);
  return result;
}

void HairLayer::start(const Points& skinned, const Points& body) {
  skinned_.start(skinned);
  player_.start(particles_, gather(skinned), body);
}

void HairLayer::advance(const Points& skinned_after, const Points& body_after,
                        const FrameSettings& settings) {
  skinned_.advance(skinned_after);
  player_.advance(particles_, gather(skinned_after), body_after, settings);
}

// How each guide is turned against its skinned place, from where its neighbours went.
std::vector<Eigen::Matrix3d> HairLayer::guide_rotations(const Points& skinned_guides) const {
  std::vector<Eigen::Matrix3d> rotations(guides_.size(), Eigen::Matrix3d::Identity());
  parallel_for(
      0, guides_.size(),
      [&](std::size_t g) {
        if (particles_.inverse_mass[g] <= 0.0) return;
        // A touch of identity decides what a flat neighbourhood leaves open.
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        double size = 0.0;
        for (const int n : neighbours_[g]) {
          const Vector3d there = row(skinned_guides, at(n)) - row(skinned_guides, g);
          moments += (particles_.position[at(n)] - particles_.position[g]) * there.transpose();
          size += there.squaredNorm();
        }
        moments += 1e-2 * size * Eigen::Matrix3d::Identity();
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
        Vector3d signs = Vector3d::Ones();
        signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
        rotations[g] = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
      },
      64);
  return rotations;
}

Points HairLayer::points() {
  const Points& skinned = skinned_.end();
  const Points skinned_guides = gather(skinned);
  const std::vector<Eigen::Matrix3d> rotations = guide_rotations(skinned_guides);
  Points result(skinned.rows(), 3);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t v = 0; v < looseness_.size(); ++v) {
    const Vector3d place = row(skinned, v);
    Vector3d followed = Vector3d::Zero();
    for (int i = binding_begin_[v]; i < binding_begin_[v + 1]; ++i) {
      const auto& [guide, weight] = bindings_[at(i)];
      followed += weight * (particles_.position[at(guide)] +
                            rotations[at(guide)] * (place - row(skinned_guides, at(guide))));
    }
    const Vector3d p = place + looseness_[v] * (followed - place);
    result.row(static_cast<Eigen::Index>(v)) = p;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // Guides keep off the body; between them a vertex may still dip into a shoulder.
  BodyCollider& body = player_.collider();
  body.prepare_search(low, high, 0.02);
  parallel_for(
      0, looseness_.size(),
      [&](std::size_t v) {
        if (looseness_[v] <= 0.0) return;
        const Vector3d p = row(result, v);
        std::int32_t triangle = body.find(p)[0];
        if (triangle < 0) return;
        const Touch touch = body.touch(p, triangle);
        if (touch.valid && touch.distance < clearance_[v])
          result.row(static_cast<Eigen::Index>(v)) +=
              looseness_[v] * (clearance_[v] - touch.distance) * touch.normal.transpose();
      },
      128);
  return result;
}

}  // namespace reprise::dynamics
