// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/smooth_course.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace reprise {
namespace {

using Vector = Eigen::ArrayXd;

// A symmetric positive definite matrix with five diagonals: 0 the main one, k the one k below.
struct Pentadiagonal {
  Vector diagonal[3];

  explicit Pentadiagonal(Eigen::Index size)
      : diagonal{Vector::Zero(size), Vector::Zero(size), Vector::Zero(size)} {}

  // The row times `x`.
  Vector operator*(const Vector& x) const {
    Vector y = diagonal[0] * x;
    for (Eigen::Index k = 1; k <= 2; ++k) {
      for (Eigen::Index i = 0; i + k < x.size(); ++i) {
        y[i] += diagonal[k][i] * x[i + k];
        y[i + k] += diagonal[k][i] * x[i];
      }
    }
    return y;
  }

  // A^-1 b, by the factors L D L^T.
  Vector solve(Vector b) const {
    const Eigen::Index n = b.size();
    Vector D = diagonal[0];
    Vector one = diagonal[1];  // first and second diagonal of L
    Vector two = diagonal[2];
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i >= 1) D[i] -= one[i - 1] * one[i - 1] * D[i - 1];
      if (i >= 2) D[i] -= two[i - 2] * two[i - 2] * D[i - 2];
      if (i >= 1) one[i] -= two[i - 1] * one[i - 1] * D[i - 1];
      one[i] /= D[i];
      two[i] /= D[i];
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i >= 1) b[i] -= one[i - 1] * b[i - 1];
      if (i >= 2) b[i] -= two[i - 2] * b[i - 2];
    }
    b /= D;
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      if (i + 1 < n) b[i] -= one[i] * b[i + 1];
      if (i + 2 < n) b[i] -= two[i] * b[i + 2];
    }
    return b;
  }
};

// The program: minimise 1/2 x^T H x + g^T x over the free samples x, subject to A x >= b. A's rows are, for n
// samples: x_i, -x_i, and the n + 1 steps between neighbours, the fixed ones on both sides included.
class CourseProgram {
 public:
  CourseProgram(std::span<const double> course, std::size_t first, std::size_t last,
                const CourseLimits& limits)
      : n_(static_cast<Eigen::Index>(last - first)), H_(n_), g_(Vector::Zero(n_)), b_(3 * n_ + 1) {
    // Second differences over the samples i, i + 1, i + 2 with coefficients 1, -2, 1.
    constexpr double coefficient[] = {1.0, -2.0, 1.0};
    for (std::size_t i = 0; i + 2 < course.size(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        if (i + r < first || i + r >= last) continue;
        const auto row = static_cast<Eigen::Index>(i + r - first);
        for (std::size_t c = 0; c < 3; ++c) {
          const double product = coefficient[r] * coefficient[c];
          if (i + c < first || i + c >= last) {
            g_[row] += product * course[i + c];
          } else if (c <= r) {
            H_.diagonal[r - c][static_cast<Eigen::Index>(i + c - first)] += product;
          }
        }
      }
    }
    for (Eigen::Index i = 0; i < n_; ++i) {
      const double here = course[first + static_cast<std::size_t>(i)];
      H_.diagonal[0][i] += limits.pull;
      g_[i] -= limits.pull * here;
      b_[i] = here - limits.farthest;
      b_[n_ + i] = -(here + limits.farthest);
    }
    b_.tail(n_ + 1).setZero();
    b_[2 * n_] = course[first - 1];
    b_[3 * n_] = -course[last];
  }

  // From a point inside of all constraints to the optimum.
  Vector solve(Vector x) const {
    constexpr int most_rounds = 100;
    constexpr double gap = 1e-13;  // frames^2 a constraint
    Vector s = rows(x) - b_;
    Vector z = 1e-2 / s;
    for (int round = 0; round < most_rounds; ++round) {
      const Vector dual = H_ * x + g_ - transposed(z);
      const double mu = (s * z).mean();
      if (mu < gap && dual.abs().maxCoeff() < 1e-10) break;
      const Pentadiagonal normal = normal_matrix(z / s);
      // Mehrotra's predictor tells how far the centre may be left behind.
      const auto step = [&](const Vector& complementarity, Vector& dx, Vector& ds, Vector& dz) {
        dx = normal.solve(transposed(complementarity / s) - dual);
        ds = rows(dx);
        dz = (complementarity - z * ds) / s;
      };
      Vector dx;
      Vector ds;
      Vector dz;
      step(-s * z, dx, ds, dz);
      const double reach = std::min(longest(s, ds), longest(z, dz));
      const double reached = ((s + reach * ds) * (z + reach * dz)).mean();
      const double ratio = reached / mu;
      const double centring = ratio * ratio * ratio;
      step(centring * mu - s * z - ds * dz, dx, ds, dz);
      const double length = std::min(1.0, 0.995 * std::min(longest(s, ds), longest(z, dz)));
      x += length * dx;
      z += length * dz;
      s += length * ds;  // not from x: the difference to a limit would be rounding alone
    }
    return x;
  }

 private:
  Vector rows(const Vector& x) const {
    Vector y(3 * n_ + 1);
    y.head(n_) = x;
    y.segment(n_, n_) = -x;
    y[2 * n_] = x[0];
    y.segment(2 * n_ + 1, n_ - 1) = x.tail(n_ - 1) - x.head(n_ - 1);
    y[3 * n_] = -x[n_ - 1];
    return y;
  }
  Vector transposed(const Vector& y) const {
    return y.head(n_) - y.segment(n_, n_) + y.segment(2 * n_, n_) - y.tail(n_);
  }
  // H + A^T diag(w) A.
  Pentadiagonal normal_matrix(const Vector& w) const {
    Pentadiagonal normal = H_;
    normal.diagonal[0] += w.head(n_) + w.segment(n_, n_) + w.segment(2 * n_, n_) + w.tail(n_);
    normal.diagonal[1].head(n_ - 1) -= w.segment(2 * n_ + 1, n_ - 1);
    return normal;
  }
  // How many times `change` can be added before an entry is negative, at most once.
  static double longest(const Vector& value, const Vector& change) {
    double length = 1.0;
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      if (change[i] < 0.0) length = std::min(length, -value[i] / change[i]);
    }
    return length;
  }

  Eigen::Index n_;
  Pentadiagonal H_;
  Vector g_;
  Vector b_;
};

}  // namespace

void smooth_course(std::span<double> course, std::size_t first, std::size_t last,
                   const CourseLimits& limits) {
  const double farthest = limits.farthest;
  const double start = course[first - 1];
  const double end = course[last];
  if (!(end > start)) return;  // stands still
  // A start inside of all limits: from the given row a little towards the straight one between its ends,
  // which rises everywhere.
  const auto n = static_cast<Eigen::Index>(last - first);
  Vector given(n);
  Vector straight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    given[i] = course[first + static_cast<std::size_t>(i)];
    straight[i] = start + (end - start) * static_cast<double>(i + 1) / static_cast<double>(n + 1);
  }
  const double away = (straight - given).abs().maxCoeff();
  const double share = away > 0.5 * farthest ? 0.5 * farthest / away : 1.0;
  const Vector x = CourseProgram(course, first, last, limits).solve(given + share * (straight - given));
  // The limits hold to rounding; now they hold.
  double least = start;
  for (Eigen::Index i = 0; i < n; ++i) {
    double& sample = course[first + static_cast<std::size_t>(i)];
    least = std::min(end, std::max(least, std::clamp(x[i], sample - farthest, sample + farthest)));
    sample = least;
  }
}

}  // namespace reprise
