// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <limits>

#include <fmt/format.h>

#include "reprise/pipeline/keyframe_table.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using ErrorOfQuery = double (GridQuery::*)() const;

GridPanel error_panel(const KeyframeGrid& grid, const EvaluateKeyframesOptions& options, const char* title,
                      ErrorOfQuery error, double largest) {
  GridPanel panel{.title = title, .largest = largest};
  panel.rows.assign(static_cast<std::size_t>(options.max_time),
                    std::vector<double>(static_cast<std::size_t>(options.max_distance), nothing));
  for (const GridQuery& query : grid.queries) {
    if (!query.is_reachable) continue;
    panel.rows[static_cast<std::size_t>(query.target_time - 1)]
              [static_cast<std::size_t>(query.target_distance - 1)] = (query.*error)();
  }
  return panel;
}

double largest_of(const KeyframeGrid& grid, ErrorOfQuery error) {
  double largest = 0.0;
  for (const GridQuery& query : grid.queries)
    if (query.is_reachable) largest = std::max(largest, (query.*error)());
  return largest;
}

}  // namespace

void draw_table(const std::vector<GridResult>& results, const std::filesystem::path& png) {
  std::vector<std::string> names;
  DotPanel distance{.title = "Distance error, rms", .x_label = "metres"};
  DotPanel time{.title = "Time error, rms", .x_label = "seconds"};
  DotPanel cpu{.title = "CPU time a query", .x_label = "seconds", .scale = DotPanel::Scale::logarithmic};
  DotSeries distance_of_paper{"paper", {}}, distance_ours{"Reprise", {}}, distance_corrected{"corrected", {}};
  DotSeries time_of_paper = distance_of_paper, time_ours = distance_ours, time_corrected = distance_corrected;
  DotSeries cpu_of_paper = distance_of_paper, cpu_ours = distance_ours;
  bool has_paper = false;
  for (const GridResult& result : results) {
    const GridFigures f = figures_of({&result});
    const PaperRow* paper = result.paper;
    has_paper = has_paper || paper != nullptr;
    names.push_back(
        fmt::format("{}: {} → {}", result.grid.database, result.grid.pair.from, result.grid.pair.to));
    const auto if_reached = [&](double value) { return f.reachable > 0 ? value : nothing; };
    distance_of_paper.values.push_back(paper != nullptr ? paper->distance_rms : nothing);
    distance_ours.values.push_back(if_reached(f.distance_error.rms));
    distance_corrected.values.push_back(if_reached(f.corrected_distance_error.rms));
    time_of_paper.values.push_back(paper != nullptr ? paper->time_rms : nothing);
    time_ours.values.push_back(if_reached(f.time_error.rms));
    time_corrected.values.push_back(if_reached(f.corrected_time_error.rms));
    cpu_of_paper.values.push_back(paper != nullptr ? paper->cpu_mean : nothing);
    cpu_ours.values.push_back(f.total_cpu() / static_cast<double>(f.targets));
  }
  distance.series = {distance_ours, distance_corrected};
  time.series = {time_ours, time_corrected};
  cpu.series = {cpu_ours};
  if (has_paper) {
    distance.series.push_back(distance_of_paper);
    time.series.push_back(time_of_paper);
    cpu.series.push_back(cpu_of_paper);
  }
  const std::vector<DotPanel> panels = {distance, time, cpu};
  plot_dots(names, panels, png);
}

void draw_errors(const KeyframeGrid& grid, const EvaluateKeyframesOptions& options,
                 const std::filesystem::path& png) {
  // Before and after on one scale.
  const double distance = largest_of(grid, &GridQuery::distance_error);
  const double time = largest_of(grid, &GridQuery::time_error);
  const std::vector<GridPanel> panels = {
      error_panel(grid, options, "distance error, m", &GridQuery::distance_error, distance),
      error_panel(grid, options, "corrected, m", &GridQuery::corrected_distance_error, distance),
      error_panel(grid, options, "time error, s", &GridQuery::time_error, time),
      error_panel(grid, options, "corrected, s", &GridQuery::corrected_time_error, time)};
  plot_grids(panels, {.x_label = "target, m", .y_label = "target, s"},
             fmt::format("{}: {} → {} (grey: out of reach)", grid.database, grid.pair.from, grid.pair.to),
             png);
}

}  // namespace reprise
