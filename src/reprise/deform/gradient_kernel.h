// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What is done per triangle, inlined into the loops of `gradients`, `reconstruct` and `blend_frames`.
// Internal.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "reprise/deform/gradient_field.h"

namespace reprise {

// Quaternion of the rotation with columns `x`, `y`, `z` (orthonormal, right-handed).
EIGEN_ALWAYS_INLINE Eigen::Quaterniond quaternion_from_axes(const Eigen::Vector3d& x,
                                                            const Eigen::Vector3d& y,
                                                            const Eigen::Vector3d& z) {
  // The matrix is linear in q q^T: every column of 4 q q^T is q times one of its components. The largest
  // component gives the best precision, and indexing instead of branching leaves nothing to mispredict.
  const double wx = y[2] - z[1], wy = z[0] - x[2], wz = x[1] - y[0];
  const double xy = x[1] + y[0], yz = y[2] + z[1], zx = z[0] + x[2];
  const double ww = 1.0 + x[0] + y[1] + z[2], xx = 1.0 + x[0] - y[1] - z[2];
  const double yy = 1.0 - x[0] + y[1] - z[2], zz = 1.0 - x[0] - y[1] + z[2];
  const Eigen::Vector4d columns[4] = {{xx, xy, zx, wx}, {xy, yy, yz, wy}, {zx, yz, zz, wz}, {wx, wy, wz, ww}};
  const int k = xx > yy ? 0 : 1;
  const int l = zz > ww ? 2 : 3;
  const double squared = std::max({xx, yy, zz, ww});
  const int largest = std::max(xx, yy) > std::max(zz, ww) ? k : l;
  return Eigen::Quaterniond(columns[largest] * (0.5 / std::sqrt(squared)));
}

// Gradients of one frame, triangle by triangle.
class GradientKernel {
 public:
  GradientKernel(const PoissonReconstruction& poisson, const PositionsView& positions)
      : poisson_(poisson), positions_(positions) {}

  EIGEN_ALWAYS_INLINE TriangleGradient operator()(std::size_t triangle_idx) {
    const Triangle& triangle = poisson_.topology_->triangles[triangle_idx];
    const Eigen::Matrix2d& inverse_edges = poisson_.reference_triangles_[triangle_idx].inverse_edges;
    const Eigen::Vector3d origin = corner(triangle[0]);
    const Eigen::Vector3d e1 = corner(triangle[1]) - origin;
    const Eigen::Vector3d e2 = corner(triangle[2]) - origin;
    const double length2 = e1.squaredNorm();
    const Eigen::Vector3d area_vector = e1.cross(e2);
    const double area2 = area_vector.squaredNorm();
    const double longest2 = std::max({length2, e2.squaredNorm(), (e2 - e1).squaredNorm()});
    // Thinner than this, rounding of the float positions decides where the normal points.
    constexpr double min_aspect = 1e-5;
    if (!(area2 > min_aspect * min_aspect * longest2 * longest2)) [[unlikely]] {
      return degenerate(triangle, e1, e2, inverse_edges);
    }
    const double double_area = std::sqrt(area2);
    const double inverse_length = 1.0 / std::sqrt(length2);
    const Eigen::Vector3d normal = area_vector / double_area;
    const Eigen::Vector3d tangent = e1 * inverse_length;
    // The edges in the tangent frame (tangent, normal x tangent) are upper triangular.
    Eigen::Matrix2d edges;
    edges << length2 * inverse_length, tangent.dot(e2), 0.0, double_area * inverse_length;
    return polar(edges * inverse_edges, tangent, normal);
  }

 private:
  Eigen::Vector3d corner(std::int32_t v) const { return positions_.row(v).cast<double>().transpose(); }

  // M = R_2 S, the in-plane gradient in the frame (tangent, normal x tangent). Its determinant is not
  // negative, so R_2 has the closed form atan2(M_10 - M_01, M_00 + M_11) and is undefined for M = 0 alone.
  EIGEN_ALWAYS_INLINE static TriangleGradient polar(const Eigen::Matrix2d& M, const Eigen::Vector3d& tangent,
                                                    const Eigen::Vector3d& normal) {
    double c = M(0, 0) + M(1, 1);
    double s = M(1, 0) - M(0, 1);
    const double norm = std::sqrt(c * c + s * s);
    if (norm > 0.0) [[likely]] {
      c /= norm;
      s /= norm;
    } else {
      c = 1.0;
      s = 0.0;
    }
    const Eigen::Vector3d binormal = normal.cross(tangent);
    return {.R = quaternion_from_axes(c * tangent + s * binormal, c * binormal - s * tangent, normal),
            .S = {c * M(0, 0) + s * M(1, 0), c * M(0, 1) + s * M(1, 1), c * M(1, 1) - s * M(0, 1)}};
  }

  // A triangle without area has its edge direction, but no normal: it takes that of its neighbourhood.
  TriangleGradient degenerate(const Triangle& triangle, const Eigen::Vector3d& e1, const Eigen::Vector3d& e2,
                              const Eigen::Matrix2d& inverse_edges);

  const PoissonReconstruction& poisson_;
  const PositionsView& positions_;
  std::optional<Positions> normals_;  // of the vertices, made for the first triangle that needs them
};

// Spherical interpolation for one alpha and many pairs of rotations.
//
// For the half angle h between two unit quaternions, sin(alpha h) / sin(h) is a smooth function of cos(h) on
// [0, 1]: one polynomial per alpha replaces an arc cosine and two sines per triangle, and has no 0/0 at equal
// rotations.
class Slerp {
 public:
  explicit Slerp(double alpha);

  // Along the shortest arc, unit length.
  Eigen::Quaterniond operator()(const Eigen::Quaterniond& source, const Eigen::Quaterniond& target) const {
    const double dot = source.dot(target);
    const double x = 2.0 * std::abs(dot) - 1.0;
    double source_weight = source_weights_.back();
    double target_weight = target_weights_.back();
    for (std::size_t k = term_count - 1; k-- > 0;) {
      source_weight = source_weight * x + source_weights_[k];
      target_weight = target_weight * x + target_weights_[k];
    }
    target_weight = std::copysign(target_weight, dot);
    return Eigen::Quaterniond(source_weight * source.coeffs() + target_weight * target.coeffs());
  }

 private:
  // The nearest singularity is at cos(h) = -1, so the error falls as 5.8^-k: below 1e-13 here.
  static constexpr std::size_t term_count = 18;
  using Polynomial = std::array<double, term_count>;  // in x = 2 cos(h) - 1
  static Polynomial fit(double alpha);

  Polynomial source_weights_;
  Polynomial target_weights_;
};

// F = R S, 3 x 2: from the reference triangle's plane to the world.
inline Eigen::Matrix<double, 3, 2> deformation_gradient(const Eigen::Quaterniond& R,
                                                        const Eigen::Vector3d& S) {
  const double x = R.x(), y = R.y(), z = R.z(), w = R.w();
  const Eigen::Vector3d r1(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
  const Eigen::Vector3d r2(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x));
  Eigen::Matrix<double, 3, 2> F;
  F.col(0) = r1 * S[0] + r2 * S[1];
  F.col(1) = r1 * S[1] + r2 * S[2];
  return F;
}

}  // namespace reprise
