// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/correction.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/synthesis/color_mix.h"
#include "reprise/synthesis/inbetweens.h"

namespace reprise {
namespace {

constexpr double largest_share = 0.5;
// Metres: a shorter ground trajectory is the swaying of somebody who stands.
constexpr double shortest_travel = 0.05;

void check_share(const char* name, double share) {
  if (!(share >= 0.0 && share <= largest_share)) {
    throw InvalidArgument(
        fmt::format("{} must be a share from 0 to {}, found {}", name, largest_share, share));
  }
}

void check_target(const char* name, const char* unit, double target) {
  if (!(target >= 0.0) || !std::isfinite(target)) {
    throw InvalidArgument(
        fmt::format("the target {} must be a finite number of {} from 0, found {}", name, unit, target));
  }
}

// Where new frame `frame_idx` lies among the old ones, in whole numbers: what falls on a frame is that frame.
Moment moment_of(std::size_t frame_idx, std::size_t new_count, std::size_t old_count) {
  const std::size_t scaled = frame_idx * (old_count - 1);
  const std::size_t intervals = new_count - 1;
  return {scaled / intervals, static_cast<double>(scaled % intervals) / static_cast<double>(intervals)};
}

void copy_colors(const MeshSequence& from, MeshSequence& to) {
  if (!from.has_colors()) return;
  if (!from.has_colors_per_frame()) {
    to.set_colors({from.colors(0).begin(), from.colors(0).end()});
    return;
  }
  std::vector<Color> colors;
  colors.reserve(to.frame_count() * to.vertex_count());
  for (std::size_t f = 0; f < to.frame_count(); ++f) {
    const Moment moment = moment_of(f, to.frame_count(), from.frame_count());
    const std::size_t next = moment.is_frame() ? moment.frame_idx : moment.frame_idx + 1;
    append_mixed_colors(from.colors(moment.frame_idx), from.colors(next), moment.alpha, colors);
  }
  to.set_colors(std::move(colors));
}

void copy_origins(const MeshSequence& from, MeshSequence& to) {
  if (from.origins().empty()) return;
  std::vector<FrameOrigin> origins;
  origins.reserve(to.frame_count());
  for (std::size_t f = 0; f < to.frame_count(); ++f) {
    origins.push_back(from.origins()[moment_of(f, to.frame_count(), from.frame_count()).nearest()]);
  }
  to.set_origins(std::move(origins));
}

}  // namespace

Correction plan_correction(const MotionPath& path, double target_distance, double target_time,
                           double frames_per_second, const CorrectionOptions& options) {
  check_share("max_retiming", options.max_retiming);
  check_share("max_stretch", options.max_stretch);
  check_target("distance", "metres", target_distance);
  check_target("time", "seconds", target_time);
  if (!(frames_per_second > 0.0) || !std::isfinite(frames_per_second)) {
    throw InvalidArgument(
        fmt::format("frames per second must be positive and finite, found {}", frames_per_second));
  }
  if (path.frame_count < 1) throw InvalidArgument("the path is empty");

  Correction correction{.frame_count = path.frame_count, .distance = path.distance};
  if (path.frame_count > 1) {
    const double frames = path.frame_count;
    // At least two frames: the first and the last key-frame are both shown.
    constexpr double rounding = 1e-9;  // 10 % of 100 frames are 10
    const double fewest = std::max(2.0, std::ceil(frames * (1.0 - options.max_retiming) - rounding));
    const double most = std::floor(frames * (1.0 + options.max_retiming) + rounding);
    correction.frame_count =
        static_cast<int>(std::clamp(std::round(target_time * frames_per_second), fewest, most));
  }
  if (path.distance >= shortest_travel) {
    correction.stretch =
        std::clamp(target_distance / path.distance, 1.0 - options.max_stretch, 1.0 + options.max_stretch);
    correction.distance = correction.stretch * path.distance;
  }
  correction.time = correction.frame_count / frames_per_second;
  return correction;
}

MeshSequence retimed(const MeshSequence& sequence, int frame_count, const PoissonReconstruction& poisson) {
  const std::size_t old_count = sequence.frame_count();
  if (old_count == 0) throw InvalidArgument(fmt::format("'{}' has no frames to retime", sequence.name()));
  if (old_count == 1 ? frame_count != 1 : frame_count < 2) {
    throw InvalidArgument(fmt::format("cannot play the {} frames of '{}' in {}: expected {}", old_count,
                                      sequence.name(), frame_count, old_count == 1 ? "1" : "2 or more"));
  }
  const auto new_count = static_cast<std::size_t>(frame_count);
  if (new_count == old_count) return sequence;

  MeshSequence result(sequence.name(), sequence.topology(), new_count, sequence.frames_per_second());
  if (sequence.has_normals()) result.mutable_normals(0);  // before frames are written in parallel
  Progress progress("retiming", new_count);
  // Consecutive frames share their neighbours' gradients.
  constexpr std::size_t frames_per_task = 32;
  parallel_for(0, (new_count + frames_per_task - 1) / frames_per_task, [&](std::size_t task) {
    Inbetweens inbetweens(sequence, poisson);
    const std::size_t end = std::min(new_count, (task + 1) * frames_per_task);
    for (std::size_t f = task * frames_per_task; f < end; ++f) {
      const Moment moment = moment_of(f, new_count, old_count);
      PositionsRef out = result.frame(f);
      if (moment.is_frame()) {
        out = sequence.frame(moment.frame_idx);
        if (sequence.has_normals()) result.mutable_normals(f) = sequence.normals(moment.frame_idx);
      } else {
        inbetweens.reconstruct(moment.frame_idx, moment.alpha, out);
        if (sequence.has_normals()) {
          result.mutable_normals(f) =
              vertex_normals(*result.topology(), PositionsView(out.data(), out.rows(), 3));
        }
      }
      progress.advance();
    }
  });
  copy_colors(sequence, result);
  copy_origins(sequence, result);
  return result;
}

void stretch_trajectory(MeshSequence& sequence, double distance) {
  if (!(distance >= 0.0) || !std::isfinite(distance)) {
    throw InvalidArgument(fmt::format(
        "the ground trajectory's length must be a finite number of metres from 0, found {}", distance));
  }
  if (sequence.frame_count() < 2) return;
  const std::vector<Eigen::Vector2d> trajectory = ground_trajectory(sequence);
  const double length = ground_distance(trajectory, 0, trajectory.size() - 1);
  if (length < shortest_travel) return;
  const double growth = distance / length - 1.0;
  parallel_for(0, sequence.frame_count(), [&](std::size_t f) {
    const Eigen::Vector2f shift = (growth * (trajectory[f] - trajectory[0])).cast<float>();
    sequence.frame(f).col(0).array() += shift.x();
    sequence.frame(f).col(2).array() += shift.y();
  });
}

}  // namespace reprise
