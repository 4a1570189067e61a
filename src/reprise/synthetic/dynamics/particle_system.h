// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Position-based dynamics for cloth and hair: XPBD (Macklin, Mueller, Chentanez 2016) with small steps
// (Macklin et al. 2019): many substeps, one sweep each. Sweeps run in a fixed order on one thread, so that
// the result does not depend on how many there are; other layers and other clips run beside it.

#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "reprise/synthetic/body/dressed_body.h"
#include "reprise/synthetic/dynamics/body_collider.h"

namespace reprise::dynamics {

// Two particles keep their distance `length` (metres). `compliance`: m/N, 0 is rigid. `damping`: seconds in
// which a compliant link forgets its speed.
struct Link {
  int a = 0;
  int b = 0;
  double length = 0.0;
  double compliance = 0.0;
  double damping = 0.0;
};

// Four particles of two triangles keep the size of their bending vector, sum of weights * place: linear
// bending elements (Bergou et al. 2006) about the shape at rest.
struct Hinge {
  std::array<int, 4> particles{};
  std::array<double, 4> weights{};
  double size = 0.0;
  double compliance = 0.0;
  double damping = 0.0;
};

// A particle comes no farther from an anchor than `length`: keeps long chains from stretching (long range
// attachments, Kim et al. 2012). Anchors are particles of infinite mass.
struct Tether {
  int particle = 0;
  int anchor = 0;
  double length = 0.0;
};

// A particle is drawn to its target, and never farther from it than `reach` (metres): not even by the body.
struct Attachment {
  int particle = 0;
  double compliance = 0.0;
  double damping = 0.0;
  double reach = std::numeric_limits<double>::infinity();
};

struct Surroundings {
  Eigen::Vector3d gravity = {0.0, -9.81, 0.0};  // m/s^2
  Eigen::Vector3d wind = {0.0, 0.0, 0.0};       // m/s
  double friction = 0.3;                        // Coulomb, on the body
};

struct ParticleSystem {
  // One entry a particle. An inverse mass of 0: follows its target.
  std::vector<Eigen::Vector3d> position, velocity;
  std::vector<double> inverse_mass;  // 1/kg
  std::vector<double> thickness;     // metres kept from the body
  std::vector<double> drag;          // 1/s: loses speed against the air at this rate

  std::vector<Link> links;
  std::vector<Hinge> hinges;
  std::vector<Tether> tethers;
  std::vector<Attachment> attachments;
  std::vector<Triangle> sails;  // triangles that the air holds back along their normals

  // Finds what every particle may touch next.
  void search(BodyCollider& collider, double radius);

  // One substep of `seconds`. `targets`: where held particles are at its end, `targets_before`: at its
  // beginning. `collider`: already there; may be null.
  void step(double seconds, const Points& targets, const Points& targets_before, const BodyCollider* collider,
            const Surroundings& surroundings);

  std::size_t size() const { return position.size(); }
  const Candidates& candidates(std::size_t particle) const { return candidates_[particle]; }
  // Joule: of motion and height.
  double energy(const Surroundings& surroundings) const;

 private:
  struct Contact {
    int particle;
    Eigen::Vector3d normal, movement;
  };
  void apply_air(double seconds, const Surroundings& surroundings);
  void solve_attachments(double seconds, const Points& targets, const Points& targets_before);
  void solve_links(double seconds);
  void solve_hinges(double seconds);
  void solve_tethers();
  void solve_reach(const Points& targets);
  void solve_contacts(double seconds, const BodyCollider& collider, double friction);

  std::vector<Eigen::Vector3d> before_;
  std::vector<Candidates> candidates_;
  std::vector<Contact> contacts_;
};

}  // namespace reprise::dynamics
