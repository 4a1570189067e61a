// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/foot_planting.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/Geometry>

#include "reprise/core/parallel.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/synthesis/leg_weights.h"

namespace reprise {
namespace {

// How fast a foot is held in a blend in which it stands in the heavier clip alone: enough to keep it within
// millimetres on an ordinary step, too little to draw the leg out or to throw the foot at its next stand.
constexpr double one_sided = 1e-3;

// How much of what the capture's vertices reach the centre of a shifted foot may: its own vertices outrun it.
constexpr double share_of_captured = 0.7;

Eigen::Vector2d on_ground(const PositionsView& positions, std::int32_t vertex) {
  return {static_cast<double>(positions(vertex, 0)), static_cast<double>(positions(vertex, 2))};
}

Eigen::Vector2d on_ground(const Eigen::Vector3d& point) {
  return {point.x(), point.z()};
}

Eigen::Vector3d center(const PositionsView& positions, const std::vector<std::int32_t>& vertices) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t v : vertices) sum += positions.row(v).cast<double>().transpose();
  return sum / static_cast<double>(vertices.size());
}

// Rotation on the ground, of (x, z), that lays a captured frame best on the one shown.
Eigen::Matrix2d shown_from_captured(const PositionsView& shown, const PositionsView& captured) {
  const Eigen::Vector3d shown_center = centroid(shown);
  const Eigen::Vector3d captured_center = centroid(captured);
  double along = 0.0;
  double across = 0.0;
  for (Eigen::Index v = 0; v < shown.rows(); ++v) {
    const double ax = static_cast<double>(shown(v, 0)) - shown_center.x();
    const double az = static_cast<double>(shown(v, 2)) - shown_center.z();
    const double bx = static_cast<double>(captured(v, 0)) - captured_center.x();
    const double bz = static_cast<double>(captured(v, 2)) - captured_center.z();
    along += ax * bx + az * bz;
    across += ax * bz - az * bx;
  }
  const Eigen::Matrix3d R = GroundTransform{.yaw = std::atan2(across, along)}.rotation();
  return (Eigen::Matrix2d() << R(0, 0), R(0, 2), R(2, 0), R(2, 2)).finished();
}

// What both hold, ascending.
std::vector<std::int32_t> common(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  std::vector<std::int32_t> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both;
}

}  // namespace

FootPlanter::FootPlanter(const PerformanceDatabase& database, const ContactOptions& options)
    : database_(&database), contacts_(database, options) {
  const Eigen::MatrixXd weights = leg_weights(database, contacts_);
  for (std::size_t i = 0; i < contacts_.feet().size(); ++i)
    feet_.push_back(make_foot(contacts_.feet()[i], weights.col(static_cast<Eigen::Index>(i))));
  // A capture that never accelerates sets no limit.
  const double captured = captured_acceleration(database);
  largest_acceleration_ =
      captured > 0.0 ? share_of_captured * captured : std::numeric_limits<double>::infinity();
}

FootPlanter::Foot FootPlanter::make_foot(const std::vector<std::int32_t>& sole,
                                         const Eigen::VectorXd& weights) const {
  Foot foot{.sole = sole};
  for (Eigen::Index v = 0; v < weights.size(); ++v) {
    if (weights[v] == 0.0) continue;
    foot.followers.push_back(static_cast<std::int32_t>(v));
    foot.weights.push_back(weights[v]);
  }
  const double hip_height = hip_share * contacts_.stature();
  for (const Triangle& triangle : database_->topology()->triangles) {
    if (std::ranges::none_of(triangle, [&](std::int32_t v) { return weights[v] > 0.0; })) continue;
    for (const std::int32_t v : triangle) {
      if (weights[v] == 0.0 && contacts_.mean_heights()[static_cast<std::size_t>(v)] > hip_height)
        foot.hip.push_back(v);
    }
  }
  std::ranges::sort(foot.hip);
  foot.hip.erase(std::ranges::unique(foot.hip).begin(), foot.hip.end());

  const PositionsView reference = database_->clip(0).frame(0);
  const Eigen::Vector2d middle = on_ground(center(reference, sole));
  double square = 0.0;
  for (const std::int32_t v : sole) square += (on_ground(reference, v) - middle).squaredNorm();
  constexpr double least_radius = 1e-3;  // a foot of one vertex has no turn
  foot.radius = std::max(std::sqrt(square / static_cast<double>(sole.size())), least_radius);

  std::size_t contacts = 0;
  std::size_t stands = 0;
  for (std::size_t c = 0; c < database_->clips().size(); ++c) {
    const MeshSequence& clip = database_->clip(c);
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const std::size_t here = common(contacts_.touching(c, f), sole).size();
      contacts += here;
      stands += here > 0 ? 1 : 0;
      if (foot.hip.empty()) continue;
      const Eigen::Vector3d leg = center(clip.frame(f), sole) - center(clip.frame(f), foot.hip);
      foot.longest_leg = std::max(foot.longest_leg, leg.norm());
    }
  }
  if (foot.hip.empty()) foot.longest_leg = std::numeric_limits<double>::infinity();
  // A foot is a patch of vertices that are in contact somewhere, so it stands at least once.
  foot.contact_count = static_cast<double>(contacts) / static_cast<double>(stands);
  return foot;
}

FootDemand FootPlanter::demand(const Foot& foot, const MeshSequence& sequence, std::size_t frame_idx,
                               const FrameSources& sources) const {
  const auto touching = [&](const FrameSource& source) {
    return common(contacts_.touching(source.id.clip_idx, source.id.frame_idx), foot.sole);
  };
  FootDemand demand;
  if (touching(sources.heavier()).empty()) return demand;
  const bool stands_in_all = std::ranges::none_of(
      sources.captured, [&](const FrameSource& source) { return touching(source).empty(); });
  const PositionsView now = sequence.frame(frame_idx);
  const PositionsView next = sequence.frame(frame_idx + 1);
  const Eigen::Vector2d center_now = on_ground(center(now, foot.sole));
  const Eigen::Vector2d center_next = on_ground(center(next, foot.sole));
  for (const FrameSource& source : sources.captured) {
    const std::vector<std::int32_t> vertices = touching(source);
    if (vertices.empty()) continue;
    const MeshSequence& clip = database_->clip(source.id.clip_idx);
    const PositionsView captured_now = clip.frame(source.id.frame_idx);
    const PositionsView captured_next = clip.frame(source.id.frame_idx + 1);
    const Eigen::Matrix2d R = shown_from_captured(now, captured_now);
    const double weight = source.weight / foot.contact_count;
    for (const std::int32_t v : vertices) {
      const Eigen::Vector2d step = on_ground(next, v) - on_ground(now, v);
      const Eigen::Vector2d captured_step = on_ground(captured_next, v) - on_ground(captured_now, v);
      demand.hold((stands_in_all ? 1.0 : one_sided) * weight, step - R * captured_step,
                  on_ground(now, v) - center_now, on_ground(next, v) - center_next);
      demand.lift(weight, static_cast<double>(captured_now(v, 1)) - static_cast<double>(now(v, 1)));
    }
  }
  return demand;
}

PlantingReport FootPlanter::plant(MeshSequence& sequence) const {
  const std::vector<FrameSources> sources = frame_sources(sequence, *database_);
  const std::size_t frames = sequence.frame_count();
  std::vector<std::vector<FootDemand>> demands(feet_.size(), std::vector<FootDemand>(frames));
  std::vector<FootCourse> courses(feet_.size());
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    courses[i] = {.centers = std::vector<Eigen::Vector3d>(frames),
                  .hips = std::vector<Eigen::Vector3d>(frames),
                  .longest_leg = feet_[i].longest_leg,
                  .largest_acceleration = largest_acceleration_};
  }
  const MeshSequence& still = sequence;
  parallel_for(0, frames, [&](std::size_t f) {
    for (std::size_t i = 0; i < feet_.size(); ++i) {
      courses[i].centers[f] = center(still.frame(f), feet_[i].sole);
      courses[i].hips[f] =
          feet_[i].hip.empty() ? courses[i].centers[f] : center(still.frame(f), feet_[i].hip);
      if (f + 1 < frames) demands[i][f] = demand(feet_[i], still, f, sources[f]);
    }
  });

  std::vector<std::vector<FootShift>> shifts(feet_.size());
  parallel_for(0, feet_.size(), [&](std::size_t i) {
    shifts[i] = solve_foot_shifts(demands[i], feet_[i].radius, courses[i]);
    constexpr double nothing = 1e-5;  // metres: the rounding of positions, not a slide
    const bool stays = std::ranges::all_of(shifts[i], [&](const FootShift& shift) {
      return std::max(shift.translation.norm(), feet_[i].radius * std::abs(shift.yaw)) < nothing;
    });
    if (stays) shifts[i].clear();
  });

  PlantingReport report;
  std::size_t stands = 0;
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (!demands[i][f].stands()) continue;
      const double shift = shifts[i].empty() ? 0.0 : shifts[i][f].translation.norm();
      report.largest_shift = std::max(report.largest_shift, shift);
      report.mean_shift += shift;
      ++stands;
    }
  }
  if (stands > 0) report.mean_shift /= static_cast<double>(stands);

  parallel_for(0, frames, [&](std::size_t f) {
    const bool moved = move_feet(sequence.frame(f), f, shifts);
    if (!moved || !sequence.has_normals()) return;
    const Positions normals = vertex_normals(*sequence.topology(), still.frame(f));
    PositionsRef kept = sequence.mutable_normals(f);
    for (const Foot& foot : feet_) {
      for (const std::int32_t v : foot.followers) kept.row(v) = normals.row(v);
    }
  });
  return report;
}

bool FootPlanter::move_feet(PositionsRef frame, std::size_t frame_idx,
                            const std::vector<std::vector<FootShift>>& shifts) const {
  bool moved = false;
  Positions before;
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    if (shifts[i].empty()) continue;
    const FootShift& shift = shifts[i][frame_idx];
    if (shift.translation.isZero(0.0) && shift.yaw == 0.0) continue;
    // What follows both feet takes the sum of what each would do to it alone.
    if (!moved) before = frame;
    moved = true;
    const Foot& foot = feet_[i];
    const Eigen::Vector3d pivot = center(PositionsView(before.data(), before.rows(), 3), foot.sole);
    const Eigen::Matrix3d turn = GroundTransform{.yaw = shift.yaw}.rotation() - Eigen::Matrix3d::Identity();
    for (std::size_t k = 0; k < foot.followers.size(); ++k) {
      const std::int32_t v = foot.followers[k];
      const Eigen::Vector3d p = before.row(v).cast<double>().transpose();
      frame.row(v) += (foot.weights[k] * (turn * (p - pivot) + shift.translation)).cast<float>().transpose();
    }
  }
  return moved;
}

}  // namespace reprise
