// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Biovision Hierarchy (.bvh): skeletal motion in one file.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "reprise/sequence/skeleton.h"

namespace reprise {

struct BvhReadOptions {
  double metres_per_unit =
      0.01;  // the format has no unit; 0.01 (centimetres) is common, CMU's files have 0.0254 / 0.45
  // Instead of the file's frame time, which then may be missing or wrong. 0: what the file says.
  double frames_per_second = 0.0;
};

// Channels in any order and number; End Sites become joints named NAME_end. The rest pose is that of zero
// angles. A position channel takes the place of the OFFSET in its direction, as Blender and MotionBuilder
// have it. A frame time that is a rounded 1 / n (0.0083333) means n frames per second. Throws `FileError`
// naming the line.
SkeletalMotion read_bvh(const std::filesystem::path& path, const BvhReadOptions& options = {});

// The same of a text; `path` is named in errors and gives the motion its name.
SkeletalMotion parse_bvh(std::string_view text, const std::filesystem::path& path,
                         const BvhReadOptions& options = {});

// Root with six channels, other joints with three rotations (ZXY): bones have their rest lengths. Spaces in
// names become '_'. A chain that ends without a joint NAME_end gets a short End Site, since readers expect
// one. Written whole or not at all. Throws `InvalidArgument` for a motion without frames or with poses that
// are not finite or not of its skeleton.
void write_bvh(const SkeletalMotion& motion, const std::filesystem::path& path,
               const BvhReadOptions& options = {});

// The text of that file.
std::string format_bvh(const SkeletalMotion& motion, const BvhReadOptions& options = {});

}  // namespace reprise
