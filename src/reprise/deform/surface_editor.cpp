// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/surface_editor.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

void check_frame(const PositionsView& frame, std::int32_t vertex_count) {
  if (frame.rows() != vertex_count) {
    throw InvalidArgument(
        fmt::format("the frame has {} vertices; the model has {}", frame.rows(), vertex_count));
  }
  for (Eigen::Index v = 0; v < frame.rows(); ++v) {
    if (!frame.row(v).allFinite())
      throw InvalidArgument(fmt::format("vertex {} of the frame is not at a finite position", v));
  }
}

void check_constraints(std::span<const PositionConstraint> constraints, std::int32_t vertex_count,
                       const Coordinates& frame) {
  if (frame.rows() == 0) throw InvalidArgument("an editor needs a frame before it can deform it");
  if (constraints.empty()) {
    throw InvalidArgument("nothing is constrained: expected one handle or anchor, or more");
  }
  validate(constraints, vertex_count);
}

double largest_residual(std::span<const PositionConstraint> constraints, const Coordinates& positions) {
  double largest = 0.0;
  for (const PositionConstraint& constraint : constraints) {
    largest = std::max(largest, (positions.row(constraint.vertex).transpose() - constraint.target).norm());
  }
  return largest;
}

}  // namespace reprise
