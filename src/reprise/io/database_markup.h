// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The parts of a database file that say more than the surface (format version 2): texture, markup, truth.
// Readers throw `FileError` naming the object for what is damaged or does not fit.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/io/hdf5.h"
#include "reprise/mesh/image.h"

namespace reprise {

// Child "texture" of the topology group.
void write_texture(Hdf5Group& topology, const Image& texture);
Image read_texture(const Hdf5Group& topology);

// `markup`, `truth`: the group itself, new or read. What is written has been validated.
void write_markup(Hdf5Group& group, const Markup& markup);
Markup read_markup(const Hdf5Group& group, std::int32_t vertex_count);

// The same within a group: datasets part_names, part_parents, part_sizes, part_vertices. Readers do not check
// what the parts mean.
void write_parts(Hdf5Group& group, const std::vector<BodyPart>& parts);
std::vector<BodyPart> read_parts(const Hdf5Group& group);

void write_truth(Hdf5Group& group, const ClipTruth& truth);
ClipTruth read_truth(const Hdf5Group& group, const Skeleton& skeleton, std::size_t frame_count);

}  // namespace reprise
