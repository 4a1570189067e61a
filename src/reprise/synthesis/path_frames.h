// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The single frames of a motion path. Internal.

#pragma once

#include <vector>

#include "reprise/database/performance_database.h"
#include "reprise/deform/gradient_field.h"
#include "reprise/path/keyframe_query.h"

namespace reprise {

// What one frame is made of.
struct PathFrame {
  FrameId source;
  FrameId partner;
  double alpha = 0.0;  // weight of the partner; 0 outside blends
  GroundTransform source_from_partner;
  GroundTransform world_from_source;

  bool is_blend() const { return alpha > 0.0; }
};

// One entry a frame of the path. Throws `InvalidArgument` if there is none or the path shows frames the
// database does not have.
std::vector<PathFrame> plan_path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                        BlendProfile profile);

FrameOrigin frame_origin(const PathFrame& frame, const PerformanceDatabase& database);

// `out`: N x 3.
void make_positions(const PathFrame& frame, const PerformanceDatabase& database,
                    const PoissonReconstruction& poisson, const PositionsRef& out);

bool all_have_normals(const std::vector<PathFrame>& frames, const PerformanceDatabase& database);
// Those of the capture, turned; computed for a blend. All clips have normals; `positions`: of
// `make_positions`.
void make_normals(const PathFrame& frame, const PerformanceDatabase& database, const PositionsView& positions,
                  PositionsRef out);

// How the clips of a path are coloured.
enum class PathColors {
  none,       // a clip has no colours
  constant,   // all frames have the same
  per_frame,  // `append_colors`
};
PathColors path_colors(const std::vector<PathFrame>& frames, const PerformanceDatabase& database);
// Appends one colour a vertex: the capture's, in a blend the weighted ones of both.
void append_colors(const PathFrame& frame, const PerformanceDatabase& database, std::vector<Color>& colors);

}  // namespace reprise
