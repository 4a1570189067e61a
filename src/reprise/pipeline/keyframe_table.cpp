// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/keyframe_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace reprise {
namespace {

// What the paper prints for a row; for all pairs of a database the same of its four rows together.
struct Printed {
  std::size_t rows = 0;
  double smoothness_min = 0.0, smoothness_max = 0.0;
  double distance_rms = 0.0, distance_max = 0.0;
  double time_rms = 0.0, time_max = 0.0;
  double cpu_mean = 0.0, cpu_deviation = 0.0;
};

Printed printed_of(const TableRow& row) {
  Printed printed;
  double cpu_squares = 0.0;
  for (const GridResult* result : row.results) {
    if (result->paper == nullptr) continue;
    const PaperRow& paper = *result->paper;
    printed.smoothness_min =
        printed.rows == 0 ? paper.smoothness_min : std::min(printed.smoothness_min, paper.smoothness_min);
    printed.smoothness_max = std::max(printed.smoothness_max, paper.smoothness_max);
    printed.distance_rms += paper.distance_rms * paper.distance_rms;
    printed.time_rms += paper.time_rms * paper.time_rms;
    printed.distance_max = std::max(printed.distance_max, paper.distance_max);
    printed.time_max = std::max(printed.time_max, paper.time_max);
    printed.cpu_mean += paper.cpu_mean;
    cpu_squares += paper.cpu_mean * paper.cpu_mean + paper.cpu_deviation * paper.cpu_deviation;
    ++printed.rows;
  }
  if (printed.rows == 0) return printed;
  const auto count = static_cast<double>(printed.rows);
  printed.distance_rms = std::sqrt(printed.distance_rms / count);
  printed.time_rms = std::sqrt(printed.time_rms / count);
  printed.cpu_mean /= count;
  printed.cpu_deviation = std::sqrt(std::max(0.0, cpu_squares / count - printed.cpu_mean * printed.cpu_mean));
  return printed;
}

// "0.12 (0.17)": ours, and the paper's where there is one.
std::string beside(double ours, const Printed& printed, double paper) {
  return printed.rows == 0 ? fmt::format("{:.2f}", ours) : fmt::format("{:.2f} ({:.2f})", ours, paper);
}

std::string row_start(const TableRow& row) {
  const std::string name = fmt::format("{}: {}", row.database, row.name());
  return row.pair == nullptr ? fmt::format("| **{}** |", name) : fmt::format("| {} |", name);
}

std::string error_table(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  std::string text =
      "| key-frames | reachable | distance error, m: min | rms | max | time error, s: min | rms | max |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const GridFigures& f = figures[r];
    const Printed printed = printed_of(rows[r]);
    text += row_start(rows[r]) + fmt::format(" {} of {} |", f.reachable, f.targets);
    if (f.reachable == 0) {
      text += " | | | | | |\n";
      continue;
    }
    text += fmt::format(" {:.4f} | {} | {} |", f.distance_error.min,
                        beside(f.distance_error.rms, printed, printed.distance_rms),
                        beside(f.distance_error.max, printed, printed.distance_max));
    text += fmt::format(" {:.2f} | {} | {} |\n", f.time_error.min,
                        beside(f.time_error.rms, printed, printed.time_rms),
                        beside(f.time_error.max, printed, printed.time_max));
  }
  return text;
}

std::string correction_table(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  std::string text =
      "| key-frames | met | distance error, m: rms before | after | max before | after | time error, s: rms "
      "before | after | max before | after |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const GridFigures& f = figures[r];
    text += row_start(rows[r]) + fmt::format(" {} of {} |", f.met, f.reachable);
    const auto errors = [&](const Spread& before, const Spread& after) {
      text += f.reachable == 0 ? std::string(" | | | |")
                               : fmt::format(" {:.3f} | {:.4f} | {:.2f} | {:.3f} |", before.rms, after.rms,
                                             before.max, after.max);
    };
    errors(f.distance_error, f.corrected_distance_error);
    errors(f.time_error, f.corrected_time_error);
    text += '\n';
  }
  return text;
}

std::string all_targets_table(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  std::string text =
      "| key-frames | unreachable | distance error, m: rms | max | time error, s: rms | max |\n"
      "|---|---|---|---|---|---|\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const GridFigures& f = figures[r];
    text += row_start(rows[r]) + fmt::format(" {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n",
                                             f.targets - f.reachable, f.all_distance_error.rms,
                                             f.all_distance_error.max, f.all_time_error.rms,
                                             f.all_time_error.max);
  }
  return text;
}

std::string time_table(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  std::string text =
      "| key-frames | proved optimal | largest gap | CPU a query, ms: mean ± dev. | median | max | prepared "
      "once, s | total, s | paper, s a query | paper's over ours |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const GridFigures& f = figures[r];
    const Printed printed = printed_of(rows[r]);
    text += row_start(rows[r]) +
            fmt::format(" {} of {} | {:.3g} | {:.2f} ± {:.2f} | {:.2f} | {:.1f} | {:.3f} | {:.2f} |",
                        f.proved, f.targets, f.largest_gap, 1e3 * f.cpu.mean, 1e3 * f.cpu.deviation,
                        1e3 * f.cpu.median, 1e3 * f.cpu.max, f.preparation_cpu, f.total_cpu());
    if (printed.rows == 0) {
      text += " | |\n";
    } else {
      text += fmt::format(" {:.2f} ± {:.2f} | {:.0f} |\n", printed.cpu_mean, printed.cpu_deviation,
                          printed.cpu_mean * static_cast<double>(f.targets) / f.total_cpu());
    }
  }
  return text;
}

std::string smoothness_table(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  std::string text =
      "| key-frames | mean over the window, m: min | max | weighted mean, m: min | max | paper: min | max |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const GridFigures& f = figures[r];
    const Printed printed = printed_of(rows[r]);
    text += row_start(rows[r]);
    if (f.smoothness.count == 0) {
      text += " | | | |";
    } else {
      text += fmt::format(" {:.3f} | {:.3f} | {:.3f} | {:.3f} |", f.smoothness.min, f.smoothness.max,
                          f.normalized_smoothness.min, f.normalized_smoothness.max);
    }
    text += printed.rows == 0
                ? std::string(" | |\n")
                : fmt::format(" {:.2f} | {:.2f} |\n", printed.smoothness_min, printed.smoothness_max);
  }
  return text;
}

// Which of the two ways to weigh comes nearer to what is printed.
std::string smoothness_verdict(const std::vector<TableRow>& rows, const std::vector<GridFigures>& figures) {
  double weighted = 0.0, normalized = 0.0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Printed printed = printed_of(rows[r]);
    if (rows[r].pair == nullptr || printed.rows == 0 || figures[r].smoothness.count == 0) continue;
    weighted += std::abs(figures[r].smoothness.max - printed.smoothness_max);
    normalized += std::abs(figures[r].normalized_smoothness.max - printed.smoothness_max);
    ++count;
  }
  if (count == 0) return {};
  const auto rows_count = static_cast<double>(count);
  return fmt::format(
      "The greatest values miss the printed ones by {:.3f} m on average with the mean over the window, by "
      "{:.3f} m with the weighted mean: the {} fits what the paper prints.\n",
      weighted / rows_count, normalized / rows_count,
      weighted < normalized ? "mean over the window" : "weighted mean");
}

std::string sample_tables(const std::vector<TableRow>& rows) {
  std::string text =
      "| database | frames | samples | measured - predicted: distance, mm | frames | distance error, m: rms "
      "| "
      "max | time error, s: rms | max |\n|---|---|---|---|---|---|---|---|---|\n";
  std::string natural =
      "| database | frames | pop ratio: median | max | foot drift, cm/s: mean | captured in the same frames "
      "| in "
      "blends | foot drift over the database's: mean | max | edge stretch over the captured: mean | max |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const TableRow& row : rows) {
    if (row.pair != nullptr) continue;
    for (const SampleVariant variant : sample_variants) {
      const SampleFigures f = sample_figures(row.results, variant);
      const std::string start = fmt::format("| {} | {} |", row.database, name_of(variant));
      text += start + fmt::format(" {} | {:.2f} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n", f.count,
                                  1e3 * f.distance_difference, f.frame_difference, f.distance_error.rms,
                                  f.distance_error.max, f.time_error.rms, f.time_error.max);
      natural +=
          start +
          fmt::format(" {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {:.3f} |\n",
                      f.pop_ratio.median, f.pop_ratio.max, f.drift.mean, f.shown_drift.mean,
                      f.blend_drift.mean, f.drift_ratio.mean, f.drift_ratio.max, f.stretch_ratio.mean,
                      f.stretch_ratio.max);
    }
  }
  return text + "\n" + natural;
}

}  // namespace

std::string TableRow::name() const {
  return pair == nullptr ? "all pairs" : fmt::format("{} → {}", pair->grid.pair.from, pair->grid.pair.to);
}

std::vector<TableRow> table_rows(const std::vector<GridResult>& results) {
  std::vector<TableRow> rows;
  for (std::size_t first = 0; first < results.size();) {
    TableRow all{.database = results[first].grid.database};
    for (; first < results.size() && results[first].grid.database == all.database; ++first) {
      rows.push_back({all.database, &results[first], {&results[first]}});
      all.results.push_back(&results[first]);
    }
    rows.push_back(std::move(all));
  }
  return rows;
}

std::string keyframe_markdown(const std::vector<GridResult>& results,
                              const EvaluateKeyframesOptions& options) {
  const std::vector<TableRow> rows = table_rows(results);
  std::vector<GridFigures> figures;
  figures.reserve(rows.size());
  std::size_t targets = 0, proved = 0, samples = 0;
  double cpu = 0.0;
  for (const TableRow& row : rows) {
    figures.push_back(figures_of(row.results));
    if (row.pair == nullptr) continue;
    targets += figures.back().targets;
    proved += figures.back().proved;
    cpu += figures.back().total_cpu();
    samples += row.pair->samples.size();
  }

  std::string text = "# Key-frame synthesis: HSSMG Table III\n\n";
  text += fmt::format(
      "Targets of 1 to {} m and 1 to {} s for each pair of key-frames; {} queries, {} of them proved optimal "
      "(Eq. 7 with w_dist = {:.4g} per metre, w_time = {:.4g} per frame), {:.1f} CPU seconds in all. In "
      "brackets what the paper prints; for all pairs of a database its four rows together.\n",
      options.max_distance, options.max_time, targets, proved, options.optimizer.distance_weight,
      options.optimizer.time_weight, cpu);
  text += fmt::format(
      "\n## Errors\n\nOver the reachable targets: those whose optimum misses them by at most {:g} m and {:g} "
      "s.\n\n",
      options.reach_distance, options.reach_time);
  text += error_table(rows, figures);
  text +=
      "\nOver all targets, those out of reach (20 m in 1 s) with them; `unreachable.csv` lists these with "
      "the "
      "path found and the nearest target within reach:\n\n";
  text += all_targets_table(rows, figures);
  text += fmt::format(
      "\n## Continuous correction\n\nThe duration changed by up to {:g} %, the way over the ground stretched "
      "by up to {:g} %, as planned for every query; over the reachable targets. A target is met if at most 1 "
      "cm and one frame are left. The others lie at the border of reach: their optimum misses them by more "
      "than these limits bridge.\n\n",
      100.0 * options.correction.max_retiming, 100.0 * options.correction.max_stretch);
  text += correction_table(rows, figures);
  text +=
      "\n## Certificates and CPU time\n\nA query counts as proved if its lower bound is its cost. CPU "
      "seconds are those of the thread that searched; what all targets of a pair share is made once and "
      "counted in the total and the ratio.\n\n";
  text += time_table(rows, figures);
  text +=
      "\n## Smoothness\n\nHausdorff distance of the frames that overlap at a transition, weighted by "
      "alpha'(k) of Eq. 2; a path's smoothness is the mean of its transitions, each as often as it is "
      "taken. \"Mean over the window\" divides by the number of frames, \"weighted mean\" by the sum of "
      "weights. The paper's columns min and max are swapped in print; here they stand in order.\n\n";
  text += smoothness_table(rows, figures);
  const std::string verdict = smoothness_verdict(rows, figures);
  if (!verdict.empty()) text += "\n" + verdict;
  if (samples == 0) return text;
  text += fmt::format(
      "\n## Frames\n\n{} queries, spread evenly over pairs and targets, were synthesised three times: "
      "\"path\", "
      "captured frames and blends alone; \"planted\", with feet planted; \"corrected\", retimed and "
      "stretched "
      "to the targets, with feet planted. Differences from the prediction are the largest, errors those of "
      "the "
      "frames over reachable targets. `samples.csv` has every sample.\n\n",
      samples);
  return text + sample_tables(rows);
}

}  // namespace reprise
