// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Textures beside mesh files: written, found again, or missing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "reprise/io/io_test_support.h"
#include "reprise/io/mesh_texture.h"
#include "reprise/io/obj.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/io/sequence_writer.h"
#include "support/captured_log.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Image& picture() {
  static const Image image = [] {
    Image result{.width = 3, .height = 2};
    for (int i = 0; i < 18; ++i) result.rgb.push_back(static_cast<std::uint8_t>(14 * i));
    return result;
  }();
  return image;
}

std::string obj_text(const std::string& before, const std::string& between = "") {
  return before + "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n" + "f 1/1 2/2 3/3\n" +
         between + "f 2/2 4/1 3/3\n";
}

TEST(TextureFiles, EveryFormatOfFramesKeepsTheTexture) {
  const TemporaryFolder folder;
  const MeshSequence clip = test::textured_walk("walk", 3);
  write_sequence(clip, folder / "obj", SequenceFormat::obj);
  write_sequence(clip, folder / "ply", SequenceFormat::ply);
  write_sequence(clip, folder / "ascii", SequenceFormat::ply, {.binary_ply = false});
  EXPECT_THAT(test::entries(folder / "obj"), ElementsAre("walk.mtl", "walk_00000.obj", "walk_00001.obj",
                                                         "walk_00002.obj", "walk_texture.png"));
  EXPECT_THAT(test::entries(folder / "ply"),
              ElementsAre("walk_00000.ply", "walk_00001.ply", "walk_00002.ply", "walk_texture.png"));
  for (const char* name : {"obj", "ply", "ascii"}) {
    const test::CapturedLog log;
    const auto reader = open_sequence({.path = folder / name});
    ASSERT_TRUE(reader->topology()->texture) << name;
    EXPECT_EQ(*reader->topology()->texture, *clip.topology()->texture) << name;
    EXPECT_EQ(reader->read(1).positions, clip.frame(1)) << name;
    EXPECT_THAT(log.text(), IsEmpty());
  }
}

TEST(TextureFiles, AnEarlierTexturedExportIsReplacedAndNothingElse) {
  const TemporaryFolder folder;
  const MeshSequence clip = test::textured_walk("walk", 2);
  for (const auto& [name, format] :
       {std::pair("obj", SequenceFormat::obj), std::pair("ply", SequenceFormat::ply)}) {
    write_sequence(clip, folder / name, format);
    EXPECT_NO_THROW(write_sequence(clip, folder / name, format));
    // Without a texture, its files go too.
    EXPECT_NO_THROW(write_sequence(test::walk("walk", 2), folder / name, format));
    EXPECT_EQ(test::entries(folder / name).size(), 2U);
    write_sequence(clip, folder / name, format);
    for (const char* foreign : {"other.mtl", "other_texture.png", "walk.png"}) {
      write_text_file(folder / name / foreign, "mine");
      EXPECT_THROW(write_sequence(clip, folder / name, format), FileError) << foreign;
      fs::remove(folder / name / foreign);
    }
    EXPECT_NO_THROW(write_sequence(clip, folder / name, format));
  }
}

TEST(TextureFiles, APointCacheHasItsTextureBesideItsTopology) {
  const TemporaryFolder folder;
  const MeshSequence clip = test::textured_walk("walk", 3);
  for (const SequenceFormat format : {SequenceFormat::pc2, SequenceFormat::mdd}) {
    const fs::path target = folder / ("a" + file_extension(format));
    const auto report = write_sequence(clip, target, format);
    EXPECT_THAT(report.files_beside, ElementsAre(folder / "a_texture.png", folder / "a.ply"));
    const auto reader = open_sequence({.path = target, .topology = folder / "a.ply"});
    ASSERT_TRUE(reader->topology()->texture);
    EXPECT_EQ(*reader->topology()->texture, *clip.topology()->texture);
    EXPECT_NO_THROW(write_sequence(clip, target, format)) << "an earlier export";
  }
  write_text_file(folder / "b_texture.png", "mine");
  EXPECT_THROW(write_sequence(clip, folder / "b.pc2", SequenceFormat::pc2), FileError);
  EXPECT_EQ(read_text_file(folder / "b_texture.png"), "mine");
  EXPECT_FALSE(fs::exists(folder / "b.pc2"));
  EXPECT_FALSE(fs::exists(folder / "b.ply"));
}

TEST(Mtl, NamesFollowOptionsAndMayHoldSpaces) {
  const auto texture_of = [](const std::string& line) {
    const auto materials = parse_mtl("newmtl skin\n" + line + "\n");
    return materials.size() == 1 ? materials[0].texture_file : "none";
  };
  EXPECT_EQ(texture_of("map_Kd a.png"), "a.png");
  EXPECT_EQ(texture_of("  map_Kd\t my picture.png \r"), "my picture.png");
  EXPECT_EQ(texture_of("map_Kd textures\\skin.jpg"), "textures/skin.jpg");
  EXPECT_EQ(texture_of("map_Kd -clamp on a.png"), "a.png");
  EXPECT_EQ(texture_of("map_Kd -s 1 1 1 -o 0.5 a.png"), "a.png");
  EXPECT_EQ(texture_of("map_Kd -mm 0 1 -o 1 2 -blendu off 1.png"), "1.png");
  EXPECT_EQ(texture_of("map_Kd -t 1 2 3"), "3") << "what comes last is the name";
  EXPECT_EQ(texture_of("map_Ks a.png"), "");
  EXPECT_EQ(texture_of("map_Kd"), "");
  const auto several =
      parse_mtl("# no newline at the end\nmap_Kd early.png\nnewmtl a\nnewmtl b c\nmap_Kd x.png");
  ASSERT_EQ(several.size(), 2U);
  EXPECT_EQ(several[0].texture_file, "");
  EXPECT_EQ(several[1].name, "b c");
  EXPECT_EQ(several[1].texture_file, "x.png");
  EXPECT_THAT(parse_mtl(""), IsEmpty());
}

TEST(Obj, MaterialNamesAreKeptOnce) {
  const ParsedMesh mesh = parse_obj(
      obj_text("mtllib my files.mtl # comment\nusemtl a\n", "usemtl b\nusemtl a\nmtllibs x\nusemtl\n"),
      "a.obj");
  EXPECT_THAT(mesh.material_files, ElementsAre("my files.mtl"));
  EXPECT_THAT(mesh.materials, ElementsAre("a", "b"));
}

TEST(TextureFiles, TheTextureOfTheMaterialInUseIsLoaded) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "maps");
  write_png(picture(), folder / "maps" / "skin.png");
  write_text_file(folder / "two.mtl", "newmtl other\nmap_Kd none.png\nnewmtl skin\nmap_Kd maps/skin.png\n");
  const test::CapturedLog log;
  write_text_file(folder / "a.obj", obj_text("mtllib two.mtl\nusemtl skin\n"));
  const Mesh mesh = read_mesh(folder / "a.obj");
  ASSERT_TRUE(mesh.topology->texture);
  EXPECT_EQ(*mesh.topology->texture, picture());

  // Nothing to be said: no texture coordinates; a material without a picture; no material at all.
  write_text_file(folder / "b.obj", "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_FALSE(read_mesh(folder / "b.obj").topology->texture);
  write_text_file(folder / "plain.mtl", "newmtl skin\nKd 1 0 0\n");
  write_text_file(folder / "c.obj", obj_text("mtllib plain.mtl\nusemtl skin\n"));
  EXPECT_FALSE(read_mesh(folder / "c.obj").topology->texture);
  write_text_file(folder / "d.obj", obj_text(""));
  EXPECT_FALSE(read_mesh(folder / "d.obj").topology->texture);
  EXPECT_THAT(log.text(), IsEmpty());
}

TEST(TextureFiles, WhatCannotBeLoadedIsAWarningAndTheMeshIsRead) {
  const TemporaryFolder folder;
  write_png(picture(), folder / "skin.png");
  write_text_file(folder / "broken.png", "a picture of a horse");
  write_text_file(folder / "skin.mtl", "newmtl a\nmap_Kd skin.png\nnewmtl b\nmap_Kd broken.png\n");
  write_text_file(folder / "missing.mtl", "newmtl a\nmap_Kd nowhere.png\n");
  struct Case {
    std::string materials;
    std::string expected;
  };
  for (const Case& c :
       {Case{"mtllib nowhere.mtl\n", "material file 'nowhere.mtl' is missing"},
        Case{"mtllib missing.mtl\nusemtl a\n", "nowhere.png"},
        Case{"mtllib skin.mtl\nusemtl b\n", "broken.png: is neither a PNG nor a JPEG"},
        Case{"mtllib skin.mtl\nusemtl a\nusemtl b\n", "has 2 textures"}, Case{"mtllib .\n", "is missing"}}) {
    write_text_file(folder / "mesh.obj", obj_text(c.materials));
    const test::CapturedLog log;
    const Mesh mesh = read_mesh(folder / "mesh.obj");
    EXPECT_FALSE(mesh.topology->texture) << c.materials;
    EXPECT_EQ(mesh.topology->triangles.size(), 2U);
    EXPECT_THAT(log.text(), testing::AllOf(HasSubstr("mesh.obj"), HasSubstr(c.expected)));
  }
}

TEST(TextureFiles, ATextureThatChangesFromFrameToFrameIsReported) {
  const TemporaryFolder folder;
  for (const char* name : {"one", "two"}) {
    write_png(picture(), folder / (std::string(name) + ".png"));
    write_text_file(folder / (std::string(name) + ".mtl"), fmt::format("newmtl a\nmap_Kd {}.png\n", name));
  }
  write_text_file(folder / "frame_0.obj", obj_text("mtllib one.mtl\n"));
  write_text_file(folder / "frame_1.obj", obj_text("mtllib two.mtl\n"));
  const test::CapturedLog log;
  EXPECT_TRUE(open_sequence({.path = folder.path()})->topology()->texture);
  EXPECT_THAT(log.text(), testing::AllOf(HasSubstr("frame_1.obj"), HasSubstr("another texture")));
}

}  // namespace
}  // namespace reprise
