// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small wrappers of OpenGL objects. They live as long as their context: nothing here is ever freed by itself.
// All need a current context.

#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reprise/render/gl_context.h"

namespace reprise {

// A linked program whose uniforms are set by name, while it is in use.
class Program {
 public:
  Program(const char* vertex_source, const char* fragment_source)
      : id_(link_program(vertex_source, fragment_source)) {}

  void use() const { glUseProgram(id_); }
  void set(const char* name, int value) { glUniform1i(location(name), value); }
  void set(const char* name, double value) { glUniform1f(location(name), static_cast<float>(value)); }
  void set(const char* name, const Eigen::Vector2d& v);
  void set(const char* name, const Eigen::Vector3d& v);
  void set(const char* name, const Eigen::Matrix4d& m);
  void set(const char* name, const Eigen::Matrix<double, 2, 3>& m);
  void set(const char* name, const std::vector<Eigen::Vector2f>& values);

 private:
  GLint location(const char* name);

  GLuint id_;
  std::map<std::string, GLint, std::less<>> locations_;
};

// A target to draw to: white beyond its border.
GLuint make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type, GLint filter);

// Left bound.
GLuint make_framebuffer();
// Throws `Error` that says for `what` the driver offers no target.
void check_framebuffer(const char* what);

void upload(GLuint buffer, const void* data, std::size_t size, GLenum usage);

}  // namespace reprise
