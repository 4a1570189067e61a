// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/frame_writers.h"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fmt/compile.h>
#include <fmt/format.h>

namespace reprise {

static_assert(std::endian::native == std::endian::little, "binary files are written in the order of memory");

namespace {

constexpr std::string_view mark = "written by Reprise";
constexpr const char* material_name = "surface";

void append_float(std::string& text, float value) {
  fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), value);
}

void append_integer(std::string& text, std::int32_t value) {
  fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), value);
}

template <typename T>
void append_bytes(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

// Colour bytes as OBJ writes them.
const std::array<std::string, 256>& channel_texts() {
  static const std::array<std::string, 256> texts = [] {
    std::array<std::string, 256> result;
    for (std::size_t i = 0; i < 256; ++i) result[i] = fmt::format(" {}", static_cast<float>(i) / 255.0F);
    return result;
  }();
  return texts;
}

}  // namespace

Positions export_normals(const MeshSequence& sequence, std::size_t frame_idx) {
  if (sequence.has_normals()) return sequence.normals(frame_idx);
  return vertex_normals(*sequence.topology(), sequence.frame(frame_idx));
}

bool is_exported_frame(const std::filesystem::path& path, std::string_view naming) {
  std::array<char, 1024> start{};
  std::ifstream stream(path, std::ios::binary);
  stream.read(start.data(), start.size());
  const std::string_view text(start.data(), static_cast<std::size_t>(stream.gcount()));
  return text.substr(0, 128).find(mark) != std::string_view::npos &&
         text.find(naming) != std::string_view::npos;
}

// ---- OBJ
// ------------------------------------------------------------------------------------------------------

std::string material_file_name(const std::string& stem) {
  return stem + ".mtl";
}

std::string texture_file_name(const std::string& stem) {
  return stem + "_texture.png";
}

std::string material_text(const std::string& texture_file) {
  return fmt::format("# {}\nnewmtl {}\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {}\n", mark,
                     material_name, texture_file);
}

ObjFrameWriter::ObjFrameWriter(const MeshSequence& sequence, std::string material_file)
    : sequence_(sequence), material_file_(std::move(material_file)) {
  const Topology& topology = *sequence.topology();
  for (const auto& [u, v] : topology.uvs) {
    uvs_ += "vt ";
    append_float(uvs_, u);
    uvs_ += ' ';
    append_float(uvs_, v);
    uvs_ += '\n';
  }
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    faces_ += 'f';
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::int32_t vertex = topology.triangles[t][corner] + 1;
      faces_ += ' ';
      append_integer(faces_, vertex);
      faces_ += '/';
      if (topology.has_uvs()) append_integer(faces_, topology.triangle_uvs[t][corner] + 1);
      faces_ += '/';
      append_integer(faces_, vertex);
    }
    faces_ += '\n';
  }
}

std::string ObjFrameWriter::text(std::size_t frame_idx) const {
  const auto positions = sequence_.frame(frame_idx);
  const Positions normals = export_normals(sequence_, frame_idx);
  const auto& channels = channel_texts();
  std::string text = fmt::format("# {}, metres, Y up\n", mark);
  if (!material_file_.empty()) text += fmt::format("mtllib {}\n", material_file_);
  text.reserve(text.size() + uvs_.size() + faces_.size() + sequence_.vertex_count() * 100);
  const auto append_row = [&](const char* key, const float* row) {
    text += key;
    append_float(text, row[0]);
    text += ' ';
    append_float(text, row[1]);
    text += ' ';
    append_float(text, row[2]);
  };
  const std::span<const Color> colors =
      sequence_.has_colors() ? sequence_.colors(frame_idx) : std::span<const Color>();
  for (std::size_t v = 0; v < sequence_.vertex_count(); ++v) {
    append_row("v ", positions.data() + 3 * v);
    if (!colors.empty()) {
      for (const std::uint8_t channel : colors[v]) text += channels[channel];
    }
    text += '\n';
  }
  text += uvs_;
  for (std::size_t v = 0; v < sequence_.vertex_count(); ++v) {
    append_row("vn ", normals.data() + 3 * v);
    text += '\n';
  }
  if (!material_file_.empty()) text += fmt::format("usemtl {}\n", material_name);
  text += faces_;
  return text;
}

// ---- PLY
// ------------------------------------------------------------------------------------------------------

PlyFrameWriter::PlyFrameWriter(const MeshSequence& sequence, bool binary, const std::string& texture_file)
    : sequence_(sequence), binary_(binary) {
  const Topology& topology = *sequence.topology();
  cut_ = cut_at_seams(topology);
  has_vertex_uvs_ = topology.has_uvs() && !cut_.has_copies(topology);
  const bool has_face_uvs = topology.has_uvs() && !has_vertex_uvs_;

  header_ = fmt::format("ply\nformat {} 1.0\ncomment {}, metres, Y up\n",
                        binary ? "binary_little_endian" : "ascii", mark);
  if (!texture_file.empty()) header_ += fmt::format("comment TextureFile {}\n", texture_file);
  header_ += fmt::format("element vertex {}\n", topology.vertex_count);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    header_ += fmt::format("property float {}\n", name);
  if (has_vertex_uvs_) header_ += "property float s\nproperty float t\n";
  if (sequence.has_colors()) header_ += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  header_ +=
      fmt::format("element face {}\nproperty list uchar int vertex_indices\n", topology.triangles.size());
  if (has_face_uvs) header_ += "property list uchar float texcoord\n";
  header_ += "end_header\n";

  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const Triangle& triangle = topology.triangles[t];
    std::array<float, 6> corner_uvs{};
    for (std::size_t corner = 0; has_face_uvs && corner < 3; ++corner) {
      const auto& uv = topology.uvs[static_cast<std::size_t>(topology.triangle_uvs[t][corner])];
      corner_uvs[2 * corner] = uv[0];
      corner_uvs[2 * corner + 1] = uv[1];
    }
    if (binary) {
      faces_ += '\3';
      append_bytes(faces_, triangle.data(), 3);
      if (has_face_uvs) {
        faces_ += '\6';
        append_bytes(faces_, corner_uvs.data(), 6);
      }
    } else {
      faces_ += '3';
      for (const std::int32_t vertex : triangle) {
        faces_ += ' ';
        append_integer(faces_, vertex);
      }
      if (has_face_uvs) {
        faces_ += " 6";
        for (const float value : corner_uvs) {
          faces_ += ' ';
          append_float(faces_, value);
        }
      }
      faces_ += '\n';
    }
  }
}

std::string PlyFrameWriter::bytes(std::size_t frame_idx) const {
  const auto positions = sequence_.frame(frame_idx);
  const Positions normals = export_normals(sequence_, frame_idx);
  const std::span<const Color> colors =
      sequence_.has_colors() ? sequence_.colors(frame_idx) : std::span<const Color>();
  std::string bytes = header_;
  bytes.reserve(header_.size() + faces_.size() + sequence_.vertex_count() * (binary_ ? 35 : 100));
  std::array<float, 8> row{};
  const std::size_t columns = has_vertex_uvs_ ? 8 : 6;
  for (std::size_t v = 0; v < sequence_.vertex_count(); ++v) {
    std::memcpy(row.data(), positions.data() + 3 * v, 3 * sizeof(float));
    std::memcpy(row.data() + 3, normals.data() + 3 * v, 3 * sizeof(float));
    if (has_vertex_uvs_) std::memcpy(row.data() + 6, cut_.uvs[v].data(), 2 * sizeof(float));
    if (binary_) {
      append_bytes(bytes, row.data(), columns);
      if (!colors.empty()) append_bytes(bytes, colors[v].data(), 3);
    } else {
      for (std::size_t i = 0; i < columns; ++i) {
        if (i > 0) bytes += ' ';
        append_float(bytes, row[i]);
      }
      for (std::size_t i = 0; !colors.empty() && i < 3; ++i) {
        bytes += ' ';
        append_integer(bytes, colors[v][i]);
      }
      bytes += '\n';
    }
  }
  return bytes += faces_;
}

}  // namespace reprise
