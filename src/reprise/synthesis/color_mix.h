// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Weighted colours of two frames. Internal.

#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "reprise/mesh/mesh.h"

namespace reprise {

// Appends (1 - alpha) source + alpha target, rounded, a colour a vertex. Both of the same size.
inline void append_mixed_colors(std::span<const Color> source, std::span<const Color> target, double alpha,
                                std::vector<Color>& colors) {
  for (std::size_t v = 0; v < source.size(); ++v) {
    Color mixed{};
    for (std::size_t c = 0; c < mixed.size(); ++c) {
      mixed[c] = static_cast<std::uint8_t>(std::lround((1.0 - alpha) * source[v][c] + alpha * target[v][c]));
    }
    colors.push_back(mixed);
  }
}

}  // namespace reprise
