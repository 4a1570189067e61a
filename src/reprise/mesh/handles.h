// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Cuts the handles of a closed surface.

#pragma once

#include "reprise/mesh/closest_point.h"

namespace reprise {

// The same surface without handles: short loops that no disc on the surface fills are cut and closed with a
// cap on either side, until none is left (a tunnel is filled, a bridge is cut, whichever is shorter). Loops
// come from a shortest-path tree and a spanning tree of what it leaves of the dual graph (Erickson and
// Whittlesey, Greedy optimal homotopy and homology generators, SODA 2005). `mesh` is closed, manifold and
// connected. Throws `InvalidArgument` if it is not closed or not manifold.
TriangleMesh without_handles(TriangleMesh mesh);

}  // namespace reprise
