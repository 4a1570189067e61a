// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The report of the stage "mocap".

#pragma once

#include <vector>

#include "reprise/pipeline/mocap.h"

namespace reprise {

// What was read, understood and planned. `origins`: of each answer, of each frame. docs/mocap.md lists every
// field.
nlohmann::json describe_mocap(const MocapStage& stage, const MocapQuery& query, const MocapStage::Query& read,
                              const std::vector<MocapPlan>& plans,
                              const std::vector<std::vector<FrameOrigin>>& origins);

}  // namespace reprise
