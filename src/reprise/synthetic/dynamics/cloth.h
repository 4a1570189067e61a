// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A garment as cloth.

#pragma once

#include <memory>
#include <vector>

#include "reprise/synthetic/dynamics/soft_layer.h"

namespace reprise::dynamics {

// A light cotton, lined.
struct ClothMaterial {
  double density = 0.18;     // kg/m^2
  double stretch = 1500.0;   // N/m along threads
  double shear = 60.0;       // N/m across them
  double bending = 1e-4;     // N m
  double damping = 0.03;     // seconds in which bending and shear forget their speed
  double drag = 1.5;         // 1/s, in air, beside what it does to its broad side
  double thickness = 0.004;  // metres kept from the body
};

// Particles of a surface, linked along its edges and across its quads, and bent at its edges. `freedom` and
// `fullness` (empty: 1): one a particle, see `BodyLayer`. Triangles without area are left out; a piece that
// nothing holds is held loosely all over.
ParticleSystem make_cloth(const Points& points, const std::vector<Triangle>& triangles,
                          const std::vector<double>& freedom, const ClothMaterial& material,
                          const std::vector<double>& fullness = {});

// Metres along the normal by which particles of a full cloth begin outside of the place where they lie at
// rest: folds about `width` wide that run down. Left to itself, cloth that is wider than its place crumples
// into the smallest folds its triangles can make. Empty if nothing is full.
std::vector<double> fold_offsets(const Points& points, const std::vector<double>& fullness, double width);

// Greatest and mean of |length / rest length - 1| over the rigid links: along threads.
struct Strain {
  double greatest = 0.0;
  double mean = 0.0;
};
Strain strain(const ParticleSystem& particles);

class ClothLayer : public SoftLayer {
 public:
  ClothLayer(const BodyLayer& layer, const ClothMaterial& material, std::vector<Triangle> body_triangles,
             const Points& body_at_rest);

  void start(const Points& skinned, const Points& body) override;
  void advance(const Points& skinned_after, const Points& body_after, const FrameSettings& settings) override;
  Points points() override;
  const ParticleSystem& particles() const override { return particles_; }

 private:
  Points gather(const Points& vertices) const;

  std::vector<int> particle_of_;  // of every vertex
  std::vector<int> vertex_of_;    // the first one of every particle
  std::vector<double> folds_;     // offset of every particle at the start, empty: none
  ParticleSystem particles_;
  FramePlayer player_;
};

}  // namespace reprise::dynamics
