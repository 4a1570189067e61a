// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The tree of body parts from the vertices they share (LPBM IV.B).

#pragma once

#include <vector>

#include "reprise/database/markup.h"

namespace reprise {

// The same parts (their `parent` is not read) as a tree, root first and parents before children, else in the
// given order. Grown from the root: a part hangs on the part nearest to the root among those with which it
// shares at least half as many vertices as with any other, so that two legs under one skirt both hang on the
// torso, of several on the one with which it shares most. Where no part outside of the tree shares that much
// with one in it, the pair that shares most is joined. Of equals, the part given first joins, at the parent
// that joined first. Throws `InvalidArgument`: a root out of range; names and vertices that `validate`
// refuses; a part that shares no vertex with any other; groups that share none.
std::vector<BodyPart> derive_hierarchy(std::vector<BodyPart> parts, int root_idx);

}  // namespace reprise
