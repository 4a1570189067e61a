// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/image_file.h"

#include <cmath>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <turbojpeg.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

Image pattern(int width, int height) {
  Image image{.width = width, .height = height};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<std::uint8_t>(5 * x + 1));
      image.rgb.push_back(static_cast<std::uint8_t>(255 - 7 * y));
      image.rgb.push_back(static_cast<std::uint8_t>(x * y));
    }
  }
  return image;
}

// Smooth, so that JPEG keeps it.
Image ramp(int width, int height) {
  Image image{.width = width, .height = height};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.rgb.push_back(static_cast<std::uint8_t>(200 * x / width));
      image.rgb.push_back(static_cast<std::uint8_t>(200 * y / height));
      image.rgb.push_back(90);
    }
  }
  return image;
}

// What other programs write. `format`: one of libpng's PNG_FORMAT_ values.
template <typename Sample>
std::string png_of(int width, int height, std::uint32_t format, const std::vector<Sample>& samples) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<std::uint32_t>(width);
  png.height = static_cast<std::uint32_t>(height);
  png.format = format;
  std::string bytes(samples.size() * sizeof(Sample) + 4096, '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_NE(png_image_write_to_memory(&png, bytes.data(), &size, 0, samples.data(), 0, nullptr), 0)
      << png.message;
  bytes.resize(size);
  return bytes;
}

std::string jpeg_of(const Image& image, int pixel_format = TJPF_RGB, int subsampling = TJSAMP_444) {
  tjhandle handle = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int status = tjCompress2(handle, image.rgb.data(), image.width, 0, image.height, pixel_format, &bytes,
                                 &size, subsampling, 95, 0);
  EXPECT_EQ(status, 0);
  std::string result(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(handle);
  return result;
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string reading(const fs::path& path) {
  return message_of([&] { read_image(path); });
}

TEST(ImageFile, APngReadsBackTheSamePixels) {
  const TemporaryFolder folder;
  const Image image = pattern(37, 21);
  write_png(image, folder / "a.png");
  std::vector<std::uint8_t> alpha = {1, 2, 3};
  EXPECT_EQ(read_image(folder / "a.png", &alpha), image);
  EXPECT_TRUE(alpha.empty()) << "opaque";
  EXPECT_EQ(test::entries(folder.path()).size(), 1U);
  EXPECT_EQ(decode_png(encode_png(image)), image);
  EXPECT_EQ(encode_png(image), encode_png(image));
}

TEST(ImageFile, ColoursUnderTransparentPixelsAreKeptAndAlphaIsBesideThem) {
  const TemporaryFolder folder;
  const Image image = pattern(6, 5);
  std::vector<std::uint8_t> rgba;
  for (std::size_t i = 0; i < 30; ++i) {
    rgba.insert(rgba.end(), &image.rgb[3 * i], &image.rgb[3 * i] + 3);
    rgba.push_back(static_cast<std::uint8_t>(i % 3 == 0 ? 0 : 200 + i));
  }
  write_text_file(folder / "a.png", png_of(6, 5, PNG_FORMAT_RGBA, rgba));
  std::vector<std::uint8_t> alpha;
  EXPECT_EQ(read_image(folder / "a.png", &alpha), image);
  ASSERT_EQ(alpha.size(), 30U);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(alpha[i], rgba[4 * i + 3]) << i;
}

TEST(ImageFile, GreyBecomesRgb) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> grey;
  for (int i = 0; i < 12; ++i) grey.push_back(static_cast<std::uint8_t>(20 * i));
  write_text_file(folder / "grey.png", png_of(4, 3, PNG_FORMAT_GRAY, grey));
  const Image image = read_image(folder / "grey.png");
  for (std::size_t i = 0; i < 36; ++i) EXPECT_EQ(image.rgb[i], grey[i / 3]) << i;
}

TEST(ImageFile, SixteenBitsInLinearLightBecomeEightInSrgb) {
  const TemporaryFolder folder;
  // libpng writes linear samples together with a gamma of 1, and reads by the power 2.2, up to 2 steps off
  // sRGB.
  std::vector<std::uint16_t> linear;
  for (int i = 0; i < 12; ++i) linear.push_back(static_cast<std::uint16_t>(5461 * (i + 1)));
  write_text_file(folder / "linear.png", png_of(4, 1, PNG_FORMAT_LINEAR_RGB, linear));
  const Image image = read_image(folder / "linear.png");
  for (std::size_t i = 0; i < 12; ++i) {
    const double c = linear[i] / 65535.0;
    EXPECT_NEAR(image.rgb[i], 255.0 * (1.055 * std::pow(c, 1.0 / 2.4) - 0.055), 2.0) << i;
  }
}

TEST(ImageFile, AJpegKeepsItsColoursWhateverItsNameAndSubsampling) {
  const TemporaryFolder folder;
  const Image image = ramp(64, 48);
  for (const int subsampling : {TJSAMP_444, TJSAMP_420}) {
    write_text_file(folder / "a.png", jpeg_of(image, TJPF_RGB, subsampling));
    std::vector<std::uint8_t> alpha = {9};
    const Image read = read_image(folder / "a.png", &alpha);
    ASSERT_EQ(read.width, 64);
    ASSERT_EQ(read.height, 48);
    EXPECT_TRUE(alpha.empty());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) EXPECT_NEAR(read.rgb[i], image.rgb[i], 8) << i;
  }
  write_text_file(folder / "grey.jpg", jpeg_of(image, TJPF_RGB, TJSAMP_GRAY));
  const Image grey = read_image(folder / "grey.jpg");
  EXPECT_EQ(grey.rgb[300], grey.rgb[301]);
  EXPECT_EQ(grey.rgb[300], grey.rgb[302]);
}

TEST(ImageFile, EveryTruncationIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  const std::string png = png_of(9, 7, PNG_FORMAT_RGB, pattern(9, 7).rgb);
  const std::string jpeg = jpeg_of(ramp(32, 32));
  for (const std::string& whole : {png, jpeg}) {
    // The last bytes mark the end and hold nothing.
    for (std::size_t size = 0; size + 14 < whole.size(); size += 1 + whole.size() / 60) {
      write_text_file(folder / "a.img", whole.substr(0, size));
      EXPECT_THAT(reading(folder / "a.img"), HasSubstr("a.img: is n")) << size << " of " << whole.size();
    }
  }
}

TEST(ImageFile, DamagedBytesNeverPassForAnotherPng) {
  const TemporaryFolder folder;
  const Image image = pattern(9, 7);
  const std::string whole = png_of(9, 7, PNG_FORMAT_RGB, image.rgb);
  const std::size_t data = whole.find("IDAT");
  ASSERT_NE(data, std::string::npos);
  for (std::size_t at = data; at + 16 < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    write_text_file(folder / "a.png", damaged);
    EXPECT_THAT(reading(folder / "a.png"), HasSubstr("a.png: is not a whole PNG")) << at;
  }
}

TEST(ImageFile, BadFilesAreNamedWithTheReason) {
  const TemporaryFolder folder;
  EXPECT_THAT(reading(folder / "none.png"), AllOf(HasSubstr("none.png"), HasSubstr("cannot be read")));
  EXPECT_THAT(reading(folder.path()), HasSubstr("folder"));
  write_text_file(folder / "text.png", "a picture of a horse");
  EXPECT_THAT(reading(folder / "text.png"), HasSubstr("text.png: is neither a PNG nor a JPEG"));
  const std::vector<std::uint8_t> wide(largest_image_side + 1, 7);
  write_text_file(folder / "wide.png", png_of(largest_image_side + 1, 1, PNG_FORMAT_GRAY, wide));
  EXPECT_THAT(reading(folder / "wide.png"), HasSubstr("wide.png: is 16385 x 1 pixels"));
  Image cmyk{.width = 8, .height = 8};
  cmyk.rgb.assign(4 * 64, 100);
  write_text_file(folder / "cmyk.jpg", jpeg_of(cmyk, TJPF_CMYK));
  EXPECT_THAT(reading(folder / "cmyk.jpg"), HasSubstr("CMYK"));
  EXPECT_THROW(decode_png({}), InvalidArgument);
  EXPECT_THAT(message_of([] { decode_png(std::vector<std::byte>(30)); }), HasSubstr("the picture is not"));
}

TEST(ImageFile, APictureOfTheWrongSizeOrInAMissingFolderLeavesNothing) {
  const TemporaryFolder folder;
  Image image = pattern(8, 8);
  EXPECT_THROW(write_png(image, folder / "no" / "a.png"), FileError);
  image.rgb.pop_back();
  EXPECT_THROW(write_png(image, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(write_png(Image{}, folder / "a.png"), InvalidArgument);
  EXPECT_THROW(encode_png(Image{}), InvalidArgument);
  EXPECT_TRUE(test::entries(folder.path()).empty());
}

TEST(ImageFile, AFullDiskIsReportedAndLeavesNothing) {
  const TemporaryFolder folder;
  Image noise{.width = 128, .height = 128};
  std::uint32_t state = 1;
  for (int i = 0; i < 3 * 128 * 128; ++i) {
    state = 1664525 * state + 1013904223;
    noise.rgb.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  {
    const test::FullDisk disk(4096);
    EXPECT_THROW(write_png(noise, folder / "a.png"), FileError);
  }
  EXPECT_TRUE(test::entries(folder.path()).empty());
}

}  // namespace
}  // namespace reprise
