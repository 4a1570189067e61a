// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A mesh sequence to the files other programs read: one object with N samples, never N objects.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/sequence/mesh_sequence.h"

namespace reprise {

enum class SequenceFormat { obj, ply, pc2, mdd, gltf };

// Shared by all formats; the fields of other formats are ignored.
struct SequenceWriteOptions {
  bool binary_ply = true;      // little-endian binary rather than ASCII
  bool write_topology = true;  // PC2, MDD: also write NAME.ply beside the file, with faces, UVs and colours
  bool quantize =
      false;  // glTF: 16-bit positions and 8-bit normals (KHR_mesh_quantization), about half the size
  bool interpolate = false;  // glTF: LINEAR weights between frames rather than STEP
  int max_morph_targets =
      256;  // glTF: the texture layers every WebGL 2 viewer has; longer clips keep the frames that say most
};

// What was written, for the user.
struct SequenceWriteReport {
  std::filesystem::path path;                       // the file or folder
  std::vector<std::filesystem::path> files_beside;  // such as the topology of a PC2
  std::size_t frames_written = 0;  // samples; less than the clip's frames where a format cannot hold them all
  double max_error = 0.0;          // metres: quantisation, or interpolation between kept frames
};

// obj and ply write the folder `target` of NAME_00000.obj ... files; the others the file `target`. A texture
// goes along: inside of a glTF file (instead of vertex colours, which viewers would multiply it with), else
// as NAME_texture.png beside the files that name it (NAME.mtl of OBJ, the PLY). Written whole or not at all.
// Throws `FileError`; refuses to replace a folder that holds anything but frames of an earlier export.
SequenceWriteReport write_sequence(const MeshSequence& sequence, const std::filesystem::path& target,
                                   SequenceFormat format, const SequenceWriteOptions& options = {});

// From a name on the command line ("obj", "ply", "pc2", "mdd", "glb"), or from a target's extension if the
// name is empty. Throws `InvalidArgument` listing the formats.
SequenceFormat parse_sequence_format(const std::string& name, const std::filesystem::path& target);

// ".glb", ".pc2", ".mdd"; empty for the formats that write a folder.
std::string file_extension(SequenceFormat format);

}  // namespace reprise
