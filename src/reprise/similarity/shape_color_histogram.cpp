// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/shape_color_histogram.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/similarity/voxel_counter.h"

namespace reprise {
namespace {

// Runs body(frame_idx) for all frames; of several that fail, the first is reported.
template <typename Body>
void for_frames(const VoxelCounter& counter, Progress& progress, const Body& body) {
  std::vector<std::string> errors(counter.frame_count());
  parallel_for(0, errors.size(), [&](std::size_t f) {
    try {
      body(f);
    } catch (const InvalidArgument& error) {
      errors[f] = error.what();
    }
    progress.advance();
  });
  for (std::size_t f = 0; f < errors.size(); ++f) {
    if (!errors[f].empty()) throw InvalidArgument(fmt::format("{}: {}", counter.name(f), errors[f]));
  }
}

// A set of colours below 128, in registers: most palettes are this small.
class SmallColorSet {
 public:
  explicit SmallColorSet(std::size_t /*color_count*/) {}

  void insert(std::size_t color) {
    const std::uint64_t bit = std::uint64_t{1} << (color % 64);
    const std::uint64_t is_high = color / 64;  // 0 or 1: without branches, which colours make unpredictable
    low_ |= bit & (is_high - 1);
    high_ |= bit & (0 - is_high);
  }

  // Calls f for all members, ascending, and empties the set.
  template <typename F>
  void drain(const F& f) {
    for (; low_ != 0; low_ &= low_ - 1) f(static_cast<std::size_t>(std::countr_zero(low_)));
    for (; high_ != 0; high_ &= high_ - 1) f(64 + static_cast<std::size_t>(std::countr_zero(high_)));
  }

 private:
  std::uint64_t low_ = 0;
  std::uint64_t high_ = 0;
};

// The same for any number of colours.
class ColorSet {
 public:
  explicit ColorSet(std::size_t color_count) : words_((color_count + 63) / 64, 0) {}

  void insert(std::size_t color) { words_[color / 64] |= std::uint64_t{1} << (color % 64); }

  template <typename F>
  void drain(const F& f) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t bits = std::exchange(words_[w], 0); bits != 0; bits &= bits - 1) {
        f(w * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      }
    }
  }

 private:
  std::vector<std::uint64_t> words_;
};

// Counts turned entries in coarse cells.
template <typename Set>
void rebin(const std::vector<FineHistogram::Entry>& entries, const BinGrid& grid, int shift,
           Signature& signature) {
  const int azimuth_bins = grid.options().azimuth_bins;
  const int fine_count = grid.half_turn_count();
  const int fine_per_bin = fine_count / azimuth_bins;
  // There are at most as many bins as entries.
  signature.bins.resize(entries.size());
  signature.masses.resize(entries.size());
  BinId* bin_out = signature.bins.data();
  std::int32_t* mass_out = signature.masses.data();
  std::int64_t total = 0;

  // Of the cell at hand: masses by colour, and the colours that have any.
  thread_local std::vector<std::int32_t> mass_of_color;
  mass_of_color.assign(static_cast<std::size_t>(grid.color_count()), 0);
  std::int32_t* masses = mass_of_color.data();
  Set present(mass_of_color.size());
  const auto flush = [&](int cell) {
    const BinId first = grid.bin(cell, 0);
    present.drain([&](std::size_t color) {
      *bin_out++ = first + static_cast<BinId>(color);
      *mass_out++ = masses[color];
      total += masses[color];
      masses[color] = 0;
    });
  };

  // A turned ring begins with the entries that the turn takes beyond the full circle.
  using Iterator = const FineHistogram::Entry*;
  const Iterator end = entries.data() + entries.size();
  for (Iterator ring = entries.data(); ring != end;) {
    const std::uint16_t cell_ring = ring->cell_ring;
    const int first_cell = cell_ring * azimuth_bins;
    Iterator split = ring;
    while (split != end && split->cell_ring == cell_ring && split->azimuth + shift < fine_count) ++split;
    Iterator last = split;
    while (last != end && last->cell_ring == cell_ring) ++last;
    int azimuth = -1;
    int boundary = 0;  // fine azimuth at which the coarse one ends
    Iterator entry = split == last ? ring : split;
    int turn = split == last ? shift : shift - fine_count;
    for (Iterator remaining = ring; remaining != last; ++remaining) {
      const int fine = entry->azimuth + turn;
      if (fine >= boundary) {
        if (azimuth >= 0) flush(first_cell + azimuth);
        azimuth = fine / fine_per_bin;
        boundary = (azimuth + 1) * fine_per_bin;
      }
      masses[entry->color] += entry->count;
      present.insert(entry->color);
      if (++entry == last) {
        entry = ring;
        turn = shift;
      }
    }
    flush(first_cell + azimuth);
    ring = last;
  }
  const auto size = static_cast<std::size_t>(bin_out - signature.bins.data());
  signature.bins.resize(size);
  signature.masses.resize(size);
  signature.total = total;
}

// The colour bins that histograms have, and which of them stands for each that occurs.
class Palette {
 public:
  Palette(const VoxelCounter& counter, const std::vector<FrameCount>& counts,
          const HistogramOptions& options) {
    std::map<ColorCode, std::uint64_t> voxels;
    std::uint64_t total = 0;
    for (const FrameCount& count : counts) {
      std::vector<std::uint64_t> of_frame(count.colors.size(), 0);
      for (const FineHistogram::Entry& entry : count.entries) of_frame[entry.color] += entry.count;
      for (std::size_t c = 0; c < of_frame.size(); ++c) {
        voxels[count.colors[c]] += of_frame[c];
        total += of_frame[c];
      }
    }
    const auto least = options.min_color_share * static_cast<double>(total);
    std::vector<ColorCode> kept;
    for (const auto& [code, number] : voxels) {
      if (static_cast<double>(number) >= least) kept.push_back(code);
    }
    if (kept.empty()) {  // many colours, all of them rare
      kept.push_back(std::ranges::max_element(voxels, {}, [](const auto& v) { return v.second; })->first);
    }
    for (const ColorCode code : kept) bins_.push_back(counter.color_bin(code));
    for (const auto& [code, number] : voxels) {
      const BinGrid::ColorBin bin = counter.color_bin(code);
      const auto distance = [&](const BinGrid::ColorBin& other) {
        double sum = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
          const double step = (static_cast<double>(bin[c]) - other[c]) / options.color_bins[c];
          sum += step * step;
        }
        return sum;
      };
      color_of_[code] =
          static_cast<std::uint16_t>(std::ranges::min_element(bins_, {}, distance) - bins_.begin());
    }
  }

  const std::vector<BinGrid::ColorBin>& bins() const { return bins_; }

  // From the colours of the frame to those of the palette.
  void rename(FrameCount& count) const {
    std::vector<std::uint16_t> color_of;
    for (const ColorCode code : count.colors) color_of.push_back(color_of_.at(code));
    for (FineHistogram::Entry& entry : count.entries) entry.color = color_of[entry.color];
    const auto place = [](const FineHistogram::Entry& e) {
      return std::tuple(e.cell_ring, e.azimuth, e.color);
    };
    std::ranges::sort(count.entries, {}, place);
    // Entries that have become equal are one, as far as its count goes.
    std::size_t last = 0;
    for (std::size_t i = 1; i < count.entries.size(); ++i) {
      FineHistogram::Entry& kept = count.entries[last];
      const FineHistogram::Entry entry = count.entries[i];
      if (place(kept) != place(entry)) {
        count.entries[++last] = entry;
        continue;
      }
      const int sum = kept.count + entry.count;
      kept.count = static_cast<std::uint16_t>(std::min<int>(sum, std::numeric_limits<std::uint16_t>::max()));
      if (sum > kept.count) {
        count.entries[++last] = entry;
        count.entries[last].count = static_cast<std::uint16_t>(sum - kept.count);
      }
    }
    count.entries.resize(last + 1);
    count.entries.shrink_to_fit();  // they stay
  }

 private:
  std::vector<BinGrid::ColorBin> bins_;
  std::map<ColorCode, std::uint16_t> color_of_;
};

}  // namespace

ShapeColorHistograms::ShapeColorHistograms(const PerformanceDatabase& database,
                                           const HistogramOptions& options) {
  validate(options);
  if (database.empty()) {
    throw InvalidArgument("histograms of a database: expected at least one clip, found none");
  }
  const VoxelCounter counter(database, options);
  Progress progress("cutting frames into voxels", 2 * counter.frame_count());

  std::vector<FrameMeasure> measures(counter.frame_count());
  for_frames(counter, progress, [&](std::size_t f) { measures[f] = counter.measure(f); });
  double max_radius = 0.0;
  for (const FrameMeasure& measure : measures) max_radius = std::max(max_radius, measure.radius);
  const auto reversed = std::ranges::find_if(measures, &FrameMeasure::partly_reversed);
  if (reversed != measures.end()) {
    spdlog::warn(
        "{} of {} frames, the first is {}: part of the surface is inside out, so that it encloses nothing "
        "and counts by itself alone",
        std::ranges::count_if(measures, &FrameMeasure::partly_reversed), measures.size(),
        counter.name(static_cast<std::size_t>(reversed - measures.begin())));
  }

  std::vector<FrameCount> counts(counter.frame_count());
  for_frames(counter, progress,
             [&](std::size_t f) { counts[f] = counter.count(f, measures[f], max_radius); });

  const Palette palette(counter, counts, options);
  grid_ = std::make_shared<const BinGrid>(options, max_radius, palette.bins());
  frames_.resize(counts.size());
  parallel_for(0, counts.size(), [&](std::size_t f) {
    palette.rename(counts[f]);
    frames_[f] = {.entries = std::move(counts[f].entries), .yaw = measures[f].yaw};
  });
}

void ShapeColorHistograms::signature(std::size_t frame_idx, int half_turns, Signature& signature) const {
  const int fine_count = grid_->half_turn_count();
  const int shift = (half_turns % fine_count + fine_count) % fine_count;
  if (grid_->color_count() <= 128) {
    rebin<SmallColorSet>(frames_[frame_idx].entries, *grid_, shift, signature);
  } else {
    rebin<ColorSet>(frames_[frame_idx].entries, *grid_, shift, signature);
  }
}

}  // namespace reprise
