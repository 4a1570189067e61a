// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/deformation_report.h"

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/render/plots.h"
#include "reprise/render/renderer.h"

namespace reprise {
namespace {

std::string source_in_words(DeformationSource source) {
  return source == DeformationSource::first ? "the first learnt frame" : "the nearest learnt frame";
}

std::string clip_of(const std::string& frame) {
  return frame.substr(0, frame.rfind(':'));
}

std::string main_table(const DeformationEvaluation& evaluation, DeformationSource source) {
  std::string text = fmt::format("\n## From {}\n\n", source_in_words(source));
  const bool is_timed = source == DeformationSource::first;
  text += fmt::format(
      "| constraints | model | mean error, mm | largest, mean of frames, mm | largest of all, mm "
      "| stretch inside parts, 99 % | largest | on frontiers, 99 % | largest |{}\n"
      "|---:|---|---:|---:|---:|---:|---:|---:|---:|{}\n",
      is_timed ? " ms a drag |" : "", is_timed ? "---:|" : "");
  for (const DeformationFigures& f : evaluation.figures) {
    if (f.source != source) continue;
    text += fmt::format("| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.1f} |", f.constraints, f.model,
                        1e3 * f.mean.mean_error, 1e3 * f.mean.max_error, 1e3 * f.worst.max_error,
                        f.mean.inside_stretch_p99, f.worst.inside_stretch_max);
    text += evaluation.has_frontier
                ? fmt::format(" {:.2f} | {:.1f} |", f.mean.frontier_stretch_p99, f.worst.frontier_stretch_max)
                : " | |";
    if (is_timed) text += fmt::format(" {:.2f} |", f.milliseconds);
    text += "\n";
  }
  return text;
}

// Mean error of every model on every clip.
std::string clip_table(const DeformationEvaluation& evaluation, const DeformationEvaluationOptions& options) {
  const std::size_t count = options.constraints[options.constraints.size() / 2];
  struct Cell {
    double sum = 0.0;
    int frames = 0;
  };
  std::map<std::tuple<std::string, DeformationSource, std::string>, Cell> cells;
  for (const DeformationTrial& trial : evaluation.trials) {
    if (trial.constraints != count) continue;
    Cell& cell = cells[{clip_of(trial.frame), trial.source, trial.model}];
    cell.sum += trial.figures.mean_error;
    ++cell.frames;
  }
  std::vector<std::string> models;
  for (const DeformationFigures& f : evaluation.figures) {
    if (std::ranges::count(models, f.model) == 0) models.push_back(f.model);
  }
  std::string text = fmt::format(
      "\n## By clip\n\nMean error in mm under {} constraints.\n\n| clip | from | {} |\n|---|---|{}\n", count,
      fmt::join(models, " | "), [&] {
        std::string line;
        for (std::size_t m = 0; m < models.size(); ++m) line += "---:|";
        return line;
      }());
  for (const std::string& clip : evaluation.held_clips) {
    for (const DeformationSource source : {DeformationSource::first, DeformationSource::nearest}) {
      if (!cells.contains({clip, source, models.front()})) continue;
      text += fmt::format("| {} | {} |", clip, to_string(source));
      for (const std::string& model : models) {
        const Cell& cell = cells[{clip, source, model}];
        text += fmt::format(" {:.1f} |", 1e3 * cell.sum / cell.frames);
      }
      text += "\n";
    }
  }
  return text;
}

std::string learning_table(const nlohmann::json& learning) {
  std::string text =
      "\n## What was learnt\n\n| model | part | vertices | examples | components | variance kept |\n"
      "|---|---|---:|---:|---:|---:|\n";
  for (const char* model : {"part", "whole"}) {
    const nlohmann::json& learnt = learning["models"][model];
    if (learnt.is_null()) continue;
    for (const nlohmann::json& part : learnt["parts"]) {
      text += fmt::format("| {} | {} | {} | {} | {} | {:.1f} % |\n", model, part["name"].get<std::string>(),
                          part["vertices"].get<std::size_t>(), part["examples"].get<std::size_t>(),
                          part["components"].get<std::size_t>(), 100.0 * part["kept_variance"].get<double>());
    }
  }
  return text;
}

std::string figures_csv(const TrialFigures& f, bool has_frontier) {
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},", f.mean_error, f.max_error, f.inside_stretch_p99,
                     f.inside_stretch_max) +
         (has_frontier ? fmt::format("{:.6g},{:.6g}", f.frontier_stretch_p99, f.frontier_stretch_max) : ",");
}

}  // namespace

std::string deformation_markdown(const DeformationEvaluation& evaluation,
                                 const DeformationEvaluationOptions& options) {
  std::string text = fmt::format(
      "# Deformation models\n\n"
      "{} frames (every {}. of {}) are reproduced; learnt from are {}. A frame gives its own places of "
      "spread "
      "vertices as constraints, and another frame is edited to meet them. Errors are distances of all "
      "vertices from the frame. The stretch of an edge is the factor by which it is longer or shorter than "
      "in "
      "any frame learnt from: at 1 nothing unseen.\n",
      evaluation.frames, options.stride, fmt::join(evaluation.held_clips, ", "),
      fmt::join(evaluation.learnt_clips, ", "));
  for (const DeformationSource source : {DeformationSource::first, DeformationSource::nearest})
    text += main_table(evaluation, source);
  text += clip_table(evaluation, options);
  if (!evaluation.learning.is_null()) text += learning_table(evaluation.learning);
  if (!evaluation.notes.empty()) text += "\n## Notes\n\n";
  for (const std::string& note : evaluation.notes) text += fmt::format("- {}\n", note);
  return text;
}

std::string deformation_csv(const DeformationEvaluation& evaluation) {
  std::string text = "constraints,source,model";
  for (const char* over : {"mean", "worst"}) {
    text += fmt::format(
        ",{0}_mean_error,{0}_max_error,{0}_inside_p99,{0}_inside_max,{0}_frontier_p99,{0}_frontier_max",
        over);
  }
  text += ",milliseconds\n";
  for (const DeformationFigures& f : evaluation.figures) {
    text += fmt::format("{},{},{},{},{},{}\n", f.constraints, to_string(f.source), f.model,
                        figures_csv(f.mean, evaluation.has_frontier),
                        figures_csv(f.worst, evaluation.has_frontier),
                        f.source == DeformationSource::first ? fmt::format("{:.4g}", f.milliseconds) : "");
  }
  return text;
}

std::string deformation_frames_csv(const DeformationEvaluation& evaluation) {
  std::string text =
      "frame,constraints,source,source_frame,model,mean_error,max_error,inside_p99,inside_max,frontier_p99,"
      "frontier_max\n";
  for (const DeformationTrial& t : evaluation.trials) {
    text += fmt::format("{},{},{},{},{},{}\n", t.frame, t.constraints, to_string(t.source), t.source_frame,
                        t.model, figures_csv(t.figures, evaluation.has_frontier));
  }
  return text;
}

void plot_deformation(const DeformationEvaluation& evaluation, const std::filesystem::path& png) {
  std::vector<std::string> rows;
  std::vector<std::pair<std::size_t, DeformationSource>> keys;
  for (const DeformationFigures& f : evaluation.figures) {
    if (!keys.empty() && keys.back() == std::pair(f.constraints, f.source)) continue;
    keys.emplace_back(f.constraints, f.source);
    rows.push_back(fmt::format("{} constraints, {}", f.constraints, to_string(f.source)));
  }
  DotPanel mean{.title = "Mean error of all vertices",
                .x_label = "mm",
                .scale = DotPanel::Scale::logarithmic,
                .series = {}};
  DotPanel largest{.title = "Largest error, mean of frames",
                   .x_label = "mm",
                   .scale = DotPanel::Scale::logarithmic,
                   .series = {}};
  const auto add = [](DotPanel& panel, const std::string& model, double value) {
    auto series = std::ranges::find(panel.series, model, &DotSeries::name);
    if (series == panel.series.end()) {
      panel.series.push_back({.name = model, .values = {}});
      series = panel.series.end() - 1;
    }
    series->values.push_back(value);
  };
  for (const DeformationFigures& f : evaluation.figures) {
    add(mean, f.model, 1e3 * f.mean.mean_error);
    add(largest, f.model, 1e3 * f.mean.max_error);
  }
  plot_dots(rows, std::array{mean, largest}, png);
}

void draw_deformation(const DeformationBench& bench, const std::vector<HeldFrame>& frames, std::size_t count,
                      const std::filesystem::path& png) {
  const std::size_t columns = bench.models().size() + 1;
  MeshSequence shown("models", bench.learnt().topology(), frames.size() * columns,
                     bench.learnt().clip(0).frames_per_second());
  std::vector<std::string> captions;
  std::vector<std::unique_ptr<SurfaceEditor>> editors;
  for (const std::string& model : bench.models()) {
    editors.push_back(bench.make(model));
    bench.set_frame(*editors.back(), model, {});
  }
  const TrialMeter& meter = bench.meter();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    // All stand in one place, so that the camera does.
    const Eigen::Vector3d middle = centroid(frames[f].positions());
    const Eigen::RowVector3f away = -Eigen::RowVector3d(middle.x(), 0.0, middle.z()).cast<float>();
    shown.frame(f * columns) = frames[f].positions().rowwise() + away;
    captions.push_back(frames[f].name);
    for (std::size_t m = 0; m < editors.size(); ++m) {
      editors[m]->deform(bench.constraints(frames[f], count));
      shown.frame(f * columns + m + 1) = editors[m]->positions().cast<float>().rowwise() + away;
      captions.push_back(fmt::format("{}, {:.0f} mm", bench.models()[m],
                                     1e3 * meter(editors[m]->positions(), frames[f].positions()).mean_error));
    }
  }
  const MeshSequence& first = bench.learnt().clip(0);
  if (first.has_colors() && !first.has_colors_per_frame()) {
    const auto colors = first.colors(0);
    shown.set_colors({colors.begin(), colors.end()});
  }
  SequenceRenderer renderer(shown, {.width = 240, .height = 360, .zoom = 1.35});
  std::vector<CaptionedPicture> pictures;
  for (std::size_t i = 0; i < captions.size(); ++i)
    pictures.push_back({.image = renderer.draw(i), .lines = {captions[i]}});
  draw_sheet(pictures, static_cast<int>(columns),
             fmt::format("{} edited to {} constraints of the frames at the left",
                         bench.learnt().to_string({}), count),
             png);
}

}  // namespace reprise
