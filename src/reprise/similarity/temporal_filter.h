// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The matrix as a blend sees it: averaged along the window of a transition (HSSMG 4.2, Figure 4).

#pragma once

#include "reprise/similarity/dissimilarity_matrix.h"

namespace reprise {

// Entry (a, b): mean of the values at (a + k, b + k), k in [-half_window, half_window], weighted by the
// alpha'(k) = min(1 - alpha, alpha) of Eq. 2 with the linear alpha; frames beyond the end of either clip do
// not count. Lower bounds are averaged likewise. Throws `InvalidArgument` unless half_window >= 1.
DissimilarityMatrix temporally_filtered(const DissimilarityMatrix& matrix, int half_window);

}  // namespace reprise
