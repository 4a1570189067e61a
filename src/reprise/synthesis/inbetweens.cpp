// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/inbetweens.h"

#include <algorithm>
#include <cmath>

#include "reprise/deform/blend.h"

namespace reprise {
namespace {

// Rotation vector of the shorter way round, radians.
Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  // sin(x) = x to rounding.
  const double angle_over_sine = sine < 1e-9 ? 2.0 : 2.0 * std::atan2(sine, std::abs(q.w())) / sine;
  return std::copysign(angle_over_sine, q.w()) * q.vec();
}

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  const double sine_over_angle = angle < 1e-9 ? 0.5 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * angle);
  q.vec() = sine_over_angle * vector;
  return q;
}

}  // namespace

Inbetweens::Inbetweens(const MeshSequence& sequence, const PoissonReconstruction& poisson)
    : sequence_(sequence), poisson_(poisson) {}

const Inbetweens::Knot& Inbetweens::knot(std::size_t frame_idx) {
  const auto [at, is_new] = knots_.try_emplace(frame_idx);
  if (is_new) {
    at->second.field = poisson_.gradients(sequence_.frame(frame_idx));
    at->second.centroids = poisson_.component_centroids(sequence_.frame(frame_idx));
  }
  return at->second;
}

const Inbetweens::Bend& Inbetweens::bend(std::size_t frame_idx) {
  const auto [at, is_new] = bends_.try_emplace(frame_idx);
  Bend& bend = at->second;
  if (!is_new) return bend;
  const Knot& before = knot(frame_idx - 1);
  const Knot& here = knot(frame_idx);
  const Knot& after = knot(frame_idx + 1);
  bend.rotation.resize(here.field.size());
  bend.stretch.resize(here.field.size());
  for (std::size_t t = 0; t < here.field.size(); ++t) {
    const Eigen::Quaterniond triangle_from_world = here.field[t].R.conjugate();
    bend.rotation[t] = rotation_vector(triangle_from_world * after.field[t].R) +
                       rotation_vector(triangle_from_world * before.field[t].R);
    bend.stretch[t] = before.field[t].S - 2.0 * here.field[t].S + after.field[t].S;
  }
  bend.centroids = before.centroids - 2.0 * here.centroids + after.centroids;
  return bend;
}

void Inbetweens::reconstruct(std::size_t frame_idx, double alpha, PositionsRef out) {
  // What lies behind is not asked for again.
  const auto forget = [&](auto& kept) {
    kept.erase(kept.begin(), kept.lower_bound(frame_idx - std::min<std::size_t>(frame_idx, 1)));
  };
  forget(knots_);
  forget(bends_);

  const Knot& source = knot(frame_idx);
  const Knot& target = knot(frame_idx + 1);
  GradientField field = interpolate(source.field, target.field, alpha);
  Eigen::MatrixX3d centroids = (1.0 - alpha) * source.centroids + alpha * target.centroids;
  if (sequence_.frame_count() > 2) {
    const std::size_t last = sequence_.frame_count() - 2;
    const Bend& source_bend = bend(std::clamp<std::size_t>(frame_idx, 1, last));
    const Bend& target_bend = bend(std::clamp<std::size_t>(frame_idx + 1, 1, last));
    const double source_weight = -0.5 * alpha * (1.0 - alpha) * (1.0 - alpha);
    const double target_weight = -0.5 * alpha * (1.0 - alpha) * alpha;
    for (std::size_t t = 0; t < field.size(); ++t) {
      field[t].R = field[t].R * rotation_by(source_weight * source_bend.rotation[t] +
                                            target_weight * target_bend.rotation[t]);
      field[t].S += source_weight * source_bend.stretch[t] + target_weight * target_bend.stretch[t];
    }
    centroids += source_weight * source_bend.centroids + target_weight * target_bend.centroids;
  }
  out = poisson_.reconstruct(field, centroids).cast<float>();
}

}  // namespace reprise
