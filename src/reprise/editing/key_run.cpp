// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/key_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reprise/skeleton/rigid_fit.h"

namespace reprise {
namespace {

std::vector<std::int32_t> constrained_vertices(const SolvedKey& key) {
  std::vector<std::int32_t> vertices;
  for (const PositionConstraint& constraint : key.constraints) vertices.push_back(constraint.vertex);
  std::ranges::sort(vertices);
  return vertices;
}

}  // namespace

SurfaceTurning::SurfaceTurning(std::vector<std::int32_t> vertices, const PositionsView& reference)
    : vertices_(std::move(vertices)), weights_(vertices_.size(), 1.0) {
  reference_ = gather(reference);
}

Eigen::Matrix3d SurfaceTurning::operator()(const PositionsView& frame) const {
  return skeleton::fit_rigid(reference_, gather(frame), weights_).rotation;
}

std::vector<Eigen::Vector3d> SurfaceTurning::gather(const PositionsView& frame) const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(vertices_.size());
  for (const std::int32_t vertex : vertices_)
    points.emplace_back(frame.row(vertex).transpose().cast<double>());
  return points;
}

double quintic_smoothstep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

KeyRun::KeyRun(std::vector<SolvedKey> keys, double window, const SurfaceTurning& turning)
    : keys_(std::move(keys)), window_(window), turning_(turning) {
  gather_vertices();
  const auto count = static_cast<Eigen::Index>(vertices_.size());
  constexpr double unknown = -1.0;
  for (const SolvedKey& key : keys_) {
    const Positions frame = key.frame.cast<float>();
    const Eigen::Matrix3d turned = turning_(PositionsView(frame.data(), frame.rows(), 3));
    // Free vertices go where the key takes them: a constraint that is already met changes no minimum.
    Coordinates displacement(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::int32_t vertex = vertices_[static_cast<std::size_t>(i)];
      displacement.row(i) = key.result.row(vertex) - key.frame.row(vertex);
    }
    Eigen::VectorXd weight = Eigen::VectorXd::Constant(count, unknown);
    for (const PositionConstraint& constraint : key.constraints) {
      const auto i = std::ranges::lower_bound(vertices_, constraint.vertex) - vertices_.begin();
      displacement.row(i) = constraint.target.transpose() - key.frame.row(constraint.vertex);
      weight[i] = constraint.weight;
    }
    displacements_.emplace_back(displacement * turned);  // rows: d^T R is (R^T d)^T
    weights_.push_back(std::move(weight));
  }
  // Where a key leaves a vertex free, its weight is that of the key before, or else of the next.
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    weights_[k] = (weights_[k].array() == unknown).select(weights_[k - 1], weights_[k]);
  }
  for (std::size_t k = keys_.size() - 1; k-- > 0;) {
    weights_[k] = (weights_[k].array() == unknown).select(weights_[k + 1], weights_[k]);
  }
}

void KeyRun::gather_vertices() {
  for (const SolvedKey& key : keys_) {
    const std::vector<std::int32_t> own = constrained_vertices(key);
    if (!vertices_.empty() && own != vertices_) is_uniform_ = false;
    vertices_.insert(vertices_.end(), own.begin(), own.end());
    std::ranges::sort(vertices_);
    const auto rest = std::ranges::unique(vertices_);
    vertices_.erase(rest.begin(), rest.end());
  }
}

std::pair<std::size_t, std::size_t> KeyRun::support(std::size_t frame_count) const {
  if (window_ == 0.0) return {0, frame_count - 1};
  // The displacement is zero at the very ends of the windows.
  const double first = std::floor(static_cast<double>(keys_.front().frame_idx) - window_) + 1.0;
  const double last = std::ceil(static_cast<double>(keys_.back().frame_idx) + window_) - 1.0;
  return {static_cast<std::size_t>(std::max(first, 0.0)),
          static_cast<std::size_t>(std::min(last, static_cast<double>(frame_count - 1)))};
}

KeyMix KeyRun::mix(std::size_t frame_idx) const {
  const auto next =
      std::ranges::find_if(keys_, [&](const SolvedKey& key) { return key.frame_idx >= frame_idx; });
  const auto k = static_cast<std::size_t>(next - keys_.begin());
  if (next != keys_.end() && next->frame_idx == frame_idx) return {.a = k, .b = k, .share_a = 1.0};
  const auto distance = [&](std::size_t key_idx) {
    return std::abs(static_cast<double>(keys_[key_idx].frame_idx) - static_cast<double>(frame_idx));
  };
  const auto outside = [&](std::size_t key_idx) {
    const double share = window_ == 0.0 ? 1.0 : quintic_smoothstep(1.0 - distance(key_idx) / window_);
    return KeyMix{.a = key_idx, .b = key_idx, .share_a = share};
  };
  if (k == 0) return outside(0);
  if (next == keys_.end()) return outside(k - 1);
  const double share = quintic_smoothstep(distance(k - 1) / (distance(k - 1) + distance(k)));
  return {.a = k - 1, .b = k, .share_a = 1.0 - share, .share_b = share};
}

std::vector<PositionConstraint> KeyRun::constraints(const KeyMix& mix, const PositionsView& frame) const {
  const Coordinates turned_displacement =
      mix.share_a * displacements_[mix.a] + mix.share_b * displacements_[mix.b];
  if (turned_displacement.isZero(0.0)) return {};
  const Coordinates displacement = turned_displacement * turning_(frame).transpose();
  const Eigen::VectorXd weight =
      (mix.share_a * weights_[mix.a] + mix.share_b * weights_[mix.b]) / (mix.share_a + mix.share_b);
  std::vector<PositionConstraint> constraints;
  constraints.reserve(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d at = frame.row(vertices_[i]).transpose().cast<double>();
    // Equal weights stay equal to the bit, so that editors keep their factorisation.
    const double w = weights_[mix.a][row] == weights_[mix.b][row] ? weights_[mix.a][row] : weight[row];
    constraints.push_back({vertices_[i], at + displacement.row(row).transpose(), w});
  }
  return constraints;
}

std::vector<Eigen::VectorXd> KeyRun::changes(const KeyMix& mix) const {
  std::vector<Eigen::VectorXd> mixed;
  for (std::size_t p = 0; p < keys_[mix.a].changes.size(); ++p) {
    mixed.emplace_back(mix.share_a * keys_[mix.a].changes[p] + mix.share_b * keys_[mix.b].changes[p]);
  }
  return mixed;
}

}  // namespace reprise
