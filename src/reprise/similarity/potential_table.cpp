// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/potential_table.h"

#include <algorithm>
#include <limits>

namespace reprise {
namespace {

constexpr std::int64_t unknown = std::numeric_limits<std::int64_t>::min();

// Slots: ring, azimuth (twice round), colour.
std::int32_t slot_of(const BinGrid& grid, BinId bin) {
  const int azimuths = grid.options().azimuth_bins;
  const int cell = grid.cell_of(bin);
  return ((cell / azimuths) * 2 * azimuths + cell % azimuths) * grid.color_count() + grid.color_of(bin);
}

}  // namespace

TurnedFrame::TurnedFrame(const ShapeColorHistograms& histograms, std::size_t frame_idx) {
  const BinGrid& grid = histograms.grid();
  Signature signature;
  for (int phase = 0; phase < 2 * grid.options().azimuth_refinement; ++phase) {
    histograms.signature(frame_idx, phase, signature);
    std::vector<Entry>& entries = phases_.emplace_back();
    for (std::size_t k = 0; k < signature.size(); ++k) {
      entries.push_back({slot_of(grid, signature.bins[k]), signature.masses[k]});
    }
    total_ = signature.total;
  }
}

PotentialTable::PotentialTable(std::shared_ptr<const BinGrid> grid)
    : grid_(std::move(grid)), potential_(grid_) {}

void PotentialTable::set(const Potential& potential) {
  values_.assign(2 * static_cast<std::size_t>(grid_->cell_count()) * grid_->palette().size(), unknown);
  potential_.set(potential);
  const int second_round = grid_->options().azimuth_bins * grid_->color_count();
  for (std::size_t k = 0; k < potential.bins.size(); ++k) {
    const auto slot = static_cast<std::size_t>(slot_of(*grid_, potential.bins[k]));
    values_[slot] = potential.values[k];
    values_[slot + static_cast<std::size_t>(second_round)] = potential.values[k];
  }
}

void PotentialTable::fill(std::int32_t slot) {
  const int azimuths = grid_->options().azimuth_bins;
  const int colors = grid_->color_count();
  const int color = slot % colors;
  const int azimuth = slot / colors % (2 * azimuths) % azimuths;
  const int ring = slot / colors / (2 * azimuths);
  const std::int64_t value = potential_(grid_->bin(ring * azimuths + azimuth, color));
  const int first = (ring * 2 * azimuths + azimuth) * colors + color;
  values_[static_cast<std::size_t>(first)] = value;
  values_[static_cast<std::size_t>(first + azimuths * colors)] = value;
}

double PotentialTable::mean(const TurnedFrame& frame, int half_turns) {
  const int phases = static_cast<int>(frame.phases_.size());
  const int around = grid_->half_turn_count();
  const int turn = ((half_turns % around) + around) % around;
  const std::int32_t shift = turn / phases * grid_->color_count();
  std::int64_t sum = 0;
  for (const TurnedFrame::Entry& entry : frame.phases_[static_cast<std::size_t>(turn % phases)]) {
    const std::int32_t slot = entry.slot + shift;
    if (values_[static_cast<std::size_t>(slot)] == unknown) fill(slot);
    sum += entry.mass * values_[static_cast<std::size_t>(slot)];
  }
  return static_cast<double>(sum) / static_cast<double>(frame.total_) * BinGrid::distance_unit;
}

}  // namespace reprise
