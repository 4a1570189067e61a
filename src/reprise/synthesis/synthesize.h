// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A motion path becomes a mesh sequence again (HSSMG 4.4): captured frames as they are, blends at the joins,
// and a ground trajectory that goes on where it was.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reprise/synthesis/correction.h"
#include "reprise/synthesis/foot_planting.h"

namespace reprise {

struct SynthesisOptions {
  BlendProfile profile = BlendProfile::smooth;  // must be the profile the path was planned with
  std::string name = "animation";               // name of the resulting clip
  bool plant_feet = true;                       // feet that stand stay where they stand (foot_planting.h)
  std::optional<Correction> correction;         // retiming and stretch, from `plan_correction`
};

// Every frame of the path with its provenance, in order; `MotionPath::frame_count` entries.
std::vector<FrameOrigin> path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                     BlendProfile profile);

// All that the animations of a database share. Keeps a reference to it; thread-safe.
class Synthesizer {
 public:
  explicit Synthesizer(const PerformanceDatabase& database, const ContactOptions& contacts = {});

  // The animation. It starts where its first captured frame stands; at each transition the rest of the
  // target is moved by `source_from_target`; then retiming, stretch and planting. The ground trajectory is as
  // long as the correction says, else as long as without planting. First and last frame have the shape of the
  // first and last of the path. Frames are made in parallel, with progress; the same bits for any number of
  // threads. Captured colours and normals are kept: blended frames take the weighted colours of both clips,
  // and computed normals. Throws `InvalidArgument` if the path shows frames the database does not have, or
  // the correction is not one of `plan_correction`.
  MeshSequence synthesize(const MotionPath& path, const SynthesisOptions& options = {}) const;

 private:
  MeshSequence blended(const MotionPath& path, const SynthesisOptions& options) const;
  // Plants the feet of `motion` while its ground trajectory gets `distance` metres long.
  MeshSequence planted(const MeshSequence& motion, double distance) const;

  const PerformanceDatabase& database_;
  PoissonReconstruction poisson_;
  FootPlanter planter_;
};

}  // namespace reprise
