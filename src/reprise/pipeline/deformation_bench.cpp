// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/deformation_bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>

#include "reprise/core/interrupt.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"

namespace reprise {
namespace {

constexpr std::array sources = {DeformationSource::first, DeformationSource::nearest};
constexpr std::size_t frames_a_chunk = 8;  // share the factorisations of an editor
constexpr std::size_t timed_drags = 15;

const Positions& reference_of(const PerformanceDatabase& learnt, Positions& room) {
  if (!learnt.models().part.parts.empty()) return learnt.models().part.reference;
  if (learnt.markup()) return learnt.markup()->reference;
  room = learnt.clip(0).frame(0);
  return room;
}

std::vector<BodyPart> parts_of(const LearntModel& model) {
  std::vector<BodyPart> parts;
  for (const LearntPart& learnt : model.parts) parts.push_back(learnt.part);
  return parts;
}

}  // namespace

DeformationBench::DeformationBench(const PerformanceDatabase& learnt, std::vector<std::string> models,
                                   const std::vector<std::size_t>& constraints)
    : learnt_(learnt), models_(std::move(models)), factory_(learnt) {
  Positions room;
  const Positions& reference = reference_of(learnt, room);
  vertices_ = spread_vertices(reference, std::ranges::max(constraints));
  std::optional<PartHierarchy> hierarchy;
  if (std::vector<BodyPart> parts = parts_of(learnt.models().part); parts.size() > 1) {
    hierarchy.emplace(learnt.topology(), PositionsView(reference.data(), reference.rows(), 3), parts);
  }
  meter_ = std::make_unique<const TrialMeter>(learnt, reference, hierarchy ? &*hierarchy : nullptr);
  for (const std::string& model : models_) set_frame(*make(model), model, {});
}

std::unique_ptr<SurfaceEditor> DeformationBench::make(const std::string& model) const {
  if (model == "rigid") return std::make_unique<RigidEditor>(learnt_.topology()->vertex_count);
  return factory_.make(parse_edit_model(model));
}

void DeformationBench::set_frame(SurfaceEditor& editor, const std::string& model, FrameId frame) const {
  const SkeletonPose* pose = model == "rigid" ? nullptr : factory_.pose(parse_edit_model(model), frame);
  editor.set_frame(learnt_.clip(frame.clip_idx).frame(frame.frame_idx), pose);
}

std::vector<PositionConstraint> DeformationBench::constraints(const HeldFrame& frame,
                                                              std::size_t count) const {
  return constraints_at({vertices_.begin(), vertices_.begin() + static_cast<std::ptrdiff_t>(count)},
                        frame.positions());
}

FrameId DeformationBench::source_frame(DeformationSource source,
                                       std::span<const PositionConstraint> constraints) const {
  return source == DeformationSource::first ? FrameId{} : nearest_frame(learnt_, constraints);
}

std::vector<DeformationTrial> DeformationBench::try_all(const std::vector<HeldFrame>& frames,
                                                        const std::vector<std::size_t>& counts) const {
  const std::size_t a_frame = counts.size() * sources.size() * models_.size();
  std::vector<DeformationTrial> trials(frames.size() * a_frame);
  Progress progress("deform", trials.size());
  const auto try_frame = [&](std::size_t f, std::size_t n,
                             const std::vector<std::unique_ptr<SurfaceEditor>>& editors) {
    const std::vector<PositionConstraint> asked = constraints(frames[f], counts[n]);
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const FrameId source = source_frame(sources[s], asked);
      for (std::size_t m = 0; m < models_.size(); ++m) {
        throw_if_interrupted();
        set_frame(*editors[m], models_[m], source);
        editors[m]->deform(asked);
        trials[f * a_frame + (n * sources.size() + s) * models_.size() + m] = {
            .frame = frames[f].name,
            .model = models_[m],
            .source = sources[s],
            .source_frame = learnt_.to_string(source),
            .constraints = counts[n],
            .figures = (*meter_)(editors[m]->positions(), frames[f].positions())};
      }
      progress.advance(models_.size());
    }
  };
  const std::size_t chunks = (frames.size() + frames_a_chunk - 1) / frames_a_chunk;
  parallel_for(0, chunks, [&](std::size_t chunk) {
    std::vector<std::unique_ptr<SurfaceEditor>> editors;
    for (const std::string& model : models_) editors.push_back(make(model));
    const std::size_t end = std::min(frames.size(), (chunk + 1) * frames_a_chunk);
    for (std::size_t n = 0; n < counts.size(); ++n) {
      for (std::size_t f = chunk * frames_a_chunk; f < end; ++f) try_frame(f, n, editors);
    }
  });
  return trials;
}

double DeformationBench::milliseconds(const std::string& model, const std::vector<HeldFrame>& frames,
                                      std::size_t count) const {
  const std::unique_ptr<SurfaceEditor> editor = make(model);
  set_frame(*editor, model, {});
  editor->deform(constraints(frames.front(), count));  // factorises
  std::vector<double> times;
  for (std::size_t f = 0; f < std::min(frames.size(), timed_drags); ++f) {
    throw_if_interrupted();
    const std::vector<PositionConstraint> asked = constraints(frames[f], count);
    const auto start = std::chrono::steady_clock::now();
    editor->deform(asked);
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::ranges::nth_element(times, middle);
  return *middle;
}

}  // namespace reprise
