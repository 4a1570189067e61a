// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/tailor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace reprise::body {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Triangles whose texture coordinates are connected.
struct Piece {
  std::vector<std::size_t> triangles;
};

std::vector<Piece> pieces_of(const BodyLayer& layer) {
  std::vector<std::int32_t> root(layer.uvs.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int32_t i) {
    while (root[static_cast<std::size_t>(i)] != i) {
      const std::int32_t above = root[static_cast<std::size_t>(i)];
      i = root[static_cast<std::size_t>(i)] = root[static_cast<std::size_t>(above)];
    }
    return i;
  };
  for (const Triangle& uvs : layer.triangle_uvs) {
    for (std::size_t k = 1; k < 3; ++k) {
      const std::int32_t a = find(uvs[0]), b = find(uvs[k]);
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::vector<int> piece_of_root(layer.uvs.size(), -1);
  std::vector<Piece> pieces;
  for (std::size_t t = 0; t < layer.triangle_uvs.size(); ++t) {
    int& piece = piece_of_root[static_cast<std::size_t>(find(layer.triangle_uvs[t][0]))];
    if (piece < 0) {
      piece = static_cast<int>(pieces.size());
      pieces.emplace_back();
    }
    pieces[static_cast<std::size_t>(piece)].triangles.push_back(t);
  }
  return pieces;
}

// One piece with its own numbering of texture coordinates.
class FlatPiece {
 public:
  FlatPiece(const BodyLayer& layer, const Piece& piece, std::vector<int>& local_idx) {
    for (const std::size_t t : piece.triangles) {
      const Triangle& uvs = layer.triangle_uvs[t];
      const Triangle& corners = layer.triangles[t];
      Part part;
      std::array<Vector3d, 3> x;
      std::array<Vector2d, 3> uv;
      for (std::size_t k = 0; k < 3; ++k) {
        int& local = local_idx[static_cast<std::size_t>(uvs[k])];
        if (local < 0) {
          local = static_cast<int>(places_.size());
          uv_idx_.push_back(uvs[k]);
          const auto& place = layer.uvs[static_cast<std::size_t>(uvs[k])];
          places_.emplace_back(place[0], place[1]);
          heights_.push_back(layer.points(corners[k], 1));
        }
        part.corners[k] = local;
        x[k] = layer.points.row(corners[k]).transpose();
        uv[k] = places_[static_cast<std::size_t>(local)];
      }
      // The triangle in its own plane, counter-clockwise as in the texture.
      const Vector3d e1 = x[1] - x[0], e2 = x[2] - x[0];
      const double length = e1.norm(), height = length > 1e-9 ? e1.cross(e2).norm() / length : 0.0;
      if (length < 1e-7 || height < 1e-7) continue;
      const double along = e1.dot(e2) / length;
      const double side =
          (uv[1] - uv[0]).x() * (uv[2] - uv[0]).y() - (uv[1] - uv[0]).y() * (uv[2] - uv[0]).x();
      part.flat = {Vector2d::Zero(), Vector2d(length, 0.0), Vector2d(along, side < 0.0 ? -height : height)};
      part.area = 0.5 * length * height;
      for (std::size_t k = 0; k < 3; ++k) {  // cotangent at corner k, of the edge opposite to it
        const Vector2d a = part.flat[(k + 1) % 3] - part.flat[k], b = part.flat[(k + 2) % 3] - part.flat[k];
        const double cotangent = a.dot(b) / (2.0 * part.area);
        part.cotangents[k] = std::clamp(cotangent, 0.02, 20.0);
      }
      parts_.push_back(part);
    }
  }

  void make_true_size() {
    if (parts_.empty()) return;
    start_affine();
    flatten();
    turn_upright();
  }

  const std::vector<std::int32_t>& uv_idx() const { return uv_idx_; }
  const std::vector<Vector2d>& places() const { return places_; }

 private:
  struct Part {
    std::array<int, 3> corners{};
    std::array<Vector2d, 3> flat;
    std::array<double, 3> cotangents{};
    double area = 0.0;
  };

  const Vector2d& place(int i) const { return places_[static_cast<std::size_t>(i)]; }

  // The matrix that takes differences of `flat` to differences of the places.
  Matrix2d gradient(const Part& part) const {
    Matrix2d from, to;
    for (int k = 0; k < 2; ++k) {
      from.col(k) = part.flat[static_cast<std::size_t>(k) + 1] - part.flat[0];
      to.col(k) = place(part.corners[static_cast<std::size_t>(k) + 1]) - place(part.corners[0]);
    }
    return to * from.inverse();
  }

  // The texture coordinates stretched to the piece's mean size in both directions.
  void start_affine() {
    Matrix2d metric = Matrix2d::Zero();
    double total = 0.0;
    for (const Part& part : parts_) {
      const Matrix2d uv_from_flat = gradient(part);
      if (std::abs(uv_from_flat.determinant()) < 1e-12) continue;
      const Matrix2d flat_from_uv = uv_from_flat.inverse();
      metric += part.area * flat_from_uv.transpose() * flat_from_uv;
      total += part.area;
    }
    if (total <= 0.0) return;
    metric /= total;
    const Vector2d scale(std::sqrt(metric(0, 0)), std::sqrt(metric(1, 1)));
    for (Vector2d& p : places_) p = p.cwiseProduct(scale).eval();
  }

  void flatten() {
    constexpr int rounds = 30;
    const auto count = static_cast<Eigen::Index>(places_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (const Part& part : parts_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int i = part.corners[(k + 1) % 3], j = part.corners[(k + 2) % 3];
        const double w = part.cotangents[k];
        entries.emplace_back(i, i, w);
        entries.emplace_back(j, j, w);
        entries.emplace_back(i, j, -w);
        entries.emplace_back(j, i, -w);
      }
    }
    // Holds the piece where it is; far too weak to bend it.
    for (Eigen::Index i = 0; i < count; ++i) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1e-6);
    }
    Eigen::SparseMatrix<double> L(count, count);
    L.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(L);
    if (solver.info() != Eigen::Success) return;
    for (int round = 0; round < rounds; ++round) {
      Eigen::Matrix<double, Eigen::Dynamic, 2> b(count, 2);
      for (Eigen::Index i = 0; i < count; ++i) b.row(i) = 1e-6 * place(static_cast<int>(i)).transpose();
      for (const Part& part : parts_) {
        Matrix2d covariance = Matrix2d::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
          covariance += part.cotangents[k] * (place(part.corners[i]) - place(part.corners[j])) *
                        (part.flat[i] - part.flat[j]).transpose();
        }
        // The rotation nearest to it.
        const double angle =
            std::atan2(covariance(1, 0) - covariance(0, 1), covariance(0, 0) + covariance(1, 1));
        const Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
          const Vector2d edge = part.cotangents[k] * (R * (part.flat[i] - part.flat[j]));
          b.row(part.corners[i]) += edge.transpose();
          b.row(part.corners[j]) -= edge.transpose();
        }
      }
      const Eigen::Matrix<double, Eigen::Dynamic, 2> x = solver.solve(b);
      for (Eigen::Index i = 0; i < count; ++i) {
        places_[static_cast<std::size_t>(i)] = x.row(i).transpose();
      }
    }
  }

  void turn_upright() {
    Vector2d up = Vector2d::Zero(), centre = Vector2d::Zero();
    double height = 0.0, total = 0.0;
    for (const Part& part : parts_) {
      Matrix2d edges;
      Vector2d rise;
      for (int k = 0; k < 2; ++k) {
        const int corner = part.corners[static_cast<std::size_t>(k) + 1];
        edges.row(k) = (place(corner) - place(part.corners[0])).transpose();
        rise[k] =
            heights_[static_cast<std::size_t>(corner)] - heights_[static_cast<std::size_t>(part.corners[0])];
      }
      if (std::abs(edges.determinant()) > 1e-12) up += part.area * (edges.inverse() * rise);
      for (const int corner : part.corners) {
        centre += part.area / 3.0 * place(corner);
        height += part.area / 3.0 * heights_[static_cast<std::size_t>(corner)];
      }
      total += part.area;
    }
    centre /= total;
    height /= total;
    if (up.norm() < 1e-9) up = Vector2d::UnitY();
    up.normalize();
    for (Vector2d& p : places_) {
      const Vector2d d = p - centre;
      p = {d.x() * up.y() - d.y() * up.x(), d.dot(up) + height};
    }
  }

  std::vector<std::int32_t> uv_idx_;
  std::vector<Vector2d> places_;
  std::vector<double> heights_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<Eigen::Vector2d> cloth_coordinates(const BodyLayer& layer) {
  std::vector<Vector2d> coordinates(layer.uvs.size(), Vector2d::Zero());
  std::vector<int> local_idx(layer.uvs.size(), -1);
  for (const Piece& piece : pieces_of(layer)) {
    FlatPiece flat(layer, piece, local_idx);
    flat.make_true_size();
    for (std::size_t i = 0; i < flat.uv_idx().size(); ++i) {
      coordinates[static_cast<std::size_t>(flat.uv_idx()[i])] = flat.places()[i];
    }
  }
  return coordinates;
}

}  // namespace reprise::body
