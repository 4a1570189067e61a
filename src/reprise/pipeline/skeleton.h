// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "skeleton": the skeletal motion of captured clips (HSSMG 3).

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise {

struct SkeletonOptions {
  std::string clip;  // empty: all
  SkeletonExtractionOptions extraction;
};

// One clip after the other: memory holds one. Motions come in the order of the clips.
struct SkeletonResult {
  std::vector<SkeletalMotion> motions;
  // position, joints (name, parent, labelled vertices, whether followed or inferred) and clips: name, frames,
  // how far bone lengths stray from those at rest, and, if the database has the truth, the difference to it
  // in metres and degrees: means over joints, and each joint's. docs/skeleton.md lists every field.
  nlohmann::json report;
};

// Throws `InvalidArgument` if the database has no markup or no such clip, `FileError`.
SkeletonResult extract_skeletons(const std::filesystem::path& database, const SkeletonOptions& options);

// CLIP.bvh for each motion in `folder`, which is made if it is missing.
void write_skeletons(const std::vector<SkeletalMotion>& motions, const std::filesystem::path& folder);

}  // namespace reprise
