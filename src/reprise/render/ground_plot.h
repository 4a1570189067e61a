// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Ways over the ground, seen from above.

#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace reprise {

struct GroundCurve {
  enum class Kind {
    asked,   // a broad pale line, with a ring at its end; a single point is a ring alone
    walked,  // a thin line, with a dot at its end
  };
  std::string name;
  Kind kind = Kind::walked;
  std::vector<Eigen::Vector2d> points;  // (x, z), metres
};
struct GroundPanel {
  std::string title;
  std::vector<GroundCurve> curves;
};
// Panels side by side, each as wide as its curves and to the same scale both ways: z upwards, x to the left,
// as one sees a performer from above who faces +Z up the page. One key below; a name has one colour in all
// panels. Throws `InvalidArgument` if there is no panel, or one has no point or one that is not finite, else
// as the plots of plots.h do.
void plot_ground(std::span<const GroundPanel> panels, const std::filesystem::path& png);

}  // namespace reprise
