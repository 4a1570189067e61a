// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What cloth and hair share: a layer of the body that is played frame by frame against the moving body.

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "reprise/synthetic/body/dressed_body.h"
#include "reprise/synthetic/dynamics/body_collider.h"
#include "reprise/synthetic/dynamics/moving_points.h"
#include "reprise/synthetic/dynamics/particle_system.h"

namespace reprise::dynamics {

struct FrameSettings {
  int substeps = 20;
  double seconds = 1.0 / 25.0;  // a frame
  Surroundings surroundings;
};

class SoftLayer {
 public:
  virtual ~SoftLayer() = default;

  // Puts everything where the skin says, at rest, on a body that stands still until the end of the first
  // frame but one.
  virtual void start(const Points& skinned, const Points& body) = 0;

  // Plays one frame. `skinned_after`, `body_after`: the skinned layer and the body one frame after the end of
  // the frame to play.
  virtual void advance(const Points& skinned_after, const Points& body_after,
                       const FrameSettings& settings) = 0;

  // Places of the layer's vertices.
  virtual Points points() = 0;

  virtual const ParticleSystem& particles() const = 0;
};

// Particles of one system, what holds them and what they may touch, through one frame after another.
class FramePlayer {
 public:
  FramePlayer(std::vector<Triangle> body_triangles, Eigen::Index body_vertices);

  // `targets`: one row a particle.
  void start(ParticleSystem& particles, const Points& targets, const Points& body);
  void advance(ParticleSystem& particles, const Points& targets_after, const Points& body_after,
               const FrameSettings& settings);

  // The targets and the body at the end of the frame played last.
  const Points& targets() const { return targets_.end(); }
  BodyCollider& collider() { return collider_; }

 private:
  BodyCollider collider_;
  MovingPoints targets_, body_;
  Points target_, target_before_, body_now_;
};

// Shortest ways over links from the nearest of `sources`: length (infinite where there is none), that source
// and the particle before, or -1.
struct LinkDistances {
  std::vector<double> length;
  std::vector<int> source;
  std::vector<int> previous;
};
LinkDistances link_distances(std::size_t particles, std::span<const Link> links,
                             std::span<const int> sources);

// Vertices at the same place (within a micrometre) become one particle: index of the particle of every
// vertex, in order of first vertex.
std::vector<int> merge_coincident(const Points& points);

// Pull towards the skinned place for a particle of that mass: endless at freedom 0, none at 1; and how far it
// may stray.
Attachment attachment_for(int particle, double freedom, double mass);

// Freedom up to which a particle is simply put where the skin says.
inline constexpr double pinned_freedom = 0.02;

// Thickness kept by every particle: what the costume leaves at rest where it is less than `thickness`.
void set_thickness(ParticleSystem& particles, BodyCollider& collider, double thickness, double least);

}  // namespace reprise::dynamics
