// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/obj.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/number.h"

namespace reprise {
namespace {

constexpr std::int32_t absent = -1;
constexpr std::size_t max_count = std::numeric_limits<std::int32_t>::max();

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::filesystem::path& path)
      : begin_(text.data()), end_(text.data() + text.size()), p_(begin_), path_(path) {
    if (text.starts_with("\xEF\xBB\xBF")) p_ += 3;
  }

  // Parses up to the first face, or from there to the end.
  void parse_until_face() { parse_statements(true); }
  void parse_rest() { parse_statements(false); }

  // From the first face on, once `parse_until_face` has returned.
  std::string_view rest() const { return {p_, static_cast<std::size_t>(end_ - p_)}; }

  bool counts_match(const ObjFaces& faces) const {
    return vertex_count() == faces.vertex_count && uvs_.size() == faces.uv_count &&
           normals_.size() == faces.normal_count;
  }

  ParsedMesh finish();
  // Without faces of its own.
  ParsedMesh finish_frame(const ObjFaces& faces);
  void describe(ObjFaces& faces) const;

 private:
  [[noreturn]] void fail(const char* at, const std::string& what) const {
    const std::string_view text(begin_, static_cast<std::size_t>(end_ - begin_));
    throw FileError(path_, line_at(text, static_cast<std::size_t>(at - begin_)), what);
  }
  // The word at `at`, for messages.
  std::string word(const char* at) const {
    const char* last = at;
    while (last != end_ && last - at < 40 && !is_space(*last) && *last != '\n') ++last;
    return last == at ? "the end of the line" : fmt::format("'{}'", std::string(at, last));
  }

  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  // Length of a line continuation at `at`, or 0.
  std::ptrdiff_t continuation(const char* at) const {
    if (*at != '\\') return 0;
    if (end_ - at >= 2 && at[1] == '\n') return 2;
    if (end_ - at >= 3 && at[1] == '\r' && at[2] == '\n') return 3;
    return 0;
  }
  void skip_spaces() {
    while (p_ != end_) {
      if (is_space(*p_)) {
        ++p_;
      } else if (const std::ptrdiff_t length = continuation(p_); length > 0) {
        p_ += length;
      } else {
        return;
      }
    }
  }
  bool at_line_end() const { return p_ == end_ || *p_ == '\n' || *p_ == '#'; }
  // A comment ends with its line, whatever stands before the line end; other statements may be continued.
  void skip_line() {
    while (p_ != end_) {
      const bool comment = *p_ == '#';
      const auto* line_end =
          static_cast<const char*>(std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_)));
      if (line_end == nullptr) {
        p_ = end_;
        return;
      }
      const char* last = line_end;
      if (last != p_ && last[-1] == '\r') --last;
      const bool continued = !comment && last != p_ && last[-1] == '\\';
      p_ = line_end + 1;
      if (!continued) return;
    }
  }

  // The next number of a statement; `what` and `expected` for the message.
  double number(const char* statement) {
    skip_spaces();
    double value = 0.0;
    const char* const after = parse_double(p_, end_, value);
    if (after == p_ ||
        (after != end_ && !is_space(*after) && *after != '\n' && *after != '#' && *after != '\\')) {
      fail(p_, fmt::format("expected a number in '{}', found {}", statement, word(p_)));
    }
    p_ = after;
    return value;
  }

  void parse_statements(bool stop_at_face);
  void parse_vertex();
  void parse_uv();
  void parse_normal();
  void parse_face();
  void parse_name(std::vector<std::string>& names);
  std::int32_t parse_index(std::size_t count, const char* of, std::size_t kind);
  void check_pending();
  Positions vertex_normals_from(const std::vector<std::array<std::int32_t, 2>>& corners) const;
  ParsedMesh take_vertices();

  std::size_t vertex_count() const { return positions_.size() / 3; }

  const char* begin_;
  const char* end_;
  const char* p_;
  const std::filesystem::path& path_;

  std::vector<float> positions_;
  std::vector<float> channels_;  // of colours: none, or three a vertex
  std::vector<std::array<float, 2>> uvs_;
  std::vector<std::array<float, 3>> normals_;

  std::vector<Triangle> triangles_, triangle_uvs_;
  bool any_uv_ = false, all_uv_ = true;
  std::vector<std::array<std::int32_t, 2>> normal_corners_;
  std::vector<std::string> material_files_, materials_;

  // An index may point at an element that follows later: the largest such index of v, vt, vn, checked at the
  // end.
  struct Pending {
    std::int32_t index = absent;
    const char* at = nullptr;
  };
  std::array<Pending, 3> pending_;
};

void ObjParser::parse_statements(bool stop_at_face) {
  while (true) {
    skip_spaces();
    if (p_ == end_) return;
    if (*p_ == '\n') {
      ++p_;
      continue;
    }
    const std::ptrdiff_t left = end_ - p_;
    const auto delimited = [&](std::ptrdiff_t length) {
      return left > length && (is_space(p_[length]) || p_[length] == '\\' || p_[length] == '\n');
    };
    if (*p_ == 'v' && delimited(1)) {
      ++p_;
      parse_vertex();
    } else if (*p_ == 'f' && delimited(1)) {
      if (stop_at_face) return;
      ++p_;
      parse_face();
    } else if (left > 2 && *p_ == 'v' && p_[1] == 't' && delimited(2)) {
      p_ += 2;
      parse_uv();
    } else if (left > 2 && *p_ == 'v' && p_[1] == 'n' && delimited(2)) {
      p_ += 2;
      parse_normal();
    } else if (left > 6 && std::string_view(p_, 6) == "mtllib" && delimited(6)) {
      p_ += 6;
      parse_name(material_files_);
    } else if (left > 6 && std::string_view(p_, 6) == "usemtl" && delimited(6)) {
      p_ += 6;
      parse_name(materials_);
    }
    skip_line();
  }
}

void ObjParser::parse_vertex() {
  const char* const statement = p_;
  if (vertex_count() >= max_count) fail(p_, fmt::format("expected at most {} vertices", max_count));
  std::array<double, 8> values;
  std::size_t count = 0;
  while (count < 3) values[count++] = number("v x y z");
  skip_spaces();
  while (!at_line_end() && count < values.size()) {
    values[count++] = number("v x y z r g b");
    skip_spaces();
  }
  if (count == 5 || count > 7)
    fail(statement, fmt::format("expected 3, 4 or 6 numbers in 'v', found {}", count));
  for (std::size_t k = 0; k < 3; ++k) positions_.push_back(static_cast<float>(values[k]));
  if (count >= 6) {
    // Earlier vertices had no colour.
    if (channels_.size() + 3 < positions_.size()) channels_.resize(positions_.size() - 3, -1.0f);
    for (std::size_t k = 3; k < 6; ++k) channels_.push_back(static_cast<float>(std::max(0.0, values[k])));
  }
}

void ObjParser::parse_uv() {
  if (uvs_.size() >= max_count) fail(p_, fmt::format("expected at most {} texture coordinates", max_count));
  const double u = number("vt u v");
  skip_spaces();
  const double v = at_line_end() ? 0.0 : number("vt u v");
  uvs_.push_back({static_cast<float>(u), static_cast<float>(v)});
}

void ObjParser::parse_normal() {
  if (normals_.size() >= max_count) fail(p_, fmt::format("expected at most {} normals", max_count));
  std::array<float, 3> normal;
  for (float& component : normal) component = static_cast<float>(number("vn x y z"));
  normals_.push_back(normal);
}

// The rest of the line, spaces included; every name once.
void ObjParser::parse_name(std::vector<std::string>& names) {
  skip_spaces();
  const char* const start = p_;
  while (!at_line_end()) ++p_;
  const char* last = p_;
  while (last != start && is_space(last[-1])) --last;
  std::string name(start, last);
  // Beyond that, a list says nothing that anyone could use, and a hostile one would take long to search.
  constexpr std::size_t most = 1000;
  if (!name.empty() && names.size() < most && std::find(names.begin(), names.end(), name) == names.end())
    names.push_back(std::move(name));
}

std::int32_t ObjParser::parse_index(std::size_t count, const char* of, std::size_t kind) {
  const char* const at = p_;
  const bool negative = p_ != end_ && *p_ == '-';
  if (p_ != end_ && (*p_ == '-' || *p_ == '+')) ++p_;
  const char* const digits = p_;
  std::size_t value = 0;
  for (; p_ != end_ && *p_ >= '0' && *p_ <= '9'; ++p_) {
    value = 10 * value + static_cast<std::size_t>(*p_ - '0');
    if (value > max_count) fail(at, fmt::format("{} index {} is out of range", of, word(at)));
  }
  if (p_ == digits) fail(at, fmt::format("expected a {} index in 'f', found {}", of, word(at)));
  if (value == 0) fail(at, fmt::format("{} index 0 in 'f': indices start at 1", of));
  if (negative) {
    if (value > count)
      fail(at, fmt::format("{} index -{} in 'f', but only {} stand before it", of, value, count));
    return static_cast<std::int32_t>(count - value);
  }
  const auto index = static_cast<std::int32_t>(value - 1);
  if (value > count && index > pending_[kind].index) pending_[kind] = {index, at};
  return index;
}

void ObjParser::parse_face() {
  const char* const statement = p_;
  struct Corner {
    std::int32_t vertex = absent, uv = absent, normal = absent;
  };
  Corner first, previous;
  std::size_t count = 0;
  skip_spaces();
  for (; !at_line_end(); ++count) {
    Corner corner;
    corner.vertex = parse_index(vertex_count(), "vertex", 0);
    if (p_ != end_ && *p_ == '/') {
      ++p_;
      if (p_ != end_ && *p_ != '/' && !is_space(*p_) && *p_ != '\n') {
        corner.uv = parse_index(uvs_.size(), "texture", 1);
      }
      if (p_ != end_ && *p_ == '/') {
        ++p_;
        if (p_ != end_ && !is_space(*p_) && *p_ != '\n')
          corner.normal = parse_index(normals_.size(), "normal", 2);
      }
    }
    if (p_ != end_ && !is_space(*p_) && *p_ != '\n' && *p_ != '#' && continuation(p_) == 0) {
      fail(p_, fmt::format("expected v, v/vt, v//vn or v/vt/vn in 'f', found {}", word(p_)));
    }
    (corner.uv == absent ? all_uv_ : any_uv_) = corner.uv != absent;
    if (corner.normal != absent) normal_corners_.push_back({corner.vertex, corner.normal});
    if (count == 0) first = corner;
    if (count >= 2) {
      if (triangles_.size() >= max_count)
        fail(statement, fmt::format("expected at most {} triangles", max_count));
      triangles_.push_back({first.vertex, previous.vertex, corner.vertex});
      // Kept from the first texture index on; the triangles before it are filled in then.
      if (any_uv_) {
        triangle_uvs_.resize(triangles_.size() - 1, Triangle{absent, absent, absent});
        triangle_uvs_.push_back({first.uv, previous.uv, corner.uv});
      }
    }
    previous = corner;
    skip_spaces();
  }
  if (count < 3) fail(statement, fmt::format("expected at least 3 corners in 'f', found {}", count));
}

void ObjParser::check_pending() {
  const std::array<std::size_t, 3> counts = {vertex_count(), uvs_.size(), normals_.size()};
  const std::array<const char*, 3> names = {"vertex", "texture", "normal"};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    if (pending_[kind].index != absent && static_cast<std::size_t>(pending_[kind].index) >= counts[kind]) {
      fail(pending_[kind].at, fmt::format("{} index {} in 'f', but the file has {}", names[kind],
                                          std::int64_t{pending_[kind].index} + 1, counts[kind]));
    }
  }
}

Positions ObjParser::vertex_normals_from(const std::vector<std::array<std::int32_t, 2>>& corners) const {
  if (corners.empty()) return {};
  const auto vertices = static_cast<Eigen::Index>(vertex_count());
  std::vector<std::int32_t> only(vertex_count(), absent);
  std::vector<std::uint8_t> several(vertex_count(), 0);
  for (const auto& [vertex, normal] : corners) {
    std::int32_t& known = only[static_cast<std::size_t>(vertex)];
    if (known == absent) known = normal;
    if (known != normal) several[static_cast<std::size_t>(vertex)] = 1;
  }
  // A vertex with one normal keeps it to the last bit.
  Positions normals = Positions::Zero(vertices, 3);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const auto vertex = static_cast<std::size_t>(v);
    if (only[vertex] != absent && several[vertex] == 0) {
      normals.row(v) =
          Eigen::Map<const Eigen::RowVector3f>(normals_[static_cast<std::size_t>(only[vertex])].data());
    }
  }
  for (const auto& [vertex, normal] : corners) {
    if (several[static_cast<std::size_t>(vertex)] != 0) {
      normals.row(vertex) +=
          Eigen::Map<const Eigen::RowVector3f>(normals_[static_cast<std::size_t>(normal)].data());
    }
  }
  for (Eigen::Index v = 0; v < vertices; ++v) {
    if (several[static_cast<std::size_t>(v)] != 0) normals.row(v).normalize();
  }
  return normals;
}

ParsedMesh ObjParser::take_vertices() {
  ParsedMesh mesh;
  mesh.topology.vertex_count = static_cast<std::int32_t>(vertex_count());
  mesh.positions = Eigen::Map<const Positions>(positions_.data(), static_cast<Eigen::Index>(vertex_count()),
                                               Eigen::Index{3});
  if (!channels_.empty()) {
    channels_.resize(positions_.size(), -1.0f);
    const bool in_bytes = std::any_of(channels_.begin(), channels_.end(), [](float c) { return c > 1.0f; });
    for (float& channel : channels_) {
      if (channel < 0.0f) channel = in_bytes ? 255.0f : 1.0f;  // a vertex without colour is white
    }
    mesh.colors = colors_from_channels(channels_);
  }
  mesh.material_files = material_files_;
  mesh.materials = materials_;
  return mesh;
}

ParsedMesh ObjParser::finish() {
  if (positions_.empty())
    throw FileError(path_, "has no vertices: expected an OBJ file with lines 'v x y z'");
  if (triangles_.empty()) throw FileError(path_, "has no faces: expected lines 'f i j k'");
  check_pending();
  ParsedMesh mesh = take_vertices();
  mesh.normals = vertex_normals_from(normal_corners_);
  mesh.topology.triangles = std::move(triangles_);
  if (any_uv_) {
    mesh.topology.uvs = std::move(uvs_);
    mesh.topology.triangle_uvs = std::move(triangle_uvs_);
    if (!all_uv_) {
      const auto missing = static_cast<std::int32_t>(mesh.topology.uvs.size());
      mesh.topology.uvs.push_back({0.0f, 0.0f});
      for (Triangle& triangle : mesh.topology.triangle_uvs) {
        std::replace(triangle.begin(), triangle.end(), absent, missing);
      }
    }
  }
  drop_repeated_corners(mesh);
  return mesh;
}

ParsedMesh ObjParser::finish_frame(const ObjFaces& faces) {
  ParsedMesh mesh = take_vertices();
  mesh.normals = vertex_normals_from(faces.normal_corners);
  return mesh;
}

void ObjParser::describe(ObjFaces& faces) const {
  faces.vertex_count = vertex_count();
  faces.uv_count = uvs_.size();
  faces.normal_count = normals_.size();
  faces.normal_corners = normal_corners_;
}

}  // namespace

ParsedMesh parse_obj(std::string_view text, const std::filesystem::path& path, ObjFaces* faces) {
  ObjParser parser(text, path);
  parser.parse_until_face();
  const std::string_view face_text = parser.rest();
  ObjFaces before;
  parser.describe(before);
  parser.parse_rest();
  if (faces != nullptr) {
    parser.describe(*faces);
    // Vertices among the faces differ from frame to frame: then the text says nothing about the faces alone.
    faces->text.clear();
    if (parser.counts_match(before)) faces->text = face_text;
  }
  return parser.finish();
}

std::optional<ParsedMesh> parse_obj_frame(std::string_view text, const std::filesystem::path& path,
                                          const ObjFaces& faces) {
  if (faces.text.empty() || !text.ends_with(faces.text)) return std::nullopt;
  ObjParser parser(text, path);
  parser.parse_until_face();
  if (parser.rest().size() != faces.text.size() || !parser.counts_match(faces)) return std::nullopt;
  return parser.finish_frame(faces);
}

}  // namespace reprise
