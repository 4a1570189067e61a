// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/edit_script.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/json_file.h"
#include "reprise/core/text.h"
#include "reprise/editing/vertex_selection.h"

namespace reprise {
namespace {

constexpr const char* script_format = "reprise edit";
constexpr int format_version = 1;
// Metres: beyond it a number is a mistake (centimetres, millimetres), and no capture is that large.
constexpr double largest_length = 1000.0;

// What does not fit is said of the field it stands in.
template <typename Work>
auto at_field(const JsonField& field, const Work& work) {
  try {
    return work();
  } catch (const InvalidArgument& error) {
    field.fail(error.what());
  }
}

Eigen::Vector3d read_vector(const JsonField& field) {
  const std::vector<JsonField> numbers = field.items();
  if (numbers.size() != 3) {
    field.fail(fmt::format("expected three numbers (x, y, z), found {}", numbers.size()));
  }
  const Eigen::Vector3d vector(numbers[0].number(), numbers[1].number(), numbers[2].number());
  if (!(vector.cwiseAbs().maxCoeff() <= largest_length)) {
    field.fail(fmt::format("expected metres from {:g} to {:g}, found ({:g}, {:g}, {:g})", -largest_length,
                           largest_length, vector.x(), vector.y(), vector.z()));
  }
  return vector;
}

double read_positive(const JsonField& field) {
  const double value = field.number();
  if (!(value > 0.0)) field.fail(fmt::format("expected a number above 0, found {}", value));
  return value;
}

Eigen::Quaterniond read_turn(const JsonField& field) {
  const Eigen::Vector3d axis = read_vector(field["axis"]);
  if (!(axis.norm() > 1e-9)) field["axis"].fail("expected a direction, found no length");
  const double angle = field["degrees"].number() * std::numbers::pi / 180.0;
  field.warn_of_others({"axis", "degrees"});
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(std::remainder(angle, 2.0 * std::numbers::pi), axis.normalized()));
}

VertexSelection read_selection(const JsonField& field, std::int32_t vertex_count) {
  VertexSelection selection;
  if (field.has("vertices")) {
    for (const JsonField& item : field["vertices"].items()) {
      selection.vertices.push_back(item.integer(0, vertex_count - 1));
    }
    if (selection.vertices.empty()) field["vertices"].fail("expected at least one vertex, found none");
  }
  if (field.has("joint")) selection.joint = field["joint"].text();
  if (field.has("part")) selection.part = field["part"].text();
  if (field.has("near")) selection.near = read_vector(field["near"]);
  if (field.has("radius")) {
    if (!selection.near) field["radius"].fail("a radius needs a place: expected \"near\" beside it");
    selection.radius = read_positive(field["radius"]);
  }
  return selection;
}

class ScriptReader {
 public:
  ScriptReader(const PerformanceDatabase& database, std::string default_frame)
      : database_(database), default_frame_(std::move(default_frame)) {}

  EditScript read(const JsonField& file) {
    EditScript script;
    if (file.has("model")) {
      script.model = at_field(file["model"], [&] { return parse_edit_model(file["model"].text()); });
    }
    if (file.has("window")) script.window = file["window"].number_from(0.0);
    const bool has_frame = file.has("frame");
    if (default_frame_.empty() && has_frame) default_frame_ = file["frame"].text();
    if (has_frame) at_field(file["frame"], [&] { return database_.parse_frame(file["frame"].text()); });
    const std::vector<JsonField> steps = file["steps"].items();
    if (steps.empty()) file["steps"].fail("expected at least one step, found none");
    for (const JsonField& step : steps) script.steps.push_back(read_step(step));
    file.warn_of_others({"format", "version", "model", "window", "frame", "steps"});
    return script;
  }

 private:
  ScriptStep read_step(const JsonField& field) {
    ScriptStep step{.frame = read_frame(field), .anchors = {}, .drags = {}};
    if (frames_.empty() || frames_.back() != step.frame) {
      if (std::ranges::find(frames_, step.frame) != frames_.end()) {
        field.fail(fmt::format("steps of {} stand in two places: expected them in a row",
                               database_.to_string(step.frame)));
      }
      frames_.push_back(step.frame);
      known_.clear();
      has_anchors_ = false;
    }
    if (field.has("anchors")) step.anchors = read_anchors(field["anchors"], step.frame);
    if (field.has("handles")) {
      for (const JsonField& item : field["handles"].items()) step.drags.push_back(read_drag(item, step));
    }
    if (known_.empty() && !has_anchors_) {
      field.fail("nothing is held or moved: expected \"handles\" or \"anchors\"");
    }
    field.warn_of_others({"frame", "anchors", "handles"});
    return step;
  }

  FrameId read_frame(const JsonField& field) const {
    if (field.has("frame")) {
      return at_field(field["frame"], [&] { return database_.parse_frame(field["frame"].text()); });
    }
    if (!frames_.empty()) return frames_.back();
    if (default_frame_.empty()) {
      field.fail("names no frame: expected \"frame\": \"CLIP:FRAME\" here, above the steps, or as --frame");
    }
    return database_.parse_frame(default_frame_);
  }

  std::vector<Handle> read_anchors(const JsonField& field, FrameId frame) {
    std::vector<Handle> anchors;
    for (const JsonField& item : field.items()) {
      const VertexSelection selection = read_selection(item, database_.topology()->vertex_count);
      Handle anchor{.name =
                        item.has("name") ? item["name"].text() : fmt::format("anchor {}", anchors.size())};
      anchor.vertices = at_field(item, [&] { return select_vertices(database_, frame, selection); });
      if (item.has("weight")) anchor.weight = read_positive(item["weight"]);
      item.warn_of_others({"name", "vertices", "joint", "part", "near", "radius", "weight"});
      check_name(item, anchor.name, anchors);
      anchors.push_back(std::move(anchor));
    }
    has_anchors_ = !anchors.empty();
    return anchors;
  }

  static void check_name(const JsonField& item, const std::string& name, const std::vector<Handle>& others) {
    if (name.empty()) item["name"].fail("expected a name, found an empty one");
    for (const Handle& other : others) {
      if (other.name == name) item.fail(fmt::format("the name '{}' is taken", name));
    }
  }

  ScriptedDrag read_drag(const JsonField& item, const ScriptStep& step) {
    const VertexSelection selection = read_selection(item, database_.topology()->vertex_count);
    ScriptedDrag drag{.handle = {.name = drag_name(item, selection), .vertices = {}}};
    for (const ScriptedDrag& other : step.drags) {
      if (other.handle.name == drag.handle.name) {
        item.fail(fmt::format("the step drags '{}' twice: expected once", drag.handle.name));
      }
    }
    const auto earlier = std::ranges::find(known_, drag.handle.name, &Handle::name);
    if (!selection.empty()) {
      drag.handle.vertices =
          at_field(item, [&] { return select_vertices(database_, step.frame, selection); });
    } else if (earlier != known_.end()) {
      drag.handle = *earlier;
    } else {
      fail_unknown(item, drag.handle.name);
    }
    if (item.has("weight")) drag.handle.weight = read_positive(item["weight"]);
    if (item.has("move") && item.has("to")) item.fail("expected \"move\" or \"to\", found both");
    if (item.has("move")) drag.displacement = read_vector(item["move"]);
    if (item.has("to")) {
      drag.displacement = read_vector(item["to"]) - centroid(drag.handle.vertices, step.frame);
    }
    if (item.has("turn")) drag.rotation = read_turn(item["turn"]);
    item.warn_of_others(
        {"name", "vertices", "joint", "part", "near", "radius", "weight", "move", "to", "turn"});
    if (earlier != known_.end()) {
      *earlier = drag.handle;
    } else {
      known_.push_back(drag.handle);
    }
    return drag;
  }

  std::string drag_name(const JsonField& item, const VertexSelection& selection) const {
    if (item.has("name")) {
      std::string name = item["name"].text();
      if (name.empty()) item["name"].fail("expected a name, found an empty one");
      return name;
    }
    if (!selection.joint.empty()) return selection.joint;
    if (!selection.part.empty()) return selection.part;
    return fmt::format("handle {}", known_.size());
  }

  [[noreturn]] void fail_unknown(const JsonField& item, const std::string& name) const {
    std::vector<std::string> names;
    for (const Handle& handle : known_) names.push_back(handle.name);
    const std::string nearest = nearest_word(name, names);
    item.fail(nearest.empty()
                  ? std::string("no vertex is chosen: expected vertices, joint, part or near")
                  : fmt::format("there is no handle '{}' yet; did you mean '{}'?", name, nearest));
  }

  Eigen::Vector3d centroid(const std::vector<std::int32_t>& vertices, FrameId frame) const {
    const PositionsView positions = database_.clip(frame.clip_idx).frame(frame.frame_idx);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t vertex : vertices) sum += positions.row(vertex).transpose().cast<double>();
    return sum / static_cast<double>(vertices.size());
  }

  const PerformanceDatabase& database_;
  std::string default_frame_;
  std::vector<FrameId> frames_;  // of the steps so far, each once
  std::vector<Handle> known_;    // handles of the frame at hand
  bool has_anchors_ = false;
};

}  // namespace

EditScript read_edit_script(const std::filesystem::path& path, const PerformanceDatabase& database,
                            const std::string& frame) {
  if (database.empty()) throw InvalidArgument("there is nothing to edit: the database has no clip");
  const Json json = read_json_file(path);
  if (!json.is_object() || !json.contains("format") || json["format"] != script_format) {
    throw FileError(path, fmt::format("is not an edit script: expected \"format\": \"{}\"", script_format));
  }
  const JsonField file(path, json);
  if (const int version = file["version"].integer(1); version > format_version) {
    file["version"].fail(
        fmt::format("the file has version {}, this program reads up to version {}", version, format_version));
  }
  if (!frame.empty()) static_cast<void>(database.parse_frame(frame));  // not the file's fault
  return ScriptReader(database, frame).read(file);
}

}  // namespace reprise
