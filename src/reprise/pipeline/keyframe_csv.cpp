// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/pipeline/keyframe_table.h"

namespace reprise {
namespace {

// Names of clips and files may hold what separates fields.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string pair_fields(const KeyframeGrid& grid) {
  return fmt::format("{},{},{}", field(grid.database), field(grid.pair.from), field(grid.pair.to));
}

std::string numbers(const std::vector<double>& values) {
  return fmt::format("{}", fmt::join(values, ","));
}

}  // namespace

std::string keyframe_table_csv(const std::vector<GridResult>& results) {
  std::string text =
      "database,from,to,targets,reachable,met_by_correction,proved,largest_gap,"
      "smoothness_min,smoothness_max,normalized_smoothness_min,normalized_smoothness_max,"
      "distance_error_min,distance_error_rms,distance_error_max,time_error_min,time_error_rms,time_error_max,"
      "corrected_distance_error_rms,corrected_distance_error_max,corrected_time_error_rms,"
      "corrected_time_error_max,all_distance_error_rms,all_distance_error_max,all_time_error_rms,"
      "all_time_error_max,cpu_mean,cpu_deviation,cpu_median,cpu_max,cpu_preparation,cpu_total,"
      "paper_smoothness_min,paper_smoothness_max,paper_distance_error_min,paper_distance_error_rms,"
      "paper_distance_error_max,paper_time_error_min,paper_time_error_rms,paper_time_error_max,"
      "paper_cpu_mean,paper_cpu_deviation\n";
  for (const TableRow& row : table_rows(results)) {
    const GridFigures f = figures_of(row.results);
    text += row.pair != nullptr ? pair_fields(row.pair->grid) : fmt::format("{},,", field(row.database));
    text += fmt::format(",{},{},{},{},{},", f.targets, f.reachable, f.met, f.proved, f.largest_gap);
    text += numbers({f.smoothness.min,
                     f.smoothness.max,
                     f.normalized_smoothness.min,
                     f.normalized_smoothness.max,
                     f.distance_error.min,
                     f.distance_error.rms,
                     f.distance_error.max,
                     f.time_error.min,
                     f.time_error.rms,
                     f.time_error.max,
                     f.corrected_distance_error.rms,
                     f.corrected_distance_error.max,
                     f.corrected_time_error.rms,
                     f.corrected_time_error.max,
                     f.all_distance_error.rms,
                     f.all_distance_error.max,
                     f.all_time_error.rms,
                     f.all_time_error.max,
                     f.cpu.mean,
                     f.cpu.deviation,
                     f.cpu.median,
                     f.cpu.max,
                     f.preparation_cpu,
                     f.total_cpu()});
    const PaperRow* paper = row.pair != nullptr ? row.pair->paper : nullptr;
    text += paper == nullptr
                ? std::string(",,,,,,,,,,")
                : "," + numbers({paper->smoothness_min, paper->smoothness_max, paper->distance_min,
                                 paper->distance_rms, paper->distance_max, paper->time_min, paper->time_rms,
                                 paper->time_max, paper->cpu_mean, paper->cpu_deviation});
    text += '\n';
  }
  return text;
}

std::string queries_csv(const std::vector<GridResult>& results) {
  std::string text =
      "database,from,to,target_distance,target_time,reachable,distance,time,frames,transitions,cost,"
      "lower_bound,gap,transition_cost,labels,corrected_distance,corrected_time,corrected_frames,stretch,"
      "smoothness,normalized_smoothness\n";
  for (const GridResult& result : results) {
    const std::string pair = pair_fields(result.grid);
    for (const GridQuery& query : result.grid.queries) {
      const MotionPath& path = query.path;
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},", pair, query.target_distance,
                          query.target_time, query.is_reachable ? 1 : 0, path.distance, path.time,
                          path.frame_count, query.transitions.size(), path.cost, path.lower_bound, path.gap(),
                          path.costs.transitions, path.labels, query.correction.distance,
                          query.correction.time, query.correction.frame_count, query.correction.stretch);
      if (query.smoothness)
        text += fmt::format("{},{}\n", query.smoothness->weighted, query.smoothness->normalized);
      else
        text += ",\n";
    }
  }
  return text;
}

std::string times_csv(const std::vector<GridResult>& results) {
  std::string text = "database,from,to,target_distance,target_time,cpu_seconds\n";
  for (const GridResult& result : results) {
    const std::string pair = pair_fields(result.grid);
    for (const GridQuery& query : result.grid.queries)
      text += fmt::format("{},{},{},{}\n", pair, query.target_distance, query.target_time, query.cpu_seconds);
  }
  return text;
}

std::string unreachable_csv(const std::vector<GridResult>& results, const KeyframeOptions& options) {
  std::string text =
      "database,from,to,target_distance,target_time,distance,time,distance_error,time_error,"
      "nearest_reachable_distance,nearest_reachable_time\n";
  for (const GridResult& result : results) {
    const std::string pair = pair_fields(result.grid);
    for (const GridQuery& query : result.grid.queries) {
      if (query.is_reachable) continue;
      text += fmt::format("{},{},{},{},{},{},{},", pair, query.target_distance, query.target_time,
                          query.path.distance, query.path.time, query.distance_error(), query.time_error());
      const GridQuery* nearest = nearest_reachable(result.grid, query, options);
      text += nearest == nullptr ? std::string(",\n")
                                 : fmt::format("{},{}\n", nearest->target_distance, nearest->target_time);
    }
  }
  return text;
}

std::string samples_csv(const std::vector<GridResult>& results) {
  std::string text =
      "database,from,to,target_distance,target_time,reachable,variant,predicted_distance,distance,"
      "predicted_frames,frames,pop_ratio,captured_pop_ratio,foot_drift_cm_s,blend_foot_drift_cm_s,shown_foot_"
      "drift_cm_s,"
      "captured_foot_drift_cm_s,edge_stretch_p99,captured_edge_stretch_p99\n";
  for (const GridResult& result : results) {
    const std::string pair = pair_fields(result.grid);
    for (const GridSample& sample : result.samples) {
      const GridQuery& query = result.grid.queries[sample.query_idx];
      for (const SampleVariant variant : sample_variants) {
        const SampleMeasures& m = sample.variants[static_cast<std::size_t>(variant)];
        const Naturalness& n = m.naturalness;
        text += fmt::format("{},{},{},{},{},{},{},{},{},", pair, query.target_distance, query.target_time,
                            query.is_reachable ? 1 : 0, name_of(variant), m.predicted_distance, m.distance,
                            m.predicted_frames, m.frames);
        text +=
            numbers({n.pop_ratio, n.captured_pop_ratio, n.foot_drift, n.blend_foot_drift, n.shown_foot_drift,
                     n.captured_foot_drift, n.edge_stretch_p99, n.captured_edge_stretch_p99}) +
            "\n";
      }
    }
  }
  return text;
}

}  // namespace reprise
