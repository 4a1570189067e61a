// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The captured frames a generated frame is made of.

#pragma once

#include <vector>

#include "reprise/database/performance_database.h"

namespace reprise {

struct FrameSource {
  FrameId id;
  double weight = 1.0;  // in a blend: its share
};

// One frame's sources: itself, or source and partner of a blend.
struct FrameSources {
  std::vector<FrameSource> captured;  // one or two

  bool is_blend() const { return captured.size() > 1; }
  // The one that weighs more; the source in a draw.
  const FrameSource& heavier() const {
    return is_blend() && captured[1].weight > captured[0].weight ? captured[1] : captured[0];
  }
};

// One entry a frame of `sequence`. Throws `InvalidArgument` if it has no origins, if its topology is not that
// of the database, or if its origins name clips or frames the database does not have.
std::vector<FrameSources> frame_sources(const MeshSequence& sequence, const PerformanceDatabase& database);

}  // namespace reprise
