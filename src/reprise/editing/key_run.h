// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Neighbouring key edits of a clip as smooth functions of time.

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reprise/deform/surface_editor.h"
#include "reprise/mesh/mesh.h"

namespace reprise {

// How a surface stands, from vertices that move nearly as one: the rotation of their best rigid fit.
class SurfaceTurning {
 public:
  SurfaceTurning(std::vector<std::int32_t> vertices, const PositionsView& reference);

  // Reference to frame.
  Eigen::Matrix3d operator()(const PositionsView& frame) const;

 private:
  std::vector<Eigen::Vector3d> gather(const PositionsView& frame) const;

  std::vector<std::int32_t> vertices_;
  std::vector<Eigen::Vector3d> reference_;
  std::vector<double> weights_;
};

// 6 t^5 - 15 t^4 + 10 t^3 of `t` clamped to [0, 1]: at both ends first and second derivative are zero.
double quintic_smoothstep(double t);

// What a frame takes from the keys on either side of it; before the first and after the last key, and on a
// key, `b` is `a`'s share of nothing.
struct KeyMix {
  std::size_t a = 0, b = 0;  // indices of keys
  double share_a = 0.0, share_b = 0.0;
};

// A key edit that was solved.
struct SolvedKey {
  std::size_t frame_idx = 0;
  std::vector<PositionConstraint> constraints;
  Coordinates frame;                     // as captured
  Coordinates result;                    // as edited
  std::vector<Eigen::VectorXd> changes;  // of learnt coefficients, one vector a part; or none
};

class KeyRun {
 public:
  // `keys`: ascending frames, at least one. `window`: in frames; 0: held.
  KeyRun(std::vector<SolvedKey> keys, double window, const SurfaceTurning& turning);

  const std::vector<SolvedKey>& keys() const { return keys_; }
  // Whether all keys constrain the same vertices.
  bool is_uniform() const { return is_uniform_; }
  // First and last frame with a displacement, of a clip of that many.
  std::pair<std::size_t, std::size_t> support(std::size_t frame_count) const;

  KeyMix mix(std::size_t frame_idx) const;
  // What to ask of a frame; none if nothing is displaced in it.
  std::vector<PositionConstraint> constraints(const KeyMix& mix, const PositionsView& frame) const;
  // Mixed changes of coefficients, or none.
  std::vector<Eigen::VectorXd> changes(const KeyMix& mix) const;

 private:
  void gather_vertices();

  std::vector<SolvedKey> keys_;
  double window_;
  const SurfaceTurning& turning_;
  bool is_uniform_ = true;
  std::vector<std::int32_t> vertices_;      // constrained by any key, ascending
  std::vector<Coordinates> displacements_;  // one a key, a row for each of `vertices_`, in the turned frame
  std::vector<Eigen::VectorXd> weights_;    // likewise
};

}  // namespace reprise
