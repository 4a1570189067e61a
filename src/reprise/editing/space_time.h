// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Edits at some frames of a clip, spread over time (LPBM's reference [22], HSSMG 5.2.3).

#pragma once

#include <vector>

#include "reprise/editing/editor_factory.h"

namespace reprise {

// At one frame: vertices and where they shall be, as a session commits them. Anchors are constraints at the
// frame's own places.
struct KeyEdit {
  std::size_t frame_idx = 0;
  std::vector<PositionConstraint> constraints;
};

struct SpaceTimeOptions {
  EditModel model = EditModel::part;
  // Seconds before the first and after the last key over which displacements come and go; 0: those of the
  // first and last key are held to the ends of the clip.
  double window = 0.5;
  // Draw the learnt coefficients of frames between keys towards those of the keys.
  bool interpolate_coefficients = true;
};

// The clip with every frame solved with its own surface. A constrained vertex's displacement from its
// captured place, in the turning frame of the root part (`EditorFactory::root_vertices`), is mixed from those
// of the keys before and after with smoothstep weights 6 t^5 - 15 t^4 + 10 t^3: twice continuously
// differentiable.
//
// - Keys in a row that constrain a common vertex, or whose windows meet, are one run; displacements are zero
//   outside of runs, and frames without displacement stay bit for bit.
// - All vertices that any key of a run constrains are constrained in all of its frames: those that a key
//   leaves free go where the solved key takes them. So a key frame is what `SurfaceEditor` makes of it alone:
//   to the bit if all keys of the run constrain the same vertices, else to where parts overlap.
// - Coefficients: a frame is solved twice, the second time with the prior drawn by the difference between
//   the mix of the keys' coefficient changes and the first result. At keys the difference is zero.
//
// Normals, if the clip has any, are recomputed where a frame changes; origins say the clip. Parallel, the
// same bits for any number of threads. Throws `InvalidArgument`: no key, a frame out of range or twice, a key
// without constraints, a window that is negative or not finite, what editors refuse.
MeshSequence edit_clip(const EditorFactory& factory, std::size_t clip_idx, const std::vector<KeyEdit>& keys,
                       const SpaceTimeOptions& options = {});

}  // namespace reprise
