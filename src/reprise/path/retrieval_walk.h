// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A walk through the retrieval trellis as the motion path it stands for.

#pragma once

#include <vector>

#include "reprise/path/skeleton_retrieval.h"
#include "reprise/path/trellis_sweep.h"

namespace reprise::path_detail {

// Path, path frames, transition cost and counts; what depends on the query is the caller's. A walk that ends
// inside a blend becomes a path that ends with the first pure frame after it.
Retrieval lay_out_walk(const Trellis& trellis, const std::vector<TrellisSweep::Visit>& walk,
                       double frames_per_second);

}  // namespace reprise::path_detail
