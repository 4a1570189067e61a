// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The joint names of programs and collections.

#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace reprise::retargeting {

// '*' stands for the side: "left_" and "right_" on the body's side of a row, `sides` on the skeleton's. A
// body joint may stand in several rows: the first name that the skeleton has counts.
struct JointTable {
  std::string_view name;
  std::array<std::string_view, 2> sides;
  std::vector<std::array<std::string_view, 2>> rows;
};

const std::vector<JointTable>& joint_tables();

}  // namespace reprise::retargeting
