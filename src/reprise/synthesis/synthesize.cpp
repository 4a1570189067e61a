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
#include "reprise/synthesis/color_mix.h"

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
    append_mixed_colors(source, partner, frame.alpha, colors);
  }
  return colors;
}

bool all_have_normals(const std::vector<FramePlan>& plan, const PerformanceDatabase& database) {
  return std::ranges::all_of(plan, [&](const FramePlan& frame) {
    return database.clip(frame.source.clip_idx).has_normals() &&
           (!frame.is_blend() || database.clip(frame.partner.clip_idx).has_normals());
  });
}

double ground_length(const MeshSequence& sequence) {
  return ground_distance(ground_trajectory(sequence), 0, sequence.frame_count() - 1);
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
  const std::vector<FramePlan> plan = plan_frames(path, options.profile);
  check_plan(plan, database_);

  MeshSequence result(options.name, database_.topology(), plan.size(), database_.frames_per_second());
  result.set_origins(path_frames(path, database_, options.profile));
  result.set_colors(blend_colors(plan, database_));
  const bool with_normals = all_have_normals(plan, database_);
  if (with_normals)
    result.mutable_normals(0);  // makes room for all frames before they are written in parallel

  Progress progress("synthesis", plan.size());
  parallel_for(0, plan.size(), [&](std::size_t f) {
    const FramePlan& frame = plan[f];
    const MeshSequence& source_clip = database_.clip(frame.source.clip_idx);
    const PositionsView source = source_clip.frame(frame.source.frame_idx);
    PositionsRef out = result.frame(f);
    if (frame.is_blend()) {
      Positions partner(source.rows(), 3);
      transform_positions(frame.source_from_partner,
                          database_.clip(frame.partner.clip_idx).frame(frame.partner.frame_idx),
                          PositionsRef(partner.data(), partner.rows(), 3));
      Positions blended(source.rows(), 3);
      blend_frames(poisson_, source, PositionsView(partner.data(), partner.rows(), 3), frame.alpha,
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
