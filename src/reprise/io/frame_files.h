// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Kinds of files by their extension, and the numbered frames of a folder.

#pragma once

#include <filesystem>
#include <vector>

namespace reprise {

enum class FileKind { obj, ply, pc2, mdd, hdf5, other };

// By the extension of `path`, in any case.
FileKind file_kind(const std::filesystem::path& path);

struct FrameFiles {
  bool is_obj = true;                        // otherwise PLY
  std::vector<std::filesystem::path> paths;  // in the order of their numbers
};

// The OBJ or PLY files of `folder`, which may hold files of no mesh kind besides. Their names are equal but
// for one number, which counts up without a gap from any start: "frame_9.obj", "frame_10.obj". A single file
// needs no number. Throws `FileError` if there is no such file, both kinds, point caches beside them, a
// number that is missing or used twice, or names that differ in more than their number.
FrameFiles find_frame_files(const std::filesystem::path& folder);

}  // namespace reprise
