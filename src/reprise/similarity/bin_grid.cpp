// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/bin_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// Cells whose table of distances takes 512 MB.
constexpr std::int64_t max_cell_count = 8192;
constexpr int max_turn_count = 16384;  // fine bins of the half turns are numbered in 16 bits
constexpr int max_color_bins = 256;

// Centroid of the part of a ball between two radii, two polar angles and two azimuths.
Eigen::Vector3d cell_centroid(double r0, double r1, double theta0, double theta1, double phi0, double phi1) {
  const double radius = 0.75 * (std::pow(r1, 4) - std::pow(r0, 4)) / (std::pow(r1, 3) - std::pow(r0, 3));
  const double polar = std::cos(theta0) - std::cos(theta1);  // integral of sin
  const double height = 0.5 * (std::pow(std::sin(theta1), 2) - std::pow(std::sin(theta0), 2)) / polar;
  const double sine =
      0.5 * ((theta1 - theta0) - 0.5 * (std::sin(2.0 * theta1) - std::sin(2.0 * theta0))) / polar;
  const double half_width = 0.5 * (phi1 - phi0);
  const double reach = radius * sine * std::sin(half_width) / half_width;
  const double phi = 0.5 * (phi0 + phi1);
  return {reach * std::sin(phi), radius * height, reach * std::cos(phi)};
}

// Squares of distances between all points, `scale` units a metre.
template <typename Points>
std::vector<float> square_table(const Points& points, double scale) {
  std::vector<float> table(points.size() * points.size());
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = 0; b < points.size(); ++b) {
      table[a * points.size() + b] = static_cast<float>((scale * (points[a] - points[b])).squaredNorm());
    }
  }
  return table;
}

}  // namespace

void validate(const HistogramOptions& options) {
  const auto check = [](const char* name, int value, int least, int most) {
    if (value < least || value > most) {
      throw InvalidArgument(fmt::format("{} is {}, expected {} to {}", name, value, least, most));
    }
  };
  check("radius_bins", options.radius_bins, 1, 1024);
  check("polar_bins", options.polar_bins, 1, 1024);
  check("azimuth_bins", options.azimuth_bins, 2, 1024);
  check("azimuth_refinement", options.azimuth_refinement, 1, 1024);
  if (options.azimuth_bins % 2 != 0) {
    throw InvalidArgument(fmt::format("azimuth_bins is {}, expected an even number", options.azimuth_bins));
  }
  for (const int bins : options.color_bins) check("color_bins", bins, 1, max_color_bins);
  const std::int64_t cells = std::int64_t{options.radius_bins} * options.polar_bins * options.azimuth_bins;
  if (cells > max_cell_count) {
    throw InvalidArgument(fmt::format("{} x {} x {} bins of space are {} cells, expected at most {}",
                                      options.radius_bins, options.polar_bins, options.azimuth_bins, cells,
                                      max_cell_count));
  }
  if (options.azimuth_bins * options.azimuth_refinement > max_turn_count) {
    throw InvalidArgument(fmt::format("azimuth_bins x azimuth_refinement is {}, expected at most {}",
                                      options.azimuth_bins * options.azimuth_refinement, max_turn_count));
  }
  const auto check_number = [](const char* name, double value, double least, double most) {
    if (!(value >= least && value <= most)) {
      throw InvalidArgument(fmt::format("{} is {}, expected {} to {}", name, value, least, most));
    }
  };
  check_number("voxel_size", options.voxel_size, 1e-3, 1.0);
  check_number("color_footprint", options.color_footprint, 0.0, 1.0);
  check_number("min_color_share", options.min_color_share, 0.0, 0.5);
  check_number("meters_per_color", options.meters_per_color, 0.0, 10.0);
}

BinGrid::BinGrid(const HistogramOptions& options, double max_radius, std::vector<ColorBin> palette)
    : options_(options), max_radius_(max_radius), palette_(std::move(palette)) {
  validate(options_);
  if (!(max_radius_ > 0.0 && max_radius_ <= 20.0)) {
    throw InvalidArgument(fmt::format(
        "the captured body reaches {} m from its centre of mass, expected more than 0 and at most 20 m: are "
        "its units metres?",
        max_radius_));
  }
  if (palette_.empty() || !std::ranges::is_sorted(palette_) ||
      std::ranges::adjacent_find(palette_) != palette_.end()) {
    throw InvalidArgument("palette: expected at least one colour bin, ascending, each once");
  }
  const double radius_step = max_radius_ / options_.radius_bins;
  const double polar_step = std::numbers::pi / options_.polar_bins;
  const double azimuth_step = 2.0 * std::numbers::pi / options_.azimuth_bins;
  for (int r = 0; r < options_.radius_bins; ++r) {
    for (int theta = 0; theta < options_.polar_bins; ++theta) {
      for (int phi = 0; phi < options_.azimuth_bins; ++phi) {
        cell_points_.push_back(cell_centroid(r * radius_step, (r + 1) * radius_step, theta * polar_step,
                                             (theta + 1) * polar_step, phi * azimuth_step,
                                             (phi + 1) * azimuth_step));
      }
    }
  }
  if (static_cast<std::uint64_t>(cell_points_.size()) * palette_.size() >
      static_cast<std::uint64_t>(std::numeric_limits<BinId>::max())) {
    throw InvalidArgument(fmt::format("{} cells of {} colours are more bins than can be numbered",
                                      cell_points_.size(), palette_.size()));
  }
  if (palette_.size() > max_palette_size) {
    throw InvalidArgument(fmt::format("{} colours occur, expected at most {}: take fewer colour bins",
                                      palette_.size(), max_palette_size));
  }
  std::vector<Eigen::Vector3d> colors;
  for (const ColorBin& bin : palette_) {
    Eigen::Vector3d& color = colors.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      if (bin[c] >= options_.color_bins[c]) {
        throw InvalidArgument(fmt::format("palette: bin {} of channel {}, expected fewer than {}", bin[c], c,
                                          options_.color_bins[c]));
      }
      color[static_cast<Eigen::Index>(c)] =
          options_.meters_per_color * (bin[c] + 0.5) / options_.color_bins[c];
    }
  }
  cell_table_ = square_table(cell_points_, 1.0 / distance_unit);
  color_table_ = square_table(colors, 1.0 / distance_unit);
  // Four roundings of half a unit in the last place of 24 bits, on each of the three sides of a triangle.
  const float longest =
      std::sqrt(*std::ranges::max_element(cell_table_) + *std::ranges::max_element(color_table_));
  slack_ = std::ceil(longest * 6.0F / (1 << 24)) + 2.0F;
}

std::int32_t BinGrid::distance(BinId a, BinId b) const {
  const auto cell =
      static_cast<std::size_t>(cell_of(a)) * cell_points_.size() + static_cast<std::size_t>(cell_of(b));
  const auto color =
      static_cast<std::size_t>(color_of(a)) * palette_.size() + static_cast<std::size_t>(color_of(b));
  const float root = std::sqrt(cell_table_[cell] + color_table_[color]);
  return root == 0.0F ? 0 : static_cast<std::int32_t>(root + slack_);
}

void BinGrid::distances(BinId from, std::span<const Place> others, std::int32_t* out) const {
  const float* cells = cell_table_.data() + static_cast<std::size_t>(cell_of(from)) * cell_points_.size();
  const float* colors = color_table_.data() + static_cast<std::size_t>(color_of(from)) * palette_.size();
  // In pieces of fixed size, which the compiler turns into vector instructions; these round roots as the
  // scalar one does (Eigen's do not).
  constexpr std::size_t piece = 64;
  std::array<float, piece> roots;
  std::array<std::int32_t, piece> rounded;
  const float slack = slack_;
  for (std::size_t first = 0; first < others.size(); first += piece) {
    const std::size_t count = std::min(piece, others.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      roots[k] = cells[others[first + k].cell] + colors[others[first + k].color];
    }
    std::fill(roots.begin() + static_cast<std::ptrdiff_t>(count), roots.end(), 0.0F);
    for (std::size_t k = 0; k < piece; ++k) roots[k] = std::sqrt(roots[k]);
    for (std::size_t k = 0; k < piece; ++k) rounded[k] = static_cast<std::int32_t>(roots[k] + slack);
    for (std::size_t k = 0; k < count; ++k) out[first + k] = roots[k] == 0.0F ? 0 : rounded[k];
  }
}

}  // namespace reprise
