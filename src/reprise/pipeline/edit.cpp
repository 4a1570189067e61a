// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/edit.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/editing/edit_script.h"
#include "reprise/editing/space_time.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/pipeline/render.h"

namespace reprise {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Color moved_color = {64, 168, 80};
constexpr Color held_color = {204, 68, 56};
constexpr Color surface_color = {196, 184, 172};
constexpr std::size_t most_pairs = 16;  // in a picture

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// A frame of the result: a captured one, and its surface now.
struct Still {
  FrameId frame;
  Positions positions;
};

// The steps of a script, done in a session.
class ScriptRun {
 public:
  ScriptRun(const PerformanceDatabase& database, const EditScript& script, EditModel model,
            const std::filesystem::path& path)
      : database_(database),
        path_(path),
        factory_(std::make_shared<const EditorFactory>(database)),
        session_(factory_, model, script.steps.front().frame) {
    for (std::size_t s = 0; s < script.steps.size(); ++s) {
      throw_if_interrupted();
      const ScriptStep& step = script.steps[s];
      if (s == 0 || step.frame != session_.frame()) begin_frame(step.frame);
      do_step(step, fmt::format("steps[{}]", s));
      const bool is_last = s + 1 == script.steps.size() || script.steps[s + 1].frame != session_.frame();
      if (is_last) session_.commit();
    }
  }

  const EditorFactory& factory() const { return *factory_; }
  const std::vector<EditedFrame>& edited() const { return session_.commits(); }
  const std::vector<Still>& shown_steps() const { return shown_steps_; }
  const nlohmann::json& report() const { return report_; }

 private:
  void begin_frame(FrameId frame) {
    session_.set_handles({});
    session_.set_anchors({});
    session_.set_frame(frame);
    show();
  }

  void show() { shown_steps_.push_back({session_.frame(), session_.positions().cast<float>()}); }

  void do_step(const ScriptStep& step, const std::string& place) {
    const auto start = Clock::now();
    std::vector<std::string> names;
    try {
      if (step.anchors) session_.set_anchors(*step.anchors);
      session_.set_handles(with_dragged(step));
      for (const ScriptedDrag& drag : step.drags) {
        session_.drag(drag.handle.name, drag.displacement, drag.rotation);
        names.push_back(drag.handle.name);
      }
    } catch (const InvalidArgument& error) {
      throw FileError(path_, place, error.what());
    }
    const DeformReport& made = session_.report();
    report_.push_back({{"frame", database_.to_string(step.frame)},
                       {"handles", names},
                       {"residual", made.largest_residual},
                       {"solved_parts", made.solved_parts},
                       {"iterations", made.iterations},
                       {"seconds", seconds_since(start)}});
    show();
  }

  // The session's handles, with those of the step in place of earlier ones of their names.
  std::vector<Handle> with_dragged(const ScriptStep& step) const {
    std::vector<Handle> handles = session_.handles();
    for (const ScriptedDrag& drag : step.drags) {
      const auto earlier = std::ranges::find(handles, drag.handle.name, &Handle::name);
      if (earlier == handles.end()) {
        handles.push_back(drag.handle);
      } else {
        *earlier = drag.handle;
      }
    }
    return handles;
  }

  const PerformanceDatabase& database_;
  const std::filesystem::path& path_;
  std::shared_ptr<const EditorFactory> factory_;
  EditingSession session_;
  std::vector<Still> shown_steps_;
  nlohmann::json report_ = nlohmann::json::array();
};

MeshSequence make_stills(const PerformanceDatabase& database, const std::vector<Still>& stills,
                         const std::string& name) {
  const MeshSequence& first = database.clip(stills.front().frame.clip_idx);
  MeshSequence made(name, database.topology(), stills.size(), first.frames_per_second());
  bool have_colors = true;
  bool have_normals = true;
  for (const Still& still : stills) {
    have_colors = have_colors && database.clip(still.frame.clip_idx).has_colors();
    have_normals = have_normals && database.clip(still.frame.clip_idx).has_normals();
  }
  std::vector<Color> colors;
  std::vector<FrameOrigin> origins;
  for (std::size_t f = 0; f < stills.size(); ++f) {
    const FrameId frame = stills[f].frame;
    const MeshSequence& clip = database.clip(frame.clip_idx);
    made.frame(f) = stills[f].positions;
    if (have_normals) {
      made.mutable_normals(f) = vertex_normals(*made.topology(), std::as_const(made).frame(f));
    }
    if (have_colors) {
      const auto own = clip.colors(frame.frame_idx);
      colors.insert(colors.end(), own.begin(), own.end());
    }
    origins.push_back({.clip = clip.name(), .frame_idx = static_cast<std::int32_t>(frame.frame_idx)});
  }
  made.set_colors(std::move(colors));
  made.set_origins(std::move(origins));
  return made;
}

MeshSequence make_before_after(const PerformanceDatabase& database, const std::vector<EditedFrame>& edited) {
  const std::size_t pairs = std::min(edited.size(), most_pairs);
  MeshSequence made("before and after", database.topology(), 2 * pairs,
                    database.clip(edited.front().frame.clip_idx).frames_per_second());
  const auto vertex_count = static_cast<std::size_t>(database.topology()->vertex_count);
  std::vector<Color> colors(2 * pairs * vertex_count, surface_color);
  for (std::size_t p = 0; p < pairs; ++p) {
    const PositionsView captured = database.clip(edited[p].frame.clip_idx).frame(edited[p].frame.frame_idx);
    made.frame(2 * p) = captured;
    made.frame(2 * p + 1) = edited[p].positions;
    for (const PositionConstraint& constraint : edited[p].constraints) {
      const bool is_held = constraint.target == captured.row(constraint.vertex).transpose().cast<double>();
      for (const std::size_t f : {2 * p, 2 * p + 1}) {
        colors[f * vertex_count + static_cast<std::size_t>(constraint.vertex)] =
            is_held ? held_color : moved_color;
      }
    }
  }
  made.set_colors(std::move(colors));
  return made;
}

// Frames that differ from the captured ones: how many, and their greatest acceleration beside the capture's.
nlohmann::json describe_change(const PerformanceDatabase& database, const MeshSequence& captured,
                               const MeshSequence& edited) {
  std::size_t changed = 0;
  double peak = 0.0;
  double captured_peak = 0.0;
  for (std::size_t f = 0; f < edited.frame_count(); ++f) {
    if (edited.frame(f) == captured.frame(f)) continue;
    ++changed;
    for (std::size_t near = f == 0 ? 0 : f - 1; near <= f + 1; ++near) {
      if (near == 0 || near + 1 >= edited.frame_count()) continue;
      peak = std::max(peak, peak_acceleration(edited, near));
      captured_peak = std::max(captured_peak, peak_acceleration(captured, near));
    }
  }
  nlohmann::json change = {
      {"changed_frames", changed}, {"pop_ratio", nullptr}, {"captured_pop_ratio", nullptr}};
  if (const double usual = captured_acceleration(database); usual > 0.0 && changed > 0) {
    change["pop_ratio"] = peak / usual;
    change["captured_pop_ratio"] = captured_peak / usual;
  }
  return change;
}

MeshSequence spread(const PerformanceDatabase& database, ScriptRun& run, const SpaceTimeOptions& options,
                    nlohmann::json& report) {
  const std::vector<EditedFrame>& edited = run.edited();
  const std::size_t clip_idx = edited.front().frame.clip_idx;
  std::vector<KeyEdit> keys;
  for (const EditedFrame& key : edited) {
    if (key.frame.clip_idx != clip_idx) {
      throw InvalidArgument(fmt::format(
          "edits can be spread over one clip: found {} and {}; edit one after the other, or without a window",
          database.to_string(edited.front().frame), database.to_string(key.frame)));
    }
    keys.push_back({key.frame.frame_idx, key.constraints});
  }
  const auto start = Clock::now();
  MeshSequence made = edit_clip(run.factory(), clip_idx, keys, options);
  report["seconds"] = seconds_since(start);
  report.update(describe_change(database, database.clip(clip_idx), made));
  return made;
}

}  // namespace

EditResult run_edit(const PerformanceDatabase& database, const EditStageOptions& options) {
  if (options.window && !(*options.window >= 0.0)) {
    throw InvalidArgument(
        fmt::format("window: expected a number of seconds of at least 0, found {}", *options.window));
  }
  const EditScript script = read_edit_script(options.script, database, options.frame);
  const EditModel model = options.model ? *options.model : script.model.value_or(EditModel::part);
  const std::optional<double> window = options.window ? options.window : script.window;
  if (window && options.show_steps) {
    throw InvalidArgument("steps are shown as stills: leave them out, or the window that spreads the edits");
  }
  ScriptRun run(database, script, model, options.script);

  EditResult result;
  result.report = {{"model", to_string(model)}, {"window", nullptr}, {"steps", run.report()}};
  result.before_after = make_before_after(database, run.edited());
  if (window) {
    result.report["window"] = *window;
    result.animation = spread(database, run, {.model = model, .window = *window}, result.report);
    if (!options.name.empty()) result.animation.set_name(options.name);
    return result;
  }
  std::vector<Still> stills;
  for (const EditedFrame& edited : run.edited()) stills.push_back({edited.frame, edited.positions});
  result.animation = make_stills(database, options.show_steps ? run.shown_steps() : stills,
                                 options.name.empty() ? "edit" : options.name);
  return result;
}

void draw_before_after(const EditResult& result, const std::filesystem::path& png) {
  render_sequence(
      result.before_after, png,
      {.view = {.width = 480, .height = 640, .appearance = Appearance::vertex_colors}, .columns = 2});
}

}  // namespace reprise
