// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Body, clothes and hair as one solid.

#pragma once

#include "reprise/mesh/closest_point.h"
#include "reprise/synthetic/surface/visible_layers.h"

namespace reprise::capture {

// The surface of what cannot be reached from outside: one closed surface without handles that lies on the
// layers where there is one to lie on. Garments are closed at their borders, hair is a volume. Triangles of
// about `voxel_size`. Deterministic.
TriangleMesh solid_of_layers(const VisibleLayers& layers, double voxel_size);

}  // namespace reprise::capture
