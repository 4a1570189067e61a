// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What tests of writers share: a clip with everything a clip can have, and a disk that is full.

#pragma once

#include <csignal>
#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "support/shapes.h"

namespace reprise::test {

// A walk with texture coordinates that have a seam, normals of its own if asked, and colours: constant, or
// changing from frame to frame.
inline MeshSequence dressed_walk(const std::string& name, std::size_t frame_count, bool colors_change = false,
                                 bool has_normals = false, bool has_seam = true) {
  const MeshSequence bare = walk(name, frame_count);
  Topology topology = *bare.topology();
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    Triangle corners{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto v = topology.triangles[t][corner];
      const float side = has_seam && t % 7 == 0 ? 0.5F : 0.0F;
      corners[corner] = static_cast<std::int32_t>(topology.uvs.size());
      topology.uvs.push_back(
          {side + 0.3F * static_cast<float>(v % 17) / 17.0F, static_cast<float>(v) / 1000.0F});
    }
    topology.triangle_uvs.push_back(corners);
  }
  MeshSequence clip(name, std::make_shared<const Topology>(std::move(topology)), frame_count, 25.0);
  const std::size_t n = clip.vertex_count();
  std::vector<Color> colors;
  for (std::size_t f = 0; f < frame_count; ++f) {
    clip.frame(f) = bare.frame(f);
    if (has_normals) clip.mutable_normals(f) = vertex_normals(*clip.topology(), std::as_const(clip).frame(f));
    for (std::size_t v = 0; v < n && (colors_change || f == 0); ++v) {
      colors.push_back({static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v * 7 + 3 * f),
                        static_cast<std::uint8_t>(255 - v % 200)});
    }
  }
  clip.set_colors(std::move(colors));
  return clip;
}

// The same with a picture on its texture coordinates.
inline MeshSequence textured_walk(const std::string& name, std::size_t frame_count) {
  MeshSequence clip = dressed_walk(name, frame_count);
  Image image{.width = 6, .height = 4};
  for (int i = 0; i < 72; ++i) image.rgb.push_back(static_cast<std::uint8_t>(37 * i));
  Topology topology = *clip.topology();
  topology.texture = std::make_shared<const Image>(std::move(image));
  clip.share_topology(std::make_shared<const Topology>(std::move(topology)));
  return clip;
}

// While it lives, no file of this process can grow beyond `bytes`: writing further fails as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(std::size_t bytes) {
    getrlimit(RLIMIT_FSIZE, &limit_);
    rlimit low = limit_;
    low.rlim_cur = bytes;
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &low);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit limit_{};
  void (*handler_)(int) = SIG_DFL;
};

// Names of everything in a folder, hidden files too.
inline std::set<std::string> entries(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

inline void expect_equal(const MeshSequence& a, const MeshSequence& b) {
  ASSERT_EQ(a.frame_count(), b.frame_count());
  EXPECT_EQ(a.name(), b.name());
  EXPECT_EQ(a.frames_per_second(), b.frames_per_second());
  EXPECT_EQ(a.topology()->triangles, b.topology()->triangles);
  EXPECT_EQ(a.topology()->uvs, b.topology()->uvs);
  EXPECT_EQ(a.topology()->triangle_uvs, b.topology()->triangle_uvs);
  EXPECT_EQ(a.data(), b.data());
  EXPECT_EQ(a.has_normals(), b.has_normals());
  EXPECT_EQ(a.has_colors(), b.has_colors());
  EXPECT_EQ(a.has_colors_per_frame(), b.has_colors_per_frame());
  EXPECT_EQ(a.origins(), b.origins());
  for (std::size_t f = 0; f < a.frame_count(); ++f) {
    if (a.has_normals() && b.has_normals()) {
      EXPECT_EQ(a.normals(f), b.normals(f));
    }
    if (a.has_colors() && b.has_colors()) {
      EXPECT_TRUE(std::ranges::equal(a.colors(f), b.colors(f)));
    }
  }
}

}  // namespace reprise::test
