// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The weights of the parts, and the surface that their solutions make together.

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/part_hierarchy.h"
#include "reprise/deform/part_weights.h"

namespace reprise {

void PartHierarchy::make_shares(const std::vector<PartDistances>& distances) {
  first_share_.assign(1, 0);
  for (std::int32_t v = 0; v < vertex_count(); ++v) {
    const std::size_t first = shares_.size();
    double sum = 0.0;
    bool is_endless = false;  // a part without border holds it
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const std::int32_t local = parts_[p].local(v);
      if (local < 0) continue;
      const float distance = distances[p].to_outside[static_cast<std::size_t>(v)];
      if (distance == EdgeGraph::unreached && !is_endless) {
        is_endless = true;
        shares_.resize(first);
        sum = 0.0;
      }
      if (is_endless && distance < EdgeGraph::unreached) continue;
      const double weight = is_endless ? 1.0 : distance;
      shares_.push_back({.part_idx = static_cast<int>(p), .local = local, .weight = weight});
      sum += weight;
    }
    if (!(sum > 0.0)) {
      // Edges without length join it to the borders of all its parts.
      for (std::size_t i = first; i < shares_.size(); ++i) shares_[i].weight = 1.0;
      sum = static_cast<double>(shares_.size() - first);
    }
    for (std::size_t i = first; i < shares_.size(); ++i) shares_[i].weight /= sum;
    const auto none = std::remove_if(shares_.begin() + static_cast<std::ptrdiff_t>(first), shares_.end(),
                                     [](const Share& share) { return share.weight == 0.0; });
    shares_.erase(none, shares_.end());
    first_share_.push_back(shares_.size());
  }
}

std::span<const PartHierarchy::Share> PartHierarchy::shares(std::int32_t vertex) const {
  const std::size_t first = first_share_.at(static_cast<std::size_t>(vertex));
  return {shares_.data() + first, first_share_.at(static_cast<std::size_t>(vertex) + 1) - first};
}

int PartHierarchy::main_part(std::int32_t vertex) const {
  return std::ranges::max_element(shares(vertex), {}, &Share::weight)->part_idx;
}

void PartHierarchy::check_shapes(std::span<const Coordinates> part_positions) const {
  if (part_positions.size() != parts_.size()) {
    throw InvalidArgument(
        fmt::format("positions of {} parts are given; expected {}", part_positions.size(), parts_.size()));
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (part_positions[p].rows() == static_cast<Eigen::Index>(parts_[p].vertices.size())) continue;
    throw InvalidArgument(fmt::format("{} positions are given for part '{}'; expected {}",
                                      part_positions[p].rows(), parts_[p].name, parts_[p].vertices.size()));
  }
}

void PartHierarchy::recombine_vertex(std::span<const Coordinates> part_positions, std::int32_t vertex,
                                     Coordinates& out) const {
  const auto place = [&](const Share& share) {
    return part_positions[static_cast<std::size_t>(share.part_idx)].row(share.local);
  };
  const Share* share = shares_.data() + first_share_[static_cast<std::size_t>(vertex)];
  const Share* end = shares_.data() + first_share_[static_cast<std::size_t>(vertex) + 1];
  // Differences from one of the parts: equal places give the same place, whatever rounding does to weights.
  const Eigen::RowVector3d base = place(*share);
  Eigen::RowVector3d offset = Eigen::RowVector3d::Zero();
  for (++share; share != end; ++share) offset += share->weight * (place(*share) - base);
  out.row(vertex) = base + offset;
}

void PartHierarchy::recombine(std::span<const Coordinates> part_positions, Coordinates& out) const {
  check_shapes(part_positions);
  out.resize(vertex_count(), 3);
  for (std::int32_t v = 0; v < vertex_count(); ++v) recombine_vertex(part_positions, v, out);
}

void PartHierarchy::recombine(std::span<const Coordinates> part_positions,
                              std::span<const std::int32_t> vertices, Coordinates& out) const {
  check_shapes(part_positions);
  if (out.rows() != vertex_count()) {
    throw InvalidArgument(
        fmt::format("the surface to recombine has {} rows; expected {}", out.rows(), vertex_count()));
  }
  for (const std::int32_t v : vertices) {
    if (v < 0 || v >= vertex_count())
      throw InvalidArgument(fmt::format("vertex {} is out of range: there are {}", v, vertex_count()));
    recombine_vertex(part_positions, v, out);
  }
}

}  // namespace reprise
