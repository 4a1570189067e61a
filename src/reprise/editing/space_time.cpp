// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/space_time.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/deform/part_editor.h"
#include "reprise/editing/key_run.h"

namespace reprise {
namespace {

// Editors that are not at work. What an editor makes does not depend on what it made before, so it does not
// matter which one a frame gets.
class EditorPool {
 public:
  EditorPool(const EditorFactory& factory, EditModel model) : factory_(factory), model_(model) {}

  template <typename Work>
  void with_editor(const Work& work) {
    std::unique_ptr<SurfaceEditor> editor = take();
    work(*editor);  // an editor whose work throws is dropped
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(editor));
  }

 private:
  std::unique_ptr<SurfaceEditor> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<SurfaceEditor> editor = std::move(idle_.back());
        idle_.pop_back();
        return editor;
      }
    }
    return factory_.make(model_);
  }

  const EditorFactory& factory_;
  EditModel model_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<SurfaceEditor>> idle_;
};

void prefer(SurfaceEditor& editor, std::vector<Eigen::VectorXd> changes) {
  if (auto* const part_editor = dynamic_cast<PartEditor*>(&editor)) part_editor->prefer(std::move(changes));
}

std::vector<Eigen::VectorXd> coefficient_changes(const SurfaceEditor& editor) {
  const auto* const part_editor = dynamic_cast<const PartEditor*>(&editor);
  return part_editor == nullptr ? std::vector<Eigen::VectorXd>() : part_editor->coefficient_changes();
}

std::vector<KeyEdit> checked_keys(const MeshSequence& clip, std::vector<KeyEdit> keys) {
  if (keys.empty()) throw InvalidArgument("there is nothing to edit: expected at least one key");
  std::ranges::sort(keys, {}, &KeyEdit::frame_idx);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const KeyEdit& key = keys[k];
    const std::string place = fmt::format("key at frame {} of '{}'", key.frame_idx, clip.name());
    if (key.frame_idx >= clip.frame_count()) {
      throw InvalidArgument(fmt::format("{}: expected a frame from 0 to {}", place, clip.frame_count() - 1));
    }
    if (k > 0 && keys[k - 1].frame_idx == key.frame_idx) {
      throw InvalidArgument(fmt::format("{}: expected one key a frame, found two", place));
    }
    if (key.constraints.empty()) {
      throw InvalidArgument(fmt::format("{}: expected at least one constraint, found none", place));
    }
    validate(key.constraints, static_cast<std::int32_t>(clip.vertex_count()));
  }
  return keys;
}

bool is_rest(const KeyEdit& key, const PositionsView& frame) {
  return std::ranges::all_of(key.constraints, [&](const PositionConstraint& constraint) {
    return constraint.target == frame.row(constraint.vertex).transpose().cast<double>();
  });
}

// The parts of `edit_clip`, which share much.
struct ClipEdit {
  const EditorFactory& factory;
  const std::size_t clip_idx;
  const SpaceTimeOptions& options;
  const MeshSequence& clip = factory.database().clip(clip_idx);
  EditorPool editors{factory, options.model};

  const SkeletonPose* pose(std::size_t frame_idx) const {
    return factory.pose(options.model, {clip_idx, frame_idx});
  }

  SolvedKey solve_key(const KeyEdit& key) {
    const PositionsView frame = clip.frame(key.frame_idx);
    SolvedKey solved{.frame_idx = key.frame_idx,
                     .constraints = key.constraints,
                     .frame = frame.cast<double>(),
                     .result = frame.cast<double>(),
                     .changes = {}};
    editors.with_editor([&](SurfaceEditor& editor) {
      editor.set_frame(frame, pose(key.frame_idx));
      prefer(editor, {});
      // Solved at rest too, for its coefficients: as many as those of other keys.
      editor.deform(key.constraints);
      solved.changes = coefficient_changes(editor);
      if (!is_rest(key, frame)) {
        solved.result = editor.positions();
        return;
      }
      for (Eigen::VectorXd& change : solved.changes) change.setZero();
    });
    return solved;
  }

  // Whether displacements run from one key to the next instead of to zero in between.
  bool are_joined(const KeyEdit& key, const KeyEdit& next, double window) const {
    if (window == 0.0 || static_cast<double>(next.frame_idx - key.frame_idx) < 2.0 * window) return true;
    std::unordered_set<std::int32_t> constrained;
    for (const PositionConstraint& constraint : key.constraints) constrained.insert(constraint.vertex);
    return std::ranges::any_of(next.constraints, [&](const PositionConstraint& constraint) {
      return constrained.contains(constraint.vertex);
    });
  }

  // The surface of a frame of a run, or nothing if it stays.
  Coordinates solve_frame(const KeyRun& run, std::size_t frame_idx) {
    const PositionsView frame = clip.frame(frame_idx);
    const KeyMix mix = run.mix(frame_idx);
    const bool is_key = run.keys()[mix.a].frame_idx == frame_idx;
    const std::vector<PositionConstraint> constraints = run.constraints(mix, frame);
    Coordinates result;
    if (constraints.empty()) return result;
    if (is_key && run.is_uniform()) return run.keys()[mix.a].result;
    editors.with_editor([&](SurfaceEditor& editor) {
      editor.set_frame(frame, pose(frame_idx));
      prefer(editor, {});
      editor.deform(constraints);
      const std::vector<Eigen::VectorXd> found = coefficient_changes(editor);
      if (options.interpolate_coefficients && !is_key && !found.empty()) {
        std::vector<Eigen::VectorXd> drawn = run.changes(mix);
        for (std::size_t p = 0; p < drawn.size(); ++p) drawn[p] -= found[p];
        prefer(editor, std::move(drawn));
        editor.deform(constraints);
      }
      result = editor.positions();
    });
    return result;
  }
};

}  // namespace

MeshSequence edit_clip(const EditorFactory& factory, std::size_t clip_idx, const std::vector<KeyEdit>& keys,
                       const SpaceTimeOptions& options) {
  if (!(options.window >= 0.0) || !std::isfinite(options.window)) {
    throw InvalidArgument(
        fmt::format("window: expected a number of seconds of at least 0, found {}", options.window));
  }
  ClipEdit edit{.factory = factory, .clip_idx = clip_idx, .options = options};
  const MeshSequence& clip = edit.clip;
  const std::vector<KeyEdit> sorted = checked_keys(clip, keys);
  const double window = options.window * clip.frames_per_second();

  std::vector<SolvedKey> solved(sorted.size());
  {
    Progress progress("solve keys", sorted.size());
    parallel_for(0, sorted.size(), [&](std::size_t k) {
      solved[k] = edit.solve_key(sorted[k]);
      progress.advance();
    });
  }
  const SurfaceTurning turning(factory.root_vertices(), clip.frame(sorted.front().frame_idx));
  std::vector<KeyRun> runs;
  for (std::size_t k = 0; k < sorted.size();) {
    std::vector<SolvedKey> joined{std::move(solved[k])};
    while (++k < sorted.size() && edit.are_joined(sorted[k - 1], sorted[k], window)) {
      joined.push_back(std::move(solved[k]));
    }
    runs.emplace_back(std::move(joined), window, turning);
  }

  std::vector<std::pair<const KeyRun*, std::size_t>> work;
  for (const KeyRun& run : runs) {
    const auto [first, last] = run.support(clip.frame_count());
    for (std::size_t f = first; f <= last; ++f) work.emplace_back(&run, f);
  }
  MeshSequence edited = clip;
  Progress progress("edit frames", work.size());
  parallel_for(0, work.size(), [&](std::size_t i) {
    const auto& [run, f] = work[i];
    const Coordinates result = edit.solve_frame(*run, f);
    if (result.rows() > 0) {
      edited.frame(f) = result.cast<float>();
      if (clip.has_normals()) {
        edited.mutable_normals(f) = vertex_normals(*clip.topology(), std::as_const(edited).frame(f));
      }
    }
    progress.advance();
  });

  std::vector<FrameOrigin> origins(clip.frame_count());
  for (std::size_t f = 0; f < origins.size(); ++f) {
    origins[f] = {.clip = clip.name(), .frame_idx = static_cast<std::int32_t>(f)};
  }
  edited.set_origins(std::move(origins));
  return edited;
}

}  // namespace reprise
