// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/leg_weights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "reprise/linalg/sparse_cholesky.h"

namespace reprise {
namespace {

struct Link {
  std::int32_t a = 0;
  std::int32_t b = 0;
  double weight = 0.0;
};

// Half the cotangent of the angle across from each edge, once a triangle.
std::vector<Link> surface_links(const Topology& topology, const PositionsView& positions) {
  constexpr double least = 0.05;  // keeps obtuse and thin triangles from pushing their neighbours apart
  constexpr double most = 5.0;
  std::vector<Link> links;
  links.reserve(3 * topology.triangles.size());
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      const auto apex = positions.row(triangle[(k + 2) % 3]).cast<double>();
      const Eigen::Vector3d p = (positions.row(a).cast<double>() - apex).transpose();
      const Eigen::Vector3d q = (positions.row(b).cast<double>() - apex).transpose();
      const double area = p.cross(q).norm();
      const double cotangent = area > 0.0 ? p.dot(q) / area : most;
      links.push_back({a, b, 0.5 * std::clamp(cotangent, least, most)});
    }
  }
  return links;
}

// Springs from each piece of the surface to the nearest other pieces within reach.
std::vector<Link> piece_links(const Topology& topology, const PositionsView& positions) {
  constexpr float reach = 0.03F;  // metres
  const ConnectedComponents pieces = connected_components(topology);
  std::vector<Link> links;
  if (pieces.count < 2) return links;
  // Vertices in order of x: what is near in space is near in this order.
  std::vector<std::int32_t> by_x(static_cast<std::size_t>(topology.vertex_count));
  for (std::size_t i = 0; i < by_x.size(); ++i) by_x[i] = static_cast<std::int32_t>(i);
  std::ranges::sort(by_x, [&](std::int32_t a, std::int32_t b) {
    return std::pair(positions(a, 0), a) < std::pair(positions(b, 0), b);
  });
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const std::int32_t v = by_x[i];
    std::int32_t nearest = -1;
    float distance = reach;
    const auto look_at = [&](std::int32_t other) {
      if (pieces.of_vertex[static_cast<std::size_t>(v)] == pieces.of_vertex[static_cast<std::size_t>(other)])
        return;
      const float d = (positions.row(v) - positions.row(other)).norm();
      if (d < distance || (d == distance && other < nearest)) {
        distance = d;
        nearest = other;
      }
    };
    for (std::size_t j = i; j-- > 0 && positions(v, 0) - positions(by_x[j], 0) <= reach;) look_at(by_x[j]);
    for (std::size_t j = i + 1; j < by_x.size() && positions(by_x[j], 0) - positions(v, 0) <= reach; ++j)
      look_at(by_x[j]);
    if (nearest >= 0) links.push_back({v, nearest, 1.0});
  }
  return links;
}

}  // namespace

Eigen::MatrixXd leg_weights(const PerformanceDatabase& database, const GroundContacts& contacts) {
  const Topology& topology = *database.topology();
  const auto foot_count = static_cast<Eigen::Index>(contacts.feet().size());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(topology.vertex_count, foot_count);
  if (foot_count == 0) return weights;

  constexpr std::int32_t fixed = -1;
  std::vector<std::int32_t> unknown(static_cast<std::size_t>(topology.vertex_count), 0);
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    if (contacts.mean_heights()[v] > hip_share * contacts.stature()) unknown[v] = fixed;
  }
  for (Eigen::Index foot = 0; foot < foot_count; ++foot) {
    for (const std::int32_t v : contacts.feet()[static_cast<std::size_t>(foot)]) {
      unknown[static_cast<std::size_t>(v)] = fixed;
      weights(v, foot) = 1.0;
    }
  }
  std::int32_t unknown_count = 0;
  for (std::int32_t& index : unknown) {
    if (index != fixed) index = unknown_count++;
  }
  if (unknown_count == 0) return weights;

  // What nothing fixes (a piece of surface that hangs on nothing) is pulled to zero by the last term.
  constexpr double pull = 1e-9;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int32_t i = 0; i < unknown_count; ++i) entries.emplace_back(i, i, pull);
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(unknown_count, foot_count);
  std::vector<Link> links = surface_links(topology, database.clip(0).frame(0));
  const std::vector<Link> more = piece_links(topology, database.clip(0).frame(0));
  links.insert(links.end(), more.begin(), more.end());
  for (const Link& link : links) {
    for (const auto& [v, other] : {std::pair(link.a, link.b), std::pair(link.b, link.a)}) {
      const std::int32_t row = unknown[static_cast<std::size_t>(v)];
      const std::int32_t column = unknown[static_cast<std::size_t>(other)];
      if (row == fixed) continue;
      entries.emplace_back(row, row, link.weight);
      if (column == fixed) {
        b.row(row) += link.weight * weights.row(other);
      } else {
        entries.emplace_back(row, column, -link.weight);
      }
    }
  }
  Eigen::SparseMatrix<double> L(unknown_count, unknown_count);
  L.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd x = SparseCholesky(L).solve(b);

  constexpr double negligible = 1e-3;  // a foot's shift is centimetres, and a capture not exact to 0.1 mm
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    if (unknown[v] == fixed) continue;
    for (Eigen::Index foot = 0; foot < foot_count; ++foot) {
      const double w = std::clamp(x(unknown[v], foot), 0.0, 1.0);
      weights(static_cast<Eigen::Index>(v), foot) = w < negligible ? 0.0 : w * w * (3.0 - 2.0 * w);
    }
  }
  return weights;
}

}  // namespace reprise
