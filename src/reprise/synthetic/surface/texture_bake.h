// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The layers' colours on the atlas of the surface around them.

#pragma once

#include <vector>

#include "reprise/mesh/image.h"
#include "reprise/mesh/uv_atlas.h"
#include "reprise/synthetic/surface/visible_layers.h"

namespace reprise::capture {

struct BakedTexture {
  Image image;
  std::vector<Color> colors;  // mean about every vertex
};

// `layer_of_vertex`: -1 for vertices that close off a hem: they take the colour of the cloth about them, in
// its shade. Gutters are filled with the colours beside them.
BakedTexture bake(const TriangleMesh& mesh, const UvAtlas& atlas, const std::vector<int>& layer_of_vertex,
                  const VisibleLayers& layers, int texture_size);

}  // namespace reprise::capture
