// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A motion path becomes a mesh sequence again (HSSMG 4.4): captured frames as they are, blends at the joins,
// and a ground trajectory that goes on where it was.

#pragma once

#include "reprise/deform/gradient_field.h"
#include "reprise/path/keyframe_query.h"

namespace reprise {

struct SynthesisOptions {
  BlendProfile profile = BlendProfile::smooth;  // must be the profile the path was planned with
  std::string name = "animation";               // name of the resulting clip
};

// Every frame of the path with its provenance, in order; `MotionPath::frame_count` entries.
std::vector<FrameOrigin> path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                     BlendProfile profile);

// The animation. It starts where its first captured frame stands; at each transition the rest of the target
// is moved by `source_from_target`. Frames are made in parallel, with progress; the same bits for any number
// of threads. Captured colours and normals are kept: blended frames take the colours of the nearer clip,
// blended, and computed normals.
MeshSequence synthesize(const MotionPath& path, const PerformanceDatabase& database,
                        const PoissonReconstruction& poisson, const SynthesisOptions& options = {});

}  // namespace reprise
