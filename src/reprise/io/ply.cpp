// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/ply.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/io/byte_order.h"
#include "reprise/io/number.h"

namespace reprise {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::optional<Type> parse_type(std::string_view word) {
  constexpr std::array<std::array<std::string_view, 2>, 8> names = {{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (word == names[i][0] || word == names[i][1]) return static_cast<Type>(i);
  }
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  // Index of the first property with one of these names, or -1.
  int find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (std::find(names.begin(), names.end(), properties[i].name) != names.end())
        return static_cast<int>(i);
    }
    return -1;
  }
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::vector<std::string> texture_files;
  std::size_t size = 0;  // bytes up to the first row
};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

Header parse_header(std::string_view bytes, const std::filesystem::path& path) {
  Header header;
  bool has_format = false;
  for (std::size_t line_idx = 1;; ++line_idx) {
    const auto fail = [&](const std::string& what) { throw FileError(path, std::to_string(line_idx), what); };
    const std::size_t end = bytes.find('\n', header.size);
    if (end == std::string_view::npos) {
      if (line_idx == 1) throw FileError(path, "is not a PLY file: expected the first line 'ply'");
      throw FileError(path, fmt::format("is truncated: expected 'end_header' before byte {}", bytes.size()));
    }
    const std::vector<std::string_view> words = split(bytes.substr(header.size, end - header.size));
    header.size = end + 1;
    if (line_idx == 1) {
      if (words.size() != 1 || words[0] != "ply") {
        throw FileError(path, "is not a PLY file: expected the first line 'ply'");
      }
      continue;
    }
    if (words.size() > 2 && words[0] == "comment" && words[1] == "TextureFile") {
      // The name may hold spaces: up to the end of the line.
      header.texture_files.emplace_back(words[2].data(), words.back().data() + words.back().size());
    }
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      if (!has_format) fail("'end_header' before any 'format'");
      return header;
    }
    if (words[0] == "format" && words.size() == 3) {
      has_format = true;
      if (words[1] == "ascii") {
        header.format = Format::ascii;
      } else if (words[1] == "binary_little_endian") {
        header.format = Format::little_endian;
      } else if (words[1] == "binary_big_endian") {
        header.format = Format::big_endian;
      } else {
        fail(fmt::format("expected the format ascii, binary_little_endian or binary_big_endian, found '{}'",
                         words[1]));
      }
      if (words[2] != "1.0") fail(fmt::format("expected format version 1.0, found '{}'", words[2]));
    } else if (words[0] == "element" && words.size() == 3) {
      Element element;
      element.name = words[1];
      const auto [after, error] =
          std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
      if (error != std::errc() || after != words[2].data() + words[2].size()) {
        fail(fmt::format("expected a count of element '{}', found '{}'", words[1], words[2]));
      }
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property" && (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
      if (header.elements.empty()) fail("'property' before any 'element'");
      Property property;
      property.name = words.back();
      const std::optional<Type> type = parse_type(words[words.size() - 2]);
      const std::optional<Type> count_type = words.size() == 5 ? parse_type(words[2]) : type;
      if (!type || !count_type) {
        fail(fmt::format("'{}' is no PLY number type", type ? words[2] : words[words.size() - 2]));
      }
      property.type = *type;
      if (words.size() == 5) property.count_type = count_type;
      header.elements.back().properties.push_back(std::move(property));
    } else {
      fail(fmt::format("expected format, element, property, comment or end_header, found '{}'",
                       std::string(words[0].substr(0, 40))));
    }
  }
}

// Values one after another, all as doubles, which hold every PLY type exactly.
class AsciiSource {
 public:
  AsciiSource(std::string_view bytes, std::size_t start, const std::filesystem::path& path)
      : bytes_(bytes), p_(bytes.data() + start), end_(bytes.data() + bytes.size()), path_(path) {}

  std::size_t min_bytes(Type) const { return 2; }  // a digit and a space
  // The last value needs no space after it.
  std::size_t left() const { return static_cast<std::size_t>(end_ - p_) + 1; }

  double next(Type) {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t')) ++p_;
    double value = 0.0;
    const char* const after = parse_double(p_, end_, value);
    if (after == p_ ||
        (after != end_ && *after != ' ' && *after != '\n' && *after != '\r' && *after != '\t')) {
      if (p_ == end_) {
        throw FileError(path_,
                        fmt::format("is truncated: expected another number after {} bytes", bytes_.size()));
      }
      const char* word_end = p_;
      while (word_end != end_ && word_end - p_ < 40 && static_cast<unsigned char>(*word_end) > ' ')
        ++word_end;
      throw FileError(path_, line_at(bytes_, static_cast<std::size_t>(p_ - bytes_.data())),
                      fmt::format("expected a number, found '{}'", std::string(p_, word_end)));
    }
    p_ = after;
    return value;
  }
  void skip(Type type, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) next(type);
  }

 private:
  std::string_view bytes_;
  const char* p_;
  const char* end_;
  const std::filesystem::path& path_;
};

template <std::endian Order>
class BinarySource {
 public:
  BinarySource(std::string_view bytes, std::size_t start, const std::filesystem::path& path)
      : bytes_(bytes), at_(start), path_(path) {}

  std::size_t min_bytes(Type type) const { return size_of(type); }
  std::size_t left() const { return bytes_.size() - at_; }

  double next(Type type) {
    if (left() < size_of(type)) {
      throw FileError(path_, fmt::format("is truncated: expected at least {} bytes, found {}",
                                         at_ + size_of(type), bytes_.size()));
    }
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::float32:
        return static_cast<double>(take<float>());
      case Type::float64:
        return take<double>();
    }
    return 0.0;
  }
  // The caller has checked that as many are left.
  void skip(Type type, std::size_t count) { at_ += size_of(type) * count; }

 private:
  template <typename T>
  T take() {
    const T value = load<T, Order>(bytes_.data() + at_);
    at_ += sizeof(T);
    return value;
  }

  std::string_view bytes_;
  std::size_t at_;
  const std::filesystem::path& path_;
};

// What a value of a colour channel is multiplied with to lie in [0, 1]; floats do already.
double channel_scale(Type type) {
  if (type == Type::float32 || type == Type::float64) return 1.0;
  return type == Type::uint16 || type == Type::int16 ? 1.0 / 65535.0 : 1.0 / 255.0;
}

template <typename Source>
class BodyParser {
 public:
  BodyParser(Source source, std::string_view bytes, const Header& header, const std::filesystem::path& path)
      : source_(std::move(source)), bytes_(bytes), header_(header), path_(path) {}

  ParsedMesh parse();

 private:
  [[noreturn]] void fail(const Element& element, std::uint64_t row, const std::string& what) const {
    throw FileError(path_, fmt::format("{} {}", element.name, row), what);
  }
  void check_size(std::size_t element_idx) const;
  std::size_t list_size(const Element& element, std::uint64_t row, const Property& property);
  void skip_property(const Element& element, std::uint64_t row, const Property& property);
  void parse_vertices(const Element& element);
  void parse_faces(const Element& element);
  void skip_element(const Element& element);

  Source source_;
  std::string_view bytes_;
  const Header& header_;
  const std::filesystem::path& path_;
  ParsedMesh mesh_;
  std::vector<std::array<float, 2>> vertex_uvs_;
  bool has_vertices_ = false, has_faces_ = false;
};

// Before anything is allocated: a count in the header may lie.
template <typename Source>
void BodyParser<Source>::check_size(std::size_t element_idx) const {
  std::uint64_t expected = 0;
  bool exact = header_.format != Format::ascii;
  for (std::size_t e = element_idx; e < header_.elements.size(); ++e) {
    const Element& element = header_.elements[e];
    std::uint64_t row = 0;
    for (const Property& property : element.properties) {
      row += source_.min_bytes(property.count_type.value_or(property.type));
      exact = exact && !property.count_type;
    }
    if (row > 0 && element.count > (std::numeric_limits<std::uint64_t>::max() - expected) / row) {
      throw FileError(path_, fmt::format("is truncated: {} rows of element '{}' cannot be in {} bytes",
                                         element.count, element.name, bytes_.size()));
    }
    expected += row * element.count;
  }
  if (expected > source_.left()) {
    throw FileError(path_,
                    fmt::format("is truncated: expected {}{} bytes, found {}", exact ? "" : "at least ",
                                bytes_.size() - source_.left() + expected, bytes_.size()));
  }
}

template <typename Source>
std::size_t BodyParser<Source>::list_size(const Element& element, std::uint64_t row,
                                          const Property& property) {
  const double count = source_.next(*property.count_type);
  if (!(count >= 0.0) || count != std::floor(count)) {
    fail(element, row, fmt::format("expected the length of list '{}', found {}", property.name, count));
  }
  const auto bytes_per_value = static_cast<double>(source_.min_bytes(property.type));
  if (count * bytes_per_value > static_cast<double>(source_.left())) {
    fail(element, row,
         fmt::format("is truncated: expected at least {:.0f} bytes for list '{}', found {}",
                     count * bytes_per_value, property.name, source_.left()));
  }
  return static_cast<std::size_t>(count);
}

template <typename Source>
void BodyParser<Source>::skip_property(const Element& element, std::uint64_t row, const Property& property) {
  if (property.count_type) {
    source_.skip(property.type, list_size(element, row, property));
  } else {
    source_.next(property.type);
  }
}

template <typename Source>
void BodyParser<Source>::skip_element(const Element& element) {
  if (element.properties.empty()) return;  // its rows take no bytes, however many there are
  for (std::uint64_t row = 0; row < element.count; ++row) {
    for (const Property& property : element.properties) skip_property(element, row, property);
  }
}

template <typename Source>
void BodyParser<Source>::parse_vertices(const Element& element) {
  constexpr std::size_t slot_count = 11;  // x y z, nx ny nz, r g b, u v
  const std::array<int, slot_count> column = {element.find({"x"}),
                                              element.find({"y"}),
                                              element.find({"z"}),
                                              element.find({"nx"}),
                                              element.find({"ny"}),
                                              element.find({"nz"}),
                                              element.find({"red", "r", "diffuse_red"}),
                                              element.find({"green", "g", "diffuse_green"}),
                                              element.find({"blue", "b", "diffuse_blue"}),
                                              element.find({"s", "u", "texture_u"}),
                                              element.find({"t", "v", "texture_v"})};
  const auto scalar = [&](std::size_t slot) {
    return column[slot] >= 0 && !element.properties[static_cast<std::size_t>(column[slot])].count_type;
  };
  const auto all = [&](std::size_t first, std::size_t last) {
    bool found = true;
    for (std::size_t slot = first; slot < last; ++slot) found = found && scalar(slot);
    return found;
  };
  if (!all(0, 3)) throw FileError(path_, "has no vertex positions: expected the properties x, y and z");
  if (element.count == 0 || element.count > std::numeric_limits<std::int32_t>::max()) {
    throw FileError(path_, fmt::format("has {} vertices: expected 1 to 2147483647", element.count));
  }
  const bool has_normals = all(3, 6), has_colors = all(6, 9), has_uvs = all(9, 11);
  std::vector<int> slot_of_property(element.properties.size(), -1);
  std::array<double, slot_count> factor;
  factor.fill(1.0);
  for (std::size_t slot = 0; slot < slot_count; ++slot) {
    if (!scalar(slot)) continue;
    const auto property = static_cast<std::size_t>(column[slot]);
    slot_of_property[property] = static_cast<int>(slot);
    if (slot >= 6 && slot < 9) factor[slot] = channel_scale(element.properties[property].type);
  }

  const auto count = static_cast<Eigen::Index>(element.count);
  mesh_.topology.vertex_count = static_cast<std::int32_t>(count);
  mesh_.positions.resize(count, 3);
  if (has_normals) mesh_.normals.resize(count, 3);
  std::vector<float> channels;
  if (has_colors) channels.reserve(3 * element.count);
  if (has_uvs) vertex_uvs_.reserve(element.count);
  std::array<float, slot_count> value{};
  for (Eigen::Index v = 0; v < count; ++v) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const int slot = slot_of_property[i];
      if (slot < 0) {
        skip_property(element, static_cast<std::uint64_t>(v), element.properties[i]);
      } else {
        const auto s = static_cast<std::size_t>(slot);
        value[s] = static_cast<float>(factor[s] * source_.next(element.properties[i].type));
      }
    }
    mesh_.positions.row(v) << value[0], value[1], value[2];
    if (has_normals) mesh_.normals.row(v) << value[3], value[4], value[5];
    if (has_colors) channels.insert(channels.end(), {value[6], value[7], value[8]});
    if (has_uvs) vertex_uvs_.push_back({value[9], value[10]});
  }
  if (has_colors) mesh_.colors = colors_from_channels(channels);
  has_vertices_ = true;
}

template <typename Source>
void BodyParser<Source>::parse_faces(const Element& element) {
  const int indices = element.find({"vertex_indices", "vertex_index"});
  const int texcoord = element.find({"texcoord"});
  if (indices < 0 || !element.properties[static_cast<std::size_t>(indices)].count_type) {
    throw FileError(path_, "has no face corners: expected the list vertex_indices or vertex_index");
  }
  if (element.count > std::numeric_limits<std::int32_t>::max()) {
    throw FileError(path_, fmt::format("has {} faces: expected at most 2147483647", element.count));
  }
  std::vector<Triangle>& triangles = mesh_.topology.triangles;
  std::vector<Triangle>& triangle_uvs = mesh_.topology.triangle_uvs;
  std::vector<std::array<float, 2>>& uvs = mesh_.topology.uvs;
  triangles.reserve(element.count);
  std::vector<std::int32_t> corners;
  std::vector<float> coordinates;
  bool some_without_uv = false;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    corners.clear();
    coordinates.clear();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (static_cast<int>(i) == indices) {
        const std::size_t size = list_size(element, row, property);
        for (std::size_t k = 0; k < size; ++k) {
          const double index = source_.next(property.type);
          const bool in_range = index >= 0.0 && index < std::numeric_limits<std::int32_t>::max();
          if (!in_range || index != std::floor(index)) {
            fail(element, row, fmt::format("expected a vertex index, found {}", index));
          }
          corners.push_back(static_cast<std::int32_t>(index));
        }
      } else if (static_cast<int>(i) == texcoord && property.count_type) {
        const std::size_t size = list_size(element, row, property);
        for (std::size_t k = 0; k < size; ++k)
          coordinates.push_back(static_cast<float>(source_.next(property.type)));
      } else {
        skip_property(element, row, property);
      }
    }
    if (corners.size() < 3)
      fail(element, row, fmt::format("expected at least 3 corners, found {}", corners.size()));
    const auto first_uv = static_cast<std::int32_t>(uvs.size());
    const bool with_uv = coordinates.size() == 2 * corners.size();
    some_without_uv = some_without_uv || !with_uv;
    if (with_uv) {
      for (std::size_t k = 0; k < corners.size(); ++k)
        uvs.push_back({coordinates[2 * k], coordinates[2 * k + 1]});
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      triangles.push_back({corners[0], corners[k], corners[k + 1]});
      const auto second = first_uv + static_cast<std::int32_t>(k);
      triangle_uvs.push_back(with_uv ? Triangle{first_uv, second, second + 1} : Triangle{-1, -1, -1});
    }
  }
  if (uvs.empty()) {
    triangle_uvs.clear();
  } else if (some_without_uv) {
    const auto missing = static_cast<std::int32_t>(uvs.size());
    uvs.push_back({0.0f, 0.0f});
    for (Triangle& triangle : triangle_uvs) {
      if (triangle[0] < 0) triangle.fill(missing);
    }
  }
  has_faces_ = true;
}

template <typename Source>
ParsedMesh BodyParser<Source>::parse() {
  for (std::size_t e = 0; e < header_.elements.size(); ++e) {
    const Element& element = header_.elements[e];
    // What follows vertices and faces is of no use here.
    if (has_vertices_ && has_faces_) break;
    check_size(e);
    if (element.name == "vertex" && !has_vertices_) {
      parse_vertices(element);
    } else if (element.name == "face" && !has_faces_) {
      parse_faces(element);
    } else {
      skip_element(element);
    }
  }
  if (!has_vertices_) throw FileError(path_, "has no vertices: expected an element 'vertex'");
  if (mesh_.topology.triangles.empty()) throw FileError(path_, "has no faces: expected an element 'face'");
  for (std::size_t t = 0; t < mesh_.topology.triangles.size(); ++t) {
    for (const std::int32_t corner : mesh_.topology.triangles[t]) {
      if (corner >= mesh_.topology.vertex_count) {
        throw FileError(
            path_, fmt::format("triangle {}", t),
            fmt::format("refers to vertex {}, but there are {}", corner, mesh_.topology.vertex_count));
      }
    }
  }
  if (mesh_.topology.uvs.empty() && !vertex_uvs_.empty()) {
    mesh_.topology.uvs = std::move(vertex_uvs_);
    mesh_.topology.triangle_uvs = mesh_.topology.triangles;
  }
  drop_repeated_corners(mesh_);
  return std::move(mesh_);
}

}  // namespace

ParsedMesh parse_ply(std::string_view bytes, const std::filesystem::path& path) {
  const Header header = parse_header(bytes, path);
  const auto parse_body = [&](auto source) {
    return BodyParser(std::move(source), bytes, header, path).parse();
  };
  ParsedMesh mesh;
  switch (header.format) {
    case Format::ascii:
      mesh = parse_body(AsciiSource(bytes, header.size, path));
      break;
    case Format::little_endian:
      mesh = parse_body(BinarySource<std::endian::little>(bytes, header.size, path));
      break;
    case Format::big_endian:
      mesh = parse_body(BinarySource<std::endian::big>(bytes, header.size, path));
      break;
  }
  mesh.texture_files = header.texture_files;
  return mesh;
}

}  // namespace reprise
