// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/mocap.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "mocap_options.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/ranks.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/mocap_strip.h"
#include "reprise/pipeline/motion_corpus.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/render/skeleton_surface.h"

namespace reprise::cli {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path database;
  std::vector<fs::path> motions;
  std::vector<fs::path> skeletons;
  double motion_scale = 0.0;
  double motion_rate = 0.0;
  fs::path corpus;
  std::vector<std::string> tiers;
  std::vector<std::string> trials;
  fs::path output;
  fs::path report;
  fs::path strip;
  fs::path skeleton_surface;
  fs::path write_drive_vertices;
  std::string name;
  MocapStageOptions options;
};

// One skeleton serves all .amc files, several go one by one with them.
std::vector<MocapQuery> named_motions(const Arguments& arguments) {
  std::vector<std::size_t> acclaim;
  for (std::size_t m = 0; m < arguments.motions.size(); ++m) {
    if (arguments.motions[m].extension() != ".bvh") acclaim.push_back(m);
  }
  const std::size_t skeletons = arguments.skeletons.size();
  if (skeletons > 0 && acclaim.empty()) {
    throw InvalidArgument("--skeleton is given without an .amc file that it could belong to");
  }
  if (skeletons > 1 && skeletons != acclaim.size()) {
    throw InvalidArgument(
        fmt::format("--skeleton: expected one for all .amc files, or one for each of the {}, found {}",
                    acclaim.size(), skeletons));
  }
  std::vector<MocapQuery> queries;
  for (const fs::path& motion : arguments.motions) {
    queries.push_back({.source = {.motion = motion}, .name = motion.stem().string()});
    if (arguments.motion_scale > 0.0) queries.back().source.metres_per_unit = arguments.motion_scale;
    if (arguments.motion_rate > 0.0) queries.back().source.frames_per_second = arguments.motion_rate;
  }
  for (std::size_t a = 0; a < acclaim.size() && skeletons > 0; ++a) {
    queries[acclaim[a]].source.skeleton = arguments.skeletons[skeletons == 1 ? 0 : a];
  }
  return queries;
}

std::vector<MocapQuery> asked_motions(const Arguments& arguments) {
  std::vector<MocapQuery> queries = named_motions(arguments);
  if (!arguments.corpus.empty()) {
    for (CorpusTrial& trial :
         chosen_trials(read_corpus(arguments.corpus), arguments.tiers, arguments.trials)) {
      queries.push_back({.source = std::move(trial.source), .name = std::move(trial.trial)});
    }
  } else if (!arguments.tiers.empty() || !arguments.trials.empty()) {
    throw InvalidArgument("--tiers and --trials choose from a --corpus, and none is given");
  }
  if (queries.empty()) throw InvalidArgument("expected a --motion or a --corpus, found neither");
  if (!arguments.name.empty()) {
    if (queries.size() > 1) {
      throw InvalidArgument(fmt::format("--name: names one clip, and {} motions are given", queries.size()));
    }
    queries.front().name = arguments.name;
  }
  return queries;
}

void print_answers(const nlohmann::json& report) {
  for (const nlohmann::json& answer : report["answers"]) {
    fmt::print("{}: {} frames, {} transitions, {} repeats, {} skips, {:.1f} cm a joint\n",
               answer["name"].get<std::string>(), answer["frames"].size(),
               answer["transition_count"].get<int>(), answer["repeats"].get<int>(),
               answer["skips"].get<int>(), 100.0 * answer["mean_dissimilarity"].get<double>());
    if (!answer.contains("measures")) continue;
    const nlohmann::json& made = answer["measures"]["animation"];
    const nlohmann::json& before = answer["measures"]["interpolation_only"];
    const auto velocity = [](const nlohmann::json& figures) {
      const nlohmann::json& error = figures["velocity_error_cm_frame"];
      return fmt::format("{:.2f} +- {:.2f}", error["mean"].get<double>(), error["deviation"].get<double>());
    };
    fmt::print(
        "  velocity error {} cm/frame, with interpolation alone {}; foot drift {:.1f} cm/s, pop ratio "
        "{:.2f}, edge stretch {:.2f}\n",
        velocity(made), velocity(before), made["foot_drift_cm_s"].get<double>(),
        made["pop_ratio"].get<double>(), made["edge_stretch_p99"].get<double>());
  }
}

int run_single(const Arguments& arguments, const MocapStage& stage, const MocapQuery& query) {
  // One motion is one rank's work.
  if (!Ranks::is_first()) return exit_success;
  const auto result = stage.run(query, arguments.output);
  if (!result) throw Error("no retrieval: " + result.error().reason);
  const nlohmann::json report = full_report(*result);
  if (!arguments.report.empty()) {
    write_text_file(arguments.report,
                    report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  if (!arguments.strip.empty()) draw_strip(result->strip_query, result->strip, arguments.strip);
  if (!arguments.skeleton_surface.empty()) {
    PerformanceDatabase drawn;
    drawn.add(skeleton_surface(result->query));
    save_database(drawn, arguments.skeleton_surface);
  }
  fmt::print("{}: {:.0f} frames/s\n", arguments.output.string(), report["frames_per_second"].get<double>());
  print_answers(report);
  return exit_success;
}

int run_folder(const Arguments& arguments, const MocapStage& stage, const std::vector<MocapQuery>& queries) {
  const std::vector<MocapOutcome> outcomes = run_mocap_folder(stage, queries, arguments.output);
  if (!Ranks::is_first()) return exit_success;
  nlohmann::json reports = nlohmann::json::array();
  std::size_t frames = 0;
  std::size_t failed = 0;
  double seconds = 0.0;
  for (const MocapOutcome& outcome : outcomes) {
    nlohmann::json report = {{"name", outcome.name}, {"output", outcome.output.string()}};
    if (outcome.failure.empty()) {
      report.update(outcome.report);
      print_answers(outcome.report);
      seconds += outcome.report["seconds"].get<double>();
      for (const nlohmann::json& answer : outcome.report["answers"]) frames += answer["frames"].size();
    } else {
      ++failed;
      report["failure"] = outcome.failure;
      fmt::print("{}: FAILED: {}\n", outcome.name, outcome.failure);
    }
    reports.push_back(std::move(report));
  }
  if (!arguments.report.empty()) {
    write_text_file(arguments.report,
                    reports.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  fmt::print("{}: {} of {} motions, {} frames, {:.0f} frames/s a rank\n", arguments.output.string(),
             outcomes.size() - failed, outcomes.size(), frames,
             seconds > 0.0 ? static_cast<double>(frames) / seconds : 0.0);
  return failed > 0 ? exit_failure : exit_success;
}

}  // namespace

Action add_mocap(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file with markup")->required();
  command
      .add_option("--motion", arguments->motions, "motion to perform, FILE.bvh or FILE.amc; repeat for more")
      ->take_all()
      ->expected(1);
  command
      .add_option("--skeleton", arguments->skeletons,
                  "FILE.asf of the .amc; default: the one that belongs to it beside it or in ../asf")
      ->take_all()
      ->expected(1);
  command
      .add_option("--motion-scale", arguments->motion_scale,
                  "metres per unit of the motion files; default: CMU's, or what makes the figure human size")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--motion-rate", arguments->motion_rate,
                  "frames per second of the motion files; default: what they say, 120 for .amc")
      ->check(CLI::PositiveNumber);
  command.add_option("--corpus", arguments->corpus, "all trials of a corpus, INDEX.csv (docs/mocap.md)");
  command.add_option("--tiers", arguments->tiers, "of the corpus, such as core,core-stop; default: all")
      ->delimiter(',');
  command.add_option("--trials", arguments->trials, "of the corpus, such as 07_01,08_07; default: all")
      ->delimiter(',');
  command
      .add_option("-o,--output", arguments->output,
                  "animation to write, such as new.reprise; a folder for several motions")
      ->required();
  command.add_option("--name", arguments->name,
                     "name of the resulting clip; default: that of the motion file");
  command.add_option("--report", arguments->report,
                     "measure the result and write what was done, FILE.json; takes half as long again");
  command.add_option("--strip", arguments->strip,
                     "draw eight frames of the query's skeleton above those of the result, FILE.png");
  command.add_option("--skeleton-surface", arguments->skeleton_surface,
                     "write the query's skeleton as a surface, to render it beside the result, FILE.reprise");
  command.add_option("--write-drive-vertices", arguments->write_drive_vertices,
                     "write the vertices that drive the surface, FILE.json, to look at and edit");
  const std::function<void()> complete = add_mocap_options(command, arguments->options);
  return [arguments, complete] {
    complete();
    const std::vector<MocapQuery> queries = asked_motions(*arguments);
    const bool is_folder = !arguments->corpus.empty() || queries.size() > 1;
    std::vector<fs::path> inputs = {arguments->database, arguments->options.graph,
                                    arguments->options.joint_map, arguments->options.drive_vertices,
                                    arguments->corpus};
    for (const MocapQuery& query : queries) inputs.push_back(query.source.motion);
    std::erase(inputs, fs::path());
    std::vector<Output> outputs = {{arguments->report, ".json"},
                                   {arguments->strip, ".png"},
                                   {arguments->skeleton_surface, ".reprise"},
                                   {arguments->write_drive_vertices, ".json"}};
    outputs.push_back({arguments->output, is_folder ? "" : ".reprise"});
    check_outputs(outputs, inputs);
    if (is_folder && !(arguments->strip.empty() && arguments->skeleton_surface.empty())) {
      throw InvalidArgument("--strip and --skeleton-surface show one motion, and several are given");
    }
    arguments->options.measure = !arguments->report.empty();
    arguments->options.strip_frames = arguments->strip.empty() ? 0 : 8;
    // What is wrong with a single motion is said before the long work.
    if (!is_folder) static_cast<void>(read_motion(queries.front().source));
    const MocapStage stage(load_database(arguments->database), arguments->database, arguments->options);
    if (!arguments->write_drive_vertices.empty() && Ranks::is_first()) {
      write_drive_vertices(stage.character().drive_vertices(), stage.database().markup()->skeleton,
                           arguments->write_drive_vertices);
    }
    return is_folder ? run_folder(*arguments, stage, queries)
                     : run_single(*arguments, stage, queries.front());
  };
}

}  // namespace reprise::cli
