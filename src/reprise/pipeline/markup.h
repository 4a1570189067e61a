// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Stage "markup": joints, parts and layers for a database that has none, from landmarks or from a file.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reprise/database/markup.h"
#include "reprise/mesh/topology.h"

namespace reprise {

// Which parts the labels of a markup make (`body_parts`, `whole_body_part`).
enum class PartScheme {
  as_marked,  // those the markup has
  six,        // torso, head, arms and legs
  limbs,      // the limbs again in upper arm, forearm, hand, thigh, shin, foot
  whole,      // the whole body as one
};
// "six", "limbs" or "whole". Throws `InvalidArgument` listing them.
PartScheme parse_part_scheme(const std::string& text);
std::vector<BodyPart> parts_of(const Topology& topology, const Markup& markup, PartScheme scheme);

struct MarkupOptions {
  std::filesystem::path landmarks;           // JSON of named vertices, from which a markup is proposed
  std::filesystem::path file;                // or JSON of a whole markup
  std::string frame;                         // "CLIP:FRAME" to mark up; empty: the one the file names
  bool keep_joints = false;                  // leave proposed joints where the landmarks put them
  PartScheme parts = PartScheme::as_marked;  // make the parts anew from the joint labels
  std::filesystem::path write_json;          // where to write the markup as JSON; empty: nowhere
};

// Proposed joints are then moved to where the bones on both sides of them agree best through all clips
// (`refine_joints`).
//
// Reads a database, gives it a markup, or new parts to the one it has, and writes it to `output` with
// everything else it holds (the truth of its clips only if the skeleton stays; learnt models have parts of
// their own and stay as they are). Without landmarks, file and parts the markup it has is written as JSON,
// and `output` must be empty. Returns the markup. Throws
// `InvalidArgument`, `FileError`.
Markup mark_up(const std::filesystem::path& database, const MarkupOptions& options,
               const std::filesystem::path& output);

}  // namespace reprise
