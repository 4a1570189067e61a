// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Binary glTF 2.0: one mesh, one morph target a frame, one animation of their weights.

#pragma once

#include <filesystem>

#include "reprise/io/sequence_writer.h"

namespace reprise {

// Writes `sequence` to the .glb file `target`, whole or not at all, and completes `report`.
//
// Vertices: the first N are those of the sequence, in order; where a vertex has several texture coordinates,
// copies of it follow, and `meshes[0].extras.copied_vertices` lists the vertex each is a copy of. Frames: the
// base mesh is frame 0; target i-1 holds POSITION and NORMAL differences of kept frame i to it, and COLOR_0
// differences if colours change. The animation sets weight i-1 to 1 at the time of kept frame i and all
// others to 0: STEP, or LINEAR if `options.interpolate` or if frames are left out. With T targets the weights
// take 4 T (T + 1) bytes, 263 kB at 256 targets: glTF cannot leave out the zeros. Colours are linear, 16 bits
// a channel (8 would band in dark cloth). Texture coordinates count from the top, as glTF wants.
// `options.quantize`: positions are 16-bit integers that the node's scale and translation return to metres;
// differences are on the same grid, so that their error does not add to that of the base; normals are 8-bit.
// Where a normal turns so far that an 8-bit difference cannot say it, all base normals are (1, 1, 1) /
// sqrt(3), from which differences reach every direction, and frame 0 has a target too. (Weights above 1 would
// do as well, but Blender 3.4 clamps them.)
//
// Throws `FileError`, also if the file would exceed the 4 GiB of binary glTF; `InvalidArgument` for NaN or
// infinite positions, or a surface without triangles.
void write_gltf(const MeshSequence& sequence, const std::filesystem::path& target,
                const SequenceWriteOptions& options, SequenceWriteReport& report);

}  // namespace reprise
