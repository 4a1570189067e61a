// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "perform": the database of a synthetic performer.

#pragma once

#include <filesystem>

#include "reprise/sequence/motion_mix.h"
#include "reprise/synthetic/figure/figure.h"
#include "reprise/synthetic/performer.h"

namespace reprise {

struct PerformOptions {
  // `performer.costume`: a costume, or "figure": the small capsule figure that needs no outside data.
  PerformerOptions performer;
  FigureOptions figure;
  // A motion to perform instead of the costume's own clips: .bvh, or .amc with its skeleton .asf, which is
  // found as `read_motion` does if it is not named. Empty: none.
  std::filesystem::path motion;
  std::filesystem::path motion_skeleton;
  // Limbs of another .bvh on the body of that motion (`mix_motions`). Empty: none.
  std::filesystem::path limbs_motion;
  MotionMixOptions limbs;
  // Metres per unit of the motion files; 0: as `read_motion` finds it.
  double motion_scale = 0.0;
};

struct PerformReport {
  std::size_t clips = 0;
  std::size_t frames = 0;
  std::size_t vertices = 0;
};

// Writes the database whole or not at all. Throws `InvalidArgument` for an unknown costume or options that do
// not go together, `FileError`.
PerformReport perform(const std::filesystem::path& database, const PerformOptions& options = {});

}  // namespace reprise
