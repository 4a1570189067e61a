// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Colours and patterns on the textures of garments and hair.

#pragma once

#include "reprise/synthetic/body/costume.h"
#include "reprise/synthetic/body/dressed_body.h"

namespace reprise::body {

// The texture in another colour: light and dark of the original about its mean over the layer's triangles
// stay, times `contrast`; its hues go.
void tint(BodyLayer& layer, const Color& color, double contrast = 1.0);

// Draws the pattern on the cloth, in true size on the layer at rest. Light and dark of the original texture
// stay, times `contrast`. The texture becomes at least `texture_size` pixels wide.
void draw_pattern(BodyLayer& layer, const CostumePattern& pattern, double contrast, int texture_size);

// The pattern's colour, red, green and blue from 0 to 255, at a place of the cloth in metres (x around, y
// up).
Eigen::Vector3d pattern_color(const CostumePattern& pattern, const Eigen::Vector2d& place);

}  // namespace reprise::body
