// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/sequence_writer.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/frame_thinning.h"
#include "reprise/io/image_file.h"
#include "reprise/io/io_test_support.h"
#include "reprise/io/sequence_reader.h"
#include "reprise/io/uv_seams.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using testing::ThrowsMessage;
namespace fs = std::filesystem;
using nlohmann::json;

// ---- Round trips through our own readers
// ----------------------------------------------------------------------

// Texture coordinates of every corner: what stays the same when a format numbers them otherwise.
std::vector<std::array<float, 2>> corner_uvs(const Topology& topology) {
  std::vector<std::array<float, 2>> result;
  for (const Triangle& triangle : topology.triangle_uvs) {
    for (const std::int32_t uv : triangle) result.push_back(topology.uvs[static_cast<std::size_t>(uv)]);
  }
  return result;
}

void expect_round_trip(const MeshSequence& sequence, const SequenceReader& reader) {
  ASSERT_EQ(reader.frame_count(), sequence.frame_count());
  EXPECT_EQ(reader.topology()->triangles, sequence.topology()->triangles);
  EXPECT_EQ(corner_uvs(*reader.topology()), corner_uvs(*sequence.topology()));
  for (std::size_t f = 0; f < sequence.frame_count(); ++f) {
    const Mesh mesh = reader.read(f);
    EXPECT_EQ(mesh.positions, sequence.frame(f)) << f;
    EXPECT_TRUE(std::ranges::equal(mesh.colors, sequence.colors(f))) << f;
  }
}

TEST(SequenceWriter, FoldersOfFramesComeBackWithEveryFloatColorAndUv) {
  const test::TemporaryFolder folder;
  for (const bool has_seam : {true, false}) {
    const MeshSequence clip = test::dressed_walk("walk", 4, true, true, has_seam);
    for (const auto& [format, binary, extension] :
         {std::tuple(SequenceFormat::obj, false, ".obj"), std::tuple(SequenceFormat::ply, true, ".ply"),
          std::tuple(SequenceFormat::ply, false, ".ply")}) {
      const fs::path target = folder / (std::string("out") + extension);
      const auto report = write_sequence(clip, target, format, {.binary_ply = binary});
      EXPECT_EQ(report.path, target);
      EXPECT_EQ(report.frames_written, 4U);
      EXPECT_EQ(report.max_error, 0.0);
      EXPECT_THAT(test::entries(target),
                  ElementsAre(std::string("walk_00000") + extension, std::string("walk_00001") + extension,
                              std::string("walk_00002") + extension, std::string("walk_00003") + extension));
      const auto reader = open_sequence({.path = target});
      expect_round_trip(clip, *reader);
      for (std::size_t f = 0; f < 4; ++f) {
        EXPECT_LT((reader->read(f).normals - clip.normals(f)).cwiseAbs().maxCoeff(), 1e-6F);
      }
    }
  }
}

TEST(SequenceWriter, PointCachesComeBackWithTheTopologyBeside) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::dressed_walk("walk", 4);
  for (const auto& [format, name] :
       {std::pair(SequenceFormat::pc2, "a.pc2"), std::pair(SequenceFormat::mdd, "b.mdd")}) {
    const auto report = write_sequence(clip, folder / name, format);
    const fs::path beside = (folder / name).replace_extension(".ply");
    EXPECT_THAT(report.files_beside, ElementsAre(beside));
    const auto reader = open_sequence({.path = folder / name, .topology = beside});
    expect_round_trip(clip, *reader);
    if (format == SequenceFormat::mdd) {
      EXPECT_NEAR(reader->frames_per_second().value_or(0.0), 25.0, 1e-3);
    }
  }
  EXPECT_THAT(
      write_sequence(clip, folder / "c.pc2", SequenceFormat::pc2, {.write_topology = false}).files_beside,
      IsEmpty());
  EXPECT_FALSE(fs::exists(folder / "c.ply"));
  EXPECT_EQ(read_text_file(folder / "c.pc2"), read_text_file(folder / "a.pc2"));
}

TEST(SequenceWriter, NormalsAreComputedWhereTheSourceHasNone) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 2);
  write_sequence(clip, folder / "out", SequenceFormat::ply);
  const auto reader = open_sequence({.path = folder / "out"});
  EXPECT_EQ(reader->read(1).normals, vertex_normals(*clip.topology(), clip.frame(1)));
}

// ---- What is replaced, and what is not
// ------------------------------------------------------------------------

TEST(SequenceWriter, ReplacesAnEarlierExportAndNothingElse) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 3);
  const fs::path target = folder / "out";
  const auto write = [&](SequenceFormat format) { write_sequence(clip, target, format); };
  fs::create_directory(target);
  write(SequenceFormat::obj);  // an empty folder
  write(SequenceFormat::obj);  // an earlier export
  // Frames of another format.
  EXPECT_THROW(write(SequenceFormat::ply), FileError);
  // Somebody's file among the frames.
  std::ofstream(target / "notes.txt") << "mine";
  EXPECT_THAT([&] { write(SequenceFormat::obj); }, ThrowsMessage<FileError>(HasSubstr("notes.txt")));
  fs::remove(target / "notes.txt");
  // A folder named like a frame.
  fs::create_directory(target / "walk_00007.obj");
  EXPECT_THROW(write(SequenceFormat::obj), FileError);
  fs::remove(target / "walk_00007.obj");
  // A capture that is named like our frames but was not written by us.
  std::ofstream(target / "scan_00000.obj") << "v 0 0 0\n";
  EXPECT_THAT([&] { write(SequenceFormat::obj); }, ThrowsMessage<FileError>(HasSubstr("scan_00000.obj")));
  EXPECT_EQ(read_text_file(target / "scan_00000.obj"), "v 0 0 0\n");
  fs::remove(target / "scan_00000.obj");
  write(SequenceFormat::obj);
  EXPECT_EQ(test::entries(target).size(), 3U);
  EXPECT_THAT(test::entries(folder.path()), ElementsAre("out"));
}

TEST(SequenceWriter, NeverReplacesATopologyThatIsNotItsOwn) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 2);
  std::ofstream(folder / "a.ply") << "ply of somebody";
  EXPECT_THROW(write_sequence(clip, folder / "a.pc2", SequenceFormat::pc2), FileError);
  EXPECT_EQ(read_text_file(folder / "a.ply"), "ply of somebody");
  EXPECT_THAT(test::entries(folder.path()), ElementsAre("a.ply"));
}

TEST(SequenceWriter, FullDiskIsAnErrorForEveryFormatAndLeavesNothing) {
  const MeshSequence clip = test::dressed_walk("walk", 8);
  for (const auto format : {SequenceFormat::obj, SequenceFormat::ply, SequenceFormat::pc2,
                            SequenceFormat::mdd, SequenceFormat::gltf}) {
    for (const std::size_t limit : {0, 10, 1000, 20000}) {
      const test::TemporaryFolder folder;
      const test::FullDisk full(limit);
      EXPECT_THAT([&] { write_sequence(clip, folder / "out", format); },
                  ThrowsMessage<FileError>(HasSubstr("cannot be written")))
          << static_cast<int>(format) << " " << limit;
      EXPECT_TRUE(fs::is_empty(folder.path())) << static_cast<int>(format) << " " << limit;
    }
  }
}

TEST(SequenceWriter, RefusesWhatCannotBeWritten) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 2);
  EXPECT_THROW(write_sequence(MeshSequence(), folder / "a.glb", SequenceFormat::gltf), InvalidArgument);
  EXPECT_THROW(write_sequence(clip, folder / "no" / "a.glb", SequenceFormat::gltf), FileError);
  EXPECT_THROW(write_sequence(clip, folder / "a.glb", SequenceFormat::gltf, {.max_morph_targets = 0}),
               InvalidArgument);
  MeshSequence broken = clip;
  broken.frame(1)(5, 2) = std::nanf("");
  EXPECT_THAT([&] { write_sequence(broken, folder / "a.glb", SequenceFormat::gltf); },
              ThrowsMessage<InvalidArgument>(HasSubstr("vertex 5 of frame 1")));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SequenceFormat, FollowsFromTheNameOrTheTarget) {
  EXPECT_EQ(parse_sequence_format("PLY", "a.obj"), SequenceFormat::ply);
  EXPECT_EQ(parse_sequence_format("", "a/b.mdd"), SequenceFormat::mdd);
  EXPECT_EQ(parse_sequence_format("", "b.glb"), SequenceFormat::gltf);
  EXPECT_THAT([] { parse_sequence_format("", "b.gltf"); }, ThrowsMessage<InvalidArgument>(HasSubstr(".glb")));
  EXPECT_THAT([] { parse_sequence_format("", "folder"); },
              ThrowsMessage<InvalidArgument>(HasSubstr("obj, ply")));
  EXPECT_THAT([] { parse_sequence_format("pcx", "a"); }, ThrowsMessage<InvalidArgument>(HasSubstr("'pc2'?")));
}

// ---- glTF
// -----------------------------------------------------------------------------------------------------

// A reader for what the writer writes: the animated mesh at the time of any kept frame.
class Glb {
 public:
  explicit Glb(const fs::path& path) : bytes_(read_text_file(path)) {
    EXPECT_EQ(bytes_.substr(0, 4), "glTF");
    EXPECT_EQ(word(8), bytes_.size());
    const std::size_t json_size = word(12);
    document = json::parse(bytes_.substr(20, json_size));
    binary_ = 28 + json_size;
    EXPECT_EQ(word(20 + json_size) + binary_, bytes_.size());
  }

  // Elements of an accessor as doubles, normalised where it says so.
  std::vector<double> values(std::size_t accessor_idx) const {
    const json& accessor = document["accessors"][accessor_idx];
    const json& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::map<std::string, std::size_t> columns = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    const std::map<int, std::size_t> sizes = {{5120, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}};
    const std::size_t n = columns.at(accessor["type"]);
    const int component = accessor["componentType"];
    const std::size_t size = sizes.at(component);
    const std::size_t stride = view.value("byteStride", n * size);
    const bool normalized = accessor.value("normalized", false);
    std::vector<double> result;
    for (std::size_t i = 0; i < accessor["count"].get<std::size_t>(); ++i) {
      for (std::size_t c = 0; c < n; ++c) {
        const char* at =
            bytes_.data() + binary_ + view["byteOffset"].get<std::size_t>() + i * stride + c * size;
        switch (component) {
          case 5120:
            result.push_back(get<std::int8_t>(at) / (normalized ? 127.0 : 1.0));
            break;
          case 5122:
            result.push_back(get<std::int16_t>(at) / (normalized ? 32767.0 : 1.0));
            break;
          case 5123:
            result.push_back(get<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0));
            break;
          case 5125:
            result.push_back(get<std::uint32_t>(at));
            break;
          default:
            result.push_back(get<float>(at));
        }
      }
    }
    return result;
  }

  // The bytes of a buffer view.
  std::string_view view(std::size_t view_idx) const {
    const json& view = document["bufferViews"][view_idx];
    return std::string_view(bytes_).substr(binary_ + view["byteOffset"].get<std::size_t>(),
                                           view["byteLength"].get<std::size_t>());
  }

  const json& primitive() const { return document["meshes"][0]["primitives"][0]; }
  const json& sampler() const { return document["animations"][0]["samplers"][0]; }
  std::size_t target_count() const { return primitive().value("targets", json::array()).size(); }

  // An attribute at key `key` of the animation: base plus weighted targets.
  std::vector<double> at_key(const std::string& attribute, std::size_t key) const {
    std::vector<double> result = values(primitive()["attributes"][attribute]);
    const std::vector<double> weights = values(sampler()["output"]);
    for (std::size_t t = 0; t < target_count(); ++t) {
      const double weight = weights.at(key * target_count() + t);
      if (weight == 0.0) continue;
      const std::vector<double> difference = values(primitive()["targets"][t][attribute]);
      for (std::size_t i = 0; i < result.size(); ++i) result[i] += weight * difference[i];
    }
    return result;
  }

  // Positions in metres of the sequence's own vertices at a key.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> positions(std::size_t key,
                                                                      std::size_t count) const {
    const std::vector<double> v = at_key("POSITION", key);
    const json& node = document["nodes"][0];
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> result(static_cast<Eigen::Index>(count), 3);
    for (std::size_t i = 0; i < 3 * count; ++i) {
      const double scale = node.contains("scale") ? node["scale"][i % 3].get<double>() : 1.0;
      const double offset = node.contains("translation") ? node["translation"][i % 3].get<double>() : 0.0;
      result.data()[i] = v[i] * scale + offset;
    }
    return result;
  }

  json document;

 private:
  template <typename T>
  static T get(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  std::size_t word(std::size_t offset) const { return get<std::uint32_t>(bytes_.data() + offset); }

  std::string bytes_;
  std::size_t binary_ = 0;
};

double linear_from_srgb(std::uint8_t channel) {
  const double c = channel / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

TEST(Gltf, EveryFrameOfAShortClipPlaysAtItsTime) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::dressed_walk("walk", 12);
  const auto report = write_sequence(clip, folder / "a.glb", SequenceFormat::gltf);
  EXPECT_EQ(report.frames_written, 12U);
  EXPECT_LT(report.max_error, 1e-6);
  const Glb glb(folder / "a.glb");
  EXPECT_EQ(glb.document["meshes"].size(), 1U);
  EXPECT_EQ(glb.document["nodes"].size(), 1U);
  EXPECT_EQ(glb.target_count(), 11U);
  EXPECT_EQ(glb.sampler()["interpolation"], "STEP");
  const std::vector<double> times = glb.values(glb.sampler()["input"]);
  ASSERT_EQ(times.size(), 12U);
  for (std::size_t f = 0; f < 12; ++f) {
    EXPECT_NEAR(times[f], static_cast<double>(f) / 25.0, 1e-6);
    const auto error =
        (glb.positions(f, clip.vertex_count()) - clip.frame(f).cast<double>()).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 1e-6);
  }
}

TEST(Gltf, LinearOptionInterpolatesWithoutLeavingFramesOut) {
  const test::TemporaryFolder folder;
  write_sequence(test::walk("walk", 5), folder / "a.glb", SequenceFormat::gltf, {.interpolate = true});
  const Glb glb(folder / "a.glb");
  EXPECT_EQ(glb.sampler()["interpolation"], "LINEAR");
  EXPECT_EQ(glb.target_count(), 4U);
}

TEST(Gltf, CornersKeepTheirUvAndVerticesTheirLinearColor) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::dressed_walk("walk", 2);
  write_sequence(clip, folder / "a.glb", SequenceFormat::gltf);
  const Glb glb(folder / "a.glb");
  const Topology& topology = *clip.topology();
  const std::vector<double> indices = glb.values(glb.primitive()["indices"]);
  const std::vector<double> uvs = glb.values(glb.primitive()["attributes"]["TEXCOORD_0"]);
  const std::vector<double> colors = glb.values(glb.primitive()["attributes"]["COLOR_0"]);
  const auto copied = glb.document["meshes"][0]["extras"]["copied_vertices"].get<std::vector<std::int32_t>>();
  ASSERT_FALSE(copied.empty());
  ASSERT_EQ(uvs.size(), 2 * (clip.vertex_count() + copied.size()));
  ASSERT_EQ(indices.size(), 3 * topology.triangles.size());
  const auto expected_uvs = corner_uvs(topology);
  for (std::size_t corner = 0; corner < indices.size(); ++corner) {
    const auto index = static_cast<std::size_t>(indices[corner]);
    const auto source =
        index < clip.vertex_count() ? static_cast<std::int32_t>(index) : copied[index - clip.vertex_count()];
    ASSERT_EQ(source, topology.triangles[corner / 3][corner % 3]);
    ASSERT_EQ(static_cast<float>(uvs[2 * index]), expected_uvs[corner][0]);
    ASSERT_NEAR(1.0 - uvs[2 * index + 1], expected_uvs[corner][1], 1e-7);
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(colors[4 * index + c],
                  linear_from_srgb(clip.colors(0)[static_cast<std::size_t>(source)][c]), 1e-5);
    }
    ASSERT_EQ(colors[4 * index + 3], 1.0);
  }
}

TEST(Gltf, TheTextureIsInsideAndNothingIsMultipliedWithIt) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::textured_walk("walk", 3);
  ASSERT_TRUE(clip.has_colors());
  for (const bool quantize : {false, true}) {
    write_sequence(clip, folder / "a.glb", SequenceFormat::gltf, {.quantize = quantize});
    const Glb glb(folder / "a.glb");
    EXPECT_FALSE(glb.primitive()["attributes"].contains("COLOR_0"));
    const json& look = glb.document["materials"][0]["pbrMetallicRoughness"];
    const json& texture = glb.document["textures"][look["baseColorTexture"]["index"].get<std::size_t>()];
    const json& image = glb.document["images"][texture["source"].get<std::size_t>()];
    EXPECT_EQ(image["mimeType"], "image/png");
    EXPECT_EQ(decode_png(std::as_bytes(std::span(glb.view(image["bufferView"].get<std::size_t>())))),
              *clip.topology()->texture);
    // glTF's v = 0 is the top of the picture.
    const std::vector<double> uvs = glb.values(glb.primitive()["attributes"]["TEXCOORD_0"]);
    const SeamCut cut = cut_at_seams(*clip.topology());
    for (std::size_t i = 0; i < cut.uvs.size(); ++i) EXPECT_EQ(uvs[2 * i + 1], 1.0F - cut.uvs[i][1]);
  }
}

TEST(Gltf, ChangingColorsPlayToo) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::dressed_walk("walk", 4, true);
  for (const bool quantize : {false, true}) {
    write_sequence(clip, folder / "a.glb", SequenceFormat::gltf, {.quantize = quantize});
    const Glb glb(folder / "a.glb");
    for (std::size_t f = 0; f < 4; ++f) {
      const std::vector<double> colors = glb.at_key("COLOR_0", f);
      for (std::size_t v = 0; v < clip.vertex_count(); ++v) {
        ASSERT_NEAR(colors[4 * v + 1], linear_from_srgb(clip.colors(f)[v][1]), 1e-4);
      }
    }
  }
}

TEST(Gltf, LongClipKeepsTheFramesThatFitAndStatesItsError) {
  const test::TemporaryFolder folder;
  const MeshSequence clip = test::walk("walk", 40);
  const auto report = write_sequence(clip, folder / "a.glb", SequenceFormat::gltf, {.max_morph_targets = 20});
  const Glb glb(folder / "a.glb");
  EXPECT_EQ(glb.target_count() + 1, report.frames_written);
  EXPECT_EQ(glb.target_count(), 20U);
  EXPECT_EQ(glb.sampler()["interpolation"], "LINEAR");
  // The stated error is that of linear interpolation between kept frames.
  const double error = thinning_error(clip, thin_frames(clip, 21));
  EXPECT_GT(error, 1e-5);
  EXPECT_NEAR(report.max_error, error, 1e-6);
}

// The clip turns round, so that normals differ by more than 8-bit differences hold without the doubled
// weights.
MeshSequence turning_walk() {
  MeshSequence clip = test::dressed_walk("turn", 9);
  for (std::size_t f = 0; f < 9; ++f) {
    const GroundTransform turn{.yaw = static_cast<double>(f) * 0.39,
                               .translation = {0.1 * static_cast<double>(f), 0.0}};
    const Positions before = std::as_const(clip).frame(f);
    transform_positions(turn, PositionsView(before.data(), before.rows(), 3), clip.frame(f));
  }
  return clip;
}

TEST(Gltf, QuantisedPositionsAndNormalsStayWithinTheStatedError) {
  const test::TemporaryFolder folder;
  for (const bool turns : {false, true}) {
    const MeshSequence clip = turns ? turning_walk() : test::dressed_walk("walk", 9);
    const auto report = write_sequence(clip, folder / "a.glb", SequenceFormat::gltf, {.quantize = true});
    write_sequence(clip, folder / "b.glb", SequenceFormat::gltf);
    EXPECT_LT(static_cast<double>(fs::file_size(folder / "a.glb")),
              0.65 * static_cast<double>(fs::file_size(folder / "b.glb")));
    const Glb glb(folder / "a.glb");
    EXPECT_THAT(glb.document["extensionsRequired"], ElementsAre("KHR_mesh_quantization"));
    double error = 0.0;
    double smallest_cosine = 1.0;
    for (std::size_t f = 0; f < clip.frame_count(); ++f) {
      const Eigen::MatrixXd difference = glb.positions(f, clip.vertex_count()) - clip.frame(f).cast<double>();
      error = std::max(error, std::sqrt(difference.rowwise().squaredNorm().maxCoeff()));
      const std::vector<double> normals = glb.at_key("NORMAL", f);
      const Positions expected = vertex_normals(*clip.topology(), std::as_const(clip).frame(f));
      for (std::size_t v = 0; v < clip.vertex_count(); ++v) {
        const Eigen::Vector3d n = Eigen::Map<const Eigen::Vector3d>(normals.data() + 3 * v).normalized();
        smallest_cosine = std::min(
            smallest_cosine, n.dot(expected.row(static_cast<Eigen::Index>(v)).cast<double>().transpose()));
      }
    }
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 2e-4);
    EXPECT_NEAR(report.max_error, error, 1e-6);
    EXPECT_GT(smallest_cosine, std::cos(0.02)) << turns;
    // No weight is above 1, which some programs clamp; only the clip that turns needs a target for its first
    // frame.
    const std::vector<double> weights = glb.values(glb.sampler()["output"]);
    EXPECT_EQ(*std::ranges::max_element(weights), 1.0);
    EXPECT_EQ(glb.target_count(), turns ? 9U : 8U);
  }
}

TEST(Gltf, TheKhronosValidatorFindsNoError) {
  fs::path modules = fs::path(REPRISE_SOURCE_DIR) / "node_modules";
  if (const char* other = std::getenv("REPRISE_NODE_MODULES")) modules = other;
  if (!fs::exists(modules / "gltf-validator")) {
    GTEST_SKIP() << "needs the npm package gltf-validator in " << modules << ": run scripts/setup";
  }
  const test::TemporaryFolder folder;
  MeshSequence loose = test::walk("loose", 3);  // with a vertex no triangle uses
  Topology topology = *loose.topology();
  std::erase_if(topology.triangles, [](const Triangle& t) { return t[0] == 7 || t[1] == 7 || t[2] == 7; });
  loose.share_topology(std::make_shared<const Topology>(std::move(topology)));
  std::string files;
  const auto write = [&](const MeshSequence& clip, const std::string& name,
                         const SequenceWriteOptions& options) {
    write_sequence(clip, folder / name, SequenceFormat::gltf, options);
    files += " '" + (folder / name).string() + "'";
  };
  write(test::dressed_walk("walk", 8), "step.glb", {});
  write(test::dressed_walk("walk", 8, false, true, false), "linear.glb", {.interpolate = true});
  write(test::dressed_walk("walk", 8), "quantised.glb", {.quantize = true});
  write(turning_walk(), "turning_quantised.glb", {.quantize = true});
  write(test::dressed_walk("walk", 4, true), "colors.glb", {});
  write(test::dressed_walk("walk", 4, true), "colors_quantised.glb", {.quantize = true});
  write(test::walk("walk", 300), "long.glb", {});
  write(test::walk("pose", 1), "pose.glb", {});
  write(test::textured_walk("walk", 4), "textured.glb", {});
  write(test::textured_walk("walk", 4), "textured_quantised.glb", {.quantize = true});
  write(loose, "loose.glb", {});
  write(loose, "loose_quantised.glb", {.quantize = true});
  const std::string command = "NODE_MODULES='" + modules.string() + "' node '" + REPRISE_SOURCE_DIR +
                              "/tests/gltf/validate.mjs'" + files + " > '" + (folder / "report").string() +
                              "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << read_text_file(folder / "report");
  EXPECT_THAT(read_text_file(folder / "report"), testing::Not(HasSubstr("  warning")))
      << "warnings are to be looked at";
}

// ---- Seams
// ----------------------------------------------------------------------------------------------------

TEST(UvSeams, EachVertexHasOneCopyForEachOfItsTextureCoordinates) {
  const Topology topology = *test::dressed_walk("walk", 1).topology();
  const SeamCut cut = cut_at_seams(topology);
  std::set<std::pair<std::int32_t, std::array<float, 2>>> pairs;
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto at = static_cast<std::size_t>(cut.triangles[t][corner]);
      const auto& uv = topology.uvs[static_cast<std::size_t>(topology.triangle_uvs[t][corner])];
      EXPECT_EQ(cut.source_vertices.at(at), topology.triangles[t][corner]);
      EXPECT_EQ(cut.uvs.at(at), uv);
      pairs.emplace(topology.triangles[t][corner], uv);
    }
  }
  EXPECT_EQ(cut.source_vertices.size(), pairs.size());
  EXPECT_TRUE(cut.has_copies(topology));
  EXPECT_FALSE(cut_at_seams(*test::walk("walk", 1).topology()).has_copies(topology));
}

}  // namespace
}  // namespace reprise
