// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/path_frames.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/blend.h"
#include "reprise/synthesis/color_mix.h"

namespace reprise {
namespace {

void check_frames(const std::vector<PathFrame>& frames, const PerformanceDatabase& database) {
  const auto check = [&](FrameId frame) {
    if (frame.clip_idx >= database.clips().size() ||
        frame.frame_idx >= database.clip(frame.clip_idx).frame_count()) {
      throw InvalidArgument(
          fmt::format("the path shows frame {} of clip {}, which the database does not have", frame.frame_idx,
                      frame.clip_idx));
    }
  };
  if (frames.empty()) throw InvalidArgument("the path is empty");
  for (const PathFrame& frame : frames) {
    check(frame.source);
    if (frame.is_blend()) check(frame.partner);
  }
}

const MeshSequence& clip_of(FrameId frame, const PerformanceDatabase& database) {
  return database.clip(frame.clip_idx);
}

}  // namespace

std::vector<PathFrame> plan_path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                        BlendProfile profile) {
  std::vector<PathFrame> frames;
  frames.reserve(static_cast<std::size_t>(std::max(path.frame_count, 0)));
  GroundTransform world_from_source;
  for (const PathSegment& segment : path.segments) {
    for (int f = segment.first_frame; f <= segment.last_frame; ++f) {
      PathFrame frame{.source = {segment.clip_idx, static_cast<std::size_t>(f)}};
      frame.world_from_source = world_from_source;
      frames.push_back(frame);
    }
    if (!segment.transition) continue;
    const Transition& t = *segment.transition;
    // The window's first and last frame are the pure source and the pure target: they belong to the segments.
    for (int k = -t.half_window + 1; k < t.half_window; ++k) {
      frames.push_back({.source = {t.source_clip, static_cast<std::size_t>(t.m + k)},
                        .partner = {t.target_clip, static_cast<std::size_t>(t.n + k)},
                        .alpha = blend_weight(profile, k, t.half_window),
                        .source_from_partner = t.source_from_target,
                        .world_from_source = world_from_source});
    }
    world_from_source = world_from_source * t.source_from_target;
  }
  check_frames(frames, database);
  return frames;
}

FrameOrigin frame_origin(const PathFrame& frame, const PerformanceDatabase& database) {
  FrameOrigin origin{.clip = clip_of(frame.source, database).name(),
                     .frame_idx = static_cast<std::int32_t>(frame.source.frame_idx)};
  if (frame.is_blend()) {
    origin.partner_clip = clip_of(frame.partner, database).name();
    origin.partner_frame_idx = static_cast<std::int32_t>(frame.partner.frame_idx);
    origin.partner_weight = frame.alpha;
  }
  return origin;
}

void make_positions(const PathFrame& frame, const PerformanceDatabase& database,
                    const PoissonReconstruction& poisson, const PositionsRef& out) {
  const PositionsView source = clip_of(frame.source, database).frame(frame.source.frame_idx);
  if (!frame.is_blend()) {
    transform_positions(frame.world_from_source, source, out);
    return;
  }
  Positions partner(source.rows(), 3);
  transform_positions(frame.source_from_partner,
                      clip_of(frame.partner, database).frame(frame.partner.frame_idx),
                      PositionsRef(partner.data(), partner.rows(), 3));
  Positions blended(source.rows(), 3);
  blend_frames(poisson, source, PositionsView(partner.data(), partner.rows(), 3), frame.alpha,
               PositionsRef(blended.data(), blended.rows(), 3));
  transform_positions(frame.world_from_source, PositionsView(blended.data(), blended.rows(), 3), out);
}

bool all_have_normals(const std::vector<PathFrame>& frames, const PerformanceDatabase& database) {
  return std::ranges::all_of(frames, [&](const PathFrame& frame) {
    return clip_of(frame.source, database).has_normals() &&
           (!frame.is_blend() || clip_of(frame.partner, database).has_normals());
  });
}

void make_normals(const PathFrame& frame, const PerformanceDatabase& database, const PositionsView& positions,
                  PositionsRef out) {
  if (frame.is_blend()) {
    out = vertex_normals(*database.topology(), positions);
    return;
  }
  const GroundTransform turn{.yaw = frame.world_from_source.yaw};
  transform_positions(turn, clip_of(frame.source, database).normals(frame.source.frame_idx), out);
}

PathColors path_colors(const std::vector<PathFrame>& frames, const PerformanceDatabase& database) {
  bool constant = true;
  const MeshSequence& first = clip_of(frames.front().source, database);
  for (const PathFrame& frame : frames) {
    for (const FrameId id : {frame.source, frame.is_blend() ? frame.partner : frame.source}) {
      const MeshSequence& clip = clip_of(id, database);
      if (!clip.has_colors()) return PathColors::none;
      constant = constant && !clip.has_colors_per_frame() &&
                 (&clip == &first || std::ranges::equal(clip.colors(0), first.colors(0)));
    }
  }
  return constant ? PathColors::constant : PathColors::per_frame;
}

void append_colors(const PathFrame& frame, const PerformanceDatabase& database, std::vector<Color>& colors) {
  const std::span<const Color> source = clip_of(frame.source, database).colors(frame.source.frame_idx);
  if (!frame.is_blend()) {
    colors.insert(colors.end(), source.begin(), source.end());
    return;
  }
  append_mixed_colors(source, clip_of(frame.partner, database).colors(frame.partner.frame_idx), frame.alpha,
                      colors);
}

}  // namespace reprise
