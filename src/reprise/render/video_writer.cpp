// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/render/child_process.h"
#include "reprise/render/renderer.h"

namespace reprise {
namespace {

std::vector<std::string> encoder_arguments(const std::filesystem::path& path, int width, int height,
                                           double frames_per_second) {
  // sRGB frames become limited-range BT.709 YCbCr, and the file says so: players then show the same colours.
  const std::string colours = "scale=in_range=full:out_range=tv:out_color_matrix=bt709";
  const std::string filters = colours + ":flags=accurate_rnd+full_chroma_int,format=yuv420p";
  return {"ffmpeg", "-hide_banner", "-nostdin", "-y", "-loglevel", "error", "-xerror", "-f", "rawvideo",
          "-pix_fmt", "rgb24", "-video_size", fmt::format("{}x{}", width, height), "-framerate",
          fmt::format("{}", frames_per_second), "-i", "pipe:0", "-an", "-vf", filters, "-c:v", "libx264",
          "-preset", "veryfast", "-crf", "18", "-colorspace", "bt709", "-color_primaries", "bt709",
          "-color_trc", "bt709", "-color_range", "tv", "-movflags", "+faststart", "-f", "mp4",
          // Absolute and with its protocol: a name such as "a:b" or "-x" is a file all the same.
          "file:" + std::filesystem::absolute(path).string()};
}

}  // namespace

struct VideoWriter::Impl {
  Impl(std::filesystem::path target, int w, int h, double rate)
      : output(std::move(target), AtomicOutput::Kind::file),
        width(w),
        height(h),
        encoder(encoder_arguments(output.path(), w, h, rate), {.input = true}, "to write videos") {}

  [[noreturn]] void fail() {
    encoder.finish();
    throw FileError(output.target(), fmt::format("the video cannot be written: {}", encoder.report()));
  }

  AtomicOutput output;
  int width;
  int height;
  std::size_t frame_count = 0;
  bool committed = false;
  ChildProcess encoder;  // after `output`: the encoder must have ended when the unfinished file is removed
};

VideoWriter::VideoWriter(std::filesystem::path target, int width, int height, double frames_per_second) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0) {
    throw InvalidArgument(fmt::format(
        "video size: expected even width and height of at least 2, found {} x {}", width, height));
  }
  if (!(frames_per_second > 0.0 && std::isfinite(frames_per_second))) {
    throw InvalidArgument(
        fmt::format("frames_per_second: expected a positive number, found {}", frames_per_second));
  }
  impl_ = std::make_unique<Impl>(std::move(target), width, height, frames_per_second);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::append(const Image& image) {
  const auto expected = 3 * static_cast<std::size_t>(impl_->width) * static_cast<std::size_t>(impl_->height);
  if (impl_->committed) throw InvalidArgument("append: the video is already finished");
  if (image.width != impl_->width || image.height != impl_->height || image.rgb.size() != expected) {
    throw InvalidArgument(fmt::format("append: expected a picture of {} x {}, found {} x {} with {} bytes",
                                      impl_->width, impl_->height, image.width, image.height,
                                      image.rgb.size()));
  }
  if (!impl_->encoder.write(image.rgb)) impl_->fail();
  ++impl_->frame_count;
}

void VideoWriter::commit() {
  if (impl_->committed) throw InvalidArgument("commit: the video is already finished");
  if (impl_->frame_count == 0) throw InvalidArgument("commit: the video has no frame");
  if (!impl_->encoder.finish()) impl_->fail();
  impl_->output.commit();
  impl_->committed = true;
}

}  // namespace reprise
