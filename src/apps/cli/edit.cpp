// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/edit.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "command.h"
#include "reprise/core/atomic_file.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {
namespace {

void print_report(const std::filesystem::path& output, const EditResult& result) {
  for (const nlohmann::json& step : result.report["steps"]) {
    fmt::print("{}: {}: residual {:.2f} mm, {} parts solved, {:.2f} ms\n", step["frame"].get<std::string>(),
               fmt::join(step["handles"].get<std::vector<std::string>>(), ", "),
               1000.0 * step["residual"].get<double>(), step["solved_parts"].get<int>(),
               1000.0 * step["seconds"].get<double>());
  }
  const MeshSequence& animation = result.animation;
  fmt::print("{}: clip '{}', {} frame{}, model {}\n", output.string(), animation.name(),
             animation.frame_count(), animation.frame_count() == 1 ? "" : "s",
             result.report["model"].get<std::string>());
  if (!result.report.contains("changed_frames")) return;
  fmt::print("{} frames changed in {:.2f} s", result.report["changed_frames"].get<std::size_t>(),
             result.report["seconds"].get<double>());
  if (!result.report["pop_ratio"].is_null()) {
    fmt::print("; their pop ratio is {:.3f}, as captured {:.3f}", result.report["pop_ratio"].get<double>(),
               result.report["captured_pop_ratio"].get<double>());
  }
  fmt::print("\n");
}

}  // namespace

Action add_edit(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path output;
    std::filesystem::path report;
    std::filesystem::path picture;
    EditModel model = EditModel::part;
    double window = 0.0;
    EditStageOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  EditStageOptions& options = arguments->options;
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command.add_option("--script", options.script, "what to drag where, FILE.json (docs/editing.md)")
      ->required();
  command.add_option("--frame", options.frame,
                     "frame to edit, CLIP:FRAME, where a step names none, instead of the script's");
  CLI::Option* model =
      command
          .add_option("--model", arguments->model,
                      "part or whole (learnt, `reprise model learn`), laplacian, lbs or dqs (skinning); "
                      "instead of the script's")
          ->transform(
              CLI::CheckedTransformer(std::map<std::string, EditModel>{{"part", EditModel::part},
                                                                       {"whole", EditModel::whole},
                                                                       {"laplacian", EditModel::laplacian},
                                                                       {"lbs", EditModel::lbs},
                                                                       {"dqs", EditModel::dqs}}))
          ->default_str("part");
  CLI::Option* window = command.add_option(
      "--window", arguments->window,
      "spread the edits over their clip: seconds in which they come and go before the first and after the "
      "last edited frame, 0 to hold them to the clip's ends; instead of the script's");
  CLI::Option* steps = command.add_flag("--steps", options.show_steps,
                                        "a frame for the capture and each step, not for the last step alone");
  steps->excludes(window);
  command.add_option("-o,--output", arguments->output, "database to write, such as edited.reprise")
      ->required();
  command.add_option("--name", options.name,
                     "name of the resulting clip; `edit`, or with a window that of the clip edited");
  command.add_option("--report", arguments->report, "write residuals and times, FILE.json");
  command.add_option("--picture", arguments->picture,
                     "draw the edited frames before and after, FILE.png: moved green, held red");
  return [arguments, model, window] {
    check_outputs(
        {{arguments->output, ".reprise"}, {arguments->report, ".json"}, {arguments->picture, ".png"}},
        {arguments->database, arguments->options.script});
    EditStageOptions wanted = arguments->options;
    if (model->count() > 0) wanted.model = arguments->model;
    if (window->count() > 0) wanted.window = arguments->window;
    const PerformanceDatabase database = load_database(arguments->database);
    const EditResult result = run_edit(database, wanted);

    PerformanceDatabase edited;
    edited.add(result.animation);
    edited.set_markup(database.markup());
    edited.set_models(database.models());
    save_database(edited, arguments->output, result.report.dump());
    if (!arguments->report.empty()) write_text_file(arguments->report, result.report.dump(2) + "\n");
    if (!arguments->picture.empty()) draw_before_after(result, arguments->picture);
    print_report(arguments->output, result);
    return exit_success;
  };
}

}  // namespace reprise::cli
