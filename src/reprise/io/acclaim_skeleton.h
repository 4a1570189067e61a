// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The two halves of an Acclaim motion as their files have them: bones with axes (.asf), and angles (.amc).

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "reprise/io/acclaim.h"

namespace reprise {

// A bone's degrees of freedom in the order of its values: 0 to 2 turn around X to Z, 3 to 5 (the root's
// alone) move along X to Z.
struct AcclaimBone {
  std::string name;
  int parent = -1;                                           // index of a bone before this one
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();          // from begin to end at rest, in the file's units
  Eigen::Quaterniond axis = Eigen::Quaterniond::Identity();  // world from the frame in which angles turn
  std::vector<int> freedoms;
};

struct AcclaimSkeleton {
  std::vector<AcclaimBone> bones;  // the root, without length, then parents before children
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();
};

// Reads the text of an .asf file. Skips sections of no use here (:skin, :units of mass). `path` is named in
// errors.
AcclaimSkeleton parse_asf(std::string_view text, const std::filesystem::path& path);

// Reads the text of an .amc file with the angles of that skeleton.
SkeletalMotion parse_amc(std::string_view text, const std::filesystem::path& path,
                         const AcclaimSkeleton& skeleton, const AcclaimReadOptions& options = {});

}  // namespace reprise
