// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/open.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/database_file.h"

namespace reprise {

MeshSequence open_clip(const std::filesystem::path& database, const std::string& clip_name) {
  const DatabaseReader reader(database);
  std::vector<std::string> names;
  for (const ClipInfo& clip : reader.clips()) names.push_back(clip.name);
  if (clip_name.empty() && names.size() == 1) return reader.read_clip(0);
  if (clip_name.empty()) {
    throw InvalidArgument(fmt::format("{} has {} clips; choose one with --clip: {}", database.string(),
                                      names.size(), fmt::join(names, ", ")));
  }
  const auto found = std::ranges::find(names, clip_name);
  if (found == names.end()) {
    const std::string nearest = nearest_word(clip_name, names);
    throw InvalidArgument(nearest.empty() ? fmt::format("{} has no clip '{}'; its clips are {}",
                                                        database.string(), clip_name, fmt::join(names, ", "))
                                          : fmt::format("{} has no clip '{}'; did you mean '{}'?",
                                                        database.string(), clip_name, nearest));
  }
  return reader.read_clip(static_cast<std::size_t>(found - names.begin()));
}

}  // namespace reprise
