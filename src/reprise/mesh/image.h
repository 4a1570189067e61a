// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// 8-bit pictures: textures and renderings.

#pragma once

#include <cstdint>
#include <vector>

namespace reprise {

// 8-bit sRGB, top row first.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  // width x height x 3

  bool empty() const { return rgb.empty(); }
  bool operator==(const Image&) const = default;
};

// Throws `InvalidArgument` for an empty image and for a number of bytes that does not fit the size.
void validate(const Image& image);

}  // namespace reprise
