// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/editing_session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/editing/edit_history.h"

namespace reprise {
namespace {

using HandleList = std::shared_ptr<const std::vector<Handle>>;  // shared by all steps that keep it

// Where a handle is, against its place in the captured frame.
struct Place {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

  bool is_rest() const {
    return displacement == Eigen::Vector3d::Zero() && rotation.vec() == Eigen::Vector3d::Zero();
  }
  bool operator==(const Place& other) const {
    return displacement == other.displacement && rotation.coeffs() == other.rotation.coeffs();
  }
};

struct State {
  EditModel model;
  FrameId frame;
  HandleList anchors, handles;
  std::vector<Place> places;  // one a handle

  bool is_rest() const {
    return std::ranges::all_of(places, [](const Place& place) { return place.is_rest(); });
  }
  bool operator==(const State& other) const {
    return model == other.model && frame == other.frame && *anchors == *other.anchors &&
           *handles == *other.handles && places == other.places;
  }
};

struct Surface {
  Coordinates positions;
  Positions normals;
  DeformReport report;
};

void validate_handles(const std::vector<Handle>& handles, const char* kind, std::int32_t vertex_count) {
  for (const Handle& handle : handles) {
    if (handle.name.empty()) throw InvalidArgument(fmt::format("a {} has no name", kind));
    const auto fail = [&](const std::string& what) {
      throw InvalidArgument(fmt::format("{} '{}': {}", kind, handle.name, what));
    };
    if (handle.vertices.empty()) fail("expected at least one vertex, found none");
    for (std::size_t i = 0; i < handle.vertices.size(); ++i) {
      const std::int32_t vertex = handle.vertices[i];
      if (vertex < 0 || vertex >= vertex_count) {
        fail(fmt::format("expected vertices from 0 to {}, found {}", vertex_count - 1, vertex));
      }
      if (i > 0 && vertex <= handle.vertices[i - 1]) {
        fail(fmt::format("expected ascending vertices, found {} after {}", vertex, handle.vertices[i - 1]));
      }
    }
    if (!(handle.weight > 0.0) || !std::isfinite(handle.weight)) {
      fail(fmt::format("expected a weight that is positive and finite, found {}", handle.weight));
    }
  }
}

void validate_together(const std::vector<Handle>& anchors, const std::vector<Handle>& handles) {
  std::vector<std::string> names;
  for (const auto* list : {&anchors, &handles}) {
    for (const Handle& handle : *list) names.push_back(handle.name);
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end()) {
    throw InvalidArgument(
        fmt::format("two anchors or handles are named '{}': expected one of each name", *twice));
  }
  std::map<std::int32_t, const Handle*> holders;
  for (const Handle& handle : handles) {
    for (const std::int32_t vertex : handle.vertices) {
      const auto [at, is_new] = holders.emplace(vertex, &handle);
      if (is_new) continue;
      throw InvalidArgument(fmt::format("vertex {} is in the handles '{}' and '{}': expected it in one",
                                        vertex, at->second->name, handle.name));
    }
  }
}

Eigen::Vector3d centroid_of(const Handle& handle, const PositionsView& frame) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t vertex : handle.vertices) sum += frame.row(vertex).transpose().cast<double>();
  return sum / static_cast<double>(handle.vertices.size());
}

// Anchors first, each vertex once.
std::vector<PositionConstraint> constraints_of(const State& state, const PositionsView& frame) {
  enum : std::uint8_t { free, anchored, handled };
  std::vector<std::uint8_t> use(static_cast<std::size_t>(frame.rows()), free);
  std::vector<double> weights(static_cast<std::size_t>(frame.rows()), 0.0);
  for (const Handle& anchor : *state.anchors) {
    for (const std::int32_t vertex : anchor.vertices) {
      const auto v = static_cast<std::size_t>(vertex);
      use[v] = anchored;
      weights[v] = std::max(weights[v], anchor.weight);
    }
  }
  for (const Handle& handle : *state.handles) {
    for (const std::int32_t vertex : handle.vertices) use[static_cast<std::size_t>(vertex)] = handled;
  }
  std::vector<PositionConstraint> constraints;
  for (std::size_t v = 0; v < use.size(); ++v) {
    if (use[v] != anchored) continue;
    const auto vertex = static_cast<std::int32_t>(v);
    constraints.push_back({vertex, frame.row(vertex).transpose().cast<double>(), weights[v]});
  }
  for (std::size_t h = 0; h < state.handles->size(); ++h) {
    const Handle& handle = (*state.handles)[h];
    const Place& place = state.places[h];
    const Eigen::Vector3d centroid = centroid_of(handle, frame);
    for (const std::int32_t vertex : handle.vertices) {
      const Eigen::Vector3d at = frame.row(vertex).transpose().cast<double>();
      const Eigen::Vector3d target =
          place.is_rest() ? at : centroid + place.rotation * (at - centroid) + place.displacement;
      constraints.push_back({vertex, target, handle.weight});
    }
  }
  return constraints;
}

}  // namespace

struct EditingSession::Impl {
  struct Editor {
    std::unique_ptr<SurfaceEditor> editor;
    std::optional<FrameId> frame;  // the one it was given
  };

  std::shared_ptr<const EditorFactory> factory;
  std::array<Editor, edit_model_count> editors;  // one a model, made when it is needed
  EditHistory<State> history;
  Surface surface;
  std::optional<std::string> open_drag;  // the handle whose drags are still the same step
  std::vector<EditedFrame> commits;

  Impl(std::shared_ptr<const EditorFactory> maker, const State& first)
      : factory(std::move(maker)), history(first) {
    surface = solve(first);
  }

  PositionsView captured(FrameId frame) const {
    return factory->database().clip(frame.clip_idx).frame(frame.frame_idx);
  }

  std::int32_t vertex_count() const { return factory->database().topology()->vertex_count; }

  Editor& editor(EditModel model) {
    Editor& kept = editors.at(static_cast<std::size_t>(model));
    if (kept.editor == nullptr) kept = {.editor = factory->make(model), .frame = {}};
    return kept;
  }

  Surface solve(const State& state) {
    const PositionsView frame = captured(state.frame);
    Editor& used = editor(state.model);
    Surface made;
    if (state.is_rest()) {
      made.positions = frame.cast<double>();
    } else {
      try {
        if (used.frame != state.frame) {
          used.frame.reset();
          used.editor->set_frame(frame, factory->pose(state.model, state.frame));
          used.frame = state.frame;
        }
        made.report = used.editor->deform(constraints_of(state, frame));
        made.positions = used.editor->positions();
      } catch (...) {
        used = {};  // whatever was half done in it
        throw;
      }
    }
    const Positions positions = made.positions.cast<float>();
    if (!positions.allFinite()) {
      throw InvalidArgument("the surface would lie beyond all numbers: drag less far");
    }
    made.normals =
        vertex_normals(*factory->database().topology(), PositionsView(positions.data(), positions.rows(), 3));
    return made;
  }

  // Solves first: what is thrown leaves all as it was.
  void step_to(State next) {
    if (next == history.now()) return;
    Surface made = solve(next);
    history.push(std::move(next));
    surface = std::move(made);
    open_drag.reset();
  }

  bool step_along(const State* next, void (EditHistory<State>::*step)()) {
    if (next == nullptr) return false;
    surface = solve(*next);
    (history.*step)();
    open_drag.reset();
    return true;
  }

  std::size_t handle_idx(const std::string& name) const {
    std::vector<std::string> names;
    for (const Handle& handle : *history.now().handles) {
      if (handle.name == name) return names.size();
      names.push_back(handle.name);
    }
    const std::string nearest = nearest_word(name, names);
    throw InvalidArgument(fmt::format("there is no handle '{}'{}", name,
                                      nearest.empty() ? fmt::format(" among the session's {}", names.size())
                                                      : fmt::format("; did you mean '{}'?", nearest)));
  }
};

EditingSession::EditingSession(std::shared_ptr<const EditorFactory> factory, EditModel model, FrameId frame) {
  if (factory == nullptr) throw InvalidArgument("a session needs an editor factory, found none");
  const auto none = std::make_shared<const std::vector<Handle>>();
  const State first{.model = model, .frame = frame, .anchors = none, .handles = none, .places = {}};
  impl_ = std::make_unique<Impl>(std::move(factory), first);
}

EditingSession::~EditingSession() = default;

void EditingSession::set_model(EditModel model) {
  State next = impl_->history.now();
  next.model = model;
  impl_->step_to(std::move(next));
}

void EditingSession::set_frame(FrameId frame) {
  State next = impl_->history.now();
  if (next.frame == frame) return;
  next.frame = frame;
  next.places.assign(next.places.size(), Place());
  impl_->step_to(std::move(next));
}

EditModel EditingSession::model() const {
  return impl_->history.now().model;
}

FrameId EditingSession::frame() const {
  return impl_->history.now().frame;
}

void EditingSession::set_anchors(std::vector<Handle> anchors) {
  State next = impl_->history.now();
  validate_handles(anchors, "anchor", impl_->vertex_count());
  validate_together(anchors, *next.handles);
  next.anchors = std::make_shared<const std::vector<Handle>>(std::move(anchors));
  impl_->step_to(std::move(next));
}

void EditingSession::set_handles(std::vector<Handle> handles) {
  const State& now = impl_->history.now();
  State next = now;
  validate_handles(handles, "handle", impl_->vertex_count());
  validate_together(*next.anchors, handles);
  next.places.assign(handles.size(), Place());
  for (std::size_t h = 0; h < handles.size(); ++h) {
    for (std::size_t old = 0; old < now.handles->size(); ++old) {
      const Handle& before = (*now.handles)[old];
      if (before.name == handles[h].name && before.vertices == handles[h].vertices) {
        next.places[h] = now.places[old];
      }
    }
  }
  next.handles = std::make_shared<const std::vector<Handle>>(std::move(handles));
  impl_->step_to(std::move(next));
}

const std::vector<Handle>& EditingSession::anchors() const {
  return *impl_->history.now().anchors;
}

const std::vector<Handle>& EditingSession::handles() const {
  return *impl_->history.now().handles;
}

DeformReport EditingSession::drag(const std::string& handle, const Eigen::Vector3d& displacement,
                                  const Eigen::Quaterniond& rotation, bool is_final) {
  const std::size_t h = impl_->handle_idx(handle);
  if (!displacement.allFinite() || !rotation.coeffs().allFinite() || !(rotation.norm() > 0.0)) {
    throw InvalidArgument(fmt::format(
        "handle '{}': expected a finite displacement and rotation, found ({}, {}, {}) and ({}, {}, "
        "{}, {})",
        handle, displacement.x(), displacement.y(), displacement.z(), rotation.w(), rotation.x(),
        rotation.y(), rotation.z()));
  }
  EditHistory<State>& history = impl_->history;
  State next = history.now();
  next.places[h] = {displacement, rotation.normalized()};
  const bool is_same_step = impl_->open_drag == handle;
  std::optional<std::string> open_drag;
  if (!is_final) open_drag = handle;
  if (next != history.now()) {
    Surface made = impl_->solve(next);
    if (is_same_step) {
      history.replace(std::move(next));
    } else {
      history.push(std::move(next));
    }
    impl_->surface = std::move(made);
  } else if (!is_same_step) {
    open_drag.reset();  // no step yet
  }
  if (is_same_step && is_final && *history.before() == history.now()) history.drop_last_step();
  impl_->open_drag = std::move(open_drag);
  return impl_->surface.report;
}

Eigen::Vector3d EditingSession::displacement(const std::string& handle) const {
  return impl_->history.now().places[impl_->handle_idx(handle)].displacement;
}

Eigen::Quaterniond EditingSession::rotation(const std::string& handle) const {
  return impl_->history.now().places[impl_->handle_idx(handle)].rotation;
}

bool EditingSession::undo() {
  return impl_->step_along(impl_->history.before(), &EditHistory<State>::step_back);
}

bool EditingSession::redo() {
  return impl_->step_along(impl_->history.after(), &EditHistory<State>::step_on);
}

void EditingSession::reset() {
  State next = impl_->history.now();
  next.places.assign(next.places.size(), Place());
  impl_->step_to(std::move(next));
}

const Coordinates& EditingSession::positions() const {
  return impl_->surface.positions;
}

const Positions& EditingSession::normals() const {
  return impl_->surface.normals;
}

const DeformReport& EditingSession::report() const {
  return impl_->surface.report;
}

const EditedFrame& EditingSession::commit() {
  const State& now = impl_->history.now();
  EditedFrame made{.frame = now.frame,
                   .constraints = constraints_of(now, impl_->captured(now.frame)),
                   .positions = impl_->surface.positions.cast<float>()};
  for (EditedFrame& earlier : impl_->commits) {
    if (earlier.frame == now.frame) return earlier = std::move(made);
  }
  return impl_->commits.emplace_back(std::move(made));
}

const std::vector<EditedFrame>& EditingSession::commits() const {
  return impl_->commits;
}

}  // namespace reprise
