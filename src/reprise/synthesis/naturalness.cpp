// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthesis/naturalness.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/graph/captured_acceleration.h"
#include "reprise/synthesis/frame_sources.h"
#include "reprise/synthesis/percentile.h"

namespace reprise {
namespace {

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

double stretch_p99(const std::vector<const MeshSequence*>& sequences,
                   const std::shared_ptr<const ReferenceEdges>& edges) {
  EdgeStretch stretch(edges);
  for (const MeshSequence* sequence : sequences) {
    for (std::size_t f = 0; f < sequence->frame_count(); ++f) {
      throw_if_interrupted();
      stretch.add(sequence->frame(f));
    }
  }
  return stretch.percentile(0.99);
}

}  // namespace

CapturedNaturalness captured_naturalness(const PerformanceDatabase& database, const GroundContacts& contacts,
                                         const std::shared_ptr<const ReferenceEdges>& edges) {
  CapturedNaturalness captured;
  const std::vector<double> peaks = captured_peak_accelerations(database);
  captured.acceleration_p99 = percentile(peaks, 0.99);
  if (captured.acceleration_p99 > 0.0) {
    captured.pop_ratio = std::ranges::max(peaks) / captured.acceleration_p99;
  }
  MeanSpeed drift;
  std::vector<const MeshSequence*> clips;
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    const MeshSequence& clip = database.clip(c);
    clips.push_back(&clip);
    for (std::size_t f = 0; f + 1 < clip.frame_count(); ++f) {
      measure(contacts.touching(c, f), clip.frame(f), clip.frame(f + 1), clip.frames_per_second(), drift);
    }
  }
  captured.foot_drift = drift.mean();
  captured.edge_stretch_p99 = stretch_p99(clips, edges);
  return captured;
}

Naturalness evaluate_naturalness(const MeshSequence& result, const PerformanceDatabase& database,
                                 const ContactOptions& options) {
  const std::vector<FrameSources> frames = frame_sources(result, database);
  const GroundContacts contacts(database, options);
  Naturalness report;

  const auto edges = std::make_shared<const ReferenceEdges>(*database.topology(), database.clip(0).frame(0));
  const CapturedNaturalness captured = captured_naturalness(database, contacts, edges);
  report.captured_acceleration_p99 = captured.acceleration_p99;
  report.captured_pop_ratio = captured.pop_ratio;
  report.captured_foot_drift = captured.foot_drift;
  report.captured_edge_stretch_p99 = captured.edge_stretch_p99;
  // A frame belongs to a blend's acceleration if any of its three samples is blended: the joins at both ends
  // count.
  for (std::size_t f = 1; f + 1 < frames.size(); ++f) {
    if (frames[f - 1].is_blend() || frames[f].is_blend() || frames[f + 1].is_blend()) {
      report.peak_acceleration = std::max(report.peak_acceleration, peak_acceleration(result, f));
    }
  }
  if (report.captured_acceleration_p99 > 0.0) {
    report.pop_ratio = report.peak_acceleration / report.captured_acceleration_p99;
  }

  MeanSpeed drift;
  MeanSpeed blend_drift;
  MeanSpeed shown_drift;
  for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
    const FrameId shown = frames[f].heavier().id;
    const std::vector<std::int32_t>& touching = contacts.touching(shown.clip_idx, shown.frame_idx);
    if (touching.empty()) continue;
    MeanSpeed here;
    measure(touching, result.frame(f), result.frame(f + 1), result.frames_per_second(), here);
    const MeshSequence& clip = database.clip(shown.clip_idx);
    measure(touching, clip.frame(shown.frame_idx), clip.frame(shown.frame_idx + 1), clip.frames_per_second(),
            shown_drift);
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
  report.edge_stretch_p99 = stretch_p99({&result}, edges);
  return report;
}

}  // namespace reprise
