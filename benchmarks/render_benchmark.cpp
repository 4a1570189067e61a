// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Time of a frame of video at 1280 x 720, by stage, beside what the OpenGL driver alone needs in the same
// run: to clear and read a picture of that size, and to draw the same triangles in one colour.

#include <algorithm>
#include <chrono>
#include <functional>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "real_data.h"
#include "reprise/pipeline/render.h"
#include "reprise/render/camera.h"
#include "reprise/render/gl_context.h"

namespace reprise::benchmark {
namespace {

// Elapsed and processor time in milliseconds; the latter with ended children (the encoder).
struct Times {
  double elapsed = 0.0;
  double processor = 0.0;
};

Times now() {
  Times times;
  times.elapsed =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage = {};
    getrusage(who, &usage);
    for (const timeval& part : {usage.ru_utime, usage.ru_stime}) {
      times.processor += 1e3 * static_cast<double>(part.tv_sec) + 1e-3 * static_cast<double>(part.tv_usec);
    }
  }
  return times;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Medians over `runs`, of each the mean of `frames` frames.
Times measure(int runs, std::size_t frames, const std::function<void()>& run) {
  std::vector<double> elapsed;
  std::vector<double> processor;
  for (int i = 0; i < runs; ++i) {
    const Times start = now();
    run();
    const Times end = now();
    elapsed.push_back((end.elapsed - start.elapsed) / static_cast<double>(frames));
    processor.push_back((end.processor - start.processor) / static_cast<double>(frames));
  }
  return {median(elapsed), median(processor)};
}

void report(const char* what, const Times& times) {
  fmt::print("  {:48} {:7.1f} frames/s   processor {:6.1f} ms a frame\n", what, 1e3 / times.elapsed,
             times.processor);
}

// The least a driver does for a picture: one colour, one sample a pixel, no light, no floor.
class BareDriver {
 public:
  BareDriver(const MeshSequence& clip, const RenderOptions& options)
      : clip_(clip), options_(options), path_(clip, options) {
    const GlContext::Scope scope(context_);
    GLuint renderbuffers[2];
    glGenRenderbuffers(2, renderbuffers);
    GLuint target = 0;
    glGenFramebuffers(1, &target);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
    const GLenum attachments[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[i], options.width, options.height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachments[i], GL_RENDERBUFFER, renderbuffers[i]);
    }
    glViewport(0, 0, options.width, options.height);
    GLuint vertex_array = 0;
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    GLuint buffers[2];
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(0);
    const auto& triangles = clip.topology()->triangles;
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(Triangle)),
                 triangles.data(), GL_STATIC_DRAW);
    program_ = link_program(
        "#version 330 core\nlayout(location = 0) in vec3 position;\nuniform mat4 clip_from_world;\n"
        "void main() { gl_Position = clip_from_world * vec4(position, 1.0); }\n",
        "#version 330 core\nout vec4 result;\nvoid main() { result = vec4(0.7, 0.6, 0.5, 1.0); }\n");
    glUseProgram(program_);
    glEnable(GL_DEPTH_TEST);
    pixels_.resize(4 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  }

  void clear_and_read() {
    const GlContext::Scope scope(context_);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    read();
  }

  void draw_and_read(std::size_t frame_idx) {
    const GlContext::Scope scope(context_);
    const View view = path_.view(frame_idx);
    Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
    m.block<1, 3>(0, 0) = (view.right / path_.tan_half_width()).transpose().cast<float>();
    m.block<1, 3>(1, 0) = (view.up / path_.tan_half_height()).transpose().cast<float>();
    m.block<1, 3>(3, 0) = view.forward.transpose().cast<float>();
    m.block<1, 3>(2, 0) = m.block<1, 3>(3, 0);
    m.col(3) = -m.leftCols<3>() * view.eye.cast<float>();
    m(2, 3) -= 0.2F;  // depth 1 - 0.2 / distance
    glUniformMatrix4fv(glGetUniformLocation(program_, "clip_from_world"), 1, GL_FALSE, m.data());
    const PositionsView positions = clip_.frame(frame_idx);
    glBufferData(GL_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(static_cast<std::size_t>(positions.size()) * sizeof(float)),
                 positions.data(), GL_STREAM_DRAW);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * clip_.topology()->triangles.size()),
                   GL_UNSIGNED_INT, nullptr);
    read();
  }

 private:
  void read() {
    glReadPixels(0, 0, options_.width, options_.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels_.data());
  }

  const MeshSequence& clip_;
  RenderOptions options_;
  CameraPath path_;
  GlContext context_;
  GLuint program_ = 0;
  std::vector<std::uint8_t> pixels_;
};

void measure_clip(const MeshSequence& clip) {
  constexpr int runs = 5;
  const RenderOptions options;
  const std::size_t frames = clip.frame_count();
  fmt::print("{}: {} frames of {} vertices, {} triangles\n", clip.name(), frames, clip.vertex_count(),
             clip.topology()->triangles.size());
  BareDriver bare(clip, options);
  report("driver alone: clear, read back", measure(runs, frames, [&] {
           for (std::size_t f = 0; f < frames; ++f) bare.clear_and_read();
         }));
  report("driver alone: one colour, read back", measure(runs, frames, [&] {
           for (std::size_t f = 0; f < frames; ++f) bare.draw_and_read(f);
         }));

  SequenceRenderer renderer(clip, options);
  std::vector<Image> images(frames);
  report("draw, read back", measure(runs, frames, [&] {
           for (std::size_t f = 0; f < frames; ++f) images[f] = renderer.draw(f);
         }));
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("render_benchmark.{}", getpid());
  std::filesystem::create_directory(folder);
  report("encode", measure(runs, frames, [&] {
           VideoWriter video(folder / "a.mp4", options.width, options.height, clip.frames_per_second());
           for (const Image& image : images) video.append(image);
           video.commit();
         }));
  report("all: draw and encode side by side, set-up too",
         measure(runs, frames, [&] { render_sequence(clip, folder / "a.mp4"); }));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace reprise::benchmark

int main() {
  using namespace reprise;
  const std::filesystem::path data = benchmark::data_folder();
  PerformanceDatabase ama;
  benchmark::add_clip(ama, "ama crane", {.path = data / "ama" / "crane"});
  PerformanceDatabase fashion;
  benchmark::add_clip(fashion, "fashion walk",
                      {.path = data / "fashion" / "walk.pc2", .topology = data / "fashion" / "topology.ply"});
  fmt::print("1280 x 720; medians of 5 runs over the clip\n");
  benchmark::measure_clip(ama.clip(0));
  benchmark::measure_clip(fashion.clip(0));
  return 0;
}
