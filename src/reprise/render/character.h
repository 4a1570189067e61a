// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The character's triangles, colours and texture in the memory of the OpenGL driver.

#pragma once

#include <vector>

#include "reprise/io/uv_seams.h"
#include "reprise/render/gl_context.h"
#include "reprise/render/openness.h"
#include "reprise/render/renderer.h"

namespace reprise {

// Where shaders find the attributes of a vertex. `color` is a texture coordinate where there is a texture.
enum class VertexAttribute : GLuint { position = 0, normal = 1, open = 2, color = 3 };

// All members need the renderer's context to be current.
class Character {
 public:
  // Throws `InvalidArgument` if `appearance` asks for a texture or colours that are not there, or if the
  // texture is larger than the driver offers.
  Character(const MeshSequence& sequence, const RenderOptions& options);

  bool is_textured() const { return texture_ != 0; }
  GLuint texture() const { return texture_; }

  void upload_frame(std::size_t frame_idx);
  // With whatever program is in use.
  void draw() const;

 private:
  void choose_appearance(Appearance appearance);
  void make_triangles();
  void make_texture(const Image& image);
  template <typename Row>
  void upload_rows(GLuint buffer, const Row* rows) const;

  const MeshSequence& sequence_;
  Color surface_color_;
  bool colors_are_drawn_ = false;
  std::vector<SurfaceSide> sides_;
  SeamCut cut_;  // only where a texture is drawn; otherwise without vertices
  GLuint vertex_array_ = 0;
  GLuint position_buffer_ = 0;
  GLuint normal_buffer_ = 0;
  GLuint open_buffer_ = 0;
  GLuint color_buffer_ = 0;  // or texture coordinates
  GLuint texture_ = 0;
  GLsizei index_count_ = 0;
  GLsizei enclosing_index_count_ = 0;  // the first ones
};

}  // namespace reprise
