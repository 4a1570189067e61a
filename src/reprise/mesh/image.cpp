// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mesh/image.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

void validate(const Image& image) {
  const auto expected = 3 * static_cast<std::size_t>(std::max(image.width, 0)) *
                        static_cast<std::size_t>(std::max(image.height, 0));
  if (expected == 0 || image.rgb.size() != expected) {
    throw InvalidArgument(fmt::format("image: expected {} bytes for a picture of {} x {}, found {}", expected,
                                      image.width, image.height, image.rgb.size()));
  }
}

}  // namespace reprise
