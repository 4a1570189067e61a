// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/example_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/json_file.h"
#include "reprise/core/text.h"
#include "reprise/database/frame_list.h"

namespace reprise {
namespace {

constexpr const char* example_format = "reprise examples";
constexpr int format_version = 1;

std::vector<FrameId> read_frames(const JsonField& field, const PerformanceDatabase& database) {
  std::vector<FrameId> frames;
  std::vector<bool> is_listed(database.frame_count(), false);
  for (const JsonField& item : field.items()) {
    std::vector<FrameId> named;
    try {
      named = parse_frames(database, item.text());
    } catch (const InvalidArgument& error) {
      item.fail(error.what());
    }
    for (const FrameId& frame : named) {
      const std::size_t idx = database.first_frame(frame.clip_idx) + frame.frame_idx;
      if (!is_listed[idx]) frames.push_back(frame);
      is_listed[idx] = true;
    }
  }
  if (frames.empty()) field.fail("expected frames, such as \"CLIP:0\" or \"CLIP:0-80:10\"; found none");
  return frames;
}

// Texts that name the frames in their order.
Json frames_json(const std::vector<FrameId>& frames, const PerformanceDatabase& database) {
  Json texts = Json::array();
  for (std::size_t begin = 0; begin < frames.size();) {
    const FrameId& first = frames[begin];
    database.clip(first.clip_idx).frame(first.frame_idx);  // checks the indices
    std::size_t end = begin + 1;
    while (end < frames.size() && frames[end].clip_idx == first.clip_idx &&
           frames[end].frame_idx == first.frame_idx + (end - begin)) {
      ++end;
    }
    std::string text = database.to_string(first);
    if (end - begin > 1) text += fmt::format("-{}", frames[end - 1].frame_idx);
    database.clip(first.clip_idx).frame(frames[end - 1].frame_idx);
    texts.push_back(std::move(text));
    begin = end;
  }
  return texts;
}

}  // namespace

const std::vector<FrameId>& ExampleList::of(const std::string& part) const {
  const auto own = frames_of_part.find(part);
  return own == frames_of_part.end() ? frames : own->second;
}

ExampleList read_example_file(const std::filesystem::path& path, const PerformanceDatabase& database,
                              std::span<const std::string> part_names) {
  const Json json = read_json_file(path);
  if (!json.is_object() || !json.contains("format") || json["format"] != example_format) {
    throw FileError(path,
                    fmt::format("is not a list of examples: expected \"format\": \"{}\"", example_format));
  }
  const JsonField file(path, json);
  if (const int version = file["version"].integer(1); version > format_version) {
    file["version"].fail(
        fmt::format("the file has version {}, this program reads up to version {}", version, format_version));
  }
  file.warn_of_others({"format", "version", "frames", "parts"});
  ExampleList list;
  if (file.has("frames")) list.frames = read_frames(file["frames"], database);
  if (file.has("parts")) {
    for (const auto& [name, field] : file["parts"].entries()) {
      if (std::ranges::find(part_names, name) == part_names.end()) {
        const std::string nearest = nearest_word(name, part_names);
        field.fail(fmt::format("there is no part '{}'; {}", name,
                               nearest.empty() ? fmt::format("the parts are {}", fmt::join(part_names, ", "))
                                               : fmt::format("did you mean '{}'?", nearest)));
      }
      list.frames_of_part[name] = read_frames(field, database);
    }
  }
  if (list.frames.empty() && list.frames_of_part.empty()) {
    file.fail("expected \"frames\" for all parts or \"parts\" with frames of each, found neither");
  }
  return list;
}

void write_example_file(const ExampleList& list, const PerformanceDatabase& database,
                        const std::filesystem::path& path) {
  Json file = {{"format", example_format}, {"version", format_version}};
  if (!list.frames.empty()) file["frames"] = frames_json(list.frames, database);
  for (const auto& [name, frames] : list.frames_of_part) {
    if (frames.empty()) throw InvalidArgument(fmt::format("part '{}' has no example to write", name));
    file["parts"][name] = frames_json(frames, database);
  }
  if (list.frames.empty() && list.frames_of_part.empty()) {
    throw InvalidArgument("there is no example to write");
  }
  write_text_file(path, file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace reprise
