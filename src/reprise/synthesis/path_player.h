// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A retrieved path played at the query's pace, a stretch at a time, so that long motions need little memory
// (HSSMG 5.2.2).

#pragma once

#include <memory>
#include <vector>

#include "reprise/synthesis/path_timing.h"
#include "reprise/synthesis/synthesize.h"

namespace reprise {

// Keeps references; thread-safe.
class PathPlayer {
 public:
  // `times`: of `path_times`, along the frames of `path`. Throws `InvalidArgument` if a time is outside of
  // the path or before the one before it, or the path shows frames the database does not have.
  PathPlayer(const PerformanceDatabase& database, const PoissonReconstruction& poisson,
             const MotionPath& path, BlendProfile profile, std::vector<double> times);
  ~PathPlayer();

  std::size_t frame_count() const;
  // Frames first .. last - 1 of the result, whatever stretch was asked before: captured frames at whole times
  // outside of blends, blends at joins, and between frames the cubic in the gradient field (inbetweens.h). It
  // goes on over the ground as `Synthesizer::synthesize` does. Colours and origins as there, of the nearer
  // frame. Computed normals if all clips have normals. Parallel, the same bits for any number of threads.
  MeshSequence frames(std::size_t first, std::size_t last) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace reprise
