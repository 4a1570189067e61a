// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/vertex_metric.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"

namespace reprise {
namespace {

// Frames of a tile and vertices of a block: the two tiles of a product (3 x 64 x 512 float64 each) stay in
// the cache.
constexpr std::size_t tile_frames = 64;
constexpr Eigen::Index block_vertices = 512;
// Below this share of the sums, the difference of the sums has lost too many digits: taken anew from the
// vertices.
constexpr double cancellation_share = 1e-9;

using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// What a frame contributes to every pair it is in.
struct FrameSums {
  Eigen::Vector3d origin;   // horizontal centroid, and a height common to all frames
  double horizontal = 0.0;  // sum |z + i x|^2 about the origin
  double vertical = 0.0;    // sum y^2 about the origin
};

Eigen::Vector3d horizontal_centroid(const PositionsView& positions) {
  Eigen::Vector3d c = centroid(positions);
  c.y() = 0.0;
  return c;
}

FrameSums frame_sums(const PositionsView& positions, double height) {
  FrameSums sums{.origin = horizontal_centroid(positions)};
  sums.origin.y() = height;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    const Eigen::Vector3d p = positions.row(v).transpose().cast<double>() - sums.origin;
    sums.horizontal += p.x() * p.x() + p.z() * p.z();
    sums.vertical += p.y() * p.y();
  }
  return sums;
}

// The frames of one tile about their origins, block after block of vertices.
class Tile {
 public:
  Tile(std::span<const PositionsView> frames, const std::vector<FrameSums>& sums, std::size_t tile_idx)
      : first_(tile_idx * tile_frames),
        sums_(&sums),
        frames_(frames.subspan(first_, std::min(tile_frames, frames.size() - first_))) {
    zx_.resize(size(), 2 * block_vertices);
    y_.resize(size(), block_vertices);
  }

  std::size_t first() const { return first_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(frames_.size()); }

  void load(Eigen::Index first_vertex, Eigen::Index count) {
    for (Eigen::Index f = 0; f < size(); ++f) {
      const PositionsView& positions = frames_[static_cast<std::size_t>(f)];
      const Eigen::Vector3d& origin = (*sums_)[first_ + static_cast<std::size_t>(f)].origin;
      for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Index v = first_vertex + k;
        zx_(f, k) = static_cast<double>(positions(v, 2)) - origin.z();
        zx_(f, count + k) = static_cast<double>(positions(v, 0)) - origin.x();
        y_(f, k) = static_cast<double>(positions(v, 1)) - origin.y();
      }
    }
  }

  auto zx(Eigen::Index count) const { return zx_.leftCols(2 * count); }
  auto z(Eigen::Index count) const { return zx_.leftCols(count); }
  auto x(Eigen::Index count) const { return zx_.middleCols(count, count); }
  auto y(Eigen::Index count) const { return y_.leftCols(count); }

 private:
  std::size_t first_;
  const std::vector<FrameSums>* sums_;
  std::span<const PositionsView> frames_;
  Table zx_;  // frames x (z of the block, then x of the block)
  Table y_;
};

// Dissimilarities of all pairs a < b of two tiles.
void compare_tiles(std::span<const PositionsView> frames, const std::vector<FrameSums>& sums,
                   std::size_t tile_a, std::size_t tile_b, DissimilarityMatrix& matrix) {
  Tile A(frames, sums, tile_a);
  Tile B(frames, sums, tile_b);
  // H(a, b) = sum_v conj(b_v) a_v with z + i x about the centroid, and Y(a, b) = sum_v y_a y_b.
  Table H_real = Table::Zero(A.size(), B.size());
  Table H_imag = Table::Zero(A.size(), B.size());
  Table Y = Table::Zero(A.size(), B.size());
  const Eigen::Index vertex_count = frames.front().rows();
  for (Eigen::Index first = 0; first < vertex_count; first += block_vertices) {
    const Eigen::Index count = std::min(block_vertices, vertex_count - first);
    A.load(first, count);
    B.load(first, count);
    H_real.noalias() += A.zx(count) * B.zx(count).transpose();
    H_imag.noalias() += A.x(count) * B.z(count).transpose();
    H_imag.noalias() -= A.z(count) * B.x(count).transpose();
    Y.noalias() += A.y(count) * B.y(count).transpose();
  }
  const auto N = static_cast<double>(vertex_count);
  for (Eigen::Index i = 0; i < A.size(); ++i) {
    const std::size_t a = A.first() + static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < B.size(); ++j) {
      const std::size_t b = B.first() + static_cast<std::size_t>(j);
      if (a >= b) continue;
      const double whole = sums[a].horizontal + sums[b].horizontal + sums[a].vertical + sums[b].vertical;
      const double rest = whole - 2.0 * std::hypot(H_real(i, j), H_imag(i, j)) - 2.0 * Y(i, j);
      if (rest < cancellation_share * whole) {
        const GroundAlignment alignment = align_on_ground(frames[a], frames[b]);
        matrix.set(a, b, static_cast<float>(alignment.rms_distance),
                   static_cast<float>(alignment.a_from_b.yaw));
      } else {
        matrix.set(a, b, static_cast<float>(std::sqrt(rest / N)),
                   static_cast<float>(std::atan2(H_imag(i, j), H_real(i, j))));
      }
    }
  }
}

}  // namespace

GroundAlignment align_on_ground(const PositionsView& a, const PositionsView& b) {
  if (a.rows() != b.rows() || a.rows() == 0) {
    throw InvalidArgument(
        fmt::format("alignment on the ground of {} and {} vertices: expected equal numbers of at least one",
                    a.rows(), b.rows()));
  }
  const Eigen::Vector3d centre_a = horizontal_centroid(a);
  const Eigen::Vector3d centre_b = horizontal_centroid(b);
  std::complex<double> H = 0.0;
  for (Eigen::Index v = 0; v < a.rows(); ++v) {
    const std::complex<double> p(a(v, 2) - centre_a.z(), a(v, 0) - centre_a.x());
    const std::complex<double> q(b(v, 2) - centre_b.z(), b(v, 0) - centre_b.x());
    H += std::complex<double>(q.real() * p.real() + q.imag() * p.imag(),
                              q.real() * p.imag() - q.imag() * p.real());
  }
  GroundAlignment alignment;
  alignment.a_from_b.yaw = std::arg(H);
  const Eigen::Vector3d turned = alignment.a_from_b * centre_b;  // the translation is still zero
  alignment.a_from_b.translation = {centre_a.x() - turned.x(), centre_a.z() - turned.z()};

  const Eigen::Matrix3d R = alignment.a_from_b.rotation();
  double sum = 0.0;
  for (Eigen::Index v = 0; v < a.rows(); ++v) {
    const Eigen::Vector3d p = a.row(v).transpose().cast<double>() - centre_a;
    const Eigen::Vector3d q = b.row(v).transpose().cast<double>() - centre_b;
    sum += (p - R * q).squaredNorm();
  }
  alignment.rms_distance = std::sqrt(sum / static_cast<double>(a.rows()));
  return alignment;
}

void set_aligned_distances(std::span<const PositionsView> frames, DissimilarityMatrix& matrix) {
  if (frames.size() != matrix.frame_count()) {
    throw InvalidArgument(fmt::format("{} frames of points for a matrix of {}: expected equal numbers",
                                      frames.size(), matrix.frame_count()));
  }
  if (frames.empty()) return;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].rows() != frames[0].rows()) {
      throw InvalidArgument(fmt::format("frame {} has {} points and frame 0 has {}: expected equal numbers",
                                        f, frames[f].rows(), frames[0].rows()));
    }
  }
  if (frames[0].rows() == 0) throw InvalidArgument("frames without points cannot be compared");

  std::vector<FrameSums> sums(frames.size());
  const double height = centroid(frames[0]).y();
  parallel_for(0, sums.size(), [&](std::size_t f) { sums[f] = frame_sums(frames[f], height); });

  struct TilePair {
    std::size_t a;
    std::size_t b;
  };
  const std::size_t tile_count = (sums.size() + tile_frames - 1) / tile_frames;
  std::vector<TilePair> pairs;
  for (std::size_t a = 0; a < tile_count; ++a) {
    for (std::size_t b = a; b < tile_count; ++b) pairs.push_back({a, b});
  }
  Progress progress("comparing frames", pairs.size());
  parallel_for(0, pairs.size(), [&](std::size_t p) {
    compare_tiles(frames, sums, pairs[p].a, pairs[p].b, matrix);
    progress.advance();
  });
}

DissimilarityMatrix vertex_dissimilarity(const PerformanceDatabase& database) {
  DissimilarityMatrix matrix("vertex", database);
  std::vector<PositionsView> frames;
  for (const MeshSequence& clip : database.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) frames.push_back(clip.frame(f));
  }
  set_aligned_distances(frames, matrix);
  return matrix;
}

}  // namespace reprise
