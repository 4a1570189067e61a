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
#include "reprise/core/parallel.h"

namespace reprise {
namespace {

// Largest vertex acceleration at a frame with both neighbours, m/frame^2.
double peak_acceleration(const MeshSequence& sequence, std::size_t frame_idx) {
  const PositionsView before = sequence.frame(frame_idx - 1);
  const PositionsView here = sequence.frame(frame_idx);
  const PositionsView after = sequence.frame(frame_idx + 1);
  return std::sqrt(static_cast<double>((after - 2.0F * here + before).rowwise().squaredNorm().maxCoeff()));
}

// Value below which a share of the values lies, by the nearest-rank rule. Zero for no values.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<double> captured_peak_accelerations(const PerformanceDatabase& database) {
  std::vector<double> peaks;
  for (const MeshSequence& clip : database.clips()) {
    if (clip.frame_count() < 3) continue;
    std::vector<double> of_clip(clip.frame_count() - 2);
    parallel_for(0, of_clip.size(), [&](std::size_t f) { of_clip[f] = peak_acceleration(clip, f + 1); });
    peaks.insert(peaks.end(), of_clip.begin(), of_clip.end());
  }
  return peaks;
}

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

class ContactDetector {
 public:
  ContactDetector(const PerformanceDatabase& database, const NaturalnessOptions& options)
      : options_(options) {
    for (const MeshSequence& clip : database.clips()) {
      std::vector<double> lowest(clip.frame_count());
      for (std::size_t f = 0; f < lowest.size(); ++f)
        lowest[f] = static_cast<double>(clip.frame(f).col(1).minCoeff());
      // Not the very lowest point: one bad frame of a capture must not move the ground.
      ground_.push_back(percentile(lowest, 0.05));
    }
  }

  // Adds the horizontal speeds, from `now` to `next`, of the vertices that are in contact at a captured
  // frame. `captured_now`, `captured_next`: that frame and the one after it in its clip.
  void measure(std::size_t clip_idx, const PositionsView& captured_now, const PositionsView& captured_next,
               const PositionsView& now, const PositionsView& next, double frames_per_second,
               MeanSpeed& speed) const {
    const auto horizontal_speed = [&](const PositionsView& a, const PositionsView& b, Eigen::Index v) {
      return frames_per_second * std::hypot(static_cast<double>(b(v, 0)) - static_cast<double>(a(v, 0)),
                                            static_cast<double>(b(v, 2)) - static_cast<double>(a(v, 2)));
    };
    const double highest = ground_[clip_idx] + options_.contact_height;
    for (Eigen::Index v = 0; v < captured_now.rows(); ++v) {
      if (static_cast<double>(captured_now(v, 1)) > highest ||
          static_cast<double>(captured_next(v, 1)) > highest ||
          horizontal_speed(captured_now, captured_next, v) > options_.contact_speed) {
        continue;
      }
      speed.sum += horizontal_speed(now, next, v);
      ++speed.count;
    }
  }

 private:
  NaturalnessOptions options_;
  std::vector<double> ground_;  // height of the ground under each clip
};

struct ResultFrame {
  std::size_t clip_idx = 0;  // the heavier clip of the frame
  std::size_t frame_idx = 0;
  bool is_blend = false;
};

std::vector<ResultFrame> resolve_origins(const MeshSequence& result, const PerformanceDatabase& database) {
  if (result.origins().empty()) {
    throw InvalidArgument(
        fmt::format("'{}' has no origins: expected motion generated by this program", result.name()));
  }
  const std::string difference =
      first_difference(*result.topology(), *database.topology(), "the animation", "the database");
  if (!difference.empty()) throw InvalidArgument(difference);
  const auto resolve = [&](const std::string& clip, std::int32_t frame_idx) {
    return database.parse_frame(fmt::format("{}:{}", clip, frame_idx));
  };
  std::vector<ResultFrame> frames;
  for (const FrameOrigin& origin : result.origins()) {
    FrameId heavier = resolve(origin.clip, origin.frame_idx);
    if (origin.is_blend()) {
      const FrameId partner = resolve(origin.partner_clip, origin.partner_frame_idx);
      if (origin.partner_weight > 0.5) heavier = partner;
    }
    frames.push_back({heavier.clip_idx, heavier.frame_idx, origin.is_blend()});
  }
  return frames;
}

}  // namespace

Naturalness evaluate_naturalness(const MeshSequence& result, const PerformanceDatabase& database,
                                 const NaturalnessOptions& options) {
  if (!(options.contact_height >= 0.0) || !std::isfinite(options.contact_height)) {
    throw InvalidArgument(
        fmt::format("contact height {} m: expected a finite height from 0", options.contact_height));
  }
  if (!(options.contact_speed > 0.0) || !std::isfinite(options.contact_speed)) {
    throw InvalidArgument(
        fmt::format("contact speed {} m/s: expected a finite speed above 0", options.contact_speed));
  }
  const std::vector<ResultFrame> frames = resolve_origins(result, database);
  Naturalness report;

  const std::vector<double> captured_peaks = captured_peak_accelerations(database);
  report.captured_acceleration_p99 = percentile(captured_peaks, 0.99);
  // A frame belongs to a blend's acceleration if any of its three samples is blended: the joins at both ends
  // count.
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    if (frames[f - 1].is_blend || frames[f].is_blend || frames[f + 1].is_blend) {
      report.peak_acceleration = std::max(report.peak_acceleration, peak_acceleration(result, f));
    }
  }
  if (report.captured_acceleration_p99 > 0.0) {
    report.pop_ratio = report.peak_acceleration / report.captured_acceleration_p99;
    report.captured_pop_ratio = std::ranges::max(captured_peaks) / report.captured_acceleration_p99;
  }

  const ContactDetector contacts(database, options);
  MeanSpeed drift;
  MeanSpeed blend_drift;
  for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
    const MeshSequence& clip = database.clip(frames[f].clip_idx);
    const std::size_t captured = frames[f].frame_idx;
    if (captured + 1 >= clip.frame_count()) continue;
    MeanSpeed here;
    contacts.measure(frames[f].clip_idx, clip.frame(captured), clip.frame(captured + 1), result.frame(f),
                     result.frame(f + 1), result.frames_per_second(), here);
    drift.sum += here.sum;
    drift.count += here.count;
    if (frames[f].is_blend || frames[f + 1].is_blend) {
      blend_drift.sum += here.sum;
      blend_drift.count += here.count;
    }
  }
  report.foot_drift = drift.mean();
  report.blend_foot_drift = blend_drift.mean();
  MeanSpeed captured_drift;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const MeshSequence& clip = database.clip(c);
    for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
      contacts.measure(c, clip.frame(f), clip.frame(f + 1), clip.frame(f), clip.frame(f + 1),
                       clip.frames_per_second(), captured_drift);
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
