// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/evaluation_report.h"

#include <functional>

#include <fmt/format.h>

namespace reprise {
namespace {

struct Truth {
  const char* key;
  const char* title;
  RetrievalQuality MetricEvaluation::*quality;
};
constexpr Truth truths[] = {{"pose_and_shape", "pose and shape", &MetricEvaluation::pose_and_shape},
                            {"clothing", "clothing", &MetricEvaluation::clothing},
                            {"looks", "looks", &MetricEvaluation::looks}};

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

double precision_at_half(const RetrievalQuality& quality) {
  return quality.precision[recall_level_count / 2 - 1];
}

std::string retrieval_table(const SimilarityEvaluation& evaluation, const Truth& truth,
                            const std::string& alike) {
  const RetrievalQuality& any = evaluation.metrics.front().*truth.quality;
  std::string text = fmt::format("\n## Retrieval: {}\n\nAlike: {}.\n", truth.title, alike);
  if (any.queries == 0)
    return text + "\nNo frame has both something to find and something to mistake for it.\n";
  text += fmt::format("{} of {} frames are queries; by lot the precision would be {:.3f}.\n\n", any.queries,
                      evaluation.frames, any.chance);
  text += "| metric | average precision | precision at recall 0.5 | area under ROC |\n|---|---|---|---|\n";
  for (const MetricEvaluation& m : evaluation.metrics) {
    const RetrievalQuality& quality = m.*truth.quality;
    text += fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} |\n", m.metric, quality.average_precision,
                        precision_at_half(quality), quality.roc_area);
  }
  return text;
}

nlohmann::ordered_json as_json(const RetrievalQuality& quality) {
  if (quality.queries == 0) return nullptr;
  return {{"queries", quality.queries},
          {"average_precision", quality.average_precision},
          {"chance", quality.chance},
          {"roc_area", quality.roc_area},
          {"precision", quality.precision}};
}

nlohmann::ordered_json as_json(const AppearanceSummary& summary) {
  return {{"count", summary.transitions},
          {"outline", summary.outline},
          {"color", summary.color},
          {"visible", summary.visible}};
}

}  // namespace

std::string evaluation_markdown(const SimilarityEvaluation& evaluation,
                                const SimilarityEvaluationOptions& options) {
  std::string text = fmt::format("# Metrics of {} frames\n\n", evaluation.frames);
  text += "| metric | time, s | pairs | exact | transitions |\n|---|---|---|---|---|\n";
  for (const MetricEvaluation& m : evaluation.metrics) {
    text += fmt::format(
        "| {} | {:.2f}{} | {} | {} | {} |\n", m.metric, m.seconds, m.from_cache ? " (kept)" : "", m.pairs,
        percent(m.pairs == 0 ? 1.0 : static_cast<double>(m.exact_pairs) / static_cast<double>(m.pairs)),
        m.transitions.size());
  }

  text += fmt::format(
      "\n## Appearance at transitions\n\nThe frames of each transition, the target turned onto the source, "
      "from "
      "four sides in pixels of {:g} cm: the share of the character that finds nothing ({}), or no colour "
      "within "
      "{:g} of L\\*a\\*b\\* ({}), within {:g} cm in the other picture.\n\n",
      100.0 * options.appearance.pixel_size, "outline", options.appearance.color_difference, "colour",
      100.0 * options.appearance.reach);
  text += fmt::format(
      "| metric | transitions | outline | colour | changed by more than {:g} % |\n|---|---|---|---|---|\n",
      100.0 * options.looks_alike);
  const auto row = [&](const std::string& name, const AppearanceSummary& s) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", name, s.transitions, percent(s.outline),
                        percent(s.color), percent(s.visible));
  };
  for (const MetricEvaluation& m : evaluation.metrics) row(m.metric, m.appearance);
  row("(a frame and the next)", evaluation.neighbors);

  if (evaluation.has_truth) {
    text += retrieval_table(
        evaluation, truths[0],
        fmt::format(
            "true surface points and joints, after alignment, are less than {:g} cm apart (root mean square)",
            100.0 * options.alike));
    text += retrieval_table(
        evaluation, truths[1],
        fmt::format(
            "among frames whose true joints are less than {:g} cm apart, cloth and hair that hang free "
            "({} vertices) are less than {:g} cm apart, seen from the bones they follow",
            100.0 * options.alike, evaluation.free_vertices, 100.0 * options.clothing_alike));
  }
  text +=
      retrieval_table(evaluation, truths[2],
                      fmt::format("less than {:g} % of the picture changes", 100.0 * options.looks_alike));
  if (!evaluation.notes.empty()) text += "\n## Notes\n\n";
  for (const std::string& note : evaluation.notes) text += fmt::format("- {}\n", note);
  return text;
}

std::string evaluation_csv(const SimilarityEvaluation& evaluation) {
  std::string text =
      "metric,seconds,pairs,exact_pairs,transitions,outline_change,color_change,visible_changes";
  for (const Truth& truth : truths) {
    text += fmt::format(",{0}_queries,{0}_chance,{0}_average_precision,{0}_roc_area", truth.key);
    for (std::size_t level = 1; level <= recall_level_count; ++level)
      text += fmt::format(",{}_precision_{:.2f}", truth.key, static_cast<double>(level) / recall_level_count);
  }
  text += "\n";
  for (const MetricEvaluation& m : evaluation.metrics) {
    text +=
        fmt::format("{},{:.3f},{},{},{},{:.6f},{:.6f},{:.6f}", m.metric, m.seconds, m.pairs, m.exact_pairs,
                    m.transitions.size(), m.appearance.outline, m.appearance.color, m.appearance.visible);
    for (const Truth& truth : truths) {
      const RetrievalQuality& quality = m.*truth.quality;
      if (quality.queries == 0) {
        text += ",0" + std::string(recall_level_count + 3, ',');
        continue;
      }
      text += fmt::format(",{},{:.6f},{:.6f},{:.6f}", quality.queries, quality.chance,
                          quality.average_precision, quality.roc_area);
      for (const double precision : quality.precision) text += fmt::format(",{:.6f}", precision);
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json evaluation_json(const SimilarityEvaluation& evaluation,
                                       const SimilarityEvaluationOptions& options) {
  nlohmann::ordered_json metrics = nlohmann::ordered_json::array();
  for (const MetricEvaluation& m : evaluation.metrics) {
    nlohmann::ordered_json transitions = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < m.transitions.size(); ++i) {
      const Transition& t = m.transitions[i];
      transitions.push_back({{"source_clip", t.source_clip},
                             {"target_clip", t.target_clip},
                             {"m", t.m},
                             {"n", t.n},
                             {"cost", t.cost},
                             {"outline", m.changes[i].outline},
                             {"color", m.changes[i].color}});
    }
    nlohmann::ordered_json entry = {{"metric", m.metric},           {"seconds", m.seconds},
                                    {"from_cache", m.from_cache},   {"pairs", m.pairs},
                                    {"exact_pairs", m.exact_pairs}, {"appearance", as_json(m.appearance)}};
    for (const Truth& truth : truths) entry[truth.key] = as_json(m.*truth.quality);
    entry["transitions"] = std::move(transitions);
    metrics.push_back(std::move(entry));
  }
  return {{"frames", evaluation.frames},
          {"has_truth", evaluation.has_truth},
          {"free_vertices", evaluation.free_vertices},
          {"options",
           {{"alike_m", options.alike},
            {"clothing_alike_m", options.clothing_alike},
            {"looks_alike", options.looks_alike},
            {"query_gap", options.query_gap},
            {"pixel_size_m", options.appearance.pixel_size},
            {"reach_m", options.appearance.reach},
            {"color_difference", options.appearance.color_difference}}},
          {"captured_neighbors", as_json(evaluation.neighbors)},
          {"metrics", std::move(metrics)},
          {"notes", evaluation.notes}};
}

}  // namespace reprise
