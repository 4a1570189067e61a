// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/soft_layer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace reprise::dynamics {

using Eigen::Vector3d;

namespace {

constexpr double search_radius = 0.025;  // metres: what a particle may come nearer between searches, and more
constexpr int searches_per_frame = 4;

}  // namespace

FramePlayer::FramePlayer(std::vector<Triangle> body_triangles, Eigen::Index body_vertices)
    : collider_(std::move(body_triangles), body_vertices) {}

void FramePlayer::start(ParticleSystem& particles, const Points& targets, const Points& body) {
  targets_.start(targets);
  body_.start(body);
  collider_.move(body);
  target_ = targets;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.position[i] = targets.row(static_cast<Eigen::Index>(i));
    particles.velocity[i].setZero();
  }
}

void FramePlayer::advance(ParticleSystem& particles, const Points& targets_after, const Points& body_after,
                          const FrameSettings& settings) {
  targets_.advance(targets_after);
  body_.advance(body_after);
  const double seconds = settings.seconds / settings.substeps;
  const int search_every = std::max(1, settings.substeps / searches_per_frame);
  for (int substep = 0; substep < settings.substeps; ++substep) {
    const double part = (substep + 1.0) / settings.substeps;
    target_before_.swap(target_);
    targets_.evaluate(part, target_);
    body_.evaluate(part, body_now_);
    collider_.move(body_now_);
    if (substep % search_every == 0) particles.search(collider_, search_radius);
    particles.step(seconds, target_, target_before_, &collider_, settings.surroundings);
  }
}

LinkDistances link_distances(std::size_t particles, std::span<const Link> links,
                             std::span<const int> sources) {
  std::vector<std::vector<std::pair<int, double>>> neighbours(particles);
  for (const Link& link : links) {
    neighbours[static_cast<std::size_t>(link.a)].emplace_back(link.b, link.length);
    neighbours[static_cast<std::size_t>(link.b)].emplace_back(link.a, link.length);
  }
  LinkDistances result{std::vector<double>(particles, std::numeric_limits<double>::infinity()),
                       std::vector<int>(particles, -1), std::vector<int>(particles, -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const int source : sources) {
    result.length[static_cast<std::size_t>(source)] = 0.0;
    result.source[static_cast<std::size_t>(source)] = source;
    open.emplace(0.0, source);
  }
  while (!open.empty()) {
    const auto [length, particle] = open.top();
    open.pop();
    const auto p = static_cast<std::size_t>(particle);
    if (length > result.length[p]) continue;
    for (const auto& [neighbour, step] : neighbours[p]) {
      const auto n = static_cast<std::size_t>(neighbour);
      if (length + step >= result.length[n]) continue;
      result.length[n] = length + step;
      result.source[n] = result.source[p];
      result.previous[n] = particle;
      open.emplace(result.length[n], neighbour);
    }
  }
  return result;
}

std::vector<int> merge_coincident(const Points& points) {
  std::map<std::array<long long, 3>, int> seen;
  std::vector<int> particle_of(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const std::array<long long, 3> key = {std::llround(points(v, 0) * 1e6), std::llround(points(v, 1) * 1e6),
                                          std::llround(points(v, 2) * 1e6)};
    particle_of[static_cast<std::size_t>(v)] =
        seen.try_emplace(key, static_cast<int>(seen.size())).first->second;
  }
  return particle_of;
}

Attachment attachment_for(int particle, double freedom, double mass) {
  // As a damped spring: 30 rad/s at freedom 1/2, firm below, soft above. The reach keeps a shirt from being
  // pushed up by arms that come too close: 1.8 cm at freedom 1/2.
  const double part = (1.0 - freedom) / std::max(freedom, 1e-3);
  const double rate = 30.0 * part;
  const double none = std::numeric_limits<double>::infinity();
  if (!(part > 0.0)) return {particle, none, 0.0, none};
  return {particle, 1.0 / (mass * rate * rate), 1.0 / rate, 0.018 / part};
}

void set_thickness(ParticleSystem& particles, BodyCollider& collider, double thickness, double least) {
  particles.thickness.assign(particles.size(), thickness);
  particles.search(collider, search_radius);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    std::int32_t triangle = particles.candidates(i)[0];
    if (triangle < 0) continue;
    const Touch touch = collider.touch(particles.position[i], triangle);
    if (touch.valid) particles.thickness[i] = std::clamp(touch.distance, least, thickness);
  }
}

}  // namespace reprise::dynamics
