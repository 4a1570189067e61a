// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A few vertices that stand for the whole surface.

#pragma once

#include <cstdint>
#include <vector>

#include "reprise/mesh/topology.h"

namespace reprise {

// Farthest-point samples, in the order they are chosen, so that the first of them are samples as well: each
// next vertex is one of those most steps along edges away from all before it. Steps, not metres: the choice
// is the same for every pose and place, to the last bit. Vertices of no triangle are left out; all others are
// returned if there are no more than `count`.
std::vector<std::int32_t> sample_vertices(const Topology& topology, int count);

}  // namespace reprise
