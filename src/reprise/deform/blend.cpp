// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/blend.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/gradient_kernel.h"

namespace reprise {
namespace {

void check_alpha(double alpha) {
  if (!(alpha >= 0.0 && alpha <= 1.0))
    throw InvalidArgument(fmt::format("alpha must lie in [0, 1], found {}", alpha));
}

}  // namespace

Slerp::Slerp(double alpha) : source_weights_(fit(1.0 - alpha)), target_weights_(fit(alpha)) {}

Slerp::Polynomial Slerp::fit(double alpha) {
  constexpr auto n = static_cast<int>(term_count);
  // Chebyshev coefficients from the values at the n Chebyshev points of [-1, 1].
  std::array<double, term_count> values;
  for (int i = 0; i < n; ++i) {
    const double x = std::cos(std::numbers::pi * (i + 0.5) / n);
    const double half_angle = std::acos(0.5 * (x + 1.0));
    values[static_cast<std::size_t>(i)] = std::sin(alpha * half_angle) / std::sin(half_angle);
  }
  Polynomial powers = {};
  Polynomial previous = {};  // T_{k-1} in powers of x
  Polynomial current = {1.0};
  for (int k = 0; k < n; ++k) {
    double coefficient = 0.0;
    for (int i = 0; i < n; ++i) {
      coefficient += values[static_cast<std::size_t>(i)] * std::cos(std::numbers::pi * k * (i + 0.5) / n);
    }
    coefficient *= (k == 0 ? 1.0 : 2.0) / n;
    for (std::size_t i = 0; i < term_count; ++i) powers[i] += coefficient * current[i];
    // T_{k+1} = 2 x T_k - T_{k-1}, and T_1 = x.
    Polynomial next = {};
    for (std::size_t i = 0; i < term_count; ++i) {
      next[i] = (i == 0 ? 0.0 : (k == 0 ? 1.0 : 2.0) * current[i - 1]) - previous[i];
    }
    previous = current;
    current = next;
  }
  return powers;
}

void blend_frames(const PoissonReconstruction& poisson, const PositionsView& source,
                  const PositionsView& target, double alpha, PositionsRef blended) {
  check_alpha(alpha);
  poisson.check_rows("source", source.rows());
  poisson.check_rows("target", target.rows());
  poisson.check_rows("blended", blended.rows());

  // As `reconstruct(interpolate(gradients(source), gradients(target)))`, but in one pass: no gradient field
  // is stored.
  GradientKernel source_gradient(poisson, source);
  GradientKernel target_gradient(poisson, target);
  const Slerp slerp(alpha);
  // Kept per thread: freshly mapped pages can cost more than the solve.
  thread_local PoissonReconstruction::Coordinates x;
  x.setZero(blended.rows(), 3);
  for (std::size_t t = 0; t < poisson.topology_->triangles.size(); ++t) {
    const TriangleGradient s = source_gradient(t);
    const TriangleGradient g = target_gradient(t);
    poisson.add_divergence(t, deformation_gradient(slerp(s.R, g.R), (1.0 - alpha) * s.S + alpha * g.S), x);
  }
  poisson.solve_in_place(
      x, (1.0 - alpha) * poisson.component_centroids(source) + alpha * poisson.component_centroids(target));
  blended = x.cast<float>();
}

GradientField interpolate(const GradientField& source, const GradientField& target, double alpha) {
  check_alpha(alpha);
  if (source.size() != target.size()) {
    throw InvalidArgument(fmt::format("gradient fields have {} and {} triangles, expected the same",
                                      source.size(), target.size()));
  }
  const Slerp slerp(alpha);
  GradientField result(source.size());
  for (std::size_t t = 0; t < result.size(); ++t) {
    result[t] = {.R = slerp(source[t].R, target[t].R),
                 .S = (1.0 - alpha) * source[t].S + alpha * target[t].S};
  }
  return result;
}

}  // namespace reprise
