// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A long skirt made of the body's helper: a tube of quads from the waist to the ankles.

#pragma once

#include "reprise/synthetic/body/fitted_layer.h"

namespace reprise::body {

// Cut into gores, as a tailor would: each an even strip of the texture. Throws `FileError` if the helper is
// not a tube of quads. `points` and `weights`: of all vertices of the body.
FittedLayer make_long_skirt(const MakehumanBody& body, const Points& points,
                            const std::vector<BoneWeights>& weights);

}  // namespace reprise::body
