// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "reprise/core/error.h"
#include "reprise/database/frame_list.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

reprise::PerformanceDatabase clips() {
  using namespace reprise;
  Topology topology{.vertex_count = 3, .triangles = {{0, 1, 2}}};
  const auto shared = std::make_shared<const Topology>(std::move(topology));
  PerformanceDatabase database;
  for (const auto& [name, frame_count] : {std::pair{"a", 3}, {"3-1", 12}, {"-", 1}}) {
    database.add(MeshSequence(name, shared, static_cast<std::size_t>(frame_count), 25.0));
  }
  return database;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  static const PerformanceDatabase database = clips();
  try {
    const std::vector<FrameId> frames =
        parse_frames(database, std::string(reinterpret_cast<const char*>(data), size));
    require(!frames.empty());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      require(frames[i].clip_idx == frames[0].clip_idx);
      require(frames[i].frame_idx < database.clip(frames[i].clip_idx).frame_count());
      require(i == 0 || frames[i].frame_idx > frames[i - 1].frame_idx);
      require(parse_frames(database, database.to_string(frames[i])) == std::vector<FrameId>{frames[i]});
    }
  } catch (const InvalidArgument&) {
  }
  return 0;
}
