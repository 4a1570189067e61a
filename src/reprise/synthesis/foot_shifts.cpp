// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/foot_shifts.h"

#include <algorithm>
#include <array>
#include <span>

#include <Eigen/SparseCore>

#include "reprise/linalg/sparse_cholesky.h"

namespace reprise {
namespace {

// Weights of the least squares; only their ratios matter. Measured on the performer's and on real databases
// (docs/synthesis.md): the smallest shifts whose accelerations stay inside of the capture's own.
constexpr double stance = 1e5;   // slides left
constexpr double lifting = 1e1;  // lifts left
constexpr double course = 1.0;   // second differences; (course / home)^(1/4) frames: how soon a shift is back
constexpr double home = 3e-2;    // shifts; (stance / home)^(1/2) frames: how long a foot can stand shifted
constexpr double strain = 1e1;   // what a leg is too long
constexpr double jolt = 3e1;     // what an acceleration is too large
constexpr int rounds = 4;        // of linearising lengths

constexpr std::array<double, 3> second_difference = {1.0, -2.0, 1.0};

// A quadratic function of four numbers a frame, frames 1 to F - 2 (the shifts at both ends are zero).
class Quadratic {
 public:
  explicit Quadratic(std::size_t frames)
      : frames_(frames), b_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(4 * (frames - 2)))) {}

  // Adds value * x(f, i) x(g, j) / 2, to be called for (f, i, g, j) and for (g, j, f, i).
  void add(std::size_t f, int i, std::size_t g, int j, double value) {
    if (is_free(f) && is_free(g)) entries_.emplace_back(index(f, i), index(g, j), value);
  }
  // Adds value * x(f, i).
  void add_linear(std::size_t f, int i, double value) {
    if (is_free(f)) b_[index(f, i)] += value;
  }
  // The minimum, one column a frame.
  Eigen::Matrix4Xd minimum() const {
    Eigen::SparseMatrix<double> A(b_.size(), b_.size());
    A.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::VectorXd x = SparseCholesky(A).solve(-b_);
    Eigen::Matrix4Xd columns = Eigen::Matrix4Xd::Zero(4, static_cast<Eigen::Index>(frames_));
    columns.middleCols(1, columns.cols() - 2) = x.reshaped(4, columns.cols() - 2);
    return columns;
  }

 private:
  bool is_free(std::size_t f) const { return f > 0 && f + 1 < frames_; }
  static Eigen::Index index(std::size_t f, int i) { return 4 * static_cast<Eigen::Index>(f - 1) + i; }

  std::size_t frames_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd b_;
};

}  // namespace

void FootDemand::hold(double weight, const Eigen::Vector2d& slide, const Eigen::Vector2d& now,
                      const Eigen::Vector2d& next) {
  // Slide left: slide + shift of the next frame - shift of this one, each translation + yaw (z, -x).
  Eigen::Matrix<double, 2, 6> A;
  A << -1.0, 0.0, -now.y(), 1.0, 0.0, next.y(),  //
      0.0, -1.0, now.x(), 0.0, 1.0, -next.x();
  H_ += weight * A.transpose() * A;
  g_ += weight * A.transpose() * slide;
  weight_ += weight;
}

void FootDemand::lift(double weight, double height) {
  lift_weight_ += weight;
  lift_ += weight * height;
}

std::vector<FootShift> solve_foot_shifts(const std::vector<FootDemand>& demands, double foot_radius,
                                         const FootCourse& foot) {
  const std::size_t frames = demands.size();
  std::vector<FootShift> shifts(frames);
  if (frames < 3) return shifts;
  constexpr int yaw = 2;
  constexpr int up = 3;
  const auto unit = [&](int i) { return i == yaw ? foot_radius * foot_radius : 1.0; };

  Quadratic Q(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    for (int i = 0; i < 4; ++i) Q.add(f, i, f, i, home * unit(i));
    if (f > 0 && f + 1 < frames) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t l = 0; l < 3; ++l) {
          const double value = course * second_difference[k] * second_difference[l];
          for (int i = 0; i < 4; ++i) Q.add(f + k - 1, i, f + l - 1, i, value * unit(i));
        }
      }
    }
    if (f + 1 == frames || !demands[f].stands()) continue;
    const FootDemand& demand = demands[f];
    for (int i = 0; i < 6; ++i) {
      Q.add_linear(f + static_cast<std::size_t>(i / 3), i % 3, stance * demand.g_[i]);
      for (int j = 0; j < 6; ++j) {
        Q.add(f + static_cast<std::size_t>(i / 3), i % 3, f + static_cast<std::size_t>(j / 3), j % 3,
              stance * demand.H_(i, j));
      }
    }
    Q.add(f, up, f, up, lifting * demand.lift_weight_);
    Q.add_linear(f, up, -lifting * demand.lift_);
  }

  for (int round = 0;; ++round) {
    const Eigen::Matrix4Xd x = Q.minimum();
    for (std::size_t f = 0; f < frames; ++f) {
      const Eigen::Vector4d column = x.col(static_cast<Eigen::Index>(f));
      shifts[f] = {.translation = {column[0], column[up], column[1]}, .yaw = column[yaw]};
    }
    if (round == rounds) return shifts;
    bool changed = false;
    // Pulls the length of `now`, the sum of `before` and these multiples of shifts from `first` on, back to
    // `limit` where it is above. What was above it without shifts is not their fault.
    const auto limit_length = [&](const Eigen::Vector3d& before, std::size_t first,
                                  std::span<const double> multiples, double limit, double weight) {
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      for (std::size_t k = 0; k < multiples.size(); ++k)
        shift += multiples[k] * shifts[first + k].translation;
      const Eigen::Vector3d now = before + shift;
      const double excess = now.norm() - std::max(limit, before.norm());
      if (excess <= 0.0) return;
      changed = true;
      const Eigen::Vector3d along = now.normalized();
      const double wanted = along.dot(shift) - excess;
      constexpr std::array<int, 3> axes = {0, up, 1};
      for (std::size_t k = 0; k < multiples.size(); ++k) {
        for (int i = 0; i < 3; ++i) {
          Q.add_linear(first + k, axes[i], -weight * multiples[k] * along[i] * wanted);
          for (std::size_t l = 0; l < multiples.size(); ++l) {
            for (int j = 0; j < 3; ++j)
              Q.add(first + k, axes[i], first + l, axes[j],
                    weight * multiples[k] * along[i] * multiples[l] * along[j]);
          }
        }
      }
    };
    for (std::size_t f = 0; f < frames; ++f)
      limit_length(foot.centers[f] - foot.hips[f], f, std::array{1.0}, foot.longest_leg, strain);
    for (std::size_t f = 1; f + 1 < frames; ++f)
      limit_length(foot.centers[f - 1] - 2.0 * foot.centers[f] + foot.centers[f + 1], f - 1,
                   second_difference, foot.largest_acceleration, jolt);
    if (!changed) return shifts;
  }
}

}  // namespace reprise
