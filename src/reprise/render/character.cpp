// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/character.h"

#include <algorithm>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/render/gl_objects.h"

namespace reprise {

Character::Character(const MeshSequence& sequence, const RenderOptions& options)
    : sequence_(sequence), surface_color_(options.surface_color) {
  glGenVertexArrays(1, &vertex_array_);
  glBindVertexArray(vertex_array_);
  GLuint buffers[4];
  glGenBuffers(4, buffers);
  position_buffer_ = buffers[0];
  normal_buffer_ = buffers[1];
  open_buffer_ = buffers[2];
  color_buffer_ = buffers[3];
  choose_appearance(options.appearance);
  const auto attribute = [](GLuint buffer, VertexAttribute place, GLint size, GLenum type) {
    const auto location = static_cast<GLuint>(place);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glVertexAttribPointer(location, size, type, type == GL_FLOAT ? GL_FALSE : GL_TRUE, 0, nullptr);
    glEnableVertexAttribArray(location);
  };
  attribute(position_buffer_, VertexAttribute::position, 3, GL_FLOAT);
  attribute(normal_buffer_, VertexAttribute::normal, 3, GL_FLOAT);
  attribute(open_buffer_, VertexAttribute::open, 2, GL_FLOAT);
  if (is_textured()) {
    attribute(color_buffer_, VertexAttribute::color, 2, GL_FLOAT);
  } else {
    attribute(color_buffer_, VertexAttribute::color, 3, GL_UNSIGNED_BYTE);
  }
  sides_ = surface_sides(*sequence.topology(), sequence.frame(0));
  make_triangles();
}

void Character::choose_appearance(Appearance appearance) {
  const Topology& topology = *sequence_.topology();
  const bool has_texture = topology.texture != nullptr;
  if (appearance == Appearance::texture && !has_texture) {
    throw InvalidArgument(fmt::format("'{}' has no texture to draw", sequence_.name()));
  }
  if (appearance == Appearance::vertex_colors && !sequence_.has_colors()) {
    throw InvalidArgument(fmt::format("'{}' has no vertex colours to draw", sequence_.name()));
  }
  const bool is_automatic = appearance == Appearance::automatic;
  if (appearance == Appearance::texture || (is_automatic && has_texture)) {
    cut_ = cut_at_seams(topology);
    make_texture(*topology.texture);
    // OpenGL's first row is v = 0, the image's is v = 1.
    std::vector<std::array<float, 2>> uvs = cut_.uvs;
    for (auto& uv : uvs) uv[1] = 1.0F - uv[1];
    upload(color_buffer_, uvs.data(), uvs.size() * sizeof(uvs.front()), GL_STATIC_DRAW);
    return;
  }
  if ((appearance == Appearance::vertex_colors || is_automatic) && sequence_.has_colors()) {
    colors_are_drawn_ = true;
    const auto colors = sequence_.colors(0);
    upload(color_buffer_, colors.data(), colors.size_bytes(), GL_STATIC_DRAW);
    return;
  }
  const std::vector<Color> colors(sequence_.vertex_count(), surface_color_);
  upload(color_buffer_, colors.data(), colors.size() * sizeof(Color), GL_STATIC_DRAW);
}

void Character::make_texture(const Image& image) {
  validate(image);
  GLint max_size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  if (image.width > max_size || image.height > max_size) {
    throw InvalidArgument(fmt::format("texture: the OpenGL driver offers at most {0} x {0}, found {1} x {2}",
                                      max_size, image.width, image.height));
  }
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  // As sRGB, the driver mixes texels in linear light.
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image.width, image.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               image.rgb.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // No anisotropic filter: on a CPU it takes nearly half of the time of a frame, and shows on few triangles.
}

void Character::make_triangles() {
  const std::vector<Triangle>& original = sequence_.topology()->triangles;
  const std::vector<Triangle>& drawn = is_textured() ? cut_.triangles : original;
  // Those of components that enclose a volume come first. As every vertex lies before the camera and before
  // the light, these see such a component from outside alone.
  std::vector<Triangle> triangles;
  triangles.reserve(drawn.size());
  for (const bool encloses : {true, false}) {
    for (std::size_t t = 0; t < drawn.size(); ++t) {
      const bool is_enclosing = sides_[static_cast<std::size_t>(original[t][0])] == SurfaceSide::normal;
      if (is_enclosing == encloses) triangles.push_back(drawn[t]);
    }
    if (encloses) enclosing_index_count_ = static_cast<GLsizei>(3 * triangles.size());
  }
  index_count_ = static_cast<GLsizei>(3 * triangles.size());
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(Triangle)),
               triangles.data(), GL_STATIC_DRAW);
}

template <typename Row>
void Character::upload_rows(GLuint buffer, const Row* rows) const {
  if (!is_textured()) {
    upload(buffer, rows, sequence_.vertex_count() * sizeof(Row), GL_STREAM_DRAW);
    return;
  }
  std::vector<Row> copies(cut_.source_vertices.size());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    copies[i] = rows[static_cast<std::size_t>(cut_.source_vertices[i])];
  }
  upload(buffer, copies.data(), copies.size() * sizeof(Row), GL_STREAM_DRAW);
}

void Character::upload_frame(std::size_t frame_idx) {
  using Row = std::array<float, 3>;
  const PositionsView positions = sequence_.frame(frame_idx);
  const Topology& topology = *sequence_.topology();
  // On the uncut surface: shading shows no seams of the texture.
  const Positions normals =
      sequence_.has_normals() ? Positions(sequence_.normals(frame_idx)) : vertex_normals(topology, positions);
  const std::vector<Openness> open =
      openness(topology, positions, PositionsView(normals.data(), normals.rows(), 3));
  upload_rows(position_buffer_, reinterpret_cast<const Row*>(positions.data()));
  upload_rows(normal_buffer_, reinterpret_cast<const Row*>(normals.data()));
  upload_rows(open_buffer_, open.data());
  if (colors_are_drawn_ && sequence_.has_colors_per_frame()) {
    const auto colors = sequence_.colors(frame_idx);
    upload(color_buffer_, colors.data(), colors.size_bytes(), GL_STREAM_DRAW);
  }
}

void Character::draw() const {
  glEnable(GL_CULL_FACE);
  glDrawElements(GL_TRIANGLES, enclosing_index_count_, GL_UNSIGNED_INT, nullptr);
  glDisable(GL_CULL_FACE);
  const std::size_t offset = sizeof(GLuint) * static_cast<std::size_t>(enclosing_index_count_);
  // OpenGL takes offsets into a buffer as pointers. NOLINTNEXTLINE(performance-no-int-to-ptr)
  const auto* rest = reinterpret_cast<const void*>(offset);
  glDrawElements(GL_TRIANGLES, index_count_ - enclosing_index_count_, GL_UNSIGNED_INT, rest);
}

}  // namespace reprise
