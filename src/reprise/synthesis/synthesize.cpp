// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/synthesize.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/deform/blend.h"

namespace reprise {
namespace {

// What one output frame is made of.
struct FramePlan {
  FrameId source;
  FrameId partner;
  double alpha = 0.0;  // weight of the partner; 0 outside blends
  GroundTransform source_from_partner;
  GroundTransform world_from_source;

  bool is_blend() const { return alpha > 0.0; }
};

std::vector<FramePlan> plan_frames(const MotionPath& path, BlendProfile profile) {
  std::vector<FramePlan> plan;
  plan.reserve(static_cast<std::size_t>(std::max(path.frame_count, 0)));
  GroundTransform world_from_source;
  for (const PathSegment& segment : path.segments) {
    for (int f = segment.first_frame; f <= segment.last_frame; ++f) {
      plan.push_back({.source = {segment.clip_idx, static_cast<std::size_t>(f)},
                      .world_from_source = world_from_source});
    }
    if (!segment.transition) continue;
    const Transition& t = *segment.transition;
    // The window's first and last frame are the pure source and the pure target: they belong to the segments.
    for (int k = -t.half_window + 1; k < t.half_window; ++k) {
      plan.push_back({.source = {t.source_clip, static_cast<std::size_t>(t.m + k)},
                      .partner = {t.target_clip, static_cast<std::size_t>(t.n + k)},
                      .alpha = blend_weight(profile, k, t.half_window),
                      .source_from_partner = t.source_from_target,
                      .world_from_source = world_from_source});
    }
    world_from_source = world_from_source * t.source_from_target;
  }
  return plan;
}

void check_plan(const std::vector<FramePlan>& plan, const PerformanceDatabase& database) {
  const auto check = [&](FrameId frame) {
    if (frame.clip_idx >= database.clips().size() ||
        frame.frame_idx >= database.clip(frame.clip_idx).frame_count()) {
      throw InvalidArgument(
          fmt::format("the path shows frame {} of clip {}, which the database does not have", frame.frame_idx,
                      frame.clip_idx));
    }
  };
  if (plan.empty()) throw InvalidArgument("the path is empty");
  for (const FramePlan& frame : plan) {
    check(frame.source);
    if (frame.is_blend()) check(frame.partner);
  }
}

// Colours of the animation: one set if all clips of the plan share it, else one set a frame; none if a clip
// has none.
std::vector<Color> blend_colors(const std::vector<FramePlan>& plan, const PerformanceDatabase& database) {
  const auto clip_of = [&](FrameId frame) -> const MeshSequence& { return database.clip(frame.clip_idx); };
  bool constant = true;
  const MeshSequence& first = clip_of(plan.front().source);
  for (const FramePlan& frame : plan) {
    for (const FrameId id : {frame.source, frame.is_blend() ? frame.partner : frame.source}) {
      if (!clip_of(id).has_colors()) return {};
      constant = constant && !clip_of(id).has_colors_per_frame() &&
                 (&clip_of(id) == &first || std::ranges::equal(clip_of(id).colors(0), first.colors(0)));
    }
  }
  if (constant) return {first.colors(0).begin(), first.colors(0).end()};

  std::vector<Color> colors;
  colors.reserve(plan.size() * first.vertex_count());
  for (const FramePlan& frame : plan) {
    const std::span<const Color> source = clip_of(frame.source).colors(frame.source.frame_idx);
    if (!frame.is_blend()) {
      colors.insert(colors.end(), source.begin(), source.end());
      continue;
    }
    const std::span<const Color> partner = clip_of(frame.partner).colors(frame.partner.frame_idx);
    for (std::size_t v = 0; v < source.size(); ++v) {
      Color blended{};
      for (std::size_t c = 0; c < 3; ++c) {
        blended[c] = static_cast<std::uint8_t>(
            std::lround((1.0 - frame.alpha) * source[v][c] + frame.alpha * partner[v][c]));
      }
      colors.push_back(blended);
    }
  }
  return colors;
}

bool all_have_normals(const std::vector<FramePlan>& plan, const PerformanceDatabase& database) {
  return std::ranges::all_of(plan, [&](const FramePlan& frame) {
    return database.clip(frame.source.clip_idx).has_normals() &&
           (!frame.is_blend() || database.clip(frame.partner.clip_idx).has_normals());
  });
}

}  // namespace

std::vector<FrameOrigin> path_frames(const MotionPath& path, const PerformanceDatabase& database,
                                     BlendProfile profile) {
  const std::vector<FramePlan> plan = plan_frames(path, profile);
  check_plan(plan, database);
  std::vector<FrameOrigin> origins;
  origins.reserve(plan.size());
  for (const FramePlan& frame : plan) {
    FrameOrigin origin{.clip = database.clip(frame.source.clip_idx).name(),
                       .frame_idx = static_cast<std::int32_t>(frame.source.frame_idx)};
    if (frame.is_blend()) {
      origin.partner_clip = database.clip(frame.partner.clip_idx).name();
      origin.partner_frame_idx = static_cast<std::int32_t>(frame.partner.frame_idx);
      origin.partner_weight = frame.alpha;
    }
    origins.push_back(std::move(origin));
  }
  return origins;
}

MeshSequence synthesize(const MotionPath& path, const PerformanceDatabase& database,
                        const PoissonReconstruction& poisson, const SynthesisOptions& options) {
  const std::vector<FramePlan> plan = plan_frames(path, options.profile);
  check_plan(plan, database);

  MeshSequence result(options.name, database.topology(), plan.size(), database.frames_per_second());
  result.set_origins(path_frames(path, database, options.profile));
  result.set_colors(blend_colors(plan, database));
  const bool with_normals = all_have_normals(plan, database);
  if (with_normals)
    result.mutable_normals(0);  // makes room for all frames before they are written in parallel

  Progress progress("synthesis", plan.size());
  parallel_for(0, plan.size(), [&](std::size_t f) {
    const FramePlan& frame = plan[f];
    const MeshSequence& source_clip = database.clip(frame.source.clip_idx);
    const PositionsView source = source_clip.frame(frame.source.frame_idx);
    PositionsRef out = result.frame(f);
    if (frame.is_blend()) {
      Positions partner(source.rows(), 3);
      transform_positions(frame.source_from_partner,
                          database.clip(frame.partner.clip_idx).frame(frame.partner.frame_idx),
                          PositionsRef(partner.data(), partner.rows(), 3));
      Positions blended(source.rows(), 3);
      blend_frames(poisson, source, PositionsView(partner.data(), partner.rows(), 3), frame.alpha,
                   PositionsRef(blended.data(), blended.rows(), 3));
      transform_positions(frame.world_from_source, PositionsView(blended.data(), blended.rows(), 3), out);
    } else {
      transform_positions(frame.world_from_source, source, out);
    }
    if (with_normals) {
      if (frame.is_blend()) {
        result.mutable_normals(f) =
            vertex_normals(*result.topology(), PositionsView(out.data(), out.rows(), 3));
      } else {
        const GroundTransform turn{.yaw = frame.world_from_source.yaw};
        transform_positions(turn, source_clip.normals(frame.source.frame_idx), result.mutable_normals(f));
      }
    }
    progress.advance();
  });
  return result;
}

}  // namespace reprise
