// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The performer: a clothed, textured human with simulated cloth and hair, "captured" as a 4D database with
// everything known that a capture never tells.

#pragma once

#include <filesystem>
#include <string>

#include "reprise/database/performance_database.h"
#include "reprise/synthetic/dynamics/dynamics.h"
#include "reprise/synthetic/effects/capture_effects.h"
#include "reprise/synthetic/motion/retarget.h"
#include "reprise/synthetic/surface/capture_surface.h"

namespace reprise {

struct PerformerOptions {
  std::string costume = "character1";    // built in, or a .json file
  std::filesystem::path makehuman_data;  // empty: see find_makehuman_data
  double frames_per_second = 25.0;
  CaptureSurfaceOptions surface;
  DynamicsOptions dynamics;
  CaptureEffects effects;
};

// All clips of the costume's motions, with markup and truth. Deterministic.
PerformanceDatabase make_performer(const PerformerOptions& options);

// The performer plays one given motion instead: a database of one clip with the motion's name. The rate is
// that of `options`.
PerformanceDatabase make_performer(const PerformerOptions& options, const SkeletalMotion& motion,
                                   RetargetOptions retarget = {});

}  // namespace reprise
