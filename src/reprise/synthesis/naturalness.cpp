// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/naturalness.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/synthesis/frame_sources.h"
#include "reprise/synthesis/percentile.h"

namespace reprise {
namespace {

// Counts of edge length ratios on a logarithmic scale: a percentile of any number of frames in constant
// memory, to better than 0.02 %.
class RatioHistogram {
 public:
  RatioHistogram() : counts_(bins, 0) {}

  void add(double ratio) {
    double position = (std::log2(ratio) + octaves) / (2.0 * octaves) * static_cast<double>(bins);
    if (std::isnan(position))
      position = static_cast<double>(bins);  // a length that is no number is no small one
    const auto bin = static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(bins - 1)));
    ++counts_[bin];
    ++total_;
  }
  double percentile(double share) const {
    const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total_)));
    std::uint64_t seen = 0;
    for (std::size_t b = 0; b < bins; ++b) {
      seen += counts_[b];
      if (seen >= rank && seen > 0) {
        return std::exp2((static_cast<double>(b) + 0.5) / static_cast<double>(bins) * 2.0 * octaves -
                         octaves);
      }
    }
    return 0.0;
  }

 private:
  static constexpr std::size_t bins = std::size_t{1} << 16U;
  static constexpr double octaves = 8.0;
  std::vector<std::uint64_t> counts_;
  std::uint64_t total_ = 0;
};

std::vector<std::pair<std::int32_t, std::int32_t>> unique_edges(const Topology& topology) {
  std::set<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& [a, b, c] : topology.triangles) {
    edges.insert({std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)});
  }
  return {edges.begin(), edges.end()};
}

class EdgeStretch {
 public:
  EdgeStretch(const Topology& topology, const PositionsView& reference) : edges_(unique_edges(topology)) {
    for (const auto& [a, b] : edges_) {
      lengths_.push_back((reference.row(a) - reference.row(b)).cast<double>().norm());
    }
  }

  // 99th percentile of length over reference length. Edges without reference length say nothing and are left
  // out.
  double p99(const std::vector<const MeshSequence*>& sequences) const {
    constexpr double shortest = 1e-9;
    RatioHistogram total;
    for (const MeshSequence* sequence : sequences) {
      for (std::size_t f = 0; f < sequence->frame_count(); ++f) {
        throw_if_interrupted();
        const PositionsView frame = sequence->frame(f);
        for (std::size_t e = 0; e < edges_.size(); ++e) {
          if (lengths_[e] < shortest) continue;
          const auto& [a, b] = edges_[e];
          const double length = (frame.row(a) - frame.row(b)).cast<double>().norm();
          total.add(std::max(length, shortest) / lengths_[e]);
        }
      }
    }
    return total.percentile(0.99);
  }

 private:
  std::vector<std::pair<std::int32_t, std::int32_t>> edges_;
  std::vector<double> lengths_;
};

// Mean of speeds, cm/s.
struct MeanSpeed {
  double sum = 0.0;
  std::size_t count = 0;
  double mean() const { return count == 0 ? 0.0 : 100.0 * sum / static_cast<double>(count); }
};

// Adds the horizontal speeds of the given vertices from `now` to `next`.
void measure(const std::vector<std::int32_t>& vertices, const PositionsView& now, const PositionsView& next,
             double frames_per_second, MeanSpeed& speed) {
  for (const std::int32_t v : vertices) {
    speed.sum +=
        frames_per_second * std::hypot(static_cast<double>(next(v, 0)) - static_cast<double>(now(v, 0)),
                                       static_cast<double>(next(v, 2)) - static_cast<double>(now(v, 2)));
    ++speed.count;
  }
}

}  // namespace

Naturalness evaluate_naturalness(const MeshSequence& result, const PerformanceDatabase& database,
                                 const ContactOptions& options) {
  const std::vector<FrameSources> frames = frame_sources(result, database);
  const GroundContacts contacts(database, options);
  Naturalness report;

  const std::vector<double> captured_peaks = captured_peak_accelerations(database);
  report.captured_acceleration_p99 = percentile(captured_peaks, 0.99);
  // A frame belongs to a blend's acceleration if any of its three samples is blended: the joins at both ends
  // count.
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    if (frames[f - 1].is_blend() || frames[f].is_blend() || frames[f + 1].is_blend()) {
      report.peak_acceleration = std::max(report.peak_acceleration, peak_acceleration(result, f));
    }
  }
  if (report.captured_acceleration_p99 > 0.0) {
    report.pop_ratio = report.peak_acceleration / report.captured_acceleration_p99;
    report.captured_pop_ratio = std::ranges::max(captured_peaks) / report.captured_acceleration_p99;
  }

  MeanSpeed drift;
  MeanSpeed blend_drift;
  MeanSpeed shown_drift;
  for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
    const FrameId captured = frames[f].heavier().id;
    const std::vector<std::int32_t>& touching = contacts.touching(captured.clip_idx, captured.frame_idx);
    if (touching.empty()) continue;
    MeanSpeed here;
    measure(touching, result.frame(f), result.frame(f + 1), result.frames_per_second(), here);
    const MeshSequence& clip = database.clip(captured.clip_idx);
    measure(touching, clip.frame(captured.frame_idx), clip.frame(captured.frame_idx + 1),
            clip.frames_per_second(), shown_drift);
    drift.sum += here.sum;
    drift.count += here.count;
    if (frames[f].is_blend() || frames[f + 1].is_blend()) {
      blend_drift.sum += here.sum;
      blend_drift.count += here.count;
    }
  }
  report.foot_drift = drift.mean();
  report.blend_foot_drift = blend_drift.mean();
  report.shown_foot_drift = shown_drift.mean();
  MeanSpeed captured_drift;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const MeshSequence& clip = database.clip(c);
    for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
      measure(contacts.touching(c, f), clip.frame(f), clip.frame(f + 1), clip.frames_per_second(),
              captured_drift);
    }
  }
  report.captured_foot_drift = captured_drift.mean();

  const EdgeStretch stretch(*database.topology(), database.clip(0).frame(0));
  report.edge_stretch_p99 = stretch.p99({&result});
  std::vector<const MeshSequence*> captured_clips;
  for (const MeshSequence& clip : database.clips()) captured_clips.push_back(&clip);
  report.captured_edge_stretch_p99 = stretch.p99(captured_clips);
  return report;
}

}  // namespace reprise
