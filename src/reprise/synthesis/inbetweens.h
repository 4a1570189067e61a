// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The surface between the frames of a motion. Internal.

#pragma once

#include <map>

#include "reprise/deform/gradient_field.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// A moment of a motion: alpha in [0, 1) of the way from `frame_idx` to the next frame.
struct Moment {
  std::size_t frame_idx = 0;
  double alpha = 0.0;

  bool is_frame() const { return alpha == 0.0; }
  std::size_t nearest() const { return alpha > 0.5 ? frame_idx + 1 : frame_idx; }
};

// Cubic through the frames, in the gradient field: `blend_frames` of the two neighbours, plus what their own
// neighbours say of how rotations, stretches and centroids speed up. Between x1 and x2, at alpha = a, with
// second differences A1, A2 there:
//
//     x = (1 - a) x1 + a x2 - a (1 - a) / 2 ((1 - a) A1 + a A2)
//
// the cubic with tangents (x[i + 1] - x[i - 1]) / 2. For rotations x1, x2 is the arc and A a rotation vector
// in the frame of the triangle. At the first and the last frame A is that of the frame next to it. So uniform
// motion and constant acceleration are met exactly, and what turns rigidly at an even rate stays rigid.
//
// Keeps references. Gradients of recently used frames are kept: ask in order, from one thread.
class Inbetweens {
 public:
  Inbetweens(const MeshSequence& sequence, const PoissonReconstruction& poisson);

  // The surface at frame_idx + alpha, alpha in (0, 1), frame_idx + 1 < F.
  void reconstruct(std::size_t frame_idx, double alpha, PositionsRef out);

 private:
  // Second difference over a frame and its neighbours.
  struct Bend {
    std::vector<Eigen::Vector3d> rotation;  // rotation vector a triangle
    std::vector<Eigen::Vector3d> stretch;   // xx, xy, yy a triangle
    Eigen::MatrixX3d centroids;             // C x 3
  };
  struct Knot {
    GradientField field;
    Eigen::MatrixX3d centroids;  // C x 3
  };
  const Knot& knot(std::size_t frame_idx);
  const Bend& bend(std::size_t frame_idx);

  const MeshSequence& sequence_;
  const PoissonReconstruction& poisson_;
  std::map<std::size_t, Knot> knots_;
  std::map<std::size_t, Bend> bends_;
};

}  // namespace reprise
