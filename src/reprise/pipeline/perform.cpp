// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/perform.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/acclaim.h"
#include "reprise/io/bvh.h"
#include "reprise/io/database_file.h"

namespace reprise {

namespace {

SkeletalMotion read_motion(const PerformOptions& options) {
  if (!std::isfinite(options.motion_scale) || options.motion_scale < 0.0) {
    throw InvalidArgument(
        fmt::format("the motion's scale is {}; expected metres per unit", options.motion_scale));
  }
  const std::string extension = options.motion.extension().string();
  const bool needs_skeleton = extension == ".amc";
  if (extension != ".bvh" && !needs_skeleton) {
    throw InvalidArgument(fmt::format("'{}' is no motion this program reads; expected a .bvh or .amc file",
                                      options.motion.string()));
  }
  if (needs_skeleton == options.motion_skeleton.empty()) {
    throw InvalidArgument(needs_skeleton
                              ? fmt::format("'{}' needs its skeleton, an .asf file", options.motion.string())
                              : fmt::format("'{}' has a skeleton of its own; no .asf file goes with it",
                                            options.motion.string()));
  }
  if (needs_skeleton) {
    AcclaimReadOptions read;
    if (options.motion_scale > 0.0) read.metres_per_unit = options.motion_scale;
    return read_acclaim(options.motion_skeleton, options.motion, read);
  }
  BvhReadOptions read;
  if (options.motion_scale > 0.0) read.metres_per_unit = options.motion_scale;
  return read_bvh(options.motion, read);
}

SkeletalMotion read_mixed_motion(const PerformOptions& options) {
  SkeletalMotion motion = read_motion(options);
  if (options.limbs_motion.empty()) return motion;
  PerformOptions limbs = options;
  limbs.motion = options.limbs_motion;
  limbs.motion_skeleton.clear();
  return mix_motions(motion, read_motion(limbs), options.limbs);
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
