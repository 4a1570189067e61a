// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A layer of the dressed body while it is tailored: fitted, sewn together, reshaped, refined.

#pragma once

#include <vector>

#include "reprise/synthetic/body/body_skinning.h"
#include "reprise/synthetic/body/costume.h"

namespace reprise::body {

struct FittedLayer {
  BodyLayer layer;
  std::vector<BoneWeights> weights;  // one a vertex
};

// Faces of a mesh as triangles, with its texture coordinates. Vertices that no face uses are left out.
// `points` and `weights`: of all vertices of the mesh. `used`: one a face; empty: all.
FittedLayer make_layer(const MakehumanMesh& mesh, const Points& points,
                       const std::vector<BoneWeights>& weights, const std::vector<bool>& used);

// Joins vertices that lie at the same place along borders, where a garment was cut for its texture only.
void sew(FittedLayer& fitted);

// Keeps the connected pieces whose middle is above (`upper`) or below the middle between the highest and the
// lowest of them.
void keep_pieces(FittedLayer& fitted, CostumePieces pieces);

// Stretches what is below `waist` so that it ends at `hem`, and widens it towards there about the vertical
// axis through `axis`.
void reshape_skirt(FittedLayer& fitted, double waist, double hem, double flare, const Eigen::Vector3d& axis);

// Splits edges longer than `edge_length` where the layer is free, until none is left or after a few rounds.
void refine(FittedLayer& fitted, double edge_length);

// Freedom by height: 0 above `from`, `most` below `to`, smooth between. Empty if `most` is 0.
std::vector<double> freedom_by_height(const Points& points, const CostumeFreedom& freedom);

// Fullness by height: 1 above `waist`, `at_hem` at the lowest point. Empty if `at_hem` is 1.
std::vector<double> fullness_by_height(const Points& points, double waist, double at_hem);

// Unit normals at the vertices, weighted by area.
Points vertex_normals(const Points& points, const std::vector<Triangle>& triangles);

}  // namespace reprise::body
