// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/mdd.h"
#include "reprise/io/obj.h"
#include "reprise/io/pc2.h"
#include "reprise/io/ply.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no FileError was thrown";
}

ParsedMesh obj(const std::string& text) {
  return parse_obj(text, "a.obj");
}
std::string obj_error(const std::string& text) {
  return message_of([&] { obj(text); });
}

const std::string square_vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, KeepsPositionsAndOrder) {
  const ParsedMesh mesh = obj("v 0.1 -2e-1 +3\nv 1 0 0\nv 0 1 .5\nf 1 2 3\n");
  EXPECT_EQ(mesh.topology.vertex_count, 3);
  EXPECT_THAT(mesh.topology.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.positions.row(0), Eigen::RowVector3f(0.1f, -0.2f, 3.0f));
  EXPECT_EQ(mesh.positions.row(2), Eigen::RowVector3f(0.0f, 1.0f, 0.5f));
  EXPECT_FALSE(mesh.topology.has_uvs());
  EXPECT_EQ(mesh.normals.size(), 0);
  EXPECT_TRUE(mesh.colors.empty());
}

TEST(Obj, AllIndexFormsNameTheSameCorners) {
  const std::string data = square_vertices + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n";
  for (const char* face :
       {"f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1//1 2//1 3//1 4//1", "f 1/1/1 2/2/1 3/3/1 4/4/1",
        "f -4 -3 -2 -1", "f -4/-4/-1 -3/-3/-1 -2/-2/-1 -1/-1/-1", "f 1/ 2/ 3/ 4/"}) {
    const ParsedMesh mesh = obj(data + face);
    EXPECT_THAT(mesh.topology.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3})) << face;
    if (mesh.topology.has_uvs()) {
      EXPECT_EQ(mesh.topology.triangle_uvs, mesh.topology.triangles) << face;
    }
    if (mesh.normals.size() > 0) {
      EXPECT_EQ(mesh.normals.row(3), Eigen::RowVector3f(0, 0, 1)) << face;
    }
  }
}

TEST(Obj, LineEndsCommentsContinuationAndForeignStatementsChangeNothing) {
  const ParsedMesh plain = obj(square_vertices + "f 1 2 3 4\n");
  for (const std::string& text :
       {"\xEF\xBB\xBF# made by hand \\\nmtllib a.mtl\no square\n" + square_vertices +
            "g a\ns 1\nusemtl b\nl 1 2\n"
            "f 1 2 \\\n 3 4",
        std::string("v 0 0 0 # first\r\nv 1 0 0\r\n\tv  1\t1 0 \r\n\r\nv 0 1 \\\r\n0\r\nf 1 2 3 4 # all\r\n"),
        "vp 1 2\nvertex 3\nfo 1 2 3\n" + square_vertices + "curv2 1 \\\n2 3\nf 1 2 3 4"}) {
    const ParsedMesh mesh = obj(text);
    EXPECT_EQ(mesh.positions, plain.positions) << text;
    EXPECT_EQ(mesh.topology.triangles, plain.topology.triangles) << text;
  }
}

TEST(Obj, ColoursAreReadInEitherRange) {
  const std::string faces = "f 1 2 3\n";
  const std::vector<Color> unit = obj("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0 0.2 0.4 0.6\n" + faces).colors;
  EXPECT_THAT(unit, ElementsAre(Color{255, 0, 128}, Color{0, 255, 0}, Color{51, 102, 153}));
  EXPECT_EQ(obj("v 0 0 0 255 0 128\nv 1 0 0 0 255 0\nv 0 1 0 51 102 153\n" + faces).colors, unit);
  // Missing colours are white, wherever they are missing.
  EXPECT_THAT(obj("v 0 0 0\nv 1 0 0 0 1 0\nv 0 1 0\n" + faces).colors,
              ElementsAre(Color{255, 255, 255}, Color{0, 255, 0}, Color{255, 255, 255}));
  EXPECT_TRUE(obj("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n" + faces).colors.empty());  // weights
}

TEST(Obj, SeveralNormalsBecomeTheirNormalisedMean) {
  const ParsedMesh mesh =
      obj(square_vertices + "vn 0 0 1\nvn 0 1 0\nvn 0.6 0.8 0\nf 1//1 2//1 3//3\nf 1//2 3//3 4\n");
  const auto half = static_cast<float>(std::sqrt(0.5));
  EXPECT_TRUE(mesh.normals.row(0).isApprox(Eigen::RowVector3f(0, half, half), 1e-6f));
  EXPECT_EQ(mesh.normals.row(2), Eigen::RowVector3f(0.6f, 0.8f, 0.0f));  // one normal, kept to the last bit
  EXPECT_EQ(mesh.normals.row(3), Eigen::RowVector3f::Zero());
}

TEST(Obj, CornersWithoutTextureCoordinateGetZero) {
  const ParsedMesh mesh = obj(square_vertices + "vt 0.5 0.5\nf 1 2 3\nf 1/1 3/1 4/1\n");
  ASSERT_EQ(mesh.topology.triangle_uvs.size(), 2u);
  const auto uv = [&](std::size_t t, std::size_t k) {
    return mesh.topology.uvs[static_cast<std::size_t>(mesh.topology.triangle_uvs[t][k])];
  };
  EXPECT_THAT(uv(0, 1), ElementsAre(0.0f, 0.0f));
  EXPECT_THAT(uv(1, 2), ElementsAre(0.5f, 0.5f));
}

TEST(Obj, TrianglesWithEqualCornersAreDroppedWithTheirTextureCoordinates) {
  const ParsedMesh mesh = obj(square_vertices + "vt 0 0\nvt 1 1\nf 1/1 1/1 2/1\nf 1/1 2/2 3/1\nf 3 1 2 3\n");
  EXPECT_EQ(mesh.dropped_triangles, 2u);
  EXPECT_THAT(mesh.topology.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 0, 1}));
  EXPECT_EQ(mesh.topology.triangle_uvs.size(), 2u);
  EXPECT_NO_THROW(validate(mesh.topology));
}

TEST(Obj, AFrameWithTheSameFaceTextIsReadLikeAWholeFile) {
  const std::string faces = "vt 0 0\nvn 0 0 1\nvn 0 1 0\nusemtl a\nf 1/1/1 2/1/2 3/1/1\nf 1//2 3//1 4//2\n";
  ObjFaces shared;
  parse_obj(square_vertices + faces, "a.obj", &shared);
  const std::string other = "v 0 0 5 1 0 0\nv 1 0 5\nv 1 1 5\nv 0 2 5\n" + faces;
  const auto frame = parse_obj_frame(other, "b.obj", shared);
  ASSERT_TRUE(frame.has_value());
  const ParsedMesh whole = obj(other);
  EXPECT_EQ(frame->positions, whole.positions);
  EXPECT_EQ(frame->normals, whole.normals);
  EXPECT_EQ(frame->colors, whole.colors);
}

TEST(Obj, FaceTextIsSharedOnlyWhereItMeansTheSameFaces) {
  const std::string faces = "f -4 -3 -2\nf 1 2 3\n";
  ObjFaces shared;
  parse_obj(square_vertices + faces, "a.obj", &shared);
  EXPECT_TRUE(parse_obj_frame(square_vertices + faces, "b.obj", shared));
  EXPECT_FALSE(
      parse_obj_frame("v 9 9 9\n" + square_vertices + faces, "b.obj", shared));  // another vertex count
  EXPECT_FALSE(parse_obj_frame("vn 0 0 1\n" + square_vertices + faces, "b.obj", shared));
  EXPECT_FALSE(
      parse_obj_frame(square_vertices + "f 1 2 4\n" + faces, "b.obj", shared));  // another face before
  EXPECT_FALSE(parse_obj_frame(square_vertices + "f 1 3 2\nf 1 2 3\n", "b.obj", shared));
  // Vertices between faces differ from frame to frame.
  parse_obj(square_vertices + "f 1 2 3\nv 5 5 5\nf 1 2 5\n", "a.obj", &shared);
  EXPECT_FALSE(parse_obj_frame(square_vertices + "f 1 2 3\nv 5 5 5\nf 1 2 5\n", "b.obj", shared));
}

TEST(ObjErrors, NameTheLineAndWhatWasFound) {
  // An empty file, and one of another format.
  EXPECT_THAT(obj_error(""), HasSubstr("a.obj: has no vertices"));
  EXPECT_THAT(obj_error("\x89PNG\r\n\x1a\n"), HasSubstr("has no vertices"));
  // No faces.
  EXPECT_THAT(obj_error(square_vertices), HasSubstr("has no faces"));
  // A bad number, and a missing one.
  EXPECT_THAT(obj_error("v 0 0 0\nv 1 abc 0\n"), AllOf(HasSubstr("a.obj:2:"), HasSubstr("'abc'")));
  EXPECT_THAT(obj_error("v 0 0\nv 1 1 0\n"), AllOf(HasSubstr("a.obj:1:"), HasSubstr("the end of the line")));
  EXPECT_THAT(obj_error("v 1,0 0 0\n"), HasSubstr("'1,0'"));
  EXPECT_THAT(obj_error("v 1 2 3 4 5\n"), HasSubstr("found 5"));
  EXPECT_THAT(obj_error("vt x\n"), HasSubstr("'vt u v'"));
  EXPECT_THAT(obj_error("vn 0 0\n"), HasSubstr("'vn x y z'"));
  // Bad indices.
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 5\n"),
              AllOf(HasSubstr("a.obj:5:"), HasSubstr("vertex index 5"), HasSubstr("has 4")));
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 0\n"), HasSubstr("indices start at 1"));
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 -5\n"), HasSubstr("only 4 stand before it"));
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 99999999999999999999\n"), HasSubstr("out of range"));
  EXPECT_THAT(obj_error(square_vertices + "f 1/1 2/1 3/1\n"), HasSubstr("texture index 1"));
  EXPECT_THAT(obj_error(square_vertices + "f 1//1 2//1 3//1\n"), HasSubstr("normal index 1"));
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 x\n"), HasSubstr("'x'"));
  EXPECT_THAT(obj_error(square_vertices + "f 1 2 3.5\n"), HasSubstr("'.5'"));
  // A face of two corners.
  EXPECT_THAT(obj_error(square_vertices + "\nf 1 2\n"), AllOf(HasSubstr("a.obj:6:"), HasSubstr("found 2")));
}

// A PLY file with every kind of property, in an unusual order, in any format.
class PlyBuilder {
 public:
  explicit PlyBuilder(std::string format) : format_(std::move(format)) {}

  template <typename T>
  PlyBuilder& add(std::initializer_list<T> values) {
    for (T value : values) {
      if (format_ == "ascii") {
        if constexpr (sizeof(T) == 1) {
          body_ += fmt::format("{} ", int{value});
        } else {
          body_ += fmt::format("{} ", value);
        }
      } else {
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), &value, sizeof(T));
        const bool big = format_ == "binary_big_endian";
        if (big != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
        body_.append(raw.begin(), raw.end());
      }
    }
    return *this;
  }
  std::string file(const std::string& elements) const {
    return fmt::format("ply\nformat {} 1.0\ncomment by hand\n{}end_header\n{}", format_, elements, body_);
  }
  std::string body() const { return body_; }

 private:
  std::string format_;
  std::string body_;
};

using U8 = std::uint8_t;
constexpr std::array formats = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST(Ply, AllFormatsTypesAndOrdersGiveTheSameMesh) {
  for (const char* format : formats) {
    PlyBuilder ply(format);
    ply.add<U8>({2}).add<std::int16_t>({-5, 6});                           // camera, before everything
    ply.add<U8>({4}).add<std::uint32_t>({0, 1, 2, 3}).add<float>({7.0f});  // faces before vertices
    ply.add<U8>({3}).add<std::uint32_t>({0, 1, 2}).add<float>({8.0f});
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      ply.add<double>({0.25 + y}).add<U8>({9}).add<float>({static_cast<float>(x)});
      ply.add<U8>({1, 2, 3}).add<std::int32_t>({5}).add<float>({0.0f, 0.0f, 1.0f});
      ply.add<std::uint16_t>({1}).add<std::int8_t>({-3}).add<float>({0.5f * static_cast<float>(x), 0.25f});
    }
    const ParsedMesh mesh = parse_ply(
        ply.file("obj_info none\nelement camera 1\nproperty list uchar short parameters\n"
                 "element face 2\nproperty list uint8 uint32 vertex_index\nproperty float32 quality\n"
                 "element vertex 4\nproperty float64 y\nproperty uint8 flags\nproperty float x\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int z\n"
                 "property float nx\nproperty float ny\nproperty float nz\n"
                 "property list ushort char notes\nproperty float s\nproperty float t\n"),
        "a.ply");
    EXPECT_EQ(mesh.topology.vertex_count, 4) << format;
    EXPECT_THAT(mesh.topology.triangles,
                ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 1, 2}));
    EXPECT_EQ(mesh.positions.row(2), Eigen::RowVector3f(1.0f, 1.25f, 5.0f)) << format;
    EXPECT_EQ(mesh.normals.row(3), Eigen::RowVector3f(0, 0, 1));
    EXPECT_THAT(mesh.colors, ElementsAre(Color{1, 2, 3}, Color{1, 2, 3}, Color{1, 2, 3}, Color{1, 2, 3}));
    EXPECT_EQ(mesh.topology.triangle_uvs, mesh.topology.triangles);
    EXPECT_THAT(mesh.topology.uvs[2], ElementsAre(0.5f, 0.25f));
  }
}

const std::string triangle_header =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\n";

PlyBuilder& add_triangle(PlyBuilder& ply) {
  return ply.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}).add<U8>({3}).add<std::int32_t>({0, 1, 2});
}

TEST(Ply, ColourNamesAndTypesAreEquivalent) {
  const auto colors = [](const std::string& type, const std::array<const char*, 3>& names,
                         const char* values) {
    const std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property {0} {1}\nproperty {0} {2}\nproperty {0} {3}\nelement face 1\nproperty list uchar int "
        "vertex_index\n"
        "end_header\n0 0 0 {4}\n1 0 0 {4}\n0 1 0 {4}\n3 0 1 2\n",
        type, names[0], names[1], names[2], values);
    return parse_ply(text, "a.ply").colors;
  };
  const std::vector<Color> expected(3, Color{255, 51, 0});
  EXPECT_EQ(colors("uchar", {"red", "green", "blue"}, "255 51 0"), expected);
  EXPECT_EQ(colors("float", {"r", "g", "b"}, "1 0.2 0"), expected);
  EXPECT_EQ(colors("double", {"diffuse_red", "diffuse_green", "diffuse_blue"}, "255 51 0"), expected);
  EXPECT_EQ(colors("ushort", {"red", "green", "blue"}, "65535 13107 0"), expected);
  EXPECT_EQ(colors("int", {"red", "green", "blue"}, "255 51 0"), expected);
  EXPECT_TRUE(colors("uchar", {"red", "green", "alpha"}, "255 51 0").empty());
}

TEST(Ply, FaceTexcoordsArePreferredAndMayBeMissing) {
  const ParsedMesh mesh = parse_ply(
      "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float "
      "z\r\n"
      "property float u\r\nproperty float v\r\nelement face 2\r\nproperty list uchar int vertex_indices\r\n"
      "property list uchar float texcoord\r\nend_header\r\n"
      "0 0 0 9 9\r\n1 0 0 9 9\r\n1 1 0 9 9\r\n0 1 0 9 9\r\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\r\n3 0 1 2 0\r\n",
      "a.ply");
  ASSERT_EQ(mesh.topology.triangle_uvs.size(), 3u);
  const auto uv = [&](std::size_t t, std::size_t k) {
    return mesh.topology.uvs[static_cast<std::size_t>(mesh.topology.triangle_uvs[t][k])];
  };
  EXPECT_THAT(uv(1, 0), ElementsAre(0.0f, 0.0f));
  EXPECT_THAT(uv(1, 1), ElementsAre(1.0f, 1.0f));
  EXPECT_THAT(uv(1, 2), ElementsAre(0.0f, 1.0f));
  EXPECT_THAT(uv(2, 1), ElementsAre(0.0f, 0.0f));
}

TEST(PlyErrors, EveryTruncationIsReported) {
  for (const char* format : formats) {
    PlyBuilder ply(format);
    const std::string whole = add_triangle(ply).file(triangle_header);
    EXPECT_NO_THROW(parse_ply(whole, "a.ply"));
    // Without the last digit and space, an ASCII file lacks a value.
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      const std::string message = message_of([&] { parse_ply(whole.substr(0, size), "a.ply"); });
      EXPECT_THAT(message, HasSubstr("a.ply")) << format << " of " << size << " bytes";
    }
    const std::string half = whole.substr(0, whole.size() - ply.body().size() / 2);
    EXPECT_THAT(message_of([&] { parse_ply(half, "a.ply"); }),
                AllOf(HasSubstr("is truncated: expected"), HasSubstr(fmt::format("found {}", half.size()))));
  }
  PlyBuilder vertices("binary_little_endian");
  vertices.add<float>({0, 0, 0, 1, 0});
  const std::string text =
      vertices.file("element vertex 3\nproperty float x\nproperty float y\nproperty float z\n");
  EXPECT_THAT(message_of([&] { parse_ply(text, "a.ply"); }),
              HasSubstr(fmt::format("expected {} bytes, found {}", text.size() + 16, text.size())));
}

TEST(PlyErrors, NameThePlaceAndWhatWasFound) {
  const auto error = [](const std::string& text) { return message_of([&] { parse_ply(text, "a.ply"); }); };
  const auto ascii = [&](const std::string& rows) {
    return error("ply\nformat ascii 1.0\n" + triangle_header + "end_header\n" + rows);
  };
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  // A foreign file.
  EXPECT_THAT(error("solid cube\nfacet"), HasSubstr("is not a PLY file"));
  EXPECT_THAT(error("POINTCACHE2"), HasSubstr("is not a PLY file"));
  // Bad headers, with their line.
  EXPECT_THAT(error("ply\nformat binary 1.0\n"), AllOf(HasSubstr("a.ply:2:"), HasSubstr("'binary'")));
  EXPECT_THAT(error("ply\nformat ascii 2.0\n"), HasSubstr("'2.0'"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex -3\n"),
              AllOf(HasSubstr("a.ply:3:"), HasSubstr("'-3'")));
  EXPECT_THAT(error("ply\nproperty float x\n"), HasSubstr("before any 'element'"));
  EXPECT_THAT(error("ply\nelement vertex 3\nproperty quad x\n"), HasSubstr("'quad' is no PLY number type"));
  EXPECT_THAT(error("ply\nelement vertex 3\nproperty list quad int x\n"), HasSubstr("'quad'"));
  EXPECT_THAT(error("ply\nsomething else\n"), HasSubstr("found 'something'"));
  EXPECT_THAT(error("ply\nend_header\n"), HasSubstr("before any 'format'"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\n"), HasSubstr("expected 'end_header'"));
  // Nothing to see.
  EXPECT_THAT(error("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("has no vertices"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
              HasSubstr("x, y and z"));
  EXPECT_THAT(
      error("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n"),
      HasSubstr("has 0 vertices"));
  EXPECT_THAT(
      error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n1 2 3\n"),
      HasSubstr("has no faces"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement face 1\nproperty int a\nend_header\n1\n"),
              HasSubstr("vertex_indices or vertex_index"));
  // Bad rows.
  EXPECT_THAT(ascii("0 0 x\n1 0 0\n0 1 0\n3 0 1 2\n"), AllOf(HasSubstr("a.ply:10:"), HasSubstr("'x'")));
  EXPECT_THAT(ascii(vertices + "3 0 1 3\n"), HasSubstr("refers to vertex 3, but there are 3"));
  EXPECT_THAT(ascii(vertices + "3 0 1 -1\n"), AllOf(HasSubstr("face 0"), HasSubstr("found -1")));
  EXPECT_THAT(ascii(vertices + "3 0 1 1.5\n"), HasSubstr("found 1.5"));
  EXPECT_THAT(ascii(vertices + "2 0 1\n"), HasSubstr("expected at least 3 corners, found 2"));
  EXPECT_THAT(ascii(vertices + "-3 0 1 2\n"), HasSubstr("found -3"));
}

TEST(PlyErrors, ACountThatCannotFitIsRefusedBeforeMemoryIsTaken) {
  for (const char* count : {"4000000000", "18446744073709551615"}) {
    const std::string text = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n",
        count);
    EXPECT_THAT(message_of([&] { parse_ply(text, "a.ply"); }), HasSubstr("is truncated"));
  }
}

std::string pc2_header(std::int32_t version, std::int32_t vertices, std::int32_t frames) {
  std::string bytes("POINTCACHE2\0", 12);
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(version);
  add(vertices);
  add(0.0f);
  add(1.0f);
  add(frames);
  return bytes;
}

TEST(Pc2Errors, NameWhatWasExpectedAndFound) {
  const auto error = [](const std::string& bytes, std::uint64_t size) {
    return message_of([&] { parse_pc2_header(bytes, size, "a.pc2"); });
  };
  EXPECT_EQ(parse_pc2_header(pc2_header(1, 10, 3), 32 + 360, "a.pc2").frame_count, 3u);
  EXPECT_THAT(error("", 0), HasSubstr("is not a PC2 file"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 3", 500), HasSubstr("is not a PC2 file"));
  EXPECT_THAT(error(pc2_header(1, 10, 3).substr(0, 20), 20), HasSubstr("a header of 32 bytes, found 20"));
  EXPECT_THAT(error(pc2_header(2, 10, 3), 392), HasSubstr("version 1 of PC2, found 2"));
  EXPECT_THAT(error(pc2_header(1, 0, 3), 32), HasSubstr("1 vertex, found 0"));
  EXPECT_THAT(error(pc2_header(1, 10, -3), 32), HasSubstr("1 frame, found -3"));
  EXPECT_THAT(error(pc2_header(1, 10, 3), 391), HasSubstr("is truncated: expected 392 bytes"));
  EXPECT_THAT(error(pc2_header(1, 10, 3), 393), HasSubstr("found 393"));
  EXPECT_THAT(error(pc2_header(1, 0x7fffffff, 0x7fffffff), 1000), HasSubstr("is truncated"));
}

std::string big_endian(std::initializer_list<std::int32_t> integers,
                       std::initializer_list<float> floats = {}) {
  std::string bytes;
  const auto add = [&](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  };
  for (const std::int32_t value : integers) add(static_cast<std::uint32_t>(value));
  for (const float value : floats) add(std::bit_cast<std::uint32_t>(value));
  return bytes;
}

TEST(MddErrors, NameWhatWasExpectedAndFound) {
  const auto error = [](const std::string& bytes, std::uint64_t size) {
    return message_of([&] { parse_mdd_header(bytes, size, "a.mdd"); });
  };
  EXPECT_EQ(parse_mdd_header(big_endian({3, 10}), 8 + 12 + 360, "a.mdd").vertex_count, 10u);
  EXPECT_THAT(error("", 0), HasSubstr("8 bytes, found 0"));
  EXPECT_THAT(error(big_endian({0, 10}), 8), HasSubstr("is not an MDD file"));
  EXPECT_THAT(error(big_endian({3, 10}), 379),
              HasSubstr("is truncated, or not an MDD file: expected 380 bytes"));
  EXPECT_THAT(error("solid cube", 5000), HasSubstr("not an MDD file"));
}

TEST(Mdd, ARateIsStatedOnlyByEvenTimes) {
  const auto rate = [](std::initializer_list<float> times) {
    return frames_per_second_from_mdd_times(big_endian({}, times));
  };
  EXPECT_EQ(rate({0.0f, 0.04f, 0.08f, 0.12f}), 25.0);
  EXPECT_EQ(rate({10.0f, 10.04f, 10.08f}), 25.0);
  EXPECT_NEAR(rate({0.0f, 1001.0f / 30000.0f, 2002.0f / 30000.0f}).value_or(0.0), 29.97, 1e-3);
  EXPECT_EQ(rate({0.0f, 0.04f, 0.12f}), std::nullopt);
  EXPECT_EQ(rate({0.0f}), std::nullopt);
  EXPECT_EQ(rate({0.0f, 0.0f, 0.0f}), std::nullopt);
  EXPECT_EQ(rate({0.0f, NAN}), std::nullopt);
}

// Inputs that fuzzing made of good files, and files that lie about their sizes.
TEST(Corpus, EveryFileIsReadOrRefusedWithAMessage) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(REPRISE_SOURCE_DIR "/tests/fuzz/corpus")) {
    if (!entry.is_regular_file()) continue;
    ++count;
    const std::string bytes = read_text_file(entry.path());
    for (const auto& parse : std::initializer_list<std::function<void()>>{
             [&] { validate(parse_obj(bytes, entry.path()).topology); },
             [&] { validate(parse_ply(bytes, entry.path()).topology); },
             [&] {
               parse_pc2_header(std::string_view(bytes).substr(0, Pc2Header::size), bytes.size(),
                                entry.path());
             },
             [&] { parse_mdd_header(std::string_view(bytes).substr(0, 8), bytes.size(), entry.path()); }}) {
      try {
        parse();
      } catch (const FileError& error) {
        EXPECT_THAT(error.what(), HasSubstr(entry.path().filename().string()));
      }
    }
  }
  EXPECT_GE(count, 20);
}

}  // namespace
}  // namespace reprise
