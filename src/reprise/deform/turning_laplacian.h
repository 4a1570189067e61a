// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Laplacian coordinates of a frame that turn with the surface (LPBM III). Internal to `LaplacianEditor`.

#pragma once

#include <vector>

#include "reprise/deform/gradient_field.h"
#include "reprise/deform/surface_laplacian.h"

namespace reprise {

// Every triangle has a rotation from the frame s to the surface x: it takes normal to normal and, within the
// plane, edges to edges best. R_t is their mean, weighted by area, over the triangles that share a vertex
// with t, and with the frame's gradients F_s the turned coordinates are delta = M^-1/2 G^T A (R F_s). The
// mean keeps a surface from crumpling, since folds that stretch no triangle would cost nothing without it,
// and leaves slivers no say. A loose component turns as the triangles around its carrier do.
class TurningLaplacian {
 public:
  // Throws `InvalidArgument` as `SurfaceLaplacian` does.
  TurningLaplacian(const TopologyPtr& topology, const PositionsView& reference);

  // The operator, with a loose component for every piece of surface but the one of most vertices.
  const SurfaceLaplacian& laplacian() const { return laplacian_; }

  // `frame`: N x 3, metres.
  void set_frame(const Coordinates& frame);

  // L x - delta(R(x)), rows() x 3. `positions`: N x 3, finite.
  void residual(const Coordinates& positions, Coordinates& out);

 private:
  // K = A G G^T of the reference triangle without its first row and column, which follow from row sums of 0.
  struct Element {
    double k11 = 0.0, k12 = 0.0, k22 = 0.0;
  };
  // A triangle of the frame: its edges in the world and in its tangent frame, where e1 = (a, 0) and e2 = (b,
  // c).
  struct FrameTriangle {
    Eigen::Vector3d e1, e2;
    double a = 0.0, b = 0.0, c = 0.0;
    double weight = 0.0;
    Eigen::Quaterniond tangent_from_world;
  };

  TurningLaplacian(const TopologyPtr& topology, const PositionsView& reference,
                   const PoissonReconstruction& poisson);
  void find_turns(const Coordinates& positions);

  TopologyPtr topology_;
  std::vector<PartHierarchy::LooseComponent> loose_;
  SurfaceLaplacian laplacian_;
  std::vector<Element> elements_;
  Eigen::VectorXd scale_;  // N: the diagonal of M^-1/2

  std::vector<FrameTriangle> triangles_;
  Coordinates delta_;                      // of the frame, rows() x 3
  std::vector<Eigen::Quaterniond> turns_;  // mean rotation around each vertex
};

}  // namespace reprise
