// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A skeleton that can be seen.

#pragma once

#include "reprise/sequence/mesh_sequence.h"
#include "reprise/sequence/skeleton.h"

namespace reprise {

struct SkeletonSurfaceOptions {
  double thickness = 0.14;  // of a bone, share of its length
  double thinnest = 0.012;  // metres
  double thickest = 0.035;
  double ball = 0.018;          // radius of the end of a chain, metres
  Color left = {64, 120, 192};  // bones whose names say left, right, or neither
  Color right = {204, 88, 56};
  Color middle = {112, 112, 112};
};

// Each bone, from a joint to each of its children, as an octahedron that is thickest near the joint; ends of
// chains as small balls. Closed surfaces of one topology; one colour a vertex. Throws `InvalidArgument` for a
// motion without frames or joints.
MeshSequence skeleton_surface(const SkeletalMotion& motion, const SkeletonSurfaceOptions& options = {});

}  // namespace reprise
