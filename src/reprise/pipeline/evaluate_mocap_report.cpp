// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_mocap_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/render/plots.h"

namespace reprise {
namespace {

using Trials = std::vector<const MocapTrial*>;

constexpr double centimetres = 100.0;
constexpr double millimetres = 1000.0;

// What HSSMG 6.2 says, cm/frame.
struct PaperFigures {
  double interpolation = 0.0, interpolation_deviation = 0.0;
  double deformation = 0.0, deformation_deviation = 0.0;
};

// Trials that the paper speaks of as one.
struct Group {
  const char* name;
  const char* motion_class;
  const char* alone;  // the trial that it is, or null
  const char* but;    // the trial left out of it, or null
  PaperFigures paper;
};
constexpr std::array groups = {Group{"walks", "walk", nullptr, "08_07", {2.0, 0.6, 0.3, 0.1}},
                               Group{"08_07", "walk", "08_07", nullptr, {3.5, 1.1, 0.6, 0.2}},
                               Group{"runs", "run", nullptr, nullptr, {3.5, 1.2, 0.8, 0.2}}};

bool is_in(const Group& group, const MocapTrial& trial) {
  return trial.motion_class == group.motion_class && (group.alone == nullptr || trial.trial == group.alone) &&
         (group.but == nullptr || trial.trial != group.but);
}

Trials made(const std::vector<MocapTrial>& trials, const std::function<bool(const MocapTrial&)>& wanted) {
  Trials some;
  for (const MocapTrial& trial : trials) {
    if (trial.failure.empty() && wanted(trial)) some.push_back(&trial);
  }
  return some;
}

double mean_of(const Trials& trials, const std::function<double(const MocapTrial&)>& figure) {
  double sum = 0.0;
  for (const MocapTrial* trial : trials) sum += figure(*trial);
  return trials.empty() ? 0.0 : sum / static_cast<double>(trials.size());
}

std::string velocity(double mean, double deviation) {
  return fmt::format("{:.2f} ± {:.2f}", mean, deviation);
}

std::string velocity(const VelocityError& error) {
  return velocity(centimetres * error.mean, centimetres * error.deviation);
}

std::string mean_velocity(const Trials& trials, MocapFigures MocapTrial::*method,
                          VelocityError MocapFigures::*error) {
  return velocity(
      centimetres * mean_of(trials, [&](const MocapTrial& t) { return (t.*method.*error).mean; }),
      centimetres * mean_of(trials, [&](const MocapTrial& t) { return (t.*method.*error).deviation; }));
}

// Frames over seconds of all trials together.
double speed(const Trials& trials) {
  double frames = 0.0;
  double seconds = 0.0;
  for (const MocapTrial* trial : trials) {
    frames += static_cast<double>(trial->frames);
    seconds += trial->planning_seconds + trial->animation_seconds;
  }
  return seconds > 0.0 ? frames / seconds : 0.0;
}

std::string summary(const std::vector<MocapTrial>& trials) {
  std::string text =
      "## Velocity error, cm/frame\n\n"
      "Means over trials of each trial's mean and standard deviation (of frames). The query enlarged by the "
      "ratio of leg lengths, and in its own size.\n\n"
      "| trials | made | frames | retrieval | interpolation | paper | with deformation | paper | own size: "
      "interpolation | with deformation |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const Group& group : groups) {
    const auto all = std::ranges::count_if(trials, [&](const MocapTrial& t) { return is_in(group, t); });
    if (all == 0) continue;
    const Trials some = made(trials, [&](const MocapTrial& t) { return is_in(group, t); });
    const auto frames = static_cast<std::size_t>(
        static_cast<double>(some.size()) *
            mean_of(some, [](const MocapTrial& t) { return static_cast<double>(t.frames); }) +
        0.5);
    text +=
        fmt::format("| {} | {} of {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", group.name, some.size(),
                    all, frames, mean_velocity(some, &MocapTrial::retrieval, &MocapFigures::velocity),
                    mean_velocity(some, &MocapTrial::interpolation, &MocapFigures::velocity),
                    velocity(group.paper.interpolation, group.paper.interpolation_deviation),
                    mean_velocity(some, &MocapTrial::deformation, &MocapFigures::velocity),
                    velocity(group.paper.deformation, group.paper.deformation_deviation),
                    mean_velocity(some, &MocapTrial::interpolation, &MocapFigures::velocity_as_is),
                    mean_velocity(some, &MocapTrial::deformation, &MocapFigures::velocity_as_is));
  }
  return text;
}

std::string quality_table(const std::vector<MocapTrial>& trials) {
  std::string text =
      "\n## Naturalness and speed\n\n"
      "Means over trials. Feet: those that stand in the query. Pops: inside transitions, and over all "
      "frames.\n\n"
      "| trials | animation | foot drift, cm/s | sole off the ground, cm | pop ratio | peak ratio | edge "
      "stretch, "
      "99 % | frames/s |\n|---|---|---:|---:|---:|---:|---:|---:|\n";
  const std::array<std::pair<const char*, MocapFigures MocapTrial::*>, 3> methods = {
      {{"retrieval", &MocapTrial::retrieval},
       {"interpolation", &MocapTrial::interpolation},
       {"with deformation", &MocapTrial::deformation}}};
  for (const Group& group : groups) {
    const Trials some = made(trials, [&](const MocapTrial& t) { return is_in(group, t); });
    if (some.empty()) continue;
    for (const auto& [name, method] : methods) {
      const auto mean = [&](double MotionQuality::*figure) {
        return mean_of(some, [&](const MocapTrial& t) { return (t.*method).quality.*figure; });
      };
      const bool is_timed = method == &MocapTrial::deformation;
      text += fmt::format("| {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {} |\n", group.name, name,
                          mean(&MotionQuality::foot_drift), mean(&MotionQuality::foot_height),
                          mean(&MotionQuality::pop_ratio), mean(&MotionQuality::peak_ratio),
                          mean(&MotionQuality::edge_stretch_p99),
                          is_timed ? fmt::format("{:.0f}", speed(some)) : "");
    }
  }
  return text;
}

// Errors of a method over trials that have a truth.
TruthError mean_truth(const Trials& trials, std::size_t method) {
  TruthError mean{.method = truth_methods()[method]};
  for (const MocapTrial* trial : trials) {
    const TruthError& error = trial->truth[method];
    mean.mean += error.mean / static_cast<double>(trials.size());
    mean.aligned_mean += error.aligned_mean / static_cast<double>(trials.size());
    mean.max = std::max(mean.max, error.max);
    mean.aligned_max = std::max(mean.aligned_max, error.aligned_max);
  }
  return mean;
}

std::string truth_table(const std::vector<MocapTrial>& trials) {
  const Trials some = made(trials, [](const MocapTrial& t) { return !t.truth.empty(); });
  if (some.empty()) return {};
  std::string text = fmt::format(
      "\n## Against the truth\n\n"
      "Distances of all vertices from what the performer does in these {} trials. Placed once: the truth is "
      "moved over the ground, as a whole, to where its joints lie nearest to the query's. Aligned: every "
      "frame "
      "is moved over the ground to where it fits best.\n\n"
      "| method | placed once: mean, mm | largest, mm | aligned: mean, mm | largest, mm |\n"
      "|---|---:|---:|---:|---:|\n",
      some.size());
  for (std::size_t m = 0; m < truth_methods().size(); ++m) {
    const TruthError error = mean_truth(some, m);
    text += fmt::format("| {} | {:.1f} | {:.0f} | {:.1f} | {:.0f} |\n", error.method,
                        millimetres * error.mean, millimetres * error.max, millimetres * error.aligned_mean,
                        millimetres * error.aligned_max);
  }
  text += fmt::format("\nAligned mean in mm, by trial:\n\n| trial | held out | {} |\n|---|---|",
                      fmt::join(truth_methods(), " | "));
  for (std::size_t m = 0; m < truth_methods().size(); ++m) text += "---:|";
  text += "\n";
  for (const MocapTrial* trial : some) {
    text += fmt::format("| {} | {} |", trial->trial, trial->held_clip);
    for (const TruthError& error : trial->truth)
      text += fmt::format(" {:.1f} |", millimetres * error.aligned_mean);
    text += "\n";
  }
  return text;
}

std::string trial_table(const std::vector<MocapTrial>& trials) {
  std::string text =
      "\n## Trials\n\n"
      "| trial | what | frames | transitions | repeats | skips | distance, cm a joint | interpolation, "
      "cm/frame "
      "| with deformation, cm/frame | foot drift, cm/s | pop ratio | edge stretch | frames/s |\n"
      "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const MocapTrial& t : trials) {
    if (!t.failure.empty()) {
      text += fmt::format("| {} | {} | failed | | | | | | | | | | |\n", t.trial, t.description);
      continue;
    }
    const MotionQuality& quality = t.deformation.quality;
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {:.1f} | {} | {} | {:.1f} | {:.2f} | {:.3f} | {:.0f} |\n", t.trial,
        t.description, t.frames, t.transitions, t.repeats, t.skips, centimetres * t.mean_dissimilarity,
        velocity(t.interpolation.velocity), velocity(t.deformation.velocity), quality.foot_drift,
        quality.pop_ratio, quality.edge_stretch_p99, t.frames_per_second());
  }
  return text;
}

std::string notes(const std::vector<MocapTrial>& trials) {
  std::string failures;
  std::string remarks;
  for (const MocapTrial& trial : trials) {
    if (!trial.failure.empty()) failures += fmt::format("- {}: {}\n", trial.trial, trial.failure);
    for (const std::string& note : trial.notes) remarks += fmt::format("- {}: {}\n", trial.trial, note);
  }
  return (failures.empty() ? "\nNo trial failed.\n" : "\n## Failures\n\n" + failures) +
         (remarks.empty() ? "" : "\n## Notes\n\n" + remarks);
}

// "a, b" in CSV stands in quotes.
std::string quoted(const std::string& text) {
  std::string inside;
  for (const char c : text) inside += c == '"' ? std::string("\"\"") : std::string(1, c);
  return "\"" + inside + "\"";
}

std::string figures_csv(const MocapFigures& f) {
  return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}",
                     centimetres * f.velocity.mean, centimetres * f.velocity.deviation,
                     centimetres * f.velocity_as_is.mean, centimetres * f.velocity_as_is.deviation,
                     f.quality.foot_drift, f.quality.foot_height, f.quality.pop_ratio, f.quality.peak_ratio,
                     f.quality.edge_stretch_p99);
}

}  // namespace

std::string mocap_markdown(const std::vector<MocapTrial>& trials, const MocapEvaluationOptions& options) {
  const Trials all = made(trials, [](const MocapTrial&) { return true; });
  return fmt::format(
             "# Motion capture drives the character\n\n"
             "{} trials, {} made; model {}, threshold {:g} m a joint. The paper's figures are those HSSMG "
             "6.2 "
             "gives for its own character and its own choice of trials.\n\n",
             trials.size(), all.size(), to_string(options.mocap.mocap.model),
             options.mocap.mocap.retrieval.threshold) +
         summary(trials) + quality_table(trials) + truth_table(trials) + trial_table(trials) + notes(trials);
}

std::string mocap_csv(const std::vector<MocapTrial>& trials) {
  std::string text =
      "trial,class,description,held_clip,frames,scale,transitions,repeats,skips,distance_cm_joint";
  for (const char* method : {"retrieval", "interpolation", "deformation"}) {
    text += fmt::format(
        ",{0}_velocity_error,{0}_deviation,{0}_velocity_error_unscaled,{0}_deviation_unscaled,{0}_foot_drift,"
        "{0}_foot_height,{0}_pop_ratio,{0}_peak_ratio,{0}_edge_stretch_p99",
        method);
  }
  text += ",failure\n";
  for (const MocapTrial& t : trials) {
    text += fmt::format("{},{},{},{},", t.trial, t.motion_class, quoted(t.description), t.held_clip);
    if (t.failure.empty()) {
      text += fmt::format("{},{:.6g},{},{},{},{:.6g},{},{},{},\n", t.frames, t.scale, t.transitions,
                          t.repeats, t.skips, centimetres * t.mean_dissimilarity, figures_csv(t.retrieval),
                          figures_csv(t.interpolation), figures_csv(t.deformation));
    } else {
      text += std::string(6 + 27, ',') + quoted(t.failure) + "\n";
    }
  }
  return text;
}

std::string mocap_times_csv(const std::vector<MocapTrial>& trials) {
  std::string text = "trial,frames,planning_seconds,animation_seconds,frames_per_second\n";
  for (const MocapTrial& t : trials) {
    if (!t.failure.empty()) continue;
    text += fmt::format("{},{},{:.4g},{:.4g},{:.4g}\n", t.trial, t.frames, t.planning_seconds,
                        t.animation_seconds, t.frames_per_second());
  }
  return text;
}

std::string mocap_truth_csv(const std::vector<MocapTrial>& trials) {
  std::string text = "trial,held_clip,method,mean_mm,max_mm,aligned_mean_mm,aligned_max_mm\n";
  for (const MocapTrial& t : trials) {
    for (const TruthError& e : t.truth) {
      text += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g}\n", t.trial, t.held_clip, e.method,
                          millimetres * e.mean, millimetres * e.max, millimetres * e.aligned_mean,
                          millimetres * e.aligned_max);
    }
  }
  return text;
}

void plot_mocap(const std::vector<MocapTrial>& trials, const std::filesystem::path& folder) {
  struct Figure {
    const char* motion_class;
    const char* title;
    const char* file;
    const PaperFigures& paper;
  };
  const std::array figures = {Figure{"walk", "Walks", "walks.png", groups[0].paper},
                              Figure{"run", "Runs", "runs.png", groups[2].paper}};
  for (const Figure& figure : figures) {
    BarPlot plot{
        .title = fmt::format("{}: error of joint velocities (bars: standard deviation)", figure.title),
        .y_label = "cm/frame",
        .columns = {},
        .series = {{.name = "interpolation", .values = {}, .deviations = {}},
                   {.name = "interpolation and deformation", .values = {}, .deviations = {}}},
        .levels = {{.name = "paper", .value = figure.paper.interpolation, .series_idx = 0},
                   {.name = "paper", .value = figure.paper.deformation, .series_idx = 1}}};
    for (const MocapTrial& trial : trials) {
      if (trial.motion_class != figure.motion_class) continue;
      plot.columns.push_back(trial.failure.empty() ? trial.trial : trial.trial + " failed");
      const std::array errors = {trial.interpolation.velocity, trial.deformation.velocity};
      for (std::size_t s = 0; s < 2; ++s) {
        plot.series[s].values.push_back(trial.failure.empty() ? centimetres * errors[s].mean
                                                              : std::numeric_limits<double>::quiet_NaN());
        plot.series[s].deviations.push_back(centimetres * errors[s].deviation);
      }
    }
    if (!plot.columns.empty()) plot_bars(plot, folder / figure.file);
  }
}

void plot_mocap_truth(const std::vector<MocapTrial>& trials, const std::filesystem::path& png) {
  const Trials some = made(trials, [](const MocapTrial& t) { return !t.truth.empty(); });
  std::vector<std::string> rows;
  for (const MocapTrial* trial : some) {
    rows.push_back(trial->held_clip.empty() ? trial->trial
                                            : fmt::format("{} ({})", trial->trial, trial->held_clip));
  }
  const auto panel = [&](const char* title, double TruthError::*figure) {
    DotPanel made_panel{.title = title,
                        .x_label = "mean error of all vertices, mm",
                        .scale = DotPanel::Scale::logarithmic,
                        .series = {}};
    for (std::size_t m = 0; m < truth_methods().size(); ++m) {
      // Its frames are those of retrieval, shown at another pace: the two would lie upon each other.
      if (truth_methods()[m] == "interpolation") continue;
      DotSeries series{.name = truth_methods()[m], .values = {}};
      for (const MocapTrial* trial : some) series.values.push_back(millimetres * trial->truth[m].*figure);
      made_panel.series.push_back(std::move(series));
    }
    return made_panel;
  };
  plot_dots(rows,
            std::array{panel("Placed once", &TruthError::mean),
                       panel("Every frame aligned", &TruthError::aligned_mean)},
            png);
}

}  // namespace reprise
