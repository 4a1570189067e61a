// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Means of one potential over many frames at many turns: bounds of their distances at the price of a sum.

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "reprise/similarity/earth_movers_distance.h"
#include "reprise/similarity/shape_color_histogram.h"

namespace reprise {

// A frame's coarse histograms at all turns. Turning by a coarse bin only renames the bins, so there are
// 2 x azimuth_refinement different ones.
class TurnedFrame {
 public:
  TurnedFrame(const ShapeColorHistograms& histograms, std::size_t frame_idx);

 private:
  friend class PotentialTable;
  struct Entry {
    std::int32_t slot = 0;  // of a table in which every ring of azimuths lies twice in a row
    std::int32_t mass = 0;
  };
  std::vector<std::vector<Entry>> phases_;
  std::int64_t total_ = 0;
};

class PotentialTable {
 public:
  explicit PotentialTable(std::shared_ptr<const BinGrid> grid);

  // Values are computed where and when they are asked for.
  void set(const Potential& potential);

  // Mean of the potential over a frame turned by `half_turns`, metres.
  double mean(const TurnedFrame& frame, int half_turns);

 private:
  void fill(std::int32_t slot);

  std::shared_ptr<const BinGrid> grid_;
  std::vector<std::int64_t> values_;
  PotentialFunction potential_;
};

}  // namespace reprise
