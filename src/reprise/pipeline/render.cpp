// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/render.h"

#include <array>
#include <charconv>
#include <chrono>
#include <functional>
#include <future>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/progress.h"
#include "reprise/io/image_file.h"

namespace reprise {
namespace {

constexpr std::size_t most_strip_frames = 64;

// Splits at `separator` and reads every piece as a number from 0. Empty if any piece is not one.
std::vector<std::size_t> parse_numbers(const std::string& text, char separator) {
  std::vector<std::size_t> numbers;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  while (true) {
    std::size_t number = 0;
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return {};
    numbers.push_back(number);
    if (stop == end) return numbers;
    if (*stop != separator) return {};
    at = stop + 1;
  }
}

FrameRange checked_range(const MeshSequence& sequence, const std::optional<FrameRange>& frames) {
  if (sequence.frame_count() == 0) throw InvalidArgument(fmt::format("'{}' has no frames", sequence.name()));
  const FrameRange range = frames.value_or(FrameRange{.first = 0, .last = sequence.frame_count() - 1});
  if (range.last >= sequence.frame_count()) {
    throw InvalidArgument(fmt::format("'{}' has frames 0 to {}, asked for {}", sequence.name(),
                                      sequence.frame_count() - 1, range.last));
  }
  return range;
}

// Lies in every folder of pictures this program has written: numbered pictures alone could be a
// photographer's.
constexpr const char* folder_mark = ".reprise-rendering";

void check_replaceable(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder) || std::filesystem::is_empty(folder)) return;
  if (!std::filesystem::exists(folder / folder_mark)) {
    throw FileError(folder, "is not replaced: it holds files that are no earlier rendering");
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().filename() == folder_mark) continue;
    if (entry.path().extension() != ".png" || stem.find_first_not_of("0123456789") != std::string::npos) {
      throw FileError(
          folder, fmt::format("is not replaced: it holds '{}', which is not a frame of an earlier rendering",
                              entry.path().filename().string()));
    }
  }
}

}  // namespace

FrameRange parse_frame_range(const std::string& text) {
  const std::vector<std::size_t> numbers = parse_numbers(text, ':');
  if (numbers.size() < 2 || numbers.size() > 3 || numbers[0] > numbers[1] ||
      (numbers.size() == 3 && numbers[2] == 0)) {
    throw InvalidArgument(
        fmt::format("'{}' is not a range of frames: expected FIRST:LAST or FIRST:LAST:STEP", text));
  }
  return {.first = numbers[0], .last = numbers[1], .step = numbers.size() == 3 ? numbers[2] : 1};
}

void parse_size(const std::string& text, RenderOptions& view) {
  constexpr std::size_t largest = 16384;
  const std::vector<std::size_t> numbers = parse_numbers(text, 'x');
  if (numbers.size() != 2 || numbers[0] == 0 || numbers[1] == 0 || numbers[0] > largest ||
      numbers[1] > largest) {
    throw InvalidArgument(
        fmt::format("'{}' is not a picture size: expected WIDTHxHEIGHT, such as 1280x720", text));
  }
  view.width = static_cast<int>(numbers[0]);
  view.height = static_cast<int>(numbers[1]);
}

CameraMode parse_camera(const std::string& text) {
  static constexpr std::array<std::pair<const char*, CameraMode>, 5> modes = {{{"follow", CameraMode::follow},
                                                                               {"orbit", CameraMode::orbit},
                                                                               {"fixed", CameraMode::fixed},
                                                                               {"front", CameraMode::front},
                                                                               {"side", CameraMode::side}}};
  for (const auto& [name, mode] : modes) {
    if (text == name) return mode;
  }
  throw InvalidArgument(
      fmt::format("there is no camera '{}'; expected follow, orbit, fixed, front or side", text));
}

Appearance parse_appearance(const std::string& text) {
  static constexpr std::array<std::pair<const char*, Appearance>, 4> names = {
      {{"auto", Appearance::automatic},
       {"texture", Appearance::texture},
       {"colors", Appearance::vertex_colors},
       {"plain", Appearance::plain}}};
  for (const auto& [name, appearance] : names) {
    if (text == name) return appearance;
  }
  throw InvalidArgument(
      fmt::format("there is no appearance '{}'; expected auto, texture, colors or plain", text));
}

void parse_look_at(const std::string& text, RenderOptions& view) {
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  std::array<double, 2> place{};
  const auto first = std::from_chars(at, end, place[0]);
  bool is_place = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
  if (is_place) {
    const auto second = std::from_chars(first.ptr + 1, end, place[1]);
    is_place = second.ec == std::errc() && second.ptr == end;
  }
  if (!is_place) {
    throw InvalidArgument(fmt::format(
        "'{}' is not a place to look at: expected ACROSS,UP in heights of the character, such as 0,0.93",
        text));
  }
  view.look_at = place;
}

RenderReport render_sequence(const MeshSequence& sequence, const std::filesystem::path& target,
                             const RenderStageOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const FrameRange range = checked_range(sequence, options.frames);
  const std::string extension = target.extension().string();
  RenderReport report{.frames = (range.last - range.first) / range.step + 1};
  if (extension != ".mp4" && extension != ".png" && !extension.empty()) {
    throw InvalidArgument(fmt::format(
        "cannot render to '{}': expected FILE.mp4, FILE.png (a strip of frames) or the name of a folder",
        target.string()));
  }
  if (extension == ".png" && report.frames > most_strip_frames) {
    throw InvalidArgument(
        fmt::format("{} frames do not fit into one picture; choose at most {} with --frames FIRST:LAST:STEP",
                    report.frames, most_strip_frames));
  }

  SequenceRenderer renderer(sequence, options.view);
  Progress progress("render", report.frames);
  const auto draw_all = [&](const std::function<void(std::size_t, const Image&)>& take) {
    // A frame is encoded while the next is drawn.
    std::future<void> taken;
    for (std::size_t f = range.first; f <= range.last; f += range.step) {
      Image image = renderer.draw(f);
      if (taken.valid()) taken.get();
      taken = std::async(std::launch::async, [&take, f, drawn = std::move(image)] { take(f, drawn); });
      progress.advance();
    }
    taken.get();
  };

  if (extension == ".mp4") {
    VideoWriter video(target, options.view.width, options.view.height,
                      sequence.frames_per_second() / static_cast<double>(range.step));
    draw_all([&](std::size_t, const Image& image) { video.append(image); });
    video.commit();
  } else if (extension == ".png") {
    std::vector<Image> images;
    draw_all([&](std::size_t, const Image& image) { images.push_back(image); });
    const int columns = options.columns > 0 ? options.columns : static_cast<int>(images.size());
    AtomicOutput output(target, AtomicOutput::Kind::file);
    write_png(tile(images, columns), output.path());
    output.commit();
  } else {
    check_replaceable(target);
    AtomicOutput output(target, AtomicOutput::Kind::directory);
    write_text_file(output.path() / folder_mark, "");
    draw_all([&](std::size_t f, const Image& image) {
      write_png(image, output.path() / fmt::format("{:05}.png", f));
    });
    output.commit();
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace reprise
