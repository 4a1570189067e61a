// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluate_similarity.h"

#include <algorithm>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/database_file.h"
#include "reprise/pipeline/evaluation_looks.h"
#include "reprise/pipeline/evaluation_report.h"
#include "reprise/pipeline/outputs.h"
#include "reprise/render/plots.h"
#include "reprise/similarity/performance_truth.h"
#include "reprise/similarity/temporal_filter.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

// More frames than this are not all looked at: pictures are kept, and compared in pairs.
constexpr std::size_t most_looked_at = 1000;

void check(const SimilarityEvaluationOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0.0))
      throw InvalidArgument(fmt::format("{}: expected a positive number, found {}", name, value));
  };
  positive("alike", options.alike);
  positive("clothing_alike", options.clothing_alike);
  positive("looks_alike", options.looks_alike);
  if (options.query_gap < 1)
    throw InvalidArgument(fmt::format("query_gap: expected 1 or more, found {}", options.query_gap));
  if (options.filter_half_window < 1) {
    throw InvalidArgument(
        fmt::format("filter_half_window: expected 1 or more, found {}", options.filter_half_window));
  }
  if (options.pictured_transitions < 1 || options.pictured_transitions > 100) {
    throw InvalidArgument(
        fmt::format("pictured_transitions: expected 1 to 100, found {}", options.pictured_transitions));
  }
}

bool has_appearance(const PerformanceDatabase& database) {
  return database.topology()->texture != nullptr ||
         std::ranges::all_of(database.clips(), [](const MeshSequence& clip) { return clip.has_colors(); });
}

// All metrics that the database allows, if none is asked for.
std::vector<std::string> chosen_metrics(const PerformanceDatabase& database,
                                        const std::vector<std::string>& asked,
                                        std::vector<std::string>& notes) {
  const std::vector<std::string>& known = similarity_metrics();
  for (const std::string& metric : asked) {
    if (metric == "shape-color" || std::ranges::find(known, metric) != known.end()) continue;
    const std::string nearest = nearest_word(metric, known);
    throw InvalidArgument(fmt::format("there is no metric '{}'; {}", metric,
                                      nearest.empty()
                                          ? fmt::format("expected one of {}", fmt::join(known, ", "))
                                          : fmt::format("did you mean '{}'?", nearest)));
  }
  if (!asked.empty()) return asked;
  std::vector<std::string> metrics;
  for (const std::string& metric : similarity_metrics()) {
    if (metric == "skeleton" && !database.markup()) {
      notes.emplace_back(
          "The skeleton metric is left out: the database has no markup (see `reprise markup`).");
    } else if (metric == "shape-colour" && !has_appearance(database)) {
      notes.emplace_back(
          "The shape-colour metric is left out: the database has neither colours nor a texture.");
    } else {
      metrics.push_back(metric);
    }
  }
  return metrics;
}

void check_same_clips(const PerformanceDatabase& database, const PerformanceDatabase& truth,
                      const fs::path& path) {
  bool same = database.clip_names() == truth.clip_names();
  for (std::size_t c = 0; same && c < database.clips().size(); ++c)
    same = database.clip(c).frame_count() == truth.clip(c).frame_count();
  if (same) return;
  const auto list = [](const PerformanceDatabase& d) {
    std::string text;
    for (const MeshSequence& clip : d.clips())
      text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", clip.name(), clip.frame_count());
    return text;
  };
  throw InvalidArgument(fmt::format("{}: is no truth of this database: expected the clips {}; found {}",
                                    path.string(), list(database), list(truth)));
}

AppearanceSummary summary(const std::vector<AppearanceChange>& changes, double visible) {
  AppearanceSummary result{.transitions = changes.size()};
  if (changes.empty()) return result;
  for (const AppearanceChange& change : changes) {
    result.outline += change.outline;
    result.color += change.color;
    result.visible += change.total() > visible ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(changes.size());
  result.outline /= count;
  result.color /= count;
  result.visible /= count;
  return result;
}

// What the metrics are measured against.
struct Truths {
  std::optional<PerformanceTruth> performance;
  LookAlikes looks;
};

// Wraps a judgement so that neighbours in one clip are not judged.
FrameJudge apart(const DissimilarityMatrix& matrix, int gap, FrameJudge judge) {
  std::vector<std::size_t> clip_of_frame;
  for (std::size_t c = 0; c < matrix.clip_frame_counts().size(); ++c)
    clip_of_frame.insert(clip_of_frame.end(), matrix.clip_frame_counts()[c], c);
  return [clip_of_frame = std::move(clip_of_frame), least = static_cast<std::size_t>(gap),
          judge = std::move(judge)](std::size_t a, std::size_t b) -> std::optional<bool> {
    const std::size_t distance = std::max(a, b) - std::min(a, b);
    if (clip_of_frame[a] == clip_of_frame[b] && distance < least) return std::nullopt;
    return judge(a, b);
  };
}

void measure_retrieval(const DissimilarityMatrix& matrix, const Truths& truths,
                       const SimilarityEvaluationOptions& options, MetricEvaluation& result) {
  const auto quality = [&](const FrameJudge& judge) {
    return retrieval_quality(matrix, apart(matrix, options.query_gap, judge));
  };
  result.looks = quality(std::cref(truths.looks));
  if (!truths.performance) return;
  const PerformanceTruth& truth = *truths.performance;
  result.pose_and_shape =
      quality([&](std::size_t a, std::size_t b) { return truth.pose_and_shape.value(a, b) < options.alike; });
  if (truth.free_vertices == 0) return;
  result.clothing = quality([&](std::size_t a, std::size_t b) -> std::optional<bool> {
    if (truth.pose.value(a, b) >= options.alike) return std::nullopt;
    return truth.clothing.value(a, b) < options.clothing_alike;
  });
}

void plot_retrieval(const SimilarityEvaluation& evaluation, const fs::path& png) {
  std::vector<CurvePanel> panels;
  const auto add = [&](const char* title, RetrievalQuality MetricEvaluation::*quality) {
    CurvePanel panel{.title = title, .x_label = "recall", .y_label = "precision"};
    for (const MetricEvaluation& m : evaluation.metrics) {
      Curve& curve = panel.curves.emplace_back(Curve{.name = m.metric});
      if ((m.*quality).queries == 0) continue;
      for (std::size_t i = 0; i < recall_level_count; ++i)
        curve.points.push_back({static_cast<double>(i + 1) / recall_level_count, (m.*quality).precision[i]});
    }
    const RetrievalQuality& first = evaluation.metrics.front().*quality;
    if (first.queries == 0) return;
    panel.curves.push_back({.name = "by lot", .points = {{0.0, first.chance}, {1.0, first.chance}}});
    panels.push_back(std::move(panel));
  };
  add("true pose and shape", &MetricEvaluation::pose_and_shape);
  add("state of the clothes", &MetricEvaluation::clothing);
  add("looks", &MetricEvaluation::looks);
  if (!panels.empty()) plot_curves(panels, png);
}

// The matrices of all metrics; what is told of them goes to `result`.
std::vector<DissimilarityMatrix> compute_metrics(const PerformanceDatabase& database,
                                                 const fs::path& database_path,
                                                 const std::vector<std::string>& metrics,
                                                 const SimilarityEvaluationOptions& options,
                                                 SimilarityEvaluation& result) {
  std::vector<DissimilarityMatrix> matrices;
  for (const std::string& metric : metrics) {
    SimilarityOptions similarity = options.similarity;
    similarity.metric = metric;
    SimilarityResult found = compute_similarity(database, database_path, similarity);
    result.metrics.push_back({.metric = found.matrix.metric(),
                              .pairs = found.matrix.pair_count(),
                              .exact_pairs = found.matrix.exact_count(),
                              .seconds = found.seconds,
                              .from_cache = found.from_cache,
                              .transitions = std::move(found.transitions)});
    matrices.push_back(std::move(found.matrix));
  }
  return matrices;
}

Truths find_truths(const PerformanceDatabase& database, bool is_clean, const FrameViewer& viewer,
                   const SimilarityEvaluationOptions& options, SimilarityEvaluation& result) {
  const std::size_t step = (result.frames + most_looked_at - 1) / most_looked_at;
  Truths truths{.performance = std::nullopt,
                .looks = LookAlikes(database, viewer, options.looks_alike, step)};
  if (step > 1)
    result.notes.push_back(fmt::format("Looks are judged on every {}th of {} frames.", step, result.frames));
  if (!result.has_truth) {
    result.notes.emplace_back(
        "Retrieval by pose, shape and clothing is left out: the database carries no truth.");
    return truths;
  }
  truths.performance = performance_truth(database);
  result.free_vertices = truths.performance->free_vertices;
  if (result.free_vertices == 0)
    result.notes.emplace_back("The state of the clothes is not judged: nothing hangs free.");
  if (!is_clean) {
    result.notes.emplace_back(
        "The database is its own truth. If it was performed with noise or drift, name the clean one "
        "(--truth).");
  }
  return truths;
}

// An older run's picture beside a newer table would be taken for its own.
void remove_older(const fs::path& picture) {
  std::error_code ignored;
  fs::remove(picture, ignored);
}

void draw_pictures(const PerformanceDatabase& database, const std::vector<DissimilarityMatrix>& matrices,
                   const FrameViewer& viewer, const SimilarityEvaluationOptions& options,
                   const fs::path& folder, SimilarityEvaluation& result) {
  const auto count = static_cast<std::size_t>(options.pictured_transitions);
  std::vector<DissimilarityMatrix> filtered;
  std::vector<MatrixPanel> panels;
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const MetricEvaluation& m = result.metrics[i];
    const fs::path sheet = folder / fmt::format("transitions-{}.png", m.metric);
    const std::vector<Transition> shown = pictured_transitions(database, m.transitions, options.pairs, count);
    if (shown.empty()) {
      remove_older(sheet);
      result.notes.push_back(fmt::format("No {} is drawn: the {} metric found no such transition.",
                                         sheet.filename().string(), m.metric));
    } else {
      draw_transitions(database, matrices[i], shown, viewer, sheet);
    }
    filtered.push_back(temporally_filtered(matrices[i], options.filter_half_window));
    panels.push_back({.matrix = &matrices[i], .title = m.metric});
  }
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const MetricEvaluation& m = result.metrics[i];
    panels.push_back({.matrix = &filtered[i],
                      .transitions = &m.transitions,
                      .title = fmt::format("{}, filtered, L = {}", m.metric, options.filter_half_window)});
  }
  plot_matrices(panels, static_cast<int>(matrices.size()), folder / "metrics.png");
  remove_older(folder / "retrieval.png");
  plot_retrieval(result, folder / "retrieval.png");
}

}  // namespace

SimilarityEvaluation evaluate_similarity(const PerformanceDatabase& database, const fs::path& database_path,
                                         const fs::path& folder, const SimilarityEvaluationOptions& options) {
  // What is wrong is said before hours of work.
  check(options);
  if (database.empty()) throw InvalidArgument("the database has no clip to evaluate");
  static_cast<void>(pictured_transitions(database, {}, options.pairs, 1));
  SimilarityEvaluation result{.frames = database.frame_count()};
  const std::vector<std::string> metrics = chosen_metrics(database, options.metrics, result.notes);
  std::optional<PerformanceDatabase> clean;
  if (!options.truth.empty()) {
    clean = load_database(options.truth);
    check_same_clips(database, *clean, options.truth);
  }
  const PerformanceDatabase& true_database = clean ? *clean : database;
  result.has_truth = has_truth(true_database);
  if (clean && !result.has_truth) {
    throw InvalidArgument(
        fmt::format("{}: carries no truth: expected a synthetic performance", options.truth.string()));
  }
  // Transitions are judged by what is seen of this database, frames by what is true.
  const FrameViewer viewer(database.clip(0), options.appearance, distinguishing_appearance(database));
  const FrameViewer true_viewer(true_database.clip(0), options.appearance,
                                distinguishing_appearance(true_database));
  prepare_folder(folder);

  const std::vector<DissimilarityMatrix> matrices =
      compute_metrics(database, database_path, metrics, options, result);
  const Truths truths = find_truths(true_database, clean.has_value(), true_viewer, options, result);
  result.neighbors = summary(neighbor_changes(database, viewer), options.looks_alike);
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    MetricEvaluation& m = result.metrics[i];
    m.changes = appearance_changes(database, m.transitions, viewer);
    m.appearance = summary(m.changes, options.looks_alike);
    measure_retrieval(matrices[i], truths, options, m);
  }
  draw_pictures(database, matrices, viewer, options, folder, result);
  write_text_file(folder / "similarity.md", evaluation_markdown(result, options));
  write_text_file(folder / "similarity.csv", evaluation_csv(result));
  const nlohmann::ordered_json json = evaluation_json(result, options);
  write_text_file(folder / "similarity.json",
                  json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return result;
}

}  // namespace reprise
