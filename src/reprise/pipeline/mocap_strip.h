// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Query above result, as a picture (HSSMG Figure 12).

#pragma once

#include <filesystem>
#include <vector>

#include "reprise/retarget/retarget.h"
#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

// The query's own skeleton at the frames of `target`, enlarged to the character's legs and in its place.
SkeletalMotion query_in_place(const SkeletalMotion& query, const RetargetedMotion& target);
SkeletalMotion frames_of(const SkeletalMotion& motion, const std::vector<std::size_t>& frames);

// Keeps a few frames of what goes by.
class StripFrames {
 public:
  // `frames`: ascending.
  StripFrames(TopologyPtr topology, double frames_per_second, std::vector<std::size_t> frames);
  void add(const Mesh& frame, std::size_t frame_idx);
  MeshSequence take();

 private:
  MeshSequence strip_;
  std::vector<std::size_t> frames_;
  std::vector<Color> colors_;
  std::size_t taken_ = 0;
};

// The skeletons in a row above the frames, from the side, every column in the middle of its picture. Both
// have one frame a column. FILE.png, whole or not at all. Throws `InvalidArgument` if the counts differ or
// are zero, and as `SequenceRenderer`.
void draw_strip(const SkeletalMotion& query, const MeshSequence& frames, const std::filesystem::path& png);

}  // namespace reprise
