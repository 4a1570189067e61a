// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which frames of a motion to keep where a format cannot hold them all.

#pragma once

#include <cstddef>
#include <vector>

#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// At most `max_frames` (>= 2) frames of the sequence, in order, the first and the last among them. Frames are
// dropped one at a time, always the one whose loss costs least: the largest distance of a vertex, in any
// frame dropped so far, to the straight line between the kept frames on either side. So fast motion keeps its
// frames and slow motion gives them up.
std::vector<std::size_t> thin_frames(const MeshSequence& sequence, std::size_t max_frames);

// That largest distance, metres, for any choice of frames that holds the first and the last.
double thinning_error(const MeshSequence& sequence, const std::vector<std::size_t>& kept);

}  // namespace reprise
