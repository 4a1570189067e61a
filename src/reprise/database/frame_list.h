// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Several frames in one word, as the user writes them.

#pragma once

#include <string>
#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

// "CLIP" (all of its frames), "CLIP:FRAME", "CLIP:FIRST-LAST" (both included) or "CLIP:FIRST-LAST:STEP": the
// frames named, ascending. Throws `InvalidArgument` for an unknown clip, what is not a number from 0, a frame
// beyond the clip, LAST before FIRST, and STEP 0; it quotes the text.
std::vector<FrameId> parse_frames(const PerformanceDatabase& database, const std::string& text);

}  // namespace reprise
