// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// CGAL's as-rigid-as-possible deformation (Sorkine and Alexa 2007), as a peer of our editors. GPL: benchmarks
// only.

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "reprise/deform/position_constraint.h"
#include "reprise/mesh/mesh.h"

namespace reprise::benchmark {

class ArapPeer {
 public:
  // The whole mesh may move; `held` are its control vertices, and stay until they are dragged.
  ArapPeer(const Topology& topology, const Positions& frame, std::span<const std::int32_t> held);
  ~ArapPeer();

  // Empty if CGAL takes the mesh (an oriented manifold); otherwise why not.
  const std::string& refusal() const { return refusal_; }
  // Weights and factorisation, processor time.
  double preparation_ms() const { return preparation_ms_; }

  // Ten iterations from the last result.
  void drag(std::span<const PositionConstraint> constraints);
  Eigen::Vector3d position(std::int32_t vertex) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::string refusal_;
  double preparation_ms_ = 0.0;
};

}  // namespace reprise::benchmark
