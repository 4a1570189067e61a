// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What pops are relative to.

#pragma once

#include <cstddef>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

// Largest vertex acceleration (second difference) at a frame with a frame on either side, m/frame^2.
double peak_acceleration(const MeshSequence& sequence, std::size_t frame_idx);
double peak_acceleration(const PositionsView& before, const PositionsView& here, const PositionsView& after);

// That of all captured frames with a frame on either side. Parallel.
std::vector<double> captured_peak_accelerations(const PerformanceDatabase& database);

// What a capture itself reaches: the 99th percentile (nearest rank), over all frames with a frame on either
// side, of the largest vertex acceleration, m/frame^2. 0 if no clip has three frames. Parallel.
double captured_acceleration(const PerformanceDatabase& database);

}  // namespace reprise
