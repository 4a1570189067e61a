// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which criterion chooses windows that do not pop? For each criterion, blend profile and weight: the
// transitions found on real clips, and the peak acceleration of all vertices of their linear blends, relative
// to the 99th percentile of what the captured frames themselves reach. docs/transitions.md holds the table.

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "real_data.h"
#include "reprise/graph/transition.h"
#include "reprise/similarity/vertex_metric.h"

namespace reprise::benchmark {
namespace {

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = std::lround(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

double peak_of(const Positions& before, const Positions& at, const Positions& after) {
  return std::sqrt(static_cast<double>((before - 2.0F * at + after).rowwise().squaredNorm().maxCoeff()));
}

// 99th percentiles of captured frames' largest vertex acceleration, m/frame^2.
struct CapturedPeaks {
  double pooled = 0.0;  // over the frames of all clips
  std::vector<double> of_clip;
};

CapturedPeaks captured_peaks(const PerformanceDatabase& database) {
  CapturedPeaks captured;
  std::vector<double> all;
  for (const MeshSequence& clip : database.clips()) {
    std::vector<double> peaks;
    for (std::size_t f = 1; f + 1 < clip.frame_count(); ++f) {
      peaks.push_back(peak_of(clip.frame(f - 1), clip.frame(f), clip.frame(f + 1)));
    }
    all.insert(all.end(), peaks.begin(), peaks.end());
    captured.of_clip.push_back(percentile(std::move(peaks), 0.99));
  }
  captured.pooled = percentile(std::move(all), 0.99);
  return captured;
}

// Of all vertices, over the frames of the window, the pure frames outside included.
double blended_peak(const PerformanceDatabase& database, const Transition& transition, BlendProfile profile) {
  const MeshSequence& source = database.clip(transition.source_clip);
  const MeshSequence& target = database.clip(transition.target_clip);
  const int L = transition.half_window;
  std::vector<Positions> frames;
  for (int k = -L - 1; k <= L + 1; ++k) {
    const double alpha = blend_weight(profile, k, L);
    const int m = transition.m + k;
    const int n = transition.n + k;
    if ((k < -L && m < 0) || (k > L && n >= static_cast<int>(target.frame_count()))) continue;
    Positions blended = Positions::Zero(static_cast<Eigen::Index>(source.vertex_count()), 3);
    if (alpha < 1.0) blended += static_cast<float>(1.0 - alpha) * source.frame(static_cast<std::size_t>(m));
    if (alpha > 0.0) {
      Positions moved(blended.rows(), 3);
      transform_positions(transition.source_from_target, target.frame(static_cast<std::size_t>(n)),
                          PositionsRef(moved.data(), moved.rows(), 3));
      blended += static_cast<float>(alpha) * moved;
    }
    frames.push_back(std::move(blended));
  }
  double peak = 0.0;
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    peak = std::max(peak, peak_of(frames[f - 1], frames[f], frames[f + 1]));
  }
  return peak;
}

double mean_dissimilarity(const Transition& transition, BlendProfile profile) {
  double weights = 0.0;
  for (int k = -transition.half_window; k <= transition.half_window; ++k) {
    const double alpha = blend_weight(profile, k, transition.half_window);
    weights += std::min(alpha, 1.0 - alpha);
  }
  return transition.distortion / weights;
}

void measure(const char* name, const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
             TransitionOptions options, const CapturedPeaks& captured) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Transition> transitions = find_transitions(database, matrix, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<double> ratios;
  std::vector<double> own_ratios;  // to the livelier of the two clips
  std::vector<double> seen;        // share of the peak that the sampled vertices see
  std::vector<double> windows;
  std::vector<double> distances;
  for (const Transition& transition : transitions) {
    const double peak = blended_peak(database, transition, options.profile);
    ratios.push_back(peak / captured.pooled);
    own_ratios.push_back(
        peak / std::max(captured.of_clip[transition.source_clip], captured.of_clip[transition.target_clip]));
    seen.push_back(transition.peak_acceleration / peak);
    windows.push_back(transition.half_window);
    distances.push_back(100.0 * mean_dissimilarity(transition, options.profile));
  }
  const auto above_one = [](double ratio) { return ratio > 1.0; };
  const bool is_paper = options.criterion == WindowCriterion::paper_sum;
  fmt::print(
      "| {} | {} | {} | {} | {} | {:.0f} | {:.0f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.2f} | {:.2f} "
      "| {} | {:.2f} | {:.0f} |\n",
      name, is_paper ? "paper_sum" : "blend_speed",
      options.profile == BlendProfile::linear ? "linear" : "smooth",
      is_paper ? std::string("-") : fmt::format("{}", options.acceleration_weight), transitions.size(),
      percentile(windows, 0.5), percentile(windows, 0.9), percentile(distances, 0.5), percentile(ratios, 0.5),
      percentile(ratios, 0.9), percentile(ratios, 1.0), std::ranges::count_if(ratios, above_one),
      percentile(own_ratios, 0.5), percentile(own_ratios, 0.9), std::ranges::count_if(own_ratios, above_one),
      percentile(seen, 0.5),
      1e3 * seconds / static_cast<double>(database.clips().size() * database.clips().size()));
}

void measure_all(const char* name, const PerformanceDatabase& database) {
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const CapturedPeaks captured = captured_peaks(database);
  fmt::print("\n{}: {} clips, {} frames, {} vertices; captured 99th percentile {:.3f} m/frame^2\n\n", name,
             database.clips().size(), database.frame_count(), database.topology()->vertex_count,
             captured.pooled);
  fmt::print(
      "| data | criterion | profile | weight | found | L median | L 90 % | cm median | pop median | 90 % | "
      "max | > 1 | own median | 90 % | > 1 | seen | ms a pair "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const BlendProfile profile : {BlendProfile::linear, BlendProfile::smooth}) {
    measure(name, database, matrix, {.criterion = WindowCriterion::paper_sum, .profile = profile}, captured);
    for (const double weight : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
      measure(name, database, matrix, {.acceleration_weight = weight, .profile = profile}, captured);
    }
  }
}

}  // namespace
}  // namespace reprise::benchmark

int main() {
  reprise::benchmark::measure_all("ama", reprise::benchmark::ama());
  reprise::benchmark::measure_all("fashion", reprise::benchmark::fashion());
}
