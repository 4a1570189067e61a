// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframes.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/outputs.h"

namespace reprise::cli {

Action add_keyframes(CLI::App& command) {
  struct Arguments {
    std::filesystem::path database;
    std::filesystem::path graph;
    std::string from;
    std::vector<std::string> via;
    std::string to;
    std::filesystem::path output;
    std::filesystem::path report;
    KeyframesOptions options;
  };
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("database", arguments->database, "a .reprise file")->required();
  command
      .add_option("--graph", arguments->graph, "surface motion graph of the database, from `reprise graph`")
      ->required();
  command.add_option("--from", arguments->from, "first key-frame, CLIP:FRAME")->required();
  command.add_option("--via", arguments->via, "key-frames to show on the way, in order");
  command.add_option("--to", arguments->to, "last key-frame, CLIP:FRAME")->required();
  command.add_option("--distance", arguments->options.distance,
                     "ground distance to travel, metres; 0: as short as possible");
  command.add_option("--time", arguments->options.time, "duration, seconds; 0: as short as possible");
  command.add_option("-o,--output", arguments->output, "animation to write, such as new.reprise")->required();
  command.add_option("--report", arguments->report, "write the path and its certificate, FILE.json");
  command.add_option("--name", arguments->options.name, "name of the resulting clip");
  command.add_option("--distance-weight", arguments->options.optimizer.distance_weight,
                     "cost of a metre beside the target");
  command.add_option("--time-weight", arguments->options.optimizer.time_weight,
                     "cost of a frame beside the target");
  command
      .add_option("--max-labels", arguments->options.optimizer.max_labels,
                  "partial paths to look at before the best so far is given with its gap")
      ->check(CLI::PositiveNumber);
  return [arguments] {
    check_outputs({{arguments->output, ".reprise"}, {arguments->report, ".json"}},
                  {arguments->database, arguments->graph});
    KeyframesOptions& options = arguments->options;
    options.keyframes = {arguments->from};
    options.keyframes.insert(options.keyframes.end(), arguments->via.begin(), arguments->via.end());
    options.keyframes.push_back(arguments->to);

    const SurfaceMotionGraph graph = load_graph(arguments->graph);
    const PerformanceDatabase database = load_database(arguments->database);
    const auto result = run_keyframes(database, graph, options);
    if (!result) throw Error("no path: " + result.error().reason);

    DatabaseWriter writer(arguments->output, database.topology());
    if (database.markup()) writer.set_markup(*database.markup());
    writer.write_clip(result->animation);
    writer.set_note(result->report.dump());
    writer.commit();
    if (!arguments->report.empty()) write_text_file(arguments->report, result->report.dump(2) + "\n");

    const MotionPath& path = result->path;
    fmt::print("{}: {} frames, {} transitions\n", arguments->output.string(), path.frame_count,
               path.segments.size() - 1);
    fmt::print("distance {:.3f} m (asked {:g}), time {:.2f} s (asked {:g}), cost {:.6g}, {}\n", path.distance,
               options.distance, path.time, options.time, path.cost,
               path.gap() > 0.0 ? fmt::format("lower bound {:.6g} (search limit reached)", path.lower_bound)
                                : "proved optimal");
    return exit_success;
  };
}

}  // namespace reprise::cli
