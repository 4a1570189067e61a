// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The vertices through which a skeleton drives a surface (x_c of HSSMG Eq. 32), chosen for each character.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/skeleton/skeleton_follower.h"

namespace reprise {

struct DriveVertex {
  std::int32_t vertex = 0;
  int joint = -1;       // the bone it was chosen for; -1: cloth or hair, which follows several
  double weight = 1.0;  // of its constraint
};

struct DriveVertexOptions {
  int per_bone = 24;          // vertices chosen on a bone, fewer if it has not as many
  double rigid_share = 0.5;   // of a bone's vertices, the most rigid ones, that are chosen from
  double foot_weight = 1.5;   // of vertices on feet and toes: standing feet must not slide
  int loose = 40;             // vertices chosen on what hangs loosely, over the whole surface
  double loose_weight = 0.1;  // theirs: a hint that a skirt goes along, which its own shape outweighs
};

// On each bone that is followed: of its labelled vertices those that hold their place in the bone best
// through all clips (`SkeletonFollower::residuals`: rigid, away from artefacts and from cloth), spread by
// farthest-point sampling. Then loose ones, at least 1 cm apart: of vertices without a followed bone, or more
// than 6 mm off it (root mean square), the farthest from all chosen before, one after the other. Ascending by
// vertex. Deterministic. Throws `InvalidArgument` for options out of range or a database without markup.
std::vector<DriveVertex> choose_drive_vertices(const PerformanceDatabase& database,
                                               const SkeletonFollower& follower,
                                               const DriveVertexOptions& options = {});

// The same as a JSON file that a user edits: "vertices": [{"vertex": 12, "joint": "head", "weight": 1}, ...].
// Joint "" is none; joint and weight may be left out. Reading throws `FileError` naming the entry: a vertex
// or joint that does not exist, a vertex twice, a weight that is not positive; or if there is no vertex. Read
// ones are ascending by vertex.
void write_drive_vertices(const std::vector<DriveVertex>& vertices, const Skeleton& skeleton,
                          const std::filesystem::path& path);
std::vector<DriveVertex> read_drive_vertices(const std::filesystem::path& path,
                                             const PerformanceDatabase& database);

}  // namespace reprise
