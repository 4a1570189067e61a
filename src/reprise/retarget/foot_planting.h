// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A captured motion in which standing feet stand still.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "reprise/database/markup.h"
#include "reprise/sequence/skeleton.h"

namespace reprise::retargeting {

// Moves the feet of `motion` (the performer's skeleton, ground at y = 0, rest pose with flat feet) so that
// each stands still while its contact lasts: on the heel with the toes up, flat, or on the toes with the heel
// up, as its pitch says; it may pivot about the ball. Between contacts it swings as it did, led smoothly from
// one place to the next. Hips sink where a leg would not reach. Contacts may be split where a foot stands
// twice without leaving the ground.
// `shifts`: how far the ankles (left, right) shall be from where the pose has them before they are planted,
// one entry a frame; empty: not at all.
void plant_feet(SkeletalMotion& motion, std::vector<FootContacts>& contacts,
                const std::vector<std::array<Eigen::Vector3d, 2>>& shifts = {});

}  // namespace reprise::retargeting
