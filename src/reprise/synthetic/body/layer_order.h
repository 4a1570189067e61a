// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What is worn over what: outer layers kept outside, and what they hide.

#pragma once

#include <vector>

#include "reprise/synthetic/body/fitted_layer.h"

namespace reprise::body {

// Moves vertices of `outer` that lie less than `gap` metres over `inner`, or a little under it, outwards.
// `under`: triangles of `inner` that count, one a triangle; empty: all.
void keep_outside(FittedLayer& outer, const FittedLayer& inner, double gap, const std::vector<bool>& under);

// The triangles of `inner` that `outer` hides whatever the pose: all corners close under it (or a little
// over it, where it would shine through), away from its borders and where it is not free.
std::vector<bool> hidden_under(const FittedLayer& inner, const FittedLayer& outer);

}  // namespace reprise::body
