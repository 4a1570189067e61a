// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What the two fashion performances share and where they differ.

#pragma once

#include <vector>

#include "reprise/synthetic/motion/clip_scores.h"

namespace reprise::motion {

// One foot carries in the first pose; the other one is free, and takes the first and the last step.
struct FashionScript {
  GaitStyle walk;
  int free_side = 1;
  GaitCourse::Stance stance;    // of the poses
  double free_heel_a = 0.0;     // degrees the free foot's heel is raised in the first pose
  double other_heel_b = 0.0;    // and the other's in the second pose
  Controls pose_a, pose_a_end;  // the pose and what it drifts to while it is held
  Controls pose_b, pose_b_end;
  // Before and after the twirl: `ready` stands easily, `wound_up` has turned away from the spin.
  Controls ready, wound_up, spinning;
  int turns = 1;              // of the twirl
  double half_turn = 0.5;     // seconds
  double twirl_start = 2.15;  // seconds from the clip's begin to the first foot's lift
  std::uint64_t seed = 0;
};
FashionScript fashion_script(FashionStyle style);

// Poses and footsteps of a twirl to the left: foot after foot swings round to the other side while the body
// turns on the ball of the standing one. `earlier`: seconds by which everything comes sooner than in the
// clip "twirl"; `origin`: x of the middle between the feet before it.
struct Twirl {
  std::array<std::vector<Step>, 2> steps;  // the first of each is the stance before
  std::vector<KeyPose> poses;              // from the wind-up on
};
Twirl twirl(const FashionScript& script, double earlier, double origin);

}  // namespace reprise::motion
