// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The skeleton of single frames, as the clips of a database taught to find it.

#pragma once

#include <memory>
#include <vector>

#include "reprise/skeleton/skeleton_extraction.h"

namespace reprise {

// `extract_skeleton` for frames that come one by one: which vertices hold their place in a bone is learnt
// once, over all clips. Immutable; thread-safe.
class SkeletonFollower {
 public:
  // Throws as `extract_skeleton`, and if there is no clip.
  SkeletonFollower(const std::vector<MeshSequence>& clips, const Markup& markup,
                   const SkeletonExtractionOptions& options = {});
  ~SkeletonFollower();
  SkeletonFollower(SkeletonFollower&&) noexcept;

  const Skeleton& skeleton() const;
  // Throws `InvalidArgument` if the number of vertices differs.
  SkeletonPose pose(const PositionsView& frame) const;
  // How far, root mean square over all clips, each vertex was from where its bone carries it, metres;
  // infinite for vertices without a bone that is followed. Small: rigid, free of artefacts.
  const std::vector<double>& residuals() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace reprise
