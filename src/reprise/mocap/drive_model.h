// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The ways in which a retrieved frame can take the query's pose.

#pragma once

#include <string>

namespace reprise {

enum class DriveModel {
  none,       // it does not: retrieval and interpolation alone
  part,       // the learnt part-based model (HSSMG 5.2.3)
  whole,      // the learnt whole body
  laplacian,  // plain Laplacian editing
  lbs,        // linear blend skinning of the retrieved frame
  dqs,        // dual quaternion skinning of the retrieved frame
  rest_lbs,   // linear blend skinning of one frame, the markup's reference: what a rigged scan does
};

// "none", "part", "whole", "laplacian", "lbs", "dqs", "rest-lbs". Throws `InvalidArgument` listing them.
DriveModel parse_drive_model(const std::string& text);
std::string to_string(DriveModel model);

}  // namespace reprise
