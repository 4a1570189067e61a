// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/renderer.h"

namespace reprise {

Image tile(const std::vector<Image>& images, int columns) {
  if (images.empty() || columns < 1) {
    throw InvalidArgument(
        fmt::format("tile: expected at least one image and one column, found {} images, {} columns",
                    images.size(), columns));
  }
  const Image& first = images.front();
  for (std::size_t i = 0; i < images.size(); ++i) {
    validate(images[i]);
    if (images[i].width != first.width || images[i].height != first.height) {
      throw InvalidArgument(fmt::format("tile: image {} is {} x {}, but the first is {} x {}", i,
                                        images[i].width, images[i].height, first.width, first.height));
    }
  }
  const auto per_row = std::min(static_cast<std::size_t>(columns), images.size());
  const std::size_t rows = (images.size() + per_row - 1) / per_row;
  const auto width = static_cast<std::size_t>(first.width);
  const auto height = static_cast<std::size_t>(first.height);
  Image result{.width = static_cast<int>(per_row * width), .height = static_cast<int>(rows * height)};
  // An incomplete last row ends in white.
  result.rgb.assign(3 * per_row * width * rows * height, 255);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::size_t left = (i % per_row) * width;
    const std::size_t top = (i / per_row) * height;
    for (std::size_t row = 0; row < height; ++row) {
      std::memcpy(result.rgb.data() + 3 * ((top + row) * per_row * width + left),
                  images[i].rgb.data() + 3 * row * width, 3 * width);
    }
  }
  return result;
}

}  // namespace reprise
