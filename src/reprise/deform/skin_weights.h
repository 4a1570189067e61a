// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How much each vertex follows each bone, found from a markup's skeleton (bone heat, Baran and Popovic 2007).

#pragma once

#include <Eigen/SparseCore>

#include "reprise/database/markup.h"
#include "reprise/mesh/topology.h"

namespace reprise {

// N x joints: the share of every joint's bone in every vertex; not negative, rows sum to 1.
using SkinWeights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct SkinWeightOptions {
  double heat = 1.0;   // c below: more keeps the seam between two bones narrower
  int most_bones = 4;  // bones a vertex follows; 0: all
};

// The equilibrium of heat on the markup's reference surface where bone j is at 1 and all others at 0:
//   (L + M H) w_j = M H p_j,   H = c / d^2,
// L the Laplacian, M the area of the vertices, d a vertex's distance from its own bone and p_j 1 for that
// bone, else 0. The bone of a joint is the segments from it to its children. That of a joint without children
// ends in the middle of the vertices labelled with it or, if there are none, goes on as its parent's does and
// as far; it may be a point.
//
// Which bone is a vertex's own, for clothed captures. A labelled vertex (Markup::joint_of_vertex) trusts its
// label, however near other bones are: hands beside a skirt and arms along the trunk do not heat each other.
// A vertex without a label (skirt, long hair, the membrane that closes a hem) takes the nearest bone that it
// sees: a straight line inside the surface leads to the bone's nearest point. Equally near bones share alike.
// Far from the bones H is weak, so a wide skirt varies smoothly from bone to bone. Where it sees none, a
// vertex has no heat of its own (H = 0) and takes what comes along the surface. A connected component that
// gets no heat in this way takes the nearest bones, seen or not. Bones that are no vertex's own (collars
// without labels) weigh nothing.
//
// A vertex with more than `most_bones` bones keeps the largest shares less the largest one dropped, so that
// no crease shows where the choice of bones changes. Throws `InvalidArgument` if the markup does not fit the
// topology, has no joints, or an option is out of range (heat > 0 and finite, most_bones >= 0).
SkinWeights skin_weights(const TopologyPtr& topology, const Markup& markup,
                         const SkinWeightOptions& options = {});

// Throws `InvalidArgument` unless the weights are one row a vertex and one column a joint, not negative, with
// rows that sum to 1 (to 1e-6).
void validate(const SkinWeights& weights, std::int32_t vertex_count, int joint_count);

}  // namespace reprise
