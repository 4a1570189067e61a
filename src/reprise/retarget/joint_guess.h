// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Body joints of a skeleton whose names are in no table.

#pragma once

#include <map>
#include <string>

#include "reprise/sequence/skeleton.h"

namespace reprise::retargeting {

// Body joint -> joint of the skeleton, as far as words ("femur", "UpLeg", "wrist"), marks of the side ("l",
// "Left", ".R") and the order in the tree tell: a limb's joints follow each other as a body's do, the pelvis
// is where the legs meet, the chest where the arms meet.
std::map<std::string, std::string> guess_joints(const Skeleton& skeleton);

}  // namespace reprise::retargeting
