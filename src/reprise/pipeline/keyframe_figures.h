// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The figures of a row of HSSMG Table III: one pair of key-frames, or all pairs of a database.

#pragma once

#include <string>
#include <vector>

#include "reprise/pipeline/keyframe_samples.h"
#include "reprise/pipeline/paper_table.h"

namespace reprise {

struct GridResult {
  KeyframeGrid grid;
  const PaperRow* paper = nullptr;  // null: the paper has no such row
  std::vector<GridSample> samples;
};

// Of some values; zeros if there are none.
struct Spread {
  std::size_t count = 0;
  double min = 0.0;
  double mean = 0.0;
  double deviation = 0.0;  // from the mean
  double rms = 0.0;
  double median = 0.0;
  double max = 0.0;
};
Spread spread_of(std::vector<double> values);

struct GridFigures {
  std::size_t targets = 0;
  std::size_t reachable = 0;
  std::size_t proved = 0;  // gap 0
  double largest_gap = 0.0;
  // Metres and seconds, over the reachable targets ...
  Spread distance_error, time_error;
  Spread corrected_distance_error, corrected_time_error;
  std::size_t met = 0;  // targets that the correction meets to a centimetre and a frame
  // ... and over all targets.
  Spread all_distance_error, all_time_error;
  Spread smoothness, normalized_smoothness;  // metres, over all paths with a transition
  Spread cpu;                                // seconds of the search, without what the targets share
  double preparation_cpu = 0.0;              // seconds, in total
  double total_cpu() const { return preparation_cpu + cpu.mean * static_cast<double>(cpu.count); }
};
GridFigures figures_of(const std::vector<const GridResult*>& results);

// Largest differences between prediction and frames, and how natural the frames are.
struct SampleFigures {
  std::size_t count = 0;
  double distance_difference = 0.0;  // metres
  int frame_difference = 0;
  Spread distance_error, time_error;  // of the frames, over the samples with a reachable target
  Spread pop_ratio;
  Spread drift, blend_drift;  // of feet, cm/s: of all frames, and inside blends
  Spread shown_drift;         // the captured clips' own in the frames that are shown
  Spread drift_ratio;         // drift over that of all captured frames
  Spread stretch_ratio;       // edge stretch over that of the captured clips
};
SampleFigures sample_figures(const std::vector<const GridResult*>& results, SampleVariant variant);

}  // namespace reprise
