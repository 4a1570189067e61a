// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_deformation.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/deformation_report.h"
#include "reprise/pipeline/outputs.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

bool needs_markup(const std::string& model) {
  return model == "lbs" || model == "dqs";
}

std::vector<std::string> chosen_models(const PerformanceDatabase& database,
                                       const DeformationEvaluationOptions& options,
                                       std::vector<std::string>& notes) {
  const std::vector<std::string>& known = deformation_models();
  const auto is_allowed = [&](const std::string& model) {
    if (model == "part") return database.markup() || !options.learning.parts.empty();
    return database.markup() || !needs_markup(model);
  };
  for (const std::string& model : options.models) {
    if (std::ranges::count(known, model) == 0) {
      const std::string nearest = nearest_word(model, known);
      throw InvalidArgument(fmt::format("there is no model '{}'; {}", model,
                                        nearest.empty()
                                            ? fmt::format("expected one of {}", fmt::join(known, ", "))
                                            : fmt::format("did you mean '{}'?", nearest)));
    }
    if (!is_allowed(model)) {
      throw InvalidArgument(fmt::format(
          "the model '{}' needs a markup, and the database has none: give it one with `reprise markup`",
          model));
    }
  }
  std::vector<std::string> models;
  for (const std::string& model : known) {
    if (!options.models.empty()) {
      if (std::ranges::count(options.models, model) > 0) models.push_back(model);
    } else if (is_allowed(model)) {
      models.push_back(model);
    } else {
      notes.push_back(fmt::format("The model {} is left out: the database has no markup.", model));
    }
  }
  return models;
}

void check(const DeformationEvaluationOptions& options, std::int32_t vertex_count) {
  if (options.constraints.empty()) throw InvalidArgument("constraints: expected at least one number");
  for (const std::size_t count : options.constraints) {
    if (count < 1 || count > static_cast<std::size_t>(vertex_count)) {
      throw InvalidArgument(fmt::format(
          "constraints: expected 1 to {} (the vertices of the surface), found {}", vertex_count, count));
    }
  }
  if (options.stride < 1) throw InvalidArgument("stride: expected 1 or more, found 0");
  if (options.pictures < 0 || options.pictures > 20) {
    throw InvalidArgument(fmt::format("pictures: expected 0 to 20, found {}", options.pictures));
  }
}

std::vector<std::string> held_clips(const PerformanceDatabase& database,
                                    const DeformationEvaluationOptions& options) {
  if (options.held.empty()) {
    if (!options.truth.empty()) return {};
    return {database.clips().back().name()};
  }
  std::vector<std::string> held;
  for (const std::string& name : options.held) {
    static_cast<void>(database.clip_idx(name));
    if (std::ranges::count(held, name) == 0) held.push_back(name);
  }
  return held;
}

// The clips that are learnt from, with what is known of the performer.
PerformanceDatabase learnt_clips(const PerformanceDatabase& database, const std::vector<std::string>& held) {
  PerformanceDatabase rest;
  for (const MeshSequence& clip : database.clips()) {
    if (std::ranges::count(held, clip.name()) == 0) rest.add(clip);
  }
  if (rest.empty()) {
    throw InvalidArgument(
        fmt::format("nothing is left to learn from: the database has {} clip{}, and held out are {}",
                    database.clips().size(), database.clips().size() == 1 ? "" : "s", fmt::join(held, ", ")));
  }
  rest.set_markup(database.markup());
  return rest;
}

void add_frames(const PerformanceDatabase& database, std::size_t clip_idx, std::size_t stride,
                const std::string& prefix, std::vector<HeldFrame>& frames) {
  for (std::size_t f = 0; f < database.clip(clip_idx).frame_count(); f += stride) {
    const FrameId id{.clip_idx = clip_idx, .frame_idx = f};
    frames.push_back({.database = &database, .id = id, .name = prefix + database.to_string(id)});
  }
}

void check_same_surface(const PerformanceDatabase& database, const PerformanceDatabase& truth,
                        const fs::path& path) {
  const std::string difference =
      first_difference(*database.topology(), *truth.topology(), "the database", path.string());
  if (!difference.empty())
    throw InvalidArgument(fmt::format("{}: is no truth of this database: {}", path.string(), difference));
}

void learn(const PerformanceDatabase& database, const std::vector<std::string>& models,
           const std::vector<std::string>& held, const DeformationEvaluationOptions& options,
           PerformanceDatabase& learnt, DeformationEvaluation& result) {
  const bool has_part = std::ranges::count(models, "part") > 0;
  const bool has_whole = std::ranges::count(models, "whole") > 0;
  if (!has_part && !has_whole) return;
  LearnModelOptions learning = options.learning;
  using Model = LearnModelOptions::Model;
  learning.model = has_part && has_whole ? Model::both : has_part ? Model::part : Model::whole;
  learning.without = held;
  LearnModelResult made = learn_models(database, learning);
  learnt.set_models(std::move(made.models));
  result.learning = std::move(made.report);
}

void add(TrialFigures& sum, const TrialFigures& figures) {
  sum.mean_error += figures.mean_error;
  sum.max_error += figures.max_error;
  sum.inside_stretch_p99 += figures.inside_stretch_p99;
  sum.inside_stretch_max += figures.inside_stretch_max;
  sum.frontier_stretch_p99 += figures.frontier_stretch_p99;
  sum.frontier_stretch_max += figures.frontier_stretch_max;
}

void divide(TrialFigures& sum, double count) {
  for (double* figure : {&sum.mean_error, &sum.max_error, &sum.inside_stretch_p99, &sum.inside_stretch_max,
                         &sum.frontier_stretch_p99, &sum.frontier_stretch_max}) {
    *figure /= count;
  }
}

void worsen(TrialFigures& worst, const TrialFigures& figures) {
  const auto most = [](double& a, double b) { a = std::max(a, b); };
  most(worst.mean_error, figures.mean_error);
  most(worst.max_error, figures.max_error);
  most(worst.inside_stretch_p99, figures.inside_stretch_p99);
  most(worst.inside_stretch_max, figures.inside_stretch_max);
  most(worst.frontier_stretch_p99, figures.frontier_stretch_p99);
  most(worst.frontier_stretch_max, figures.frontier_stretch_max);
}

// Trials come frame by frame, always in the same order.
std::vector<DeformationFigures> summarize(const std::vector<DeformationTrial>& trials, std::size_t frames) {
  const std::size_t a_frame = trials.size() / frames;
  std::vector<DeformationFigures> all(a_frame);
  for (std::size_t i = 0; i < a_frame; ++i) {
    const DeformationTrial& first = trials[i];
    all[i] = {.model = first.model,
              .source = first.source,
              .constraints = first.constraints,
              .mean = first.figures,
              .worst = first.figures};
    for (std::size_t t = i + a_frame; t < trials.size(); t += a_frame) {
      add(all[i].mean, trials[t].figures);
      worsen(all[i].worst, trials[t].figures);
    }
    divide(all[i].mean, static_cast<double>(frames));
  }
  return all;
}

// Spread evenly over all of them.
std::vector<HeldFrame> pictured(const std::vector<HeldFrame>& frames, int count) {
  std::vector<HeldFrame> some;
  const std::size_t wanted = std::min(frames.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < wanted; ++i) some.push_back(frames[(2 * i + 1) * frames.size() / (2 * wanted)]);
  return some;
}

void write(const DeformationEvaluation& result, const DeformationEvaluationOptions& options,
           const fs::path& folder) {
  write_text_file(folder / "deformation.md", deformation_markdown(result, options));
  write_text_file(folder / "deformation.csv", deformation_csv(result));
  write_text_file(folder / "frames.csv", deformation_frames_csv(result));
  plot_deformation(result, folder / "deformation.png");
}

}  // namespace

const std::vector<std::string>& deformation_models() {
  static const std::vector<std::string> models = {"part", "whole", "laplacian", "lbs", "dqs", "rigid"};
  return models;
}

std::string to_string(DeformationSource source) {
  return source == DeformationSource::first ? "first" : "nearest";
}

DeformationEvaluation evaluate_deformation(const PerformanceDatabase& database, const fs::path& folder,
                                           const DeformationEvaluationOptions& options) {
  // What is wrong is said before the long work.
  if (database.empty()) throw InvalidArgument("the database has no clip to evaluate");
  check(options, database.topology()->vertex_count);
  DeformationEvaluation result;
  const std::vector<std::string> models = chosen_models(database, options, result.notes);
  const std::vector<std::string> held = held_clips(database, options);
  PerformanceDatabase learnt = learnt_clips(database, held);
  std::optional<PerformanceDatabase> truth;
  std::vector<HeldFrame> frames;
  for (const std::string& name : held) {
    add_frames(database, database.clip_idx(name), options.stride, "", frames);
    result.held_clips.push_back(name);
  }
  if (!options.truth.empty()) {
    truth = load_database(options.truth);
    check_same_surface(database, *truth, options.truth);
    const std::string prefix = options.truth.stem().string() + "/";
    for (std::size_t c = 0; c < truth->clips().size(); ++c) {
      add_frames(*truth, c, options.stride, prefix, frames);
      result.held_clips.push_back(prefix + truth->clip(c).name());
    }
  }
  prepare_folder(folder);

  learn(database, models, held, options, learnt, result);
  const DeformationBench bench(learnt, models, options.constraints);
  result.learnt_clips = learnt.clip_names();
  result.frames = frames.size();
  result.has_frontier = bench.meter().has_frontier();
  result.trials = bench.try_all(frames, options.constraints);
  result.figures = summarize(result.trials, frames.size());
  for (DeformationFigures& figures : result.figures) {
    if (figures.source != DeformationSource::first) continue;
    figures.milliseconds = bench.milliseconds(figures.model, frames, figures.constraints);
  }
  if (options.pictures > 0) {
    draw_deformation(bench, pictured(frames, options.pictures),
                     options.constraints[options.constraints.size() / 2], folder / "pictures.png");
  }
  write(result, options, folder);
  return result;
}

}  // namespace reprise
