// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/path/trellis.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise::path_detail {
namespace {

void check_window(const Transition& transition, const std::vector<int>& frame_counts, std::size_t idx) {
  const auto check = [&](const char* which, std::size_t clip_idx, int center) {
    if (clip_idx >= frame_counts.size()) {
      throw InvalidArgument(
          fmt::format("transition {}: {} clip {} of {}", idx, which, clip_idx, frame_counts.size()));
    }
    const int frame_count = frame_counts[clip_idx];
    if (center - transition.half_window < 0 || center + transition.half_window >= frame_count) {
      throw InvalidArgument(fmt::format(
          "transition {}: its window {} .. {} leaves the {} clip {}, which has {} frames", idx,
          center - transition.half_window, center + transition.half_window, which, clip_idx, frame_count));
    }
  };
  if (transition.half_window < 1) {
    throw InvalidArgument(
        fmt::format("transition {}: half window {}, expected at least 1", idx, transition.half_window));
  }
  check("source", transition.source_clip, transition.m);
  check("target", transition.target_clip, transition.n);
  if (!(transition.cost >= 0.0) || transition.cost == std::numeric_limits<double>::infinity()) {
    throw InvalidArgument(
        fmt::format("transition {}: cost {}, expected a number from 0", idx, transition.cost));
  }
}

}  // namespace

Trellis::Trellis(std::vector<int> frame_counts, std::vector<Transition> transitions)
    : clip_count_(frame_counts.size()), transitions_(std::move(transitions)) {
  std::size_t end = 0;
  const auto add_run = [&](std::size_t owner_idx, bool blended, int length) {
    const std::size_t first = end;
    end += static_cast<std::size_t>(length);
    runs_.push_back({.owner_idx = owner_idx, .blended = blended, .first = first, .end = end});
  };
  for (std::size_t clip = 0; clip < clip_count_; ++clip) {
    if (frame_counts[clip] < 1) throw InvalidArgument(fmt::format("clip {} has no frames", clip));
    add_run(clip, false, frame_counts[clip]);
  }
  if (runs_.empty()) throw InvalidArgument("there is no clip");
  for (std::size_t t = 0; t < transitions_.size(); ++t) {
    check_window(transitions_[t], frame_counts, t);
    add_run(t, true, 2 * transitions_[t].half_window - 1);
  }
  if (end > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw InvalidArgument(fmt::format("{} frames and blended frames are more than fit", end));
  }
  collect_entries();
}

const Trellis::Run& Trellis::run_of(std::size_t node) const {
  return *std::ranges::partition_point(runs_, [&](const Run& run) { return run.end <= node; });
}

void Trellis::collect_entries() {
  struct Step {
    std::int32_t from;
    double cost;
  };
  // Single steps from one run into another: into blends and out of them.
  std::vector<std::vector<Step>> crossings(node_count());
  for (std::size_t t = 0; t < transitions_.size(); ++t) {
    const Transition& transition = transitions_[t];
    const Run& blend = blend_run(t);
    const auto leave = clip_run(transition.source_clip).first + static_cast<std::size_t>(transition.leave());
    const auto arrive =
        clip_run(transition.target_clip).first + static_cast<std::size_t>(transition.arrive());
    crossings[blend.first].push_back({static_cast<std::int32_t>(leave), transition.cost});
    crossings[arrive].push_back({static_cast<std::int32_t>(blend.end - 1), 0.0});
  }
  first_entry_.push_back(0);
  std::vector<Entry> entries;
  for (const Run& run : runs_) {
    for (std::size_t node = run.first; node < run.end; ++node) {
      entries.clear();
      // A skip over `via`, which leads to this node by a step of its own.
      const auto add_skips = [&](std::size_t via, bool via_in_run, double cost) {
        const Run& of_via = via_in_run ? run : run_of(via);
        if (!via_in_run && via > of_via.first) {
          entries.push_back({static_cast<std::int32_t>(via) - 1, static_cast<std::int32_t>(via), cost});
        }
        for (const Step& step : crossings[via]) {
          entries.push_back({step.from, static_cast<std::int32_t>(via), cost + step.cost});
        }
      };
      for (const Step& step : crossings[node]) {
        entries.push_back({step.from, -1, step.cost});
        add_skips(static_cast<std::size_t>(step.from), false, step.cost);
      }
      if (node > run.first) add_skips(node - 1, true, 0.0);
      if (entries.empty()) continue;
      if (entries.size() > std::numeric_limits<std::uint16_t>::max()) {
        throw InvalidArgument(fmt::format("{} ways lead to one frame, more than fit", entries.size()));
      }
      std::ranges::sort(
          entries, {}, [](const Entry& entry) { return std::tuple(entry.is_skip(), entry.from, entry.via); });
      entered_.push_back(static_cast<std::int32_t>(node));
      entries_.insert(entries_.end(), entries.begin(), entries.end());
      first_entry_.push_back(entries_.size());
    }
  }
}

}  // namespace reprise::path_detail
