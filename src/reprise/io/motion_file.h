// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A motion from whatever file it is in.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reprise/sequence/skeleton.h"

namespace reprise {

struct MotionSource {
  std::filesystem::path motion;  // .bvh or .amc
  // The .asf of an .amc. Empty: the file of its subject ("07" of "07_01.amc") beside it, in ../asf, or the
  // only .asf beside it.
  std::filesystem::path skeleton;
  // None: CMU's unit for Acclaim; for BVH, which has none, that of the common ones (metre, centimetre,
  // millimetre, inch, CMU's) in which the figure is as tall as a person.
  std::optional<double> metres_per_unit;
  std::optional<double> frames_per_second;  // none: what the file says; 120 for Acclaim, which does not say
};

struct MotionFile {
  SkeletalMotion motion;  // as the file has it, in metres
  double metres_per_unit = 1.0;
  std::vector<std::string> notes;  // what was assumed, each a sentence
};

// Throws `FileError` naming file, line or frame: a file of another kind, an .amc without .asf (says which
// names were looked for), no frames, a rate that is not known, values that are not finite, a figure that is
// not of human size (says how tall it is and which unit would mend that), and what the readers throw.
MotionFile read_motion(const MotionSource& source);

// Frames that cannot be what the body did, as far as one sees it without knowing the body.
struct MotionDefect {
  enum class Kind {
    jump,       // the whole figure is elsewhere from one frame to the next, and goes on there
    rest_pose,  // frames at the beginning in the file's rest pose (a T-pose, all angles zero), then another
                // pose
    flip        // one joint is turned over for less than a quarter of a second, or so at either end
  };
  Kind kind = Kind::jump;
  std::size_t first_frame = 0;  // of the frames; a jump is between first_frame and first_frame + 1
  std::size_t last_frame = 0;
  double distance = 0.0;  // metres, of a jump
  int joint = -1;         // of a flip
};
std::vector<MotionDefect> find_defects(const SkeletalMotion& motion);
// "frames 1 to 4 are in the rest pose": frames counted from 1, as the files count them.
std::string to_string(const MotionDefect& defect, const Skeleton& skeleton);
// Without the leading rest pose, and with what comes before a jump moved to where it goes on, and with a
// joint that flips led from its last good rotation to the next one.
SkeletalMotion without_defects(const SkeletalMotion& motion, const std::vector<MotionDefect>& defects);

}  // namespace reprise
