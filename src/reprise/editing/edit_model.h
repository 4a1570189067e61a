// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The ways of deforming a frame that an editing session can be asked for.

#pragma once

#include <string>

namespace reprise {

enum class EditModel {
  part,       // learnt parts (LPBM IV)
  whole,      // the learnt whole body as one part (LPBM Figure 2)
  laplacian,  // nothing learnt (LPBM III)
  lbs,        // linear blend skinning of the extracted skeleton
  dqs,        // dual quaternion skinning of the same
};
inline constexpr int edit_model_count = 5;

// "part", "whole", "laplacian", "lbs", "dqs". Throws `InvalidArgument` listing them.
EditModel parse_edit_model(const std::string& text);
std::string to_string(EditModel model);

}  // namespace reprise
