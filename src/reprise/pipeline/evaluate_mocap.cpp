// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_mocap.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/json_file.h"
#include "reprise/core/log.h"
#include "reprise/core/ranks.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/evaluate_mocap_report.h"
#include "reprise/pipeline/graph.h"
#include "reprise/pipeline/outputs.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

// Everything but one clip, and nothing that was learnt.
PerformanceDatabase database_without(const PerformanceDatabase& database, std::size_t clip_idx) {
  PerformanceDatabase rest;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    if (c != clip_idx) rest.add(database.clip(c));
  }
  if (rest.empty()) {
    throw InvalidArgument(
        fmt::format("clip '{}' is held out, and the database has no other", database.clip(clip_idx).name()));
  }
  rest.set_markup(database.markup());
  return rest;
}

// The transitions in force between the clips that are left.
SurfaceMotionGraph graph_without(const SurfaceMotionGraph& graph, const PerformanceDatabase& rest,
                                 std::size_t clip_idx) {
  std::vector<Transition> transitions;
  for (Transition transition : graph.active_transitions()) {
    if (transition.source_clip == clip_idx || transition.target_clip == clip_idx) continue;
    if (transition.source_clip > clip_idx) --transition.source_clip;
    if (transition.target_clip > clip_idx) --transition.target_clip;
    transitions.push_back(transition);
  }
  return build_graph(rest, graph.metric, std::move(transitions), graph.options);
}

class Evaluation {
 public:
  Evaluation(const fs::path& path, const MocapEvaluationOptions& options)
      : options_(options),
        trials_(chosen_trials(read_corpus(options.corpus), options.tiers, options.trials)),
        database_(load_database(path)) {
    check_held();
    for (const fs::path& truth : options.truth) open_truth(truth);
    if (!database_.markup()) {
      throw InvalidArgument(
          fmt::format("{}: has no markup, which says where the joints of the performer are: give it one with "
                      "`reprise markup`",
                      path.string()));
    }
    graph_ = open_graph(database_, path, options.mocap.graph);
  }

  std::vector<MocapTrial> run() {
    std::vector<std::uintmax_t> sizes;
    for (const CorpusTrial& trial : trials_) sizes.push_back(std::max<std::size_t>(1, trial.frames));
    const std::vector<int> rank_of = shares_of_ranks(sizes, Ranks::count());
    nlohmann::json own = nlohmann::json::array();
    for (std::size_t t = 0; t < trials_.size(); ++t) {
      if (rank_of[t] != Ranks::index()) continue;
      own.push_back({t, to_exchange(run_trial(trials_[t]))});
    }
    std::vector<MocapTrial> results(trials_.size());
    const std::string text = own.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (const std::vector<std::byte>& part : Ranks::all_gather(std::as_bytes(std::span(text)))) {
      const char* const begin = reinterpret_cast<const char*>(part.data());
      for (const nlohmann::json& entry : nlohmann::json::parse(begin, begin + part.size())) {
        results[entry[0].get<std::size_t>()] = from_exchange(entry[1]);
      }
    }
    return results;
  }

 private:
  void check_held() const {
    for (const auto& [trial, clip] : options_.held) {
      static_cast<void>(database_.clip_idx(clip));
      static_cast<void>(chosen_trials(read_corpus(options_.corpus), {}, {trial}));
    }
  }

  void open_truth(const fs::path& path) {
    const PerformanceDatabase truth = load_database(path);
    const std::string difference =
        first_difference(*database_.topology(), *truth.topology(), "the database", path.string());
    if (!difference.empty()) {
      throw InvalidArgument(fmt::format("{}: is no truth of this database: {}", path.string(), difference));
    }
    if (truth.frames_per_second() != database_.frames_per_second()) {
      throw InvalidArgument(
          fmt::format("{}: is no truth of this database: expected {:g} frames/s, found {:g}", path.string(),
                      database_.frames_per_second(), truth.frames_per_second()));
    }
    for (const MeshSequence& clip : truth.clips()) truth_.add(clip);
  }

  const MeshSequence* truth_of(const CorpusTrial& trial) const {
    if (const auto held = options_.held.find(trial.trial); held != options_.held.end()) {
      return &database_.clip(database_.clip_idx(held->second));
    }
    const auto clip = std::ranges::find(truth_.clips(), trial.trial, &MeshSequence::name);
    return clip == truth_.clips().end() ? nullptr : &*clip;
  }

  // Models that are compared with the truth must be learnt.
  std::vector<DriveModel> wanted_models(bool has_truth) const {
    if (has_truth) return {DriveModel::part, DriveModel::whole, options_.mocap.mocap.model};
    return {options_.mocap.mocap.model};
  }

  // Of the whole database; made when a trial first needs it.
  const MocapStage& whole_stage() {
    if (!stage_) {
      PerformanceDatabase database = database_;
      const bool has_truth = std::ranges::any_of(
          trials_, [this](const CorpusTrial& trial) { return truth_of(trial) != nullptr; });
      learn_what_is_missing(database, wanted_models(has_truth));
      stage_ = std::make_unique<MocapStage>(std::move(database), graph_, options_.mocap);
    }
    return *stage_;
  }

  MocapTrial run_trial(const CorpusTrial& trial) {
    const auto held = options_.held.find(trial.trial);
    MocapTrial result;
    if (held == options_.held.end()) {
      result = run_mocap_trial(whole_stage(), trial, truth_of(trial));
    } else {
      const std::size_t clip_idx = database_.clip_idx(held->second);
      PerformanceDatabase rest = database_without(database_, clip_idx);
      SurfaceMotionGraph graph = graph_without(graph_, rest, clip_idx);
      learn_what_is_missing(rest, wanted_models(true));
      MocapStageOptions options = options_.mocap;
      std::erase(options.without, held->second);
      const MocapStage stage(std::move(rest), std::move(graph), std::move(options));
      result = run_mocap_trial(stage, trial, truth_of(trial));
      result.held_clip = held->second;
    }
    if (result.failure.empty()) {
      spdlog::info("{}: {} frames, velocity error {:.2f} -> {:.2f} cm/frame", trial.trial, result.frames,
                   100.0 * result.interpolation.velocity.mean, 100.0 * result.deformation.velocity.mean);
    } else {
      spdlog::error("{}: {}", trial.trial, result.failure);
    }
    return result;
  }

  const MocapEvaluationOptions& options_;
  std::vector<CorpusTrial> trials_;
  PerformanceDatabase database_;
  PerformanceDatabase truth_;
  SurfaceMotionGraph graph_;
  std::unique_ptr<MocapStage> stage_;
};

}  // namespace

std::map<std::string, std::string> read_held_clips(const fs::path& path) {
  const Json json = read_json_file(path);
  std::map<std::string, std::string> held;
  for (const auto& [clip, field] : JsonField(path, json).entries()) {
    const std::string trial = field.text();
    if (!held.emplace(trial, clip).second) field.fail(fmt::format("trial '{}' is named twice", trial));
  }
  if (held.empty()) throw FileError(path, "names no clip: expected an object such as {\"walk\": \"07_01\"}");
  return held;
}

std::vector<MocapTrial> evaluate_mocap(const fs::path& database, const fs::path& folder,
                                       const MocapEvaluationOptions& options) {
  Evaluation evaluation(database, options);
  if (Ranks::is_first()) prepare_folder(folder);
  std::vector<MocapTrial> trials = evaluation.run();
  if (!Ranks::is_first()) return trials;
  write_text_file(folder / "mocap.md", mocap_markdown(trials, options));
  write_text_file(folder / "mocap.csv", mocap_csv(trials));
  write_text_file(folder / "times.csv", mocap_times_csv(trials));
  plot_mocap(trials, folder);
  if (std::ranges::any_of(trials, [](const MocapTrial& trial) { return !trial.truth.empty(); })) {
    write_text_file(folder / "truth.csv", mocap_truth_csv(trials));
    plot_mocap_truth(trials, folder / "truth.png");
  }
  return trials;
}

}  // namespace reprise
