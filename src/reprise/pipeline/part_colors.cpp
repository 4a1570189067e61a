// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/part_colors.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/deform/part_hierarchy.h"
#include "reprise/io/database_file.h"

namespace reprise {
namespace {

// sRGB from 0 to 1. Hues a golden angle apart differ however many parts there are.
Eigen::Array3d color_of_part(std::size_t part_idx) {
  constexpr double golden_turn = 0.381966;
  constexpr double first_turn = 0.13;  // yellow
  constexpr double least = 0.28;
  constexpr double greatest = 0.88;
  const double turn = first_turn + golden_turn * static_cast<double>(part_idx);
  Eigen::Array3d color;
  for (int channel = 0; channel < 3; ++channel) {
    const double from_peak = std::abs(std::remainder(turn - channel / 3.0, 1.0));  // 0 to a half
    color[channel] = least + (greatest - least) * std::clamp(2.0 - 6.0 * from_peak, 0.0, 1.0);
  }
  return color;
}

}  // namespace

void color_parts(MeshSequence& clip, const std::filesystem::path& database) {
  const std::optional<Markup> markup = DatabaseReader(database).markup();
  if (!markup || markup->parts.empty())
    throw InvalidArgument(
        fmt::format("{} has no body parts to show: see 'reprise markup'", database.string()));
  const PositionsView reference(markup->reference.data(), markup->reference.rows(), 3);
  const PartHierarchy parts(clip.topology(), reference, markup->parts);
  std::vector<Color> colors(static_cast<std::size_t>(parts.vertex_count()));
  for (std::int32_t v = 0; v < parts.vertex_count(); ++v) {
    Eigen::Array3d mixed = Eigen::Array3d::Zero();
    for (const PartHierarchy::Share& share : parts.shares(v))
      mixed += share.weight * color_of_part(static_cast<std::size_t>(share.part_idx));
    for (int channel = 0; channel < 3; ++channel) {
      colors[static_cast<std::size_t>(v)][static_cast<std::size_t>(channel)] =
          static_cast<std::uint8_t>(std::lround(255.0 * mixed[channel]));
    }
  }
  clip.set_colors(std::move(colors));
}

}  // namespace reprise
