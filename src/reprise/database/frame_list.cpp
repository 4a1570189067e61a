// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/database/frame_list.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

// A whole number; one beyond any index is as far as an index goes. Nothing for anything else.
bool parse_index(std::string_view word, std::size_t& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) value = std::numeric_limits<std::size_t>::max();
  return error != std::errc::invalid_argument && end == word.data() + word.size();
}

}  // namespace

std::vector<FrameId> parse_frames(const PerformanceDatabase& database, const std::string& text) {
  const std::string_view all = text;
  const std::size_t colon = all.find(':');
  const std::size_t clip_idx = database.clip_idx(text.substr(0, colon));
  const std::size_t frame_count = database.clip(clip_idx).frame_count();
  std::size_t first = 0;
  std::size_t last = frame_count - 1;
  std::size_t step = 1;
  if (colon != std::string_view::npos) {
    std::string_view range = all.substr(colon + 1);
    std::string_view step_word = "1";
    const std::size_t second = range.find(':');
    if (second != std::string_view::npos) {
      step_word = range.substr(second + 1);
      range = range.substr(0, second);
    }
    const std::size_t dash = range.find('-');
    const bool is_one_frame = dash == std::string_view::npos;
    if (is_one_frame && second != std::string_view::npos) {
      throw InvalidArgument(fmt::format("'{}' has a step and no range: expected CLIP:FIRST-LAST:STEP", text));
    }
    if (!parse_index(range.substr(0, dash), first) ||
        !parse_index(is_one_frame ? range : range.substr(dash + 1), last) || !parse_index(step_word, step) ||
        step == 0) {
      throw InvalidArgument(fmt::format(
          "'{}' names no frames: expected CLIP, CLIP:FRAME, CLIP:FIRST-LAST or CLIP:FIRST-LAST:STEP, "
          "frames from 0 and the step from 1",
          text));
    }
    if (last < first) throw InvalidArgument(fmt::format("'{}': the range ends before it begins", text));
    if (last >= frame_count) {
      throw InvalidArgument(fmt::format("'{}': clip '{}' has frames 0 to {}", text,
                                        database.clip(clip_idx).name(), frame_count - 1));
    }
  }
  std::vector<FrameId> frames;
  for (std::size_t f = first; f <= last; f += std::min(step, frame_count)) {
    frames.push_back({.clip_idx = clip_idx, .frame_idx = f});
  }
  return frames;
}

}  // namespace reprise
