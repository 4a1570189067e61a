// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What is known of a performer beyond the surface: joints, parts and layers of its vertices (HSSMG 3, LPBM
// II), and, for synthetic performers, the truth of every frame.

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reprise/mesh/mesh.h"
#include "reprise/sequence/skeleton.h"

namespace reprise {

// Parts overlap; a vertex may be in several. They form a tree (LPBM III).
struct BodyPart {
  std::string name;                    // "torso", "head", "left_arm", "right_arm", "left_leg", "right_leg"
  int parent = -1;                     // index of a part before this one; -1: the root (the torso)
  std::vector<std::int32_t> vertices;  // ascending
};

struct Markup {
  // Joints at rest, in the coordinates of the reference surface below.
  Skeleton skeleton;
  // The surface on which the markup was made: N x 3, metres. Every vertex label refers to it.
  Positions reference;
  // N entries: the joint whose bone the vertex follows, or -1 for none (cloth that hangs free, hair).
  std::vector<std::int32_t> joint_of_vertex;
  std::vector<BodyPart> parts;
  // What lies under a vertex: names such as "skin", "shirt", "hair"; N entries, or both empty if not known.
  std::vector<std::string> layers;
  std::vector<std::uint8_t> layer_of_vertex;

  // The vertices of a joint's label, ascending.
  std::vector<std::int32_t> vertices_of_joint(int joint_idx) const;
};

// Throws `InvalidArgument` that names what does not fit: counts, indices out of range, names that are empty
// or taken, a part that is empty or unsorted, parts with no or several roots, a label without a joint, a
// reference that is not finite.
void validate(const Markup& markup, std::int32_t vertex_count);

// The same for parts alone; no parts are none to complain of.
void validate(const std::vector<BodyPart>& parts, std::int32_t vertex_count);

// Feet of a frame that stand on the ground: left, right.
using FootContacts = std::array<bool, 2>;

// The truth of a synthetic clip, which a capture never tells.
struct ClipTruth {
  std::vector<SkeletonPose> poses;     // one a frame, of the markup's skeleton
  std::vector<FootContacts> contacts;  // one a frame
};

// Throws `InvalidArgument` naming the frame: not one pose and one contact entry a frame, not one finite
// position and one unit rotation a joint.
void validate(const ClipTruth& truth, const Skeleton& skeleton, std::size_t frame_count);

}  // namespace reprise
