// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/ground_contacts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/synthesis/percentile.h"

namespace reprise {
namespace {

void check(const ContactOptions& options) {
  if (!(options.height >= 0.0) || !std::isfinite(options.height)) {
    throw InvalidArgument(
        fmt::format("contact height {} m: expected a finite height from 0", options.height));
  }
  if (!(options.speed > 0.0) || !std::isfinite(options.speed)) {
    throw InvalidArgument(
        fmt::format("contact speed {} m/s: expected a finite speed above 0", options.speed));
  }
}

std::vector<std::int32_t> vertices_in_contact(const PositionsView& now, const PositionsView& next,
                                              double highest, double longest_step) {
  std::vector<std::int32_t> vertices;
  for (Eigen::Index v = 0; v < now.rows(); ++v) {
    if (static_cast<double>(now(v, 1)) > highest || static_cast<double>(next(v, 1)) > highest) continue;
    const double step = std::hypot(static_cast<double>(next(v, 0)) - static_cast<double>(now(v, 0)),
                                   static_cast<double>(next(v, 2)) - static_cast<double>(now(v, 2)));
    if (step <= longest_step) vertices.push_back(static_cast<std::int32_t>(v));
  }
  return vertices;
}

// Connected patches of the marked vertices, each ascending, in order of their first vertices.
std::vector<std::vector<std::int32_t>> connected_patches(const Topology& topology,
                                                         const std::vector<std::int64_t>& marked) {
  Topology induced{.vertex_count = topology.vertex_count};
  const auto is_marked = [&](std::int32_t v) { return marked[static_cast<std::size_t>(v)] > 0; };
  for (const auto& [a, b, c] : topology.triangles) {
    // Edges between marked vertices join them: triangles that repeat a corner.
    if (is_marked(a) && is_marked(b)) induced.triangles.push_back({a, b, b});
    if (is_marked(b) && is_marked(c)) induced.triangles.push_back({b, c, c});
    if (is_marked(c) && is_marked(a)) induced.triangles.push_back({c, a, a});
  }
  const ConnectedComponents components = connected_components(induced);
  std::vector<std::vector<std::int32_t>> of_component(static_cast<std::size_t>(components.count));
  for (std::int32_t v = 0; v < topology.vertex_count; ++v) {
    if (!is_marked(v)) continue;
    of_component[static_cast<std::size_t>(components.of_vertex[static_cast<std::size_t>(v)])].push_back(v);
  }
  std::erase_if(of_component, [](const auto& patch) { return patch.empty(); });
  return of_component;
}

}  // namespace

GroundContacts::GroundContacts(const PerformanceDatabase& database, const ContactOptions& options) {
  check(options);
  if (database.empty()) throw InvalidArgument("ground contacts need a database with clips");

  std::vector<double> tops;
  mean_heights_.assign(static_cast<std::size_t>(database.topology()->vertex_count), 0.0);
  for (const MeshSequence& clip : database.clips()) {
    throw_if_interrupted();
    std::vector<double> lowest(clip.frame_count());
    for (std::size_t f = 0; f < lowest.size(); ++f)
      lowest[f] = static_cast<double>(clip.frame(f).col(1).minCoeff());
    // Not the very lowest point: one bad frame of a capture must not move the ground.
    const double ground = percentile(lowest, 0.05);
    ground_.push_back(ground);

    std::vector<std::vector<std::int32_t>> of_clip(clip.frame_count());
    parallel_for(0, clip.frame_count() - 1, [&](std::size_t f) {
      of_clip[f] = vertices_in_contact(clip.frame(f), clip.frame(f + 1), ground + options.height,
                                       options.speed / clip.frames_per_second());
    });
    touching_.push_back(std::move(of_clip));

    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const PositionsView frame = clip.frame(f);
      tops.push_back(static_cast<double>(frame.col(1).maxCoeff()) - ground);
      for (std::size_t v = 0; v < mean_heights_.size(); ++v)
        mean_heights_[v] += static_cast<double>(frame(static_cast<Eigen::Index>(v), 1)) - ground;
    }
  }
  for (double& height : mean_heights_) height /= static_cast<double>(database.frame_count());
  stature_ = percentile(std::move(tops), 0.5);
  find_feet(*database.topology());
}

void GroundContacts::find_feet(const Topology& topology) {
  constexpr double highest_share = 0.25;   // of the stature: mean height of a foot
  constexpr double fewest_contacts = 0.1;  // of those of the busiest patch
  std::vector<std::int64_t> contacts(mean_heights_.size(), 0);
  for (const auto& of_clip : touching_) {
    for (const auto& vertices : of_clip) {
      for (const std::int32_t v : vertices) ++contacts[static_cast<std::size_t>(v)];
    }
  }
  std::vector<double> busy;
  for (std::vector<std::int32_t>& patch : connected_patches(topology, contacts)) {
    double height = 0.0;
    std::int64_t total = 0;
    for (const std::int32_t v : patch) {
      height += mean_heights_[static_cast<std::size_t>(v)] / static_cast<double>(patch.size());
      total += contacts[static_cast<std::size_t>(v)];
    }
    if (height > highest_share * stature_) continue;
    busy.push_back(static_cast<double>(total));
    feet_.push_back(std::move(patch));
  }
  if (feet_.empty()) return;
  const double least = fewest_contacts * *std::ranges::max_element(busy);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < feet_.size(); ++i) {
    if (busy[i] >= least) std::swap(feet_[kept++], feet_[i]);
  }
  feet_.resize(kept);
}

const std::vector<std::int32_t>& GroundContacts::touching(std::size_t clip_idx, std::size_t frame_idx) const {
  if (clip_idx >= touching_.size() || frame_idx >= touching_[clip_idx].size()) {
    throw InvalidArgument(
        fmt::format("frame {} of clip {}: the database has no such frame", frame_idx, clip_idx));
  }
  return touching_[clip_idx][frame_idx];
}

}  // namespace reprise
