// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/path_player.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/synthesis/inbetweens.h"
#include "reprise/synthesis/path_frames.h"

namespace reprise {
namespace {

Moment moment_of(double time) {
  const double whole = std::floor(time);
  return {static_cast<std::size_t>(whole), time - whole};
}

}  // namespace

struct PathPlayer::Impl {
  Impl(const PerformanceDatabase& of, const PoissonReconstruction& by) : database(of), poisson(by) {}

  const PerformanceDatabase& database;
  const PoissonReconstruction& poisson;
  std::vector<PathFrame> path;
  std::vector<double> times;
  PathColors colors = PathColors::none;
  bool with_normals = false;

  // The frames of the path that a stretch is made of, moments counted from `first`.
  struct Window {
    std::size_t first = 0;
    MeshSequence frames;
  };
  Window window(const std::vector<Moment>& moments) const;
};

PathPlayer::PathPlayer(const PerformanceDatabase& database, const PoissonReconstruction& poisson,
                       const MotionPath& path, BlendProfile profile, std::vector<double> times) {
  auto impl = std::make_unique<Impl>(database, poisson);
  impl->path = plan_path_frames(path, database, profile);
  impl->colors = path_colors(impl->path, database);
  impl->with_normals = all_have_normals(impl->path, database);
  const auto last = static_cast<double>(impl->path.size() - 1);
  double before = 0.0;
  for (std::size_t f = 0; f < times.size(); ++f) {
    const double time = times[f];
    if (!(time >= 0.0 && time <= last)) {
      throw InvalidArgument(
          fmt::format("frame {} shows the path at {}: expected a time from 0 to {}", f, time, last));
    }
    if (time < before) {
      throw InvalidArgument(
          fmt::format("frame {} shows the path at {}, after {}: time does not go back", f, time, before));
    }
    before = time;
  }
  impl->times = std::move(times);
  impl_ = std::move(impl);
}

PathPlayer::~PathPlayer() = default;

std::size_t PathPlayer::frame_count() const {
  return impl_->times.size();
}

PathPlayer::Impl::Window PathPlayer::Impl::window(const std::vector<Moment>& moments) const {
  // A cubic between two frames sees one before and one after them.
  const std::size_t first = moments.front().frame_idx - std::min<std::size_t>(moments.front().frame_idx, 1);
  const std::size_t last = std::min(moments.back().frame_idx + 3, path.size());
  std::vector<bool> is_needed(last - first, false);
  for (const Moment& moment : moments) {
    const std::size_t at = moment.frame_idx - first;
    if (moment.is_frame()) {
      is_needed[at] = true;
    } else {
      for (std::size_t i = at - std::min<std::size_t>(at, 1); i < std::min(at + 3, is_needed.size()); ++i) {
        is_needed[i] = true;
      }
    }
  }
  Window window{.first = first,
                .frames = MeshSequence({}, database.topology(), last - first, database.frames_per_second())};
  parallel_for(0, is_needed.size(), [&](std::size_t i) {
    if (is_needed[i]) make_positions(path[first + i], database, poisson, window.frames.frame(i));
  });
  return window;
}

MeshSequence PathPlayer::frames(std::size_t first, std::size_t last) const {
  const Impl& player = *impl_;
  if (first > last || last > player.times.size()) {
    throw InvalidArgument(fmt::format("frames {} to {} of a motion of {}", first, last, player.times.size()));
  }
  std::vector<Moment> moments;
  for (std::size_t f = first; f < last; ++f) moments.push_back(moment_of(player.times[f]));
  MeshSequence result({}, player.database.topology(), moments.size(), player.database.frames_per_second());
  if (moments.empty()) return result;

  const Impl::Window window = player.window(moments);
  if (player.with_normals) result.mutable_normals(0);  // before frames are written in parallel
  // Consecutive frames share their neighbours' gradients.
  constexpr std::size_t frames_per_task = 16;
  parallel_for(0, (moments.size() + frames_per_task - 1) / frames_per_task, [&](std::size_t task) {
    Inbetweens inbetweens(window.frames, player.poisson);
    const std::size_t end = std::min(moments.size(), (task + 1) * frames_per_task);
    for (std::size_t f = task * frames_per_task; f < end; ++f) {
      throw_if_interrupted();
      const Moment& moment = moments[f];
      const std::size_t in_window = moment.frame_idx - window.first;
      const PathFrame& shown = player.path[moment.frame_idx];
      PositionsRef out = result.frame(f);
      const PositionsView made = std::as_const(result).frame(f);
      if (moment.is_frame()) {
        out = window.frames.frame(in_window);
        if (player.with_normals) make_normals(shown, player.database, made, result.mutable_normals(f));
      } else {
        inbetweens.reconstruct(in_window, moment.alpha, out);
        if (player.with_normals) result.mutable_normals(f) = vertex_normals(*result.topology(), made);
      }
    }
  });

  std::vector<FrameOrigin> origins;
  std::vector<Color> colors;
  for (const Moment& moment : moments) {
    const PathFrame& shown = player.path[moment.nearest()];
    origins.push_back(frame_origin(shown, player.database));
    if (player.colors == PathColors::per_frame || (player.colors == PathColors::constant && colors.empty())) {
      append_colors(shown, player.database, colors);
    }
  }
  result.set_origins(std::move(origins));
  result.set_colors(std::move(colors));
  return result;
}

}  // namespace reprise
