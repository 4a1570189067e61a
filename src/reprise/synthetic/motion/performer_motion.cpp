// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/motion/performer_motion.h"

#include <cmath>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/synthetic/motion/clip_scores.h"

namespace reprise {

namespace {

constexpr double lead_in_duration = 1.5;  // seconds

std::vector<motion::ClipScore> scores_of(const std::string& set) {
  if (set == "character") return motion::character_scores();
  if (set == "fashion1") return motion::fashion_scores(motion::FashionStyle::calm);
  if (set == "fashion2") return motion::fashion_scores(motion::FashionStyle::lively);
  throw InvalidArgument(
      fmt::format("set of motions: expected \"character\", \"fashion1\" or \"fashion2\", found \"{}\"", set));
}

}  // namespace

std::vector<PerformerClip> performer_clips(const std::string& set, const Skeleton& skeleton,
                                           double frames_per_second) {
  if (!std::isfinite(frames_per_second) || frames_per_second <= 0.0) {
    throw InvalidArgument(
        fmt::format("frames per second: expected a positive number, found {}", frames_per_second));
  }
  std::vector<PerformerClip> clips;
  for (motion::ClipScore& score : scores_of(set)) {
    const motion::Performance performance(skeleton, std::move(score));
    PerformerClip clip;
    clip.motion.name = performance.score().name;
    clip.motion.skeleton = skeleton;
    clip.motion.frames_per_second = frames_per_second;
    clip.lead_in = static_cast<int>(std::lround(lead_in_duration * frames_per_second));
    const int frames = static_cast<int>(std::lround(performance.score().duration * frames_per_second));
    for (int k = -clip.lead_in; k < frames; ++k) {
      const double time = k / frames_per_second;
      clip.motion.frames.push_back(performance.pose(time));
      clip.contacts.push_back(performance.contacts(time));
    }
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace reprise
