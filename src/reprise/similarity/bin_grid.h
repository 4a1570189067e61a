// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The cells that shape-colour histograms count in, and the distances between them (HSSMG 4.1).

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace reprise {

struct HistogramOptions {
  // Bins of the spherical coordinates about the centre of mass (r, theta, phi) and of R, G, B; the defaults
  // are the paper's.
  int radius_bins = 5;
  int polar_bins = 10;    // theta, from straight up to straight down
  int azimuth_bins = 20;  // phi, about the vertical axis; even
  std::array<int, 3> color_bins = {10, 10, 10};
  // Two frames are compared at azimuth_bins x azimuth_refinement turns about the vertical axis.
  int azimuth_refinement = 10;
  double voxel_size = 0.02;       // metres
  double meters_per_color = 0.5;  // distance of two colours that differ by 1 (black to full) in one channel
  // Colours are averaged along the surface of the first frame over about this radius, metres; 0: over about a
  // voxel. Patterns finer than a cell of space make no difference between poses, but noise.
  double color_footprint = 0.1;
  // Colour bins that hold a smaller share of the database's voxels are counted in the nearest frequent one;
  // 0: none is. Transport problems grow with the number of colours, rare ones hardly change their cost.
  double min_color_share = 0.05;
  bool use_color = true;  // false: the paper's "shape only" metric
};

// Throws `InvalidArgument` naming the option that is out of range.
void validate(const HistogramOptions& options);

// A cell of space together with a colour of the palette: cell * palette size + colour.
using BinId = std::int32_t;

// What all histograms of a database share. A cell of space is (radius * polar_bins + polar) * azimuth_bins +
// azimuth; phi = 0 is +Z, and grows towards +X as a positive yaw does.
class BinGrid {
 public:
  using ColorBin = std::array<std::uint16_t, 3>;

  static constexpr std::size_t max_palette_size = 4096;

  // `max_radius`: outer end of the last radius bin, metres, positive. `palette`: the colour bins that occur,
  // ascending; one entry of zeros when colour is not used. Throws `InvalidArgument`, also if there are more
  // bins than 32 bits can name.
  BinGrid(const HistogramOptions& options, double max_radius, std::vector<ColorBin> palette);

  const HistogramOptions& options() const { return options_; }
  double max_radius() const { return max_radius_; }
  const std::vector<ColorBin>& palette() const { return palette_; }
  int cell_count() const { return static_cast<int>(cell_points_.size()); }
  int color_count() const { return static_cast<int>(palette_.size()); }
  BinId bin(int cell, int color) const { return cell * color_count() + color; }
  int cell_of(BinId bin) const { return bin / color_count(); }
  int color_of(BinId bin) const { return bin % color_count(); }

  // Turns two frames are compared at, and turns a histogram can be asked for: twice as many, so that half of
  // any of the former is a whole number of the latter.
  int turn_count() const { return options_.azimuth_bins * options_.azimuth_refinement; }
  int half_turn_count() const { return 2 * turn_count(); }
  // The turn at a position of the circle (any whole number), in (-turn_count / 2, turn_count / 2].
  int turn_at(int position) const {
    const int turns = turn_count();
    const int turn = ((position % turns) + turns) % turns;
    return turn <= turns / 2 ? turn : turn - turns;
  }

  // Centroid of the volume of a cell, metres.
  const Eigen::Vector3d& cell_point(int cell) const { return cell_points_[static_cast<std::size_t>(cell)]; }

  // Ground distances are whole multiples of this many metres (60 nm): with whole masses, optimum and
  // certificate of a transport problem agree to the last bit.
  static constexpr double distance_unit = 1.0 / (1 << 24);

  // Euclidean distance of positions (metres) and colours (times `meters_per_color`), in units; for different
  // bins a few units (about 1 um) more, so that the triangle inequality survives the rounding.
  std::int32_t distance(BinId a, BinId b) const;
  // A bin taken apart, for loops over many.
  struct Place {
    std::int32_t cell = 0;
    std::int32_t color = 0;
  };
  Place place(BinId bin) const { return {cell_of(bin), color_of(bin)}; }
  // Distances from a bin to many. `out` has as many entries as `others`.
  void distances(BinId from, std::span<const Place> others, std::int32_t* out) const;

 private:
  HistogramOptions options_;
  double max_radius_;
  std::vector<ColorBin> palette_;
  std::vector<Eigen::Vector3d> cell_points_;
  // Squares of distances in units: cells x cells, colours x colours.
  std::vector<float> cell_table_;
  std::vector<float> color_table_;
  float slack_ = 0.0F;  // units on top of every distance but zero: more than single precision errs by
};

}  // namespace reprise
