// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/gl_context.h"

#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr const char* advice = "on Debian: apt install libegl1 libgl1-mesa-dri";

bool has_word(const char* text, std::string_view word) {
  return text != nullptr &&
         (" " + std::string(text) + " ").find(fmt::format(" {} ", word)) != std::string::npos;
}

// The display is shared by all contexts of the process and never terminated: another thread may be using it.
EGLDisplay open_display() {
  // epoxy aborts the process where it cannot load a library, so look first.
  for (const char* library : {"libEGL.so.1", "libGL.so.1"}) {
    if (dlopen(library, RTLD_LAZY | RTLD_GLOBAL) == nullptr) {
      if (std::string_view(library) == "libGL.so.1" &&
          dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_GLOBAL) != nullptr) {
        continue;
      }
      throw Error(fmt::format("no headless OpenGL: {} is missing ({})", library, advice));
    }
  }
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  for (const char* extension : {"EGL_EXT_platform_base", "EGL_MESA_platform_surfaceless"}) {
    if (!has_word(extensions, extension)) {
      throw Error(
          fmt::format("no headless OpenGL: libEGL does not offer {}, Mesa's libEGL_mesa.so.0 is missing ({})",
                      extension, advice));
    }
  }
  // Not eglGetPlatformDisplay: epoxy wants EGL 1.5 for it, which it only knows of a display once there is
  // one.
  EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    throw Error(
        fmt::format("no headless OpenGL: Mesa's driver swrast_dri.so cannot be loaded (EGL error {:#x}; {})",
                    eglGetError(), advice));
  }
  return display;
}

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    glDeleteShader(shader);
    throw Error(fmt::format("the OpenGL driver refuses a shader: {}", log));
  }
  return shader;
}

}  // namespace

GlContext::GlContext() {
  static EGLDisplay display = open_display();
  display_ = display;
  eglBindAPI(EGL_OPENGL_API);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               3,
                               EGL_CONTEXT_MINOR_VERSION,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context_ == EGL_NO_CONTEXT) {
    throw Error(
        fmt::format("no headless OpenGL: the driver does not offer OpenGL 3.3 core (EGL error {:#x}; {})",
                    eglGetError(), advice));
  }
}

GlContext::~GlContext() {
  eglDestroyContext(display_, context_);
}

GlContext::Scope::Scope(const GlContext& context) : display_(context.display_) {
  eglBindAPI(EGL_OPENGL_API);
  previous_display_ = eglGetCurrentDisplay();
  previous_context_ = eglGetCurrentContext();
  previous_draw_ = eglGetCurrentSurface(EGL_DRAW);
  previous_read_ = eglGetCurrentSurface(EGL_READ);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) == EGL_FALSE) {
    throw Error(
        fmt::format("the OpenGL context cannot be used (EGL error {:#x}): is it in use by another thread?",
                    eglGetError()));
  }
}

GlContext::Scope::~Scope() {
  if (previous_context_ != EGL_NO_CONTEXT) {
    eglMakeCurrent(previous_display_, previous_draw_, previous_read_, previous_context_);
  } else {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
}

GLuint link_program(const char* vertex_source, const char* fragment_source) {
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  const GLuint program = glCreateProgram();
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw Error(fmt::format("the OpenGL driver cannot link a shader: {}", log));
  }
  return program;
}

}  // namespace reprise
