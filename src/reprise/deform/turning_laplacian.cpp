// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/turning_laplacian.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "reprise/deform/gradient_kernel.h"

namespace reprise {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Every connected component but the one of most vertices, with the vertex of that one which is nearest.
std::vector<PartHierarchy::LooseComponent> loose_components(const TopologyPtr& topology,
                                                            const PositionsView& reference) {
  const ConnectedComponents components = connected_components(*topology);
  std::vector<std::vector<std::int32_t>> members(static_cast<std::size_t>(components.count));
  for (std::size_t v = 0; v < components.of_vertex.size(); ++v)
    members[static_cast<std::size_t>(components.of_vertex[v])].push_back(static_cast<std::int32_t>(v));
  const auto held = std::ranges::max_element(members, {}, &std::vector<std::int32_t>::size);
  std::vector<PartHierarchy::LooseComponent> loose;
  for (auto member = members.begin(); member != members.end(); ++member) {
    if (member == held) continue;
    std::int32_t carrier = held->front();
    float least = std::numeric_limits<float>::infinity();
    for (const std::int32_t v : *member) {
      for (const std::int32_t candidate : *held) {
        const float distance = (reference.row(v) - reference.row(candidate)).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        carrier = candidate;
      }
    }
    loose.push_back({.vertices = std::move(*member), .carrier = carrier});
  }
  return loose;
}

// Edges of a triangle in its tangent frame: e1 = a tangent, e2 = b tangent + c binormal.
struct LaidTriangle {
  Vector3d tangent, binormal;
  double a = 0.0, b = 0.0, c = 0.0;
};

// Without area any plane through the longest edge will do.
LaidTriangle lay_without_area(const Vector3d& e1, const Vector3d& e2) {
  const Vector3d& longer = e1.squaredNorm() < e2.squaredNorm() ? e2 : e1;
  LaidTriangle laid;
  laid.tangent = longer.norm() > 0.0 ? Vector3d(longer.normalized()) : Vector3d::UnitX();
  laid.binormal = laid.tangent.unitOrthogonal();
  laid.a = laid.tangent.dot(e1);
  laid.b = laid.tangent.dot(e2);
  return laid;
}

EIGEN_ALWAYS_INLINE LaidTriangle lay(const Vector3d& e1, const Vector3d& e2) {
  const Vector3d area_vector = e1.cross(e2);
  const double area2 = area_vector.squaredNorm();
  const double length2 = e1.squaredNorm();
  if (!(area2 > 1e-20 * length2 * e2.squaredNorm())) [[unlikely]] {
    return lay_without_area(e1, e2);
  }
  LaidTriangle laid;
  laid.a = std::sqrt(length2);
  laid.tangent = e1 / laid.a;
  laid.binormal = area_vector.cross(laid.tangent) / std::sqrt(area2);
  laid.b = laid.tangent.dot(e2);
  laid.c = laid.binormal.dot(e2);
  return laid;
}

// Cosine and sine of the turn in the plane that takes the edges of `from` to those of `to` best.
struct Turn {
  double c = 1.0, s = 0.0;
};
template <typename From>
EIGEN_ALWAYS_INLINE Turn turn(const From& from, const LaidTriangle& to) {
  const double db = from.b - from.a;
  const double to_db = to.b - to.a;
  Turn turn;
  turn.c = to.a * from.a + to.b * from.b + to_db * db + 2.0 * to.c * from.c;
  turn.s = to.c * from.b - to.b * from.c + to.c * db - to_db * from.c;
  const double norm = std::sqrt(turn.c * turn.c + turn.s * turn.s);
  if (!(norm > 0.0)) [[unlikely]] {
    return {};
  }
  turn.c /= norm;
  turn.s /= norm;
  return turn;
}

// q and -q are the same rotation: the mean takes the nearer one.
EIGEN_ALWAYS_INLINE void add(double weight, const Quaterniond& rotation, Quaterniond& sum) {
  sum.coeffs() += std::copysign(weight, sum.dot(rotation)) * rotation.coeffs();
}

EIGEN_ALWAYS_INLINE void normalize(Quaterniond& sum) {
  const double norm = sum.norm();
  if (norm > 0.0) [[likely]] {
    sum.coeffs() /= norm;
  } else {
    sum.setIdentity();
  }
}

Vector3d edge(const Coordinates& positions, std::int32_t from, std::int32_t to) {
  return (positions.row(to) - positions.row(from)).transpose();
}

}  // namespace

TurningLaplacian::TurningLaplacian(const TopologyPtr& topology, const PositionsView& reference)
    : TurningLaplacian(topology, reference, PoissonReconstruction(topology, reference)) {}

TurningLaplacian::TurningLaplacian(const TopologyPtr& topology, const PositionsView& reference,
                                   const PoissonReconstruction& poisson)
    : topology_(topology),
      loose_(loose_components(topology, reference)),
      laplacian_(topology, reference, loose_) {
  const std::vector<Triangle>& triangles = topology_->triangles;
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(topology_->vertex_count);
  elements_.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Matrix3d K = poisson.element_laplacian(t);
    elements_.push_back({.k11 = K(1, 1), .k12 = K(1, 2), .k22 = K(2, 2)});
    for (std::size_t k = 0; k < 3; ++k)
      diagonal[triangles[t][k]] += K(static_cast<int>(k), static_cast<int>(k));
  }
  // The operator itself tells how it is scaled. A vertex without triangles has no coordinates.
  scale_ = laplacian_.matrix().diagonal();
  for (Eigen::Index v = 0; v < scale_.size(); ++v) {
    if (diagonal[v] > 0.0) scale_[v] /= diagonal[v];
  }
}

void TurningLaplacian::set_frame(const Coordinates& frame) {
  delta_ = laplacian_(frame);
  triangles_.resize(topology_->triangles.size());
  double total = 0.0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& triangle = topology_->triangles[t];
    FrameTriangle& one = triangles_[t];
    one.e1 = edge(frame, triangle[0], triangle[1]);
    one.e2 = edge(frame, triangle[0], triangle[2]);
    const LaidTriangle laid = lay(one.e1, one.e2);
    one.a = laid.a;
    one.b = laid.b;
    one.c = laid.c;
    one.weight = laid.a * laid.c;
    one.tangent_from_world =
        quaternion_from_axes(laid.tangent, laid.binormal, laid.tangent.cross(laid.binormal)).conjugate();
    total += one.weight;
  }
  // Where there are none but triangles without area, those have to do.
  const double least = total > 0.0 ? 1e-6 * total / static_cast<double>(triangles_.size()) : 1.0;
  for (FrameTriangle& one : triangles_) one.weight += least;
}

void TurningLaplacian::find_turns(const Coordinates& positions) {
  turns_.assign(static_cast<std::size_t>(positions.rows()), Quaterniond(0.0, 0.0, 0.0, 0.0));
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& triangle = topology_->triangles[t];
    const FrameTriangle& one = triangles_[t];
    const LaidTriangle laid =
        lay(edge(positions, triangle[0], triangle[1]), edge(positions, triangle[0], triangle[2]));
    const Turn in_plane = turn(one, laid);
    const Vector3d tangent = in_plane.c * laid.tangent + in_plane.s * laid.binormal;
    const Vector3d binormal = in_plane.c * laid.binormal - in_plane.s * laid.tangent;
    const Quaterniond rotation =
        quaternion_from_axes(tangent, binormal, tangent.cross(binormal)) * one.tangent_from_world;
    for (const std::int32_t v : triangle) add(one.weight, rotation, turns_[static_cast<std::size_t>(v)]);
  }
  for (Quaterniond& turn : turns_) normalize(turn);
}

void TurningLaplacian::residual(const Coordinates& positions, Coordinates& out) {
  find_turns(positions);
  const Eigen::Index n = positions.rows();
  out.setZero(laplacian_.rows(), 3);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& triangle = topology_->triangles[t];
    const FrameTriangle& one = triangles_[t];
    Quaterniond sum = turns_[static_cast<std::size_t>(triangle[0])];
    add(1.0, turns_[static_cast<std::size_t>(triangle[1])], sum);
    add(1.0, turns_[static_cast<std::size_t>(triangle[2])], sum);
    normalize(sum);
    const Matrix3d R = sum.toRotationMatrix();
    // L x - G^T A (R F_s), by the edges: K has no say in where a triangle is.
    const Vector3d strain1 = edge(positions, triangle[0], triangle[1]) - R * one.e1;
    const Vector3d strain2 = edge(positions, triangle[0], triangle[2]) - R * one.e2;
    const Element& K = elements_[t];
    const Vector3d row1 = K.k11 * strain1 + K.k12 * strain2;
    const Vector3d row2 = K.k12 * strain1 + K.k22 * strain2;
    out.row(triangle[0]) -= (row1 + row2).transpose();
    out.row(triangle[1]) += row1.transpose();
    out.row(triangle[2]) += row2.transpose();
  }
  out.topRows(n).array().colwise() *= scale_.array();
  if (loose_.empty()) return;

  Eigen::Index row = n;
  out.bottomRows(out.rows() - n) = laplacian_(positions).bottomRows(out.rows() - n);
  for (const PartHierarchy::LooseComponent& component : loose_) {
    const Matrix3d R = turns_[static_cast<std::size_t>(component.carrier)].toRotationMatrix();
    for (std::size_t i = 0; i < component.vertices.size(); ++i, ++row)
      out.row(row) -= (R * delta_.row(row).transpose()).transpose();
  }
}

}  // namespace reprise
