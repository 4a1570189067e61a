// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Acclaim skeleton and motion (.asf, .amc), as the CMU Graphics Lab Motion Capture Database has them.

#pragma once

#include <filesystem>

#include "reprise/sequence/skeleton.h"

namespace reprise {

struct AcclaimReadOptions {
  double frames_per_second = 120.0;        // the format does not say
  double metres_per_unit = 0.0254 / 0.45;  // CMU's units
};

// Joints are named as the bones of the .asf that begin there ("root", "lfemur", ...), plus a NAME_end where a
// chain ends. The rest pose is that of the .asf. Throws `FileError` naming file and line: an unknown bone,
// values missing, a frame out of order.
SkeletalMotion read_acclaim(const std::filesystem::path& skeleton_asf,
                            const std::filesystem::path& motion_amc, const AcclaimReadOptions& options = {});

}  // namespace reprise
