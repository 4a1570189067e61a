// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "model learn": how the parts and the whole of a performer deform (LPBM IV.A), kept in the database
// file.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "reprise/database/learnt_model.h"
#include "reprise/deform/example_selection.h"
#include "reprise/deform/learning.h"
#include "reprise/pipeline/markup.h"

namespace reprise {

struct LearnModelOptions {
  enum class Model { both, part, whole };
  Model model = Model::both;
  std::filesystem::path parts;  // JSON of a markup whose parts and reference are taken; empty: the database's
  PartScheme scheme = PartScheme::as_marked;  // or make the parts from the joints of that markup
  std::filesystem::path examples;             // JSON list of frames; empty: chosen automatically
  ExampleOptions selection;                   // of the automatic choice, a part at a time
  std::vector<std::string> without;           // clips held out: no example is taken from them
  LearningOptions learning;
};

struct LearnModelResult {
  LearntModels models;  // what the database had, with what was learnt now in its place
  // kept_variance (asked for), held_out (clips), seconds, models.part and models.whole (null if not learnt
  // now): choosing_seconds, learning_seconds and parts, each with name, parent, vertices, examples,
  // components, kept_variance and covering_radius (metres: no frame that is not held out is farther from its
  // nearest example).
  nlohmann::json report;
  std::vector<std::vector<FrameId>> examples;  // of the parts learnt now, the whole body last
};

// The whole body needs no markup: its reference is that of the markup or else the first frame. In a list of
// examples it is the part "body". A markup without parts gets six. Throws `InvalidArgument`: no markup, parts
// that `PartHierarchy` refuses, a clip that is not there, no frame left to learn from; `FileError`: what is
// wrong with the file of parts or of examples, such as a part it names no example for or one that is held
// out.
LearnModelResult learn_models(const PerformanceDatabase& database, const LearnModelOptions& options = {});

// The same for a file, which is written anew to `output` with everything it holds; if `output` is empty, it
// replaces the file, whole or not at all. `write_examples`, if not empty: where the examples are written
// as a list. Adds "database" and "output" to the report.
LearnModelResult learn_models(const std::filesystem::path& database, const LearnModelOptions& options,
                              const std::filesystem::path& output = {},
                              const std::filesystem::path& write_examples = {});

}  // namespace reprise
