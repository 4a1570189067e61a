// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluation_looks.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/render/plots.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise {
namespace {

constexpr int picture_width = 190;  // of one frame
constexpr int picture_height = 320;
constexpr int sheet_columns = 4;

// The frame of a clip for an index over all frames.
std::vector<FrameId> all_frames(const PerformanceDatabase& database) {
  std::vector<FrameId> frames;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    for (std::size_t f = 0; f < database.clip(c).frame_count(); ++f)
      frames.push_back({.clip_idx = c, .frame_idx = f});
  }
  return frames;
}

}  // namespace

Appearance distinguishing_appearance(const PerformanceDatabase& database) {
  if (database.empty()) return Appearance::automatic;
  bool differ = false;
  for (const MeshSequence& clip : database.clips()) {
    if (!clip.has_colors()) return Appearance::automatic;
    const std::span<const Color> first = database.clip(0).colors(0);
    const std::size_t sets = clip.has_colors_per_frame() ? clip.frame_count() : 1;
    for (std::size_t f = 0; !differ && f < sets; ++f) differ = !std::ranges::equal(clip.colors(f), first);
  }
  return differ ? Appearance::vertex_colors : Appearance::automatic;
}

std::vector<GroundTransform> common_placement(const PerformanceDatabase& database) {
  const std::vector<FrameId> frames = all_frames(database);
  std::vector<GroundTransform> placed(frames.size());
  parallel_for(0, frames.size(), [&](std::size_t i) {
    placed[i] = align_on_ground(database.clip(0).frame(0),
                                database.clip(frames[i].clip_idx).frame(frames[i].frame_idx))
                    .a_from_b;
  });
  return placed;
}

std::vector<AppearanceChange> appearance_changes(const PerformanceDatabase& database,
                                                 const std::vector<Transition>& transitions,
                                                 const FrameViewer& viewer) {
  const std::vector<GroundTransform> placed = common_placement(database);
  std::vector<AppearanceChange> changes(transitions.size());
  Progress progress("appearance at transitions", transitions.size());
  parallel_for(0, transitions.size(), [&](std::size_t i) {
    const Transition& t = transitions[i];
    const auto m = static_cast<std::size_t>(t.m);
    const GroundTransform& placed_from_source = placed[database.first_frame(t.source_clip) + m];
    changes[i] = viewer.change(viewer.look(database.clip(t.source_clip), m, placed_from_source),
                               viewer.look(database.clip(t.target_clip), static_cast<std::size_t>(t.n),
                                           placed_from_source * t.source_from_target));
    progress.advance();
  });
  return changes;
}

std::vector<AppearanceChange> neighbor_changes(const PerformanceDatabase& database,
                                               const FrameViewer& viewer) {
  std::vector<Transition> steps;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const MeshSequence& clip = database.clip(c);
    for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
      steps.push_back({.source_clip = c,
                       .target_clip = c,
                       .m = static_cast<int>(f),
                       .n = static_cast<int>(f) + 1,
                       .source_from_target = align_on_ground(clip.frame(f), clip.frame(f + 1)).a_from_b});
    }
  }
  return appearance_changes(database, steps, viewer);
}

LookAlikes::LookAlikes(const PerformanceDatabase& database, const FrameViewer& viewer, double share,
                       std::size_t step)
    : step_(step) {
  const std::vector<FrameId> frames = all_frames(database);
  const std::vector<GroundTransform> placed = common_placement(database);
  const std::size_t count = (frames.size() + step - 1) / step;
  std::vector<FrameViews> views(count);
  parallel_for(0, count, [&](std::size_t i) {
    const FrameId frame = frames[i * step];
    views[i] = viewer.look(database.clip(frame.clip_idx), frame.frame_idx, placed[i * step]);
  });
  alike_.resize(count);
  Progress progress("looks of all pairs", count * (count - 1) / 2);
  parallel_for(0, count, [&](std::size_t a) {
    for (std::size_t b = a + 1; b < count; ++b)
      alike_[a].push_back(viewer.is_less(views[a], views[b], share));
    progress.advance(alike_[a].size());
  });
}

std::optional<bool> LookAlikes::operator()(std::size_t a, std::size_t b) const {
  if (a % step_ != 0 || b % step_ != 0) return std::nullopt;
  if (a == b) return true;
  const std::size_t first = std::min(a, b) / step_;
  return alike_[first][std::max(a, b) / step_ - first - 1];
}

std::vector<Transition> pictured_transitions(const PerformanceDatabase& database,
                                             const std::vector<Transition>& transitions,
                                             const std::vector<std::string>& pairs, std::size_t count) {
  using ClipPair = std::pair<std::size_t, std::size_t>;
  std::set<ClipPair> wanted;
  for (const std::string& pair : pairs) {
    const std::size_t colon = pair.find(':');
    if (colon == std::string::npos) {
      throw InvalidArgument(
          fmt::format("'{}' is not a pair of clips: expected SOURCE:TARGET, such as walk:run", pair));
    }
    wanted.emplace(database.clip_idx(pair.substr(0, colon)), database.clip_idx(pair.substr(colon + 1)));
  }
  std::vector<Transition> sorted = transitions;
  std::ranges::stable_sort(sorted, {}, &Transition::cost);
  std::vector<Transition> chosen;
  std::set<ClipPair> taken;
  for (const Transition& t : sorted) {
    if (chosen.size() == count) break;
    const ClipPair both = std::minmax(t.source_clip, t.target_clip);
    const bool is_shown = wanted.empty() ? t.source_clip != t.target_clip && taken.insert(both).second
                                         : wanted.contains({t.source_clip, t.target_clip});
    if (is_shown) chosen.push_back(t);
  }
  // A single clip has transitions to itself alone.
  if (chosen.empty() && wanted.empty())
    chosen.assign(sorted.begin(),
                  sorted.begin() + static_cast<std::ptrdiff_t>(std::min(count, sorted.size())));
  return chosen;
}

void draw_transitions(const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                      const std::vector<Transition>& transitions, const FrameViewer& viewer,
                      const std::filesystem::path& png) {
  const std::vector<GroundTransform> placed = common_placement(database);
  const Appearance appearance = distinguishing_appearance(database);
  // One sequence of all frames in one place, so that one camera sees all of them alike.
  MeshSequence frames("transitions", database.topology(), 2 * transitions.size(), 25.0);
  std::vector<Color> colors;
  bool has_colors = true;
  for (std::size_t i = 0; i < transitions.size(); ++i) {
    const Transition& t = transitions[i];
    const MeshSequence& source = database.clip(t.source_clip);
    const MeshSequence& target = database.clip(t.target_clip);
    const auto m = static_cast<std::size_t>(t.m);
    const auto n = static_cast<std::size_t>(t.n);
    const GroundTransform& placed_from_source = placed[database.first_frame(t.source_clip) + m];
    transform_positions(placed_from_source, source.frame(m), frames.frame(2 * i));
    transform_positions(placed_from_source * t.source_from_target, target.frame(n), frames.frame(2 * i + 1));
    has_colors = has_colors && source.has_colors() && target.has_colors();
    if (!has_colors) continue;
    colors.insert(colors.end(), source.colors(m).begin(), source.colors(m).end());
    colors.insert(colors.end(), target.colors(n).begin(), target.colors(n).end());
  }
  if (has_colors) frames.set_colors(std::move(colors));

  const std::vector<AppearanceChange> changes = appearance_changes(database, transitions, viewer);
  SequenceRenderer renderer(frames, {.width = picture_width,
                                     .height = picture_height,
                                     .camera = CameraMode::fixed,
                                     .zoom = 1.25,
                                     .appearance = appearance});
  std::vector<CaptionedPicture> pictures;
  for (std::size_t i = 0; i < transitions.size(); ++i) {
    const Transition& t = transitions[i];
    const std::size_t a = database.first_frame(t.source_clip) + static_cast<std::size_t>(t.m);
    const std::size_t b = database.first_frame(t.target_clip) + static_cast<std::size_t>(t.n);
    pictures.push_back(
        {.image = tile({renderer.draw(2 * i), renderer.draw(2 * i + 1)}, 2),
         .lines = {fmt::format("{}:{} → {}:{}", database.clip(t.source_clip).name(), t.m,
                               database.clip(t.target_clip).name(), t.n),
                   fmt::format("{:.1f} cm apart, cost {:.1f} cm, {:.0f} % differ", 100.0 * matrix.value(a, b),
                               100.0 * t.cost, 100.0 * changes[i].total())}});
  }
  draw_sheet(pictures, sheet_columns,
             fmt::format("Transitions by the {} metric: source, and target turned onto it", matrix.metric()),
             png);
}

}  // namespace reprise
