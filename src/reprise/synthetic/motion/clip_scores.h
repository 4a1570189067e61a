// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The clips as their author wrote them: key poses, footsteps, gaits.

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reprise/synthetic/motion/gait.h"
#include "reprise/synthetic/motion/performance.h"

namespace reprise::motion {

// Scores are written in frames of this rate.
constexpr double score_rate = 25.0;

std::vector<ClipScore> character_scores();
// `lively`: the second performance (faster twirl, longer steps, other poses).
enum class FashionStyle { calm, lively };
std::vector<ClipScore> fashion_scores(FashionStyle style);

// Breathing and small shifts of weight and gaze, which repeat after the period of the clip so that clips
// loop.
class Life {
 public:
  Life(std::uint64_t seed, double period);
  Controls add_to(Controls controls, double time, double amount = 1.0) const;

 private:
  double breath_period_;
  std::vector<SmoothNoise> noise_;
};

// A foot that stands from `begin` to `end`: outwards and forwards from the origin, turned outwards.
Step foot_at(int side, double out, double ahead, double yaw_out, double begin, double end);

// Footsteps and key poses of an action, alive with the given seed.
ClipScore action_score(const std::string& name, int frames, std::array<std::vector<Step>, 2> steps,
                       const std::vector<KeyPose>& poses, double smoothing, std::uint64_t seed);

// Parts of the character's set.
ClipScore stagger_score();
ClipScore hit_score();
ClipScore tense_score();

// Standing at ease, feet beside one another.
Controls standing_pose();

// A course of steps with the controls of a gait where `striding` is 1 and `standing` where it is 0.
ClipScore gait_score(const std::string& name, int frames, const GaitCourse& course,
                     const std::function<double(double time)>& striding,
                     const std::function<Controls(double time)>& standing, std::uint64_t seed);

}  // namespace reprise::motion
