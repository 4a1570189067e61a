// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Hair as a springy body of guides.

#pragma once

#include <vector>

#include "reprise/synthetic/dynamics/soft_layer.h"

namespace reprise::dynamics {

struct HairMaterial {
  double spacing = 0.022;    // metres between guide particles
  double mass = 0.15;        // kg, the whole head of hair
  double bending = 12.0;     // rad/s at which strands straighten again
  double cohesion = 40.0;    // rad/s at which neighbouring strands keep together
  double damping = 0.03;     // seconds in which both forget their speed
  double combing = 3.5;      // rad/s at which it is drawn to the place where it hangs at rest
  double drag = 2.5;         // 1/s, in air
  double thickness = 0.010;  // metres that guides keep from the body; vertices keep 3 mm
};

// Cards of hair are too many and too loose to be cloth: one by one they fall apart. Guide particles are
// sampled among the vertices instead, linked with all their neighbours: stiff along the strands (down the
// distance from the scalp), soft across. Vertices follow the guides near them, places and rotations both,
// with weights that fade smoothly, so that what was side by side stays so.
class HairLayer : public SoftLayer {
 public:
  HairLayer(const BodyLayer& layer, const HairMaterial& material, std::vector<Triangle> body_triangles,
            const Points& body_at_rest);

  void start(const Points& skinned, const Points& body) override;
  void advance(const Points& skinned_after, const Points& body_after, const FrameSettings& settings) override;
  Points points() override;
  const ParticleSystem& particles() const override { return particles_; }

 private:
  struct Weight {
    int guide = 0;
    double weight = 0.0;
  };
  Points gather(const Points& vertices) const;
  void link_guides(const std::vector<double>& freedom, const HairMaterial& material);
  void bind_vertices(const Points& rest, double spacing);
  std::vector<Eigen::Matrix3d> guide_rotations(const Points& skinned_guides) const;

  std::vector<int> guides_;  // vertex of every guide
  std::vector<std::vector<int>> neighbours_;
  std::vector<int> binding_begin_;  // of each vertex, in `bindings_`
  std::vector<Weight> bindings_;
  std::vector<double> looseness_;  // of every vertex: 0 stays where the skin says, 1 follows the guides
  std::vector<double> clearance_;  // of every vertex: kept from the body
  ParticleSystem particles_;
  FramePlayer player_;
  MovingPoints skinned_;
};

}  // namespace reprise::dynamics
