// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/synthesize.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/synthesis/path_frames.h"

namespace reprise {
namespace {

double ground_length(const MeshSequence& sequence) {
  return ground_distance(ground_trajectory(sequence), 0, sequence.frame_count() - 1);
}

}  // namespace

std::vector<FrameOrigin> path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                     BlendProfile profile) {
  std::vector<FrameOrigin> origins;
  for (const PathFrame& frame : plan_path_frames(path, database, profile)) {
    origins.push_back(frame_origin(frame, database));
  }
  return origins;
}

Synthesizer::Synthesizer(const PerformanceDatabase& database, const ContactOptions& contacts)
    : database_(database),
      poisson_(database.topology(), database.clip(0).frame(0)),
      planter_(database, contacts) {}

MeshSequence Synthesizer::synthesize(const MotionPath& path, const SynthesisOptions& options) const {
  MeshSequence motion = blended(path, options);
  double distance = ground_length(motion);
  if (options.correction) {
    motion = retimed(motion, options.correction->frame_count, poisson_);
    distance = options.correction->distance;
  }
  if (options.plant_feet) return planted(motion, distance);
  if (options.correction) stretch_trajectory(motion, distance);
  return motion;
}

MeshSequence Synthesizer::planted(const MeshSequence& motion, double distance) const {
  // The legs move the centroid, and a stretch moves the feet. So the motion is stretched a little beside the
  // wanted length, such that planting brings it there.
  constexpr double close = 5e-4;  // metres: what is left is stretched away and slides no foot that one sees
  constexpr int most_rounds = 5;
  MeshSequence result;
  double before_planting = distance;
  for (int round = 0; round < most_rounds; ++round) {
    result = motion;
    stretch_trajectory(result, before_planting);
    planter_.plant(result);
    const double miss = distance - ground_length(result);
    if (std::abs(miss) < close) break;
    before_planting = std::max(before_planting + miss, 0.0);
  }
  stretch_trajectory(result, distance);
  return result;
}

MeshSequence Synthesizer::blended(const MotionPath& path, const SynthesisOptions& options) const {
  const std::vector<PathFrame> frames = plan_path_frames(path, database_, options.profile);

  MeshSequence result(options.name, database_.topology(), frames.size(), database_.frames_per_second());
  result.set_origins(path_frames(path, database_, options.profile));
  const PathColors colors = path_colors(frames, database_);
  std::vector<Color> all_colors;
  const std::size_t colored = colors == PathColors::none       ? 0
                              : colors == PathColors::constant ? 1
                                                               : frames.size();
  for (std::size_t f = 0; f < colored; ++f) append_colors(frames[f], database_, all_colors);
  result.set_colors(std::move(all_colors));
  const bool with_normals = all_have_normals(frames, database_);
  if (with_normals)
    result.mutable_normals(0);  // makes room for all frames before they are written in parallel

  Progress progress("synthesis", frames.size());
  parallel_for(0, frames.size(), [&](std::size_t f) {
    make_positions(frames[f], database_, poisson_, result.frame(f));
    if (with_normals) {
      make_normals(frames[f], database_, std::as_const(result).frame(f), result.mutable_normals(f));
    }
    progress.advance();
  });
  return result;
}

}  // namespace reprise
