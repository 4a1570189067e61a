// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/perform.h"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/io/motion_file.h"

namespace reprise {

namespace {

SkeletalMotion read_whole_motion(const MotionSource& source) {
  MotionFile file = read_motion(source);
  for (const std::string& note : file.notes) spdlog::info("{}: {}", source.motion.string(), note);
  const std::vector<MotionDefect> defects = find_defects(file.motion);
  for (const MotionDefect& defect : defects) {
    spdlog::warn("{}: {}, which is mended", source.motion.string(), to_string(defect, file.motion.skeleton));
  }
  return defects.empty() ? std::move(file.motion) : without_defects(file.motion, defects);
}

SkeletalMotion read_mixed_motion(const PerformOptions& options) {
  if (!std::isfinite(options.motion_scale) || options.motion_scale < 0.0) {
    throw InvalidArgument(
        fmt::format("the motion's scale is {}; expected metres per unit", options.motion_scale));
  }
  MotionSource source{.motion = options.motion, .skeleton = options.motion_skeleton};
  if (options.motion_scale > 0.0) source.metres_per_unit = options.motion_scale;
  SkeletalMotion motion = read_whole_motion(source);
  if (options.limbs_motion.empty()) return motion;
  MotionSource limbs = source;
  limbs.motion = options.limbs_motion;
  limbs.skeleton.clear();
  return mix_motions(motion, read_whole_motion(limbs), options.limbs);
}

PerformanceDatabase make_database(const PerformOptions& options) {
  const bool has_motion = !options.motion.empty();
  if (!has_motion && !options.motion_skeleton.empty()) {
    throw InvalidArgument("a skeleton file is given, but no motion file");
  }
  if (!has_motion && !options.limbs_motion.empty())
    throw InvalidArgument("a motion for limbs is given, but none for the body");
  if (options.limbs_motion.empty() != options.limbs.limbs.empty())
    throw InvalidArgument("limbs and the motion they are taken from go together: name both or none");
  if (options.performer.costume == "figure") {
    if (has_motion)
      throw InvalidArgument("the figure performs its own clips only; choose a costume for a motion file");
    if (options.performer.effects.any())
      throw InvalidArgument("the figure has no capture effects; choose a costume");
    return make_figure(options.figure);
  }
  return has_motion ? make_performer(options.performer, read_mixed_motion(options))
                    : make_performer(options.performer);
}

}  // namespace

PerformReport perform(const std::filesystem::path& database, const PerformOptions& options) {
  const PerformanceDatabase performance = make_database(options);
  save_database(performance, database);
  return {.clips = performance.clips().size(),
          .frames = performance.frame_count(),
          .vertices = static_cast<std::size_t>(performance.topology()->vertex_count)};
}

}  // namespace reprise
