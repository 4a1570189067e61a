// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/learn_model.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/core/stopwatch.h"
#include "reprise/database/body_parts.h"
#include "reprise/deform/part_hierarchy.h"
#include "reprise/io/database_file.h"
#include "reprise/io/example_file.h"
#include "reprise/io/markup_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise {
namespace {

using nlohmann::json;
using Model = LearnModelOptions::Model;

// A surface and the parts it is divided into.
struct Body {
  Positions reference;
  std::vector<BodyPart> parts;
};

std::optional<Markup> find_markup(const PerformanceDatabase& database, const LearnModelOptions& options) {
  if (!options.parts.empty()) return read_markup_file(options.parts, database);
  if (database.markup() || options.model == Model::whole) return database.markup();
  throw InvalidArgument(
      "the database has no markup, which says what its parts are: give it one with `reprise markup`, name "
      "one "
      "with --parts, or learn the whole body alone with --model whole");
}

// Only what a hierarchy can be made of, and of it only vertices that a part's triangles touch.
std::vector<BodyPart> usable_parts(const TopologyPtr& topology, const Markup& markup,
                                   const LearnModelOptions& options) {
  const bool lacks_parts = markup.parts.empty() && options.scheme == PartScheme::as_marked;
  const std::vector<BodyPart> parts =
      parts_of(*topology, markup, lacks_parts ? PartScheme::six : options.scheme);
  const Positions& reference = markup.reference;
  const PartHierarchy hierarchy(topology, PositionsView(reference.data(), reference.rows(), 3), parts);
  std::vector<BodyPart> usable;
  for (const PartHierarchy::Part& part : hierarchy.parts()) {
    usable.push_back({.name = part.name, .parent = part.parent, .vertices = part.vertices});
  }
  return usable;
}

Body marked_body(const PerformanceDatabase& database, const Markup& markup,
                 const LearnModelOptions& options) {
  try {
    return {.reference = markup.reference, .parts = usable_parts(database.topology(), markup, options)};
  } catch (const InvalidArgument& error) {
    if (options.parts.empty()) throw;
    throw FileError(options.parts, error.what());
  }
}

Body whole_body(const PerformanceDatabase& database, const std::optional<Markup>& markup) {
  return {.reference = markup ? markup->reference : Positions(database.clip(0).frame(0)),
          .parts = {whole_body_part(database.topology()->vertex_count)}};
}

std::vector<FrameId> held_out_frames(const PerformanceDatabase& database,
                                     const std::vector<std::string>& clips) {
  std::vector<FrameId> frames;
  for (const std::string& name : clips) {
    const std::size_t clip_idx = database.clip_idx(name);
    for (std::size_t f = 0; f < database.clip(clip_idx).frame_count(); ++f) {
      frames.push_back({.clip_idx = clip_idx, .frame_idx = f});
    }
  }
  return frames;
}

// The examples of one part and how well they cover the frames.
struct Examples {
  std::vector<FrameId> frames;
  double radius = 0.0;
};

// Where examples come from: the user's list or the automatic choice, without what is held out.
class ExampleSource {
 public:
  ExampleSource(const PerformanceDatabase& database, const LearnModelOptions& options,
                const std::vector<std::string>& part_names)
      : database_(&database), options_(&options), selection_(options.selection) {
    selection_.excluded = held_out_frames(database, options.without);
    selection_.excluded.insert(selection_.excluded.end(), options.selection.excluded.begin(),
                               options.selection.excluded.end());
    if (!options.examples.empty()) list_ = read_example_file(options.examples, database, part_names);
  }

  Examples of(const Positions& reference, const BodyPart& part) const {
    try {
      return list_ ? listed(reference, part) : chosen(reference, part);
    } catch (const InvalidArgument& error) {
      throw InvalidArgument(fmt::format("part '{}': {}", part.name, error.what()));
    }
  }

 private:
  Examples chosen(const Positions& reference, const BodyPart& part) const {
    ExampleSelection selection = select_examples(*database_, reference, part.vertices, selection_);
    return {.frames = std::move(selection.frames), .radius = selection.radii.back()};
  }

  Examples listed(const Positions& reference, const BodyPart& part) const {
    const std::vector<FrameId>& frames = list_->of(part.name);
    if (frames.empty()) {
      throw FileError(options_->examples,
                      fmt::format("names no example for part '{}': expected it in \"parts\", or \"frames\" "
                                  "for all parts without a list of their own",
                                  part.name));
    }
    for (const FrameId& frame : frames) {
      if (std::ranges::count(selection_.excluded, frame) == 0) continue;
      throw FileError(options_->examples,
                      fmt::format("names the example {} for part '{}', but it is held out",
                                  database_->to_string(frame), part.name));
    }
    return {.frames = frames,
            .radius = covering_radii(*database_, reference, part.vertices, frames, selection_).back()};
  }

  const PerformanceDatabase* database_;
  const LearnModelOptions* options_;
  ExampleOptions selection_;
  std::optional<ExampleList> list_;
};

json describe(const LearntModel& model, const std::vector<Examples>& examples) {
  json parts = json::array();
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const LearntPart& learnt = model.parts[p];
    json parent;
    if (learnt.part.parent >= 0) {
      parent = model.parts[static_cast<std::size_t>(learnt.part.parent)].part.name;
    }
    parts.push_back({{"name", learnt.part.name},
                     {"parent", std::move(parent)},
                     {"vertices", learnt.part.vertices.size()},
                     {"examples", learnt.examples.size()},
                     {"components", learnt.component_count()},
                     {"kept_variance", learnt.kept_variance()},
                     {"covering_radius", examples[p].radius}});
  }
  return parts;
}

struct Learnt {
  LearntModel model;
  std::vector<std::vector<FrameId>> examples;
  json report;
};

Learnt learn(const PerformanceDatabase& database, const Body& body, const ExampleSource& source,
             const LearningOptions& options, Progress& progress) {
  const Stopwatch choosing;
  std::vector<Examples> examples;
  Learnt learnt;
  for (const BodyPart& part : body.parts) {
    examples.push_back(source.of(body.reference, part));
    learnt.examples.push_back(examples.back().frames);
    progress.advance();
  }
  const double choosing_seconds = choosing.seconds();
  const Stopwatch learning;
  learnt.model = learn_model(database, body.reference, body.parts, learnt.examples, options);
  progress.advance(body.parts.size());
  learnt.report = {{"parts", describe(learnt.model, examples)},
                   {"choosing_seconds", choosing_seconds},
                   {"learning_seconds", learning.seconds()}};
  return learnt;
}

std::vector<std::string> names_of(const std::vector<Body>& bodies) {
  std::vector<std::string> names;
  for (const Body& body : bodies) {
    for (const BodyPart& part : body.parts) names.push_back(part.name);
  }
  return names;
}

void write_examples_of(const PerformanceDatabase& database, const LearnModelResult& result,
                       const std::filesystem::path& path) {
  ExampleList list;
  auto frames = result.examples.begin();
  for (const char* model : {"part", "whole"}) {
    const json& learnt = result.report["models"][model];
    if (learnt.is_null()) continue;
    for (const json& part : learnt["parts"]) {
      list.frames_of_part[part["name"].get<std::string>()] = *frames++;
    }
  }
  write_example_file(list, database, path);
}

}  // namespace

LearnModelResult learn_models(const PerformanceDatabase& database, const LearnModelOptions& options) {
  if (database.empty()) throw InvalidArgument("the database holds no clip to learn from");
  const Stopwatch all;
  const std::optional<Markup> markup = find_markup(database, options);
  std::vector<Body> bodies;
  if (options.model != Model::whole) bodies.push_back(marked_body(database, *markup, options));
  if (options.model != Model::part) bodies.push_back(whole_body(database, markup));
  const std::vector<std::string> names = names_of(bodies);
  const ExampleSource source(database, options, names);

  LearnModelResult result{.models = database.models()};
  result.report = {{"kept_variance", options.learning.kept_variance},
                   {"held_out", options.without},
                   {"models", {{"part", nullptr}, {"whole", nullptr}}}};
  Progress progress("learn", 2 * names.size());
  for (const Body& body : bodies) {
    const bool is_whole = options.model != Model::part && &body == &bodies.back();
    Learnt learnt = learn(database, body, source, options.learning, progress);
    (is_whole ? result.models.whole : result.models.part) = std::move(learnt.model);
    result.report["models"][is_whole ? "whole" : "part"] = std::move(learnt.report);
    std::ranges::move(learnt.examples, std::back_inserter(result.examples));
  }
  result.report["seconds"] = all.seconds();
  return result;
}

LearnModelResult learn_models(const std::filesystem::path& path, const LearnModelOptions& options,
                              const std::filesystem::path& output,
                              const std::filesystem::path& write_examples) {
  check_outputs({{output, ".reprise"}, {write_examples, ".json"}}, {path, options.parts, options.examples});
  PerformanceDatabase database = load_database(path);
  LearnModelResult result = learn_models(database, options);
  database.set_models(result.models);
  const std::filesystem::path& target = output.empty() ? path : output;
  save_database(database, target, DatabaseReader(path).note());
  if (!write_examples.empty()) write_examples_of(database, result, write_examples);
  result.report["database"] = path.string();
  result.report["output"] = target.string();
  return result;
}

}  // namespace reprise
