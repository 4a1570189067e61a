// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/deformation_trial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/part_alignment.h"

namespace reprise {
namespace {

Coordinates targets_of(std::span<const PositionConstraint> constraints) {
  Coordinates targets(static_cast<Eigen::Index>(constraints.size()), 3);
  for (std::size_t i = 0; i < constraints.size(); ++i)
    targets.row(static_cast<Eigen::Index>(i)) = constraints[i].target.transpose();
  return targets;
}

std::vector<std::int32_t> vertices_of(std::span<const PositionConstraint> constraints) {
  std::vector<std::int32_t> vertices;
  for (const PositionConstraint& constraint : constraints) vertices.push_back(constraint.vertex);
  return vertices;
}

}  // namespace

std::vector<std::int32_t> spread_vertices(const Positions& reference, std::size_t count) {
  const Eigen::Index n = reference.rows();
  if (count < 1 || count > static_cast<std::size_t>(n)) {
    throw InvalidArgument(
        fmt::format("constraints: expected 1 to {} (the vertices of the surface), found {}", n, count));
  }
  std::vector<std::int32_t> chosen;
  Eigen::Index next = 0;
  reference.col(1).maxCoeff(&next);
  Eigen::VectorXf nearest = Eigen::VectorXf::Constant(n, std::numeric_limits<float>::infinity());
  for (;;) {
    chosen.push_back(static_cast<std::int32_t>(next));
    if (chosen.size() == count) return chosen;
    nearest = nearest.cwiseMin((reference.rowwise() - reference.row(next)).rowwise().squaredNorm());
    nearest[next] = -1.0F;  // never twice, even where vertices lie on each other
    nearest.maxCoeff(&next);
  }
}

std::vector<PositionConstraint> constraints_at(std::vector<std::int32_t> vertices,
                                               const PositionsView& frame) {
  std::ranges::sort(vertices);
  std::vector<PositionConstraint> constraints;
  for (const std::int32_t v : vertices)
    constraints.push_back({.vertex = v, .target = frame.row(v).cast<double>().transpose()});
  return constraints;
}

FrameId nearest_frame(const PerformanceDatabase& database, std::span<const PositionConstraint> constraints) {
  const Coordinates targets = targets_of(constraints);
  const std::vector<std::int32_t> vertices = vertices_of(constraints);
  FrameId nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); ++f) {
      const Coordinates rows = rows_of(database.clip(c).frame(f), vertices);
      const double distance = (align(rows, targets).apply(rows) - targets).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      nearest = {.clip_idx = c, .frame_idx = f};
    }
  }
  return nearest;
}

void RigidEditor::set_frame(const PositionsView& frame, const SkeletonPose* /*pose*/) {
  check_frame(frame, vertex_count_);
  frame_ = frame.cast<double>();
  positions_ = frame_;
}

DeformReport RigidEditor::deform(std::span<const PositionConstraint> constraints) {
  check_constraints(constraints, vertex_count_, frame_);
  Coordinates rows(static_cast<Eigen::Index>(constraints.size()), 3);
  for (std::size_t i = 0; i < constraints.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = frame_.row(constraints[i].vertex);
  positions_ = align(rows, targets_of(constraints)).apply(frame_);
  return {.iterations = 1, .solved_parts = 1, .largest_residual = largest_residual(constraints, positions_)};
}

TrialMeter::TrialMeter(const PerformanceDatabase& seen, const Positions& reference,
                       const PartHierarchy* hierarchy) {
  const Topology& topology = *seen.topology();
  const auto tiny = static_cast<float>(
      0.25 * mean_edge_length(topology, PositionsView(reference.data(), reference.rows(), 3)));
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (const Triangle& triangle : topology.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k];
      const std::int32_t b = triangle[(k + 1) % 3];
      pairs.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::ranges::sort(pairs);
  const auto doubles = std::ranges::unique(pairs);
  pairs.erase(doubles.begin(), doubles.end());
  const auto is_shared = [&](std::int32_t v) {
    return hierarchy != nullptr && hierarchy->shares(v).size() > 1;
  };
  for (const auto& [a, b] : pairs)
    (is_shared(a) || is_shared(b) ? frontier_ : inside_)
        .push_back({.a = a, .b = b, .shortest = tiny, .longest = tiny});
  for (const MeshSequence& clip : seen.clips()) {
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const PositionsView frame = clip.frame(f);
      for (std::vector<Edge>* edges : {&inside_, &frontier_}) {
        for (Edge& edge : *edges) {
          const float length = (frame.row(edge.a) - frame.row(edge.b)).norm();
          edge.longest = std::max(edge.longest, length);
          edge.shortest = std::min(edge.shortest, length);
        }
      }
    }
  }
}

TrialMeter::Stretch TrialMeter::stretch_of(const std::vector<Edge>& edges, const Coordinates& positions) {
  if (edges.empty()) return {};
  std::vector<double> factors;
  for (const Edge& edge : edges) {
    const double length = (positions.row(edge.a) - positions.row(edge.b)).norm();
    // A micrometre stands for an edge that has collapsed.
    factors.push_back(std::max({1.0, length / edge.longest, edge.shortest / std::max(length, 1e-6)}));
  }
  const auto rank = factors.begin() + static_cast<std::ptrdiff_t>(99 * (factors.size() - 1) / 100);
  std::ranges::nth_element(factors, rank);
  return {.p99 = *rank, .max = *std::max_element(rank, factors.end())};
}

TrialFigures TrialMeter::operator()(const Coordinates& positions, const PositionsView& truth) const {
  const Eigen::VectorXd errors = (positions - truth.cast<double>()).rowwise().norm();
  const Stretch inside = stretch_of(inside_, positions);
  const Stretch frontier = stretch_of(frontier_, positions);
  return {.mean_error = errors.mean(),
          .max_error = errors.maxCoeff(),
          .inside_stretch_p99 = inside.p99,
          .inside_stretch_max = inside.max,
          .frontier_stretch_p99 = frontier.p99,
          .frontier_stretch_max = frontier.max};
}

}  // namespace reprise
