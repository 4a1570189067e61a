// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Pictures from and to files. PNG goes through libpng; JPEG, which textures of captures often are, is only
// read, through libjpeg-turbo. Both are maintained against hostile files, which the single-header readers
// say they are not.

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "reprise/mesh/image.h"

namespace reprise {

// Largest width and height that is read.
constexpr int largest_image_side = 16384;

// Reads a PNG (any kind) or a JPEG (grey or colour); the content decides, not the extension. Grey becomes
// RGB, 16 bits become 8, a PNG that states another gamma is converted to sRGB. Colours are as stored under
// transparent pixels too. `alpha`, if asked for: one byte a pixel, 255 is opaque; left empty if all pixels
// are. Throws `FileError` naming the file and what is wrong: missing, no such picture, truncated, damaged,
// too large.
Image read_image(const std::filesystem::path& path, std::vector<std::uint8_t>* alpha = nullptr);

// A PNG in memory. The same image gives the same bytes. Throws `InvalidArgument` for a broken image.
std::vector<std::byte> encode_png(const Image& image);
// Throws `InvalidArgument` that says what is wrong with the bytes.
Image decode_png(std::span<const std::byte> bytes);

// Whole or not at all. Throws `FileError`, and `InvalidArgument` for a broken image.
void write_png(const Image& image, const std::filesystem::path& path);

}  // namespace reprise
