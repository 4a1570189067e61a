// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/image_file.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <png.h>
#include <spdlog/spdlog.h>
#include <turbojpeg.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/input_file.h"
#include "reprise/io/output_file.h"

namespace reprise {
namespace {

constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view jpeg_signature = "\xff\xd8\xff";

// libpng's simplified interface, freed in every case.
struct PngImage {
  png_image png{};
  PngImage() { png.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&png); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

void check_size(std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || width > largest_image_side || height > largest_image_side) {
    throw InvalidArgument(
        fmt::format("is {} x {} pixels; expected 1 to {} each way", width, height, largest_image_side));
  }
}

// Throws `InvalidArgument` whose text reads on after the name of a file.
Image decode_png(std::string_view bytes, std::vector<std::uint8_t>* alpha) {
  PngImage source;
  png_image& png = source.png;
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    throw InvalidArgument(fmt::format("is not a whole PNG picture: {}", png.message));
  }
  check_size(png.width, png.height);
  const bool has_alpha = (png.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  png.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  // Without this, libpng takes 16-bit files that state no gamma for linear light.
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  Image image{.width = static_cast<int>(png.width), .height = static_cast<int>(png.height)};
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(png));
  if (png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr) == 0) {
    throw InvalidArgument(fmt::format("is not a whole PNG picture: {}", png.message));
  }
  if (!has_alpha) {
    image.rgb = std::move(pixels);
    return image;
  }
  const std::size_t count = pixels.size() / 4;
  image.rgb.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) std::copy_n(&pixels[4 * i], 3, &image.rgb[3 * i]);
  if (alpha != nullptr) {
    alpha->resize(count);
    for (std::size_t i = 0; i < count; ++i) (*alpha)[i] = pixels[4 * i + 3];
    if (std::ranges::all_of(*alpha, [](std::uint8_t a) { return a == 255; })) alpha->clear();
  }
  return image;
}

Image decode_jpeg(std::string_view bytes, const std::filesystem::path& path) {
  const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitDecompress(), &tjDestroy);
  if (!handle) throw Error(fmt::format("the JPEG library does not start: {}", tjGetErrorStr2(nullptr)));
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int color_space = 0;
  const int status =
      tjDecompressHeader3(handle.get(), data, bytes.size(), &width, &height, &subsampling, &color_space);
  if (status != 0 && tjGetErrorCode(handle.get()) == TJERR_FATAL) {
    throw InvalidArgument(fmt::format("is not a whole JPEG picture: {}", tjGetErrorStr2(handle.get())));
  }
  // A file that ends early can pass for a header without a picture.
  if (width < 1) throw InvalidArgument("is not a whole JPEG picture: it ends before its size is stated");
  check_size(width, height);
  if (color_space == TJCS_CMYK || color_space == TJCS_YCCK) {
    throw InvalidArgument("is a JPEG picture in printing colours (CMYK); expected RGB or grey");
  }
  Image image{.width = width, .height = height};
  image.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (tjDecompress2(handle.get(), data, bytes.size(), image.rgb.data(), width, 0, height, TJPF_RGB,
                    TJFLAG_ACCURATEDCT) != 0) {
    const std::string_view what = tjGetErrorStr2(handle.get());
    // Other warnings, such as superfluous bytes between the parts of a file, leave the picture whole.
    if (tjGetErrorCode(handle.get()) == TJERR_FATAL || what.find("remature end") != std::string_view::npos ||
        what.find("orrupt") != std::string_view::npos) {
      throw InvalidArgument(fmt::format("is not a whole JPEG picture: {}", what));
    }
    spdlog::warn("{}: {}", path.string(), what);
  }
  return image;
}

}  // namespace

Image read_image(const std::filesystem::path& path, std::vector<std::uint8_t>* alpha) {
  const FileBytes bytes = InputFile(path).read_all();
  if (alpha != nullptr) alpha->clear();
  try {
    if (bytes.view().starts_with(png_signature)) return decode_png(bytes.view(), alpha);
    if (bytes.view().starts_with(jpeg_signature)) return decode_jpeg(bytes.view(), path);
  } catch (const InvalidArgument& error) {
    throw FileError(path, error.what());
  }
  throw FileError(path, "is neither a PNG nor a JPEG picture");
}

std::vector<std::byte> encode_png(const Image& image) {
  validate(image);
  PngImage target;
  png_image& png = target.png;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    throw Error(fmt::format("the picture cannot be encoded: {}", png.message));
  }
  bytes.resize(size);
  return bytes;
}

Image decode_png(std::span<const std::byte> bytes) {
  try {
    return decode_png(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), nullptr);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(fmt::format("the picture {}", error.what()));
  }
}

void write_png(const Image& image, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = encode_png(image);
  AtomicOutput output(path, AtomicOutput::Kind::file);
  OutputFile file(output.path(), path);
  file.write_values(std::span(bytes));
  file.finish();
  output.commit();
}

}  // namespace reprise
