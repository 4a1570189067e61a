// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Which criterion chooses windows that do not pop? For each criterion, blend profile and weight: the
// transitions found on real clips, and the peak acceleration of all vertices of their linear blends, relative
// to the 99th percentile of what the captured frames themselves reach. And which limit on that ratio keeps
// the blends, as they are made, from popping? docs/transitions.md holds the tables.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include <fmt/format.h>

#include "real_data.h"
#include "reprise/deform/blend.h"
#include "reprise/graph/graph_components.h"
#include "reprise/graph/transition.h"
#include "reprise/io/database_file.h"
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

// The same of the blend as synthesis makes it.
double made_peak(const PerformanceDatabase& database, const PoissonReconstruction& poisson,
                 const Transition& transition, BlendProfile profile) {
  const MeshSequence& source = database.clip(transition.source_clip);
  const MeshSequence& target = database.clip(transition.target_clip);
  const int L = transition.half_window;
  const int first = transition.leave() < 1 ? -L : -L - 1;
  const int last = transition.arrive() + 1 < static_cast<int>(target.frame_count()) ? L + 1 : L;
  std::vector<Positions> frames(static_cast<std::size_t>(last - first + 1));
  parallel_for(0, frames.size(), [&](std::size_t i) {
    const int k = first + static_cast<int>(i);
    const double alpha = blend_weight(profile, k, L);
    if (k <= -L) {
      frames[i] = source.frame(static_cast<std::size_t>(transition.m + k));
      return;
    }
    Positions moved(static_cast<Eigen::Index>(source.vertex_count()), 3);
    transform_positions(transition.source_from_target,
                        target.frame(static_cast<std::size_t>(transition.n + k)),
                        PositionsRef(moved.data(), moved.rows(), 3));
    if (k < L) {
      Positions blended(moved.rows(), 3);
      blend_frames(poisson, source.frame(static_cast<std::size_t>(transition.m + k)),
                   PositionsView(moved.data(), moved.rows(), 3), alpha,
                   PositionsRef(blended.data(), blended.rows(), 3));
      moved = std::move(blended);
    }
    frames[i] = std::move(moved);
  });
  double peak = 0.0;
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    peak = std::max(peak, peak_of(frames[f - 1], frames[f], frames[f + 1]));
  }
  return peak;
}

// Processor time of all threads so far: what others do on the machine is not in it.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
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
  options.max_pop_ratio = std::numeric_limits<double>::infinity();  // each as it is
  const double start = cpu_seconds();
  const std::vector<Transition> transitions = find_transitions(database, matrix, options);
  const double seconds = cpu_seconds() - start;
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
      "| {} | {:.2f} | {:.2f} |\n",
      name, is_paper ? "paper_sum" : "blend_speed",
      options.profile == BlendProfile::linear ? "linear" : "smooth",
      is_paper ? std::string("-") : fmt::format("{}", options.acceleration_weight), transitions.size(),
      percentile(windows, 0.5), percentile(windows, 0.9), percentile(distances, 0.5), percentile(ratios, 0.5),
      percentile(ratios, 0.9), percentile(ratios, 1.0), std::ranges::count_if(ratios, above_one),
      percentile(own_ratios, 0.5), percentile(own_ratios, 0.9), std::ranges::count_if(own_ratios, above_one),
      percentile(seen, 0.5),
      1e3 * seconds / static_cast<double>(database.clips().size() * database.clips().size()));
}

// Share of the frames among which a walk can go on for ever and come back.
double share_of_largest_component(const PerformanceDatabase& database,
                                  const std::vector<Transition>& transitions) {
  std::vector<int> frame_counts;
  for (const MeshSequence& clip : database.clips()) {
    frame_counts.push_back(static_cast<int>(clip.frame_count()));
  }
  const GraphComponents found = find_components(frame_counts, transitions);
  if (found.components.empty()) return 0.0;
  int frames = 0;
  for (const FrameRange& range : found.components.front().ranges) frames += range.last - range.first + 1;
  return static_cast<double>(frames) / static_cast<double>(database.frame_count());
}

// What a limit on the pop ratio does: to the blends as they are made, to the number of transitions and to
// what they connect.
void measure_limit(const char* name, const PerformanceDatabase& database, const DissimilarityMatrix& matrix,
                   const PoissonReconstruction& poisson, double limit, const CapturedPeaks& captured) {
  const TransitionOptions options{.max_pop_ratio = limit};
  const std::vector<Transition> transitions = find_transitions(database, matrix, options);
  std::vector<double> estimated;
  std::vector<double> made;
  std::vector<double> windows;
  std::vector<double> costs;
  for (const Transition& transition : transitions) {
    estimated.push_back(transition.peak_acceleration / captured.pooled);
    made.push_back(made_peak(database, poisson, transition, options.profile) / captured.pooled);
    windows.push_back(transition.half_window);
    costs.push_back(100.0 * transition.cost);
  }
  const auto above = [&](double least) {
    return std::ranges::count_if(made, [&](double ratio) { return ratio > least; });
  };
  fmt::print("| {} | {} | {} | {:.0f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {} | {:.0f} % |\n",
             name, std::isinf(limit) ? std::string("none") : fmt::format("{}", limit), transitions.size(),
             percentile(windows, 0.5), percentile(costs, 0.5), percentile(estimated, 1.0),
             percentile(made, 0.5), percentile(made, 0.9), percentile(made, 1.0), above(1.0), above(1.2),
             100.0 * share_of_largest_component(database, transitions));
}

void measure_all(const char* name, const PerformanceDatabase& database) {
  const DissimilarityMatrix matrix = vertex_dissimilarity(database);
  const CapturedPeaks captured = captured_peaks(database);
  fmt::print("\n{}: {} clips, {} frames, {} vertices; captured 99th percentile {:.3f} m/frame^2\n\n", name,
             database.clips().size(), database.frame_count(), database.topology()->vertex_count,
             captured.pooled);
  fmt::print(
      "| data | criterion | profile | weight | found | L median | L 90 % | cm median | pop median | 90 % | "
      "max | > 1 | own median | 90 % | > 1 | seen | CPU ms a pair "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const BlendProfile profile : {BlendProfile::linear, BlendProfile::smooth}) {
    measure(name, database, matrix, {.criterion = WindowCriterion::paper_sum, .profile = profile}, captured);
    for (const double weight : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
      measure(name, database, matrix, {.acceleration_weight = weight, .profile = profile}, captured);
    }
  }
  fmt::print(
      "\n| data | limit | found | L median | cost median, cm | estimated max | made median | 90 % | max | > "
      "1 "
      "| > 1.2 | largest component |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const PoissonReconstruction poisson(database.topology(), database.clip(0).frame(0));
  for (const double limit : {std::numeric_limits<double>::infinity(), 1.2, 1.0, 0.9, 0.8, 0.7}) {
    measure_limit(name, database, matrix, poisson, limit, captured);
  }
}

}  // namespace
}  // namespace reprise::benchmark

// Arguments: .reprise databases to measure on; none: the real captures.
int main(int count, char** arguments) {
  using namespace reprise::benchmark;
  if (count == 1) {
    measure_all("ama", ama());
    measure_all("fashion", fashion());
  }
  for (int i = 1; i < count; ++i) {
    const std::filesystem::path path = arguments[i];
    measure_all(path.stem().c_str(), reprise::load_database(path));
  }
}
