// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/deform/position_constraint.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

void validate(std::span<const PositionConstraint> constraints, std::int32_t vertex_count) {
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> constraint_of(static_cast<std::size_t>(std::max(vertex_count, 0)), none);
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const PositionConstraint& constraint = constraints[i];
    if (constraint.vertex < 0 || constraint.vertex >= vertex_count) {
      throw InvalidArgument(fmt::format("constraint {} is on vertex {}; expected 0 to {}", i,
                                        constraint.vertex, vertex_count - 1));
    }
    std::size_t& taken = constraint_of[static_cast<std::size_t>(constraint.vertex)];
    if (taken != none) {
      throw InvalidArgument(
          fmt::format("constraints {} and {} are both on vertex {}", taken, i, constraint.vertex));
    }
    taken = i;
    if (!constraint.target.allFinite()) {
      throw InvalidArgument(
          fmt::format("constraint {} (vertex {}) has a target that is not finite", i, constraint.vertex));
    }
    if (!(constraint.weight > 0.0) || !std::isfinite(constraint.weight)) {
      throw InvalidArgument(
          fmt::format("constraint {} (vertex {}) has the weight {}; expected a positive, finite one", i,
                      constraint.vertex, constraint.weight));
    }
  }
}

}  // namespace reprise
