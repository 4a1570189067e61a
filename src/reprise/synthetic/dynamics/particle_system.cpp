// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/dynamics/particle_system.h"

#include <algorithm>
#include <cmath>

#include "reprise/core/parallel.h"

namespace reprise::dynamics {

using Eigen::Vector3d;

namespace {

constexpr double air_density = 1.2;            // kg/m^3
constexpr double drag_coefficient = 1.2;       // of a flat plate across the wind
constexpr double fastest = 15.0;               // m/s, far above what cloth on a dancer reaches
constexpr double recovery = 2.0;               // m/s at which what is inside the body is pushed out
constexpr std::size_t searches_at_once = 128;  // particles worth handing to another thread

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

void ParticleSystem::search(BodyCollider& collider, double radius) {
  Vector3d low = position.front(), high = position.front();
  for (const Vector3d& p : position) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  collider.prepare_search(low, high, radius);
  candidates_.resize(size(), no_candidates);
  parallel_for(
      0, size(),
      [&](std::size_t i) {
        candidates_[i] =
            inverse_mass[i] > 0.0 ? collider.find(position[i], candidates_[i][0]) : no_candidates;
      },
      searches_at_once);
}

void ParticleSystem::step(double seconds, const Points& targets, const Points& targets_before,
                          const BodyCollider* collider, const Surroundings& surroundings) {
  apply_air(seconds, surroundings);
  before_ = position;
  for (std::size_t i = 0; i < size(); ++i) {
    if (inverse_mass[i] > 0.0) {
      velocity[i] += seconds * surroundings.gravity;
      position[i] += seconds * velocity[i];
    } else {
      position[i] = targets.row(static_cast<Eigen::Index>(i));
    }
  }
  solve_attachments(seconds, targets, targets_before);
  solve_links(seconds);
  solve_hinges(seconds);
  solve_tethers();
  contacts_.clear();
  if (collider != nullptr && !candidates_.empty()) solve_contacts(seconds, *collider, surroundings.friction);
  solve_reach(targets);

  for (std::size_t i = 0; i < size(); ++i) {
    velocity[i] = (position[i] - before_[i]) / seconds;
    const double speed = velocity[i].norm();
    if (speed > fastest && inverse_mass[i] > 0.0) velocity[i] *= fastest / speed;
  }
  // Being pushed out of the body must not throw a particle off: cloth does not bounce.
  for (const Contact& contact : contacts_) {
    Vector3d& v = velocity[at(contact.particle)];
    const double away = (v - contact.movement / seconds).dot(contact.normal);
    if (away > 0.0) v -= away * contact.normal;
  }
}

void ParticleSystem::apply_air(double seconds, const Surroundings& surroundings) {
  for (std::size_t i = 0; i < drag.size(); ++i)
    velocity[i] -= (1.0 - std::exp(-drag[i] * seconds)) * (velocity[i] - surroundings.wind);
  for (const Triangle& sail : sails) {
    const std::size_t a = at(sail[0]), b = at(sail[1]), c = at(sail[2]);
    const Vector3d area = 0.5 * (position[b] - position[a]).cross(position[c] - position[a]);
    const double size = area.norm();
    if (!(size > 0.0)) continue;
    const Vector3d normal = area / size;
    const double speed = ((velocity[a] + velocity[b] + velocity[c]) / 3.0 - surroundings.wind).dot(normal);
    const double mobility = (inverse_mass[a] + inverse_mass[b] + inverse_mass[c]) / 9.0;
    if (!(mobility > 0.0)) continue;
    // Never more than would stop the triangle: air cannot push back what it slows down.
    const double impulse =
        std::min(0.5 * air_density * drag_coefficient * size * std::abs(speed) * seconds, 0.5 / mobility);
    const Vector3d change = -impulse * speed / 3.0 * normal;
    velocity[a] += inverse_mass[a] * change;
    velocity[b] += inverse_mass[b] * change;
    velocity[c] += inverse_mass[c] * change;
  }
}

// Every solver below does, for a constraint C with gradient g (XPBD, eq. 26, one sweep a substep):
//   lambda = (-C - gamma g.(x - x_before)) / ((1 + gamma) g.W.g + compliance / h^2), gamma = damping / h.

void ParticleSystem::solve_attachments(double seconds, const Points& targets, const Points& targets_before) {
  for (const Attachment& attachment : attachments) {
    const std::size_t i = at(attachment.particle);
    const Vector3d target = targets.row(attachment.particle);
    const Vector3d target_movement = target - targets_before.row(attachment.particle).transpose();
    const double gamma = attachment.damping / seconds;
    const double w = inverse_mass[i];
    const Vector3d error = position[i] - target;
    const Vector3d movement = position[i] - before_[i] - target_movement;
    position[i] -=
        w / ((1.0 + gamma) * w + attachment.compliance / (seconds * seconds)) * (error + gamma * movement);
  }
}

void ParticleSystem::solve_links(double seconds) {
  const double per_square = 1.0 / (seconds * seconds), per_second = 1.0 / seconds;
  for (const Link& link : links) {
    const std::size_t a = at(link.a), b = at(link.b);
    const double w = inverse_mass[a] + inverse_mass[b];
    const Vector3d d = position[a] - position[b];
    const double length = d.norm();
    if (!(length > 1e-9)) continue;
    double error = length - link.length;
    double resistance = w;
    if (link.damping > 0.0) {
      const double gamma = link.damping * per_second;
      error += gamma * d.dot(d - (before_[a] - before_[b])) / length;
      resistance *= 1.0 + gamma;
    }
    const Vector3d change = error / ((resistance + link.compliance * per_square) * length) * d;
    position[a] -= inverse_mass[a] * change;
    position[b] += inverse_mass[b] * change;
  }
}

void ParticleSystem::solve_hinges(double seconds) {
  const double per_square = 1.0 / (seconds * seconds), per_second = 1.0 / seconds;
  for (const Hinge& hinge : hinges) {
    const auto& k = hinge.weights;
    const std::size_t p0 = at(hinge.particles[0]), p1 = at(hinge.particles[1]), p2 = at(hinge.particles[2]),
                      p3 = at(hinge.particles[3]);
    const Vector3d bend =
        k[0] * position[p0] + k[1] * position[p1] + k[2] * position[p2] + k[3] * position[p3];
    const double size = bend.norm();
    if (!(size > 1e-9)) continue;
    double resistance = k[0] * k[0] * inverse_mass[p0] + k[1] * k[1] * inverse_mass[p1] +
                        k[2] * k[2] * inverse_mass[p2] + k[3] * k[3] * inverse_mass[p3];
    const double gamma = hinge.damping * per_second;
    const Vector3d bend_before =
        k[0] * before_[p0] + k[1] * before_[p1] + k[2] * before_[p2] + k[3] * before_[p3];
    const double error = size - hinge.size + gamma * bend.dot(bend - bend_before) / size;
    resistance = (1.0 + gamma) * resistance + hinge.compliance * per_square;
    const Vector3d change = error / (resistance * size) * bend;
    position[p0] -= inverse_mass[p0] * k[0] * change;
    position[p1] -= inverse_mass[p1] * k[1] * change;
    position[p2] -= inverse_mass[p2] * k[2] * change;
    position[p3] -= inverse_mass[p3] * k[3] * change;
  }
}

void ParticleSystem::solve_tethers() {
  for (const Tether& tether : tethers) {
    Vector3d& p = position[at(tether.particle)];
    const Vector3d d = p - position[at(tether.anchor)];
    const double squared = d.squaredNorm();
    if (squared > tether.length * tether.length) p -= (1.0 - tether.length / std::sqrt(squared)) * d;
  }
}

void ParticleSystem::solve_reach(const Points& targets) {
  for (const Attachment& attachment : attachments) {
    const Vector3d target = targets.row(attachment.particle);
    const Vector3d d = position[at(attachment.particle)] - target;
    const double squared = d.squaredNorm();
    if (squared > attachment.reach * attachment.reach)
      position[at(attachment.particle)] = target + attachment.reach / std::sqrt(squared) * d;
  }
}

void ParticleSystem::solve_contacts(double seconds, const BodyCollider& collider, double friction) {
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::int32_t& triangle : candidates_[i]) {
      if (triangle < 0) break;
      const Touch touch = collider.touch(position[i], triangle);
      if (!touch.valid || touch.distance >= thickness[i]) continue;
      const double inward = touch.movement.dot(touch.normal);
      const double push = std::min(thickness[i] - touch.distance, std::max(0.0, inward) + recovery * seconds);
      position[i] += push * touch.normal;
      const Vector3d slip = position[i] - before_[i] - touch.movement;
      const Vector3d tangential = slip - slip.dot(touch.normal) * touch.normal;
      const double length = tangential.norm();
      if (length > 0.0) position[i] -= std::min(1.0, friction * push / length) * tangential;
      contacts_.push_back({static_cast<int>(i), touch.normal, touch.movement});
    }
  }
}

double ParticleSystem::energy(const Surroundings& surroundings) const {
  double total = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (inverse_mass[i] > 0.0)
      total += (0.5 * velocity[i].squaredNorm() - surroundings.gravity.dot(position[i])) / inverse_mass[i];
  }
  return total;
}

}  // namespace reprise::dynamics
