// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A current OpenGL 3.3 core context without window, X server or GPU (EGL surfaceless; Mesa's llvmpipe
// suffices).

#pragma once

// Keeps X11 headers, and their macros, out.
#define EGL_NO_X11
#include <epoxy/gl.h>
// After gl.h. <EGL/egl.h> would clash with both.
#include <epoxy/egl.h>

namespace reprise {

class GlContext {
 public:
  // Throws `Error` if there is no headless OpenGL here; says which library is missing.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  // Makes the context current for a scope and gives the thread back what was current before, so that one
  // thread may use several contexts (also a host program's own) and one context may wander between threads.
  class Scope {
   public:
    explicit Scope(const GlContext& context);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    EGLDisplay display_;
    EGLDisplay previous_display_;
    EGLContext previous_context_;
    EGLSurface previous_draw_;
    EGLSurface previous_read_;
  };

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

// Compiles and links. Throws `Error` with the driver's log.
GLuint link_program(const char* vertex_source, const char* fragment_source);

}  // namespace reprise
