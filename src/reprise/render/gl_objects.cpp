// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/gl_objects.h"

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {

void Program::set(const char* name, const Eigen::Vector2d& v) {
  const Eigen::Vector2f value = v.cast<float>();
  glUniform2fv(location(name), 1, value.data());
}

void Program::set(const char* name, const Eigen::Vector3d& v) {
  const Eigen::Vector3f value = v.cast<float>();
  glUniform3fv(location(name), 1, value.data());
}

void Program::set(const char* name, const Eigen::Matrix4d& m) {
  const Eigen::Matrix4f value = m.cast<float>();
  glUniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}

void Program::set(const char* name, const Eigen::Matrix<double, 2, 3>& m) {
  const Eigen::Matrix<float, 2, 3> value = m.cast<float>();
  glUniformMatrix3x2fv(location(name), 1, GL_FALSE, value.data());
}

void Program::set(const char* name, const std::vector<Eigen::Vector2f>& values) {
  glUniform2fv(location(name), static_cast<GLsizei>(values.size()), values.front().data());
}

GLint Program::location(const char* name) {
  const auto [entry, is_new] = locations_.try_emplace(name, -1);
  if (is_new) entry->second = glGetUniformLocation(id_, name);
  return entry->second;
}

GLuint make_texture(GLenum internal_format, int width, int height, GLenum format, GLenum type, GLint filter) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format, type,
               nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const float lit[] = {1.0F, 1.0F, 1.0F, 1.0F};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  return texture;
}

GLuint make_framebuffer() {
  GLuint framebuffer = 0;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  return framebuffer;
}

void check_framebuffer(const char* what) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  const GLenum error = glGetError();
  if (status != GL_FRAMEBUFFER_COMPLETE || error != GL_NO_ERROR) {
    throw Error(fmt::format("the OpenGL driver cannot make a target for {} (status {:#x}, error {:#x})", what,
                            status, error));
  }
}

void upload(GLuint buffer, const void* data, std::size_t size, GLenum usage) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(size), data, usage);
}

}  // namespace reprise
