// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// How much of its surroundings each vertex sees: the soft darkening under chins, arms and hems.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/mesh/mesh.h"

namespace reprise {

// Which side of the surface a vertex is seen from.
enum class SurfaceSide : std::int8_t {
  both,      // of an open surface
  normal,    // of a closed one whose normals point outwards
  opposite,  // of a closed one that is inside out
};

// Per vertex, by its connected component in these positions.
std::vector<SurfaceSide> surface_sides(const Topology& topology, const PositionsView& positions);

// Of either side of a surface: the part of the directions from which nothing hides it, weighted by the cosine
// to its normal. 1 on a lone convex body.
struct Openness {
  float front = 1.0F;  // where the normal points
  float back = 1.0F;
};

// Per vertex. Seen through depth maps from 24 directions, so details below about a hundredth of the
// character's height count as flat. `normals`: unit or zero. Vertices that are not finite see everything.
std::vector<Openness> openness(const Topology& topology, const PositionsView& positions,
                               const PositionsView& normals);

}  // namespace reprise
