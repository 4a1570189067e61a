// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Isotropic remeshing of a closed surface, with a sizing field. After Botsch and Kobbelt, A remeshing
// approach to multiresolution modeling (SGP 2004): split, collapse, flip, tangential smoothing, projection.

#pragma once

#include <array>
#include <vector>

#include "reprise/mesh/closest_point.h"

namespace reprise {

struct RemeshOptions {
  int vertices = 2500;  // met exactly where the shape allows
  int iterations = 12;  // rounds at the final size
  // Lines on the surface, such as hems, that draw vertices close by onto them.
  std::vector<std::array<Eigen::Vector3d, 2>> creases;
};

// A closed, manifold mesh of the same surface, of the same genus, with edges of about the same length times
// the relative size there. Vertices lie on `dense`. `relative_size`: one positive value a vertex of `dense`,
// or empty for a uniform mesh. Deterministic. Throws `InvalidArgument` if `dense` is not closed and manifold
// or the options are out of range.
TriangleMesh remesh(const TriangleMesh& dense, const std::vector<double>& relative_size,
                    const RemeshOptions& options);

// Moves vertices out of (or into) the surface `dense` they lie on, so that triangles lie about it instead of
// inside of it: a coarse mesh of a finger keeps its thickness. No vertex moves farther than `limit`.
void balance(const TriangleMesh& dense, double limit, TriangleMesh& mesh);

// Area-weighted unit normal of every point; zero where no triangle of positive area meets it.
std::vector<Eigen::Vector3d> vertex_normals(const TriangleMesh& mesh);

// Standard deviation over mean of all edge lengths.
double edge_length_variation(const TriangleMesh& mesh);

// Number of handles of a closed, manifold, connected mesh without unused points.
int genus(const TriangleMesh& mesh);

}  // namespace reprise
