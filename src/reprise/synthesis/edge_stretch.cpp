// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/edge_stretch.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace reprise {
namespace {

constexpr std::size_t bins = std::size_t{1} << 16U;
constexpr double octaves = 8.0;
constexpr double shortest = 1e-9;  // metres

}  // namespace

ReferenceEdges::ReferenceEdges(const Topology& topology, const PositionsView& reference) {
  std::set<std::pair<std::int32_t, std::int32_t>> unique;
  for (const auto& [a, b, c] : topology.triangles) {
    unique.insert({std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)});
  }
  for (const auto& [a, b] : unique) {
    const double length = (reference.row(a) - reference.row(b)).cast<double>().norm();
    if (length < shortest) continue;
    edges.emplace_back(a, b);
    lengths.push_back(length);
  }
}

EdgeStretch::EdgeStretch(std::shared_ptr<const ReferenceEdges> reference)
    : reference_(std::move(reference)), counts_(bins, 0) {}

void EdgeStretch::add(const PositionsView& frame) {
  for (std::size_t e = 0; e < reference_->edges.size(); ++e) {
    const auto& [a, b] = reference_->edges[e];
    const double length = (frame.row(a) - frame.row(b)).cast<double>().norm();
    const double ratio = std::max(length, shortest) / reference_->lengths[e];
    double position = (std::log2(ratio) + octaves) / (2.0 * octaves) * static_cast<double>(bins);
    // A length that is no number is no small one.
    if (std::isnan(position)) position = static_cast<double>(bins);
    ++counts_[static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(bins - 1)))];
  }
  total_ += reference_->edges.size();
}

double EdgeStretch::percentile(double share) const {
  const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
  std::uint64_t seen = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    seen += counts_[b];
    if (seen >= rank && seen > 0) {
      return std::exp2((static_cast<double>(b) + 0.5) / static_cast<double>(bins) * 2.0 * octaves - octaves);
    }
  }
  return 0.0;
}

}  // namespace reprise
