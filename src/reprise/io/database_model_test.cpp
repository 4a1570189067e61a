// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Learnt models in the database file.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/database/learnt_model_test_support.h"
#include "reprise/io/database_file.h"
#include "reprise/io/hdf5.h"
#include "reprise/io/io_test_support.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

// Three parts on six vertices; one of them learnt from a single example, and so without components.
LearntModels small_models(const Positions& reference) {
  return test::learnt_models(reference, {{.name = "torso", .parent = -1, .vertices = {0, 1, 3, 4, 5}},
                                         {.name = "left/leg é", .parent = 0, .vertices = {1, 2, 5}},
                                         {.name = "foot", .parent = 1, .vertices = {1, 2}}});
}

// The database of tests/fixtures/database_v3.reprise.
PerformanceDatabase database_with_models() {
  const test::Shape shape = test::sphere(0);
  MeshSequence clip("rise", shape.topology, 2, 25.0);
  for (std::size_t f = 0; f < 2; ++f) {
    clip.frame(f) = shape.positions;
    clip.frame(f).col(1).array() += 0.125F * static_cast<float>(f);
  }
  PerformanceDatabase database;
  database.add(std::move(clip));
  database.set_models(small_models(shape.positions));
  return database;
}

TEST(DatabaseFixture, Version3StillLoads) {
  const fs::path path = fs::path(REPRISE_SOURCE_DIR) / "tests/fixtures/database_v3.reprise";
  const DatabaseReader reader(path);
  EXPECT_EQ(reader.format_version(), 3);
  const LearntModels models = reader.read_models();
  ASSERT_EQ(models.part.parts.size(), 3U);
  EXPECT_EQ(models.part.parts[1].part.name, "left/leg é");
  EXPECT_EQ(models.part.parts[1].examples, std::vector<std::string>({"walk:0"}));
  EXPECT_EQ(models.part.parts[0].component_count(), 2);
  EXPECT_EQ(models.part.parts[0].deviations[0], 1.0 / 3.0);
  EXPECT_EQ(models.part.parts[2].component_count(), 0);
  ASSERT_EQ(models.whole.parts.size(), 1U);
  EXPECT_EQ(models.whole.parts[0].greatest[2], 7.0 / 3.0 * 0.1);
}

TEST(DatabaseModel, ComesBackToTheLastBitAndFrameByFrameReadersFindIt) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = database_with_models();
  save_database(database, folder / "a.reprise", "a note");
  test::expect_equal(load_database(folder / "a.reprise").models(), database.models());
  test::expect_equal(DatabaseReader(folder / "a.reprise").read_models(), database.models());
  EXPECT_EQ(DatabaseReader(folder / "a.reprise").note(), "a note");
  save_database(load_database(folder / "a.reprise"), folder / "b.reprise", "a note");
  EXPECT_EQ(read_text_file(folder / "a.reprise"), read_text_file(folder / "b.reprise"));
}

TEST(DatabaseModel, EitherMayBeMissingAndOnlyAModelNeedsTheNewVersion) {
  const test::TemporaryFolder folder;
  PerformanceDatabase database = database_with_models();
  const LearntModels both = database.models();
  for (const LearntModels& some :
       {LearntModels{.part = both.part}, LearntModels{.whole = both.whole}, LearntModels()}) {
    database.set_models(some);
    save_database(database, folder / "a.reprise");
    const DatabaseReader reader(folder / "a.reprise");
    EXPECT_EQ(reader.format_version(), some.empty() ? 2 : database_format_version);
    test::expect_equal(reader.read_models(), some);
    test::expect_equal(load_database(folder / "a.reprise").models(), some);
  }
}

TEST(DatabaseModel, WriterRefusesModelsThatDoNotFitAndASecondTime) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = database_with_models();
  DatabaseWriter writer(folder / "a.reprise", database.topology());
  LearntModels other = database.models();
  other.part.reference.conservativeResize(5, 3);
  EXPECT_THAT([&] { writer.set_models(other); },
              ThrowsMessage<InvalidArgument>(HasSubstr("5 vertices; expected 6")));
  EXPECT_NO_THROW(writer.set_models({}));
  writer.set_models(database.models());
  EXPECT_THAT([&] { writer.set_models(database.models()); },
              ThrowsMessage<InvalidArgument>(HasSubstr("once")));
  writer.write_clip(database.clip(0));
  writer.commit();
  EXPECT_THROW(writer.set_models({}), InvalidArgument);
  test::expect_equal(load_database(folder / "a.reprise").models(), database.models());
}

enum class Damage { none, missing, shorter, other_rank, text, wrong_value };

// Writes the models of a file by hand, one of its objects damaged. A name is "whole/0/mean".
class ModelWriter {
 public:
  ModelWriter(std::string victim, Damage damage) : victim_(std::move(victim)), damage_(damage) {}

  void write(const fs::path& path, const PerformanceDatabase& database) {
    const Topology& topology = *database.topology();
    Hdf5File file = Hdf5File::create(path, 512);
    file.write_text("format", "Reprise performance database");
    file.write_integer("clip_count", 1);
    {
      Hdf5Group group = file.create_group("topology");
      group.write_integer("vertex_count", topology.vertex_count);
      group.write<std::int32_t>("triangles", {topology.triangles.size(), 3},
                                std::span(topology.triangles.front().data(), 3 * topology.triangles.size()));
      Hdf5Group clip = file.create_group("clips").create_group("rise");
      clip.write_integer("index", 0);
      clip.write_integer("frame_count", 1);
      clip.write_number("frames_per_second", 25.0);
      const auto positions = database.clip(0).frame(0);
      clip.write<float>("positions", {1, static_cast<std::size_t>(positions.rows()), 3},
                        std::span(positions.data(), static_cast<std::size_t>(positions.size())));
      Hdf5Group models = file.create_group("model");
      write_model(models, "part", database.models().part);
      write_model(models, "whole", database.models().whole);
    }
    file.finish();
    std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
    stream << "REPRISE DATABASE\nversion 3\nbytes " << fs::file_size(path) << '\n';
  }

  bool has_damaged() const { return has_damaged_; }

 private:
  Damage damage_of(const std::string& name) {
    if (name != victim_) return Damage::none;
    has_damaged_ = true;
    return damage_;
  }

  template <typename T>
  void put(Hdf5Group& group, const std::string& prefix, const std::string& name, Hdf5Shape shape,
           std::vector<T> values) {
    const Damage damage = damage_of(prefix + name);
    if (damage == Damage::missing) return;
    if (damage == Damage::text) return group.write_text_dataset(name, "words");
    if (damage == Damage::shorter) {
      values.resize(values.size() / shape[0] * (shape[0] - 1));
      --shape[0];
    }
    if (damage == Damage::other_rank) shape.push_back(1);
    if (damage == Damage::wrong_value) {
      // No part begins after vertex 5, none has 99 vertices, no parent comes that late.
      values.back() = std::is_integral_v<T> ? T{99} : std::numeric_limits<T>::quiet_NaN();
    }
    group.write<T>(name, shape, values);
  }

  void put_texts(Hdf5Group& group, const std::string& prefix, const std::string& name,
                 std::vector<std::string> texts) {
    const Damage damage = damage_of(prefix + name);
    if (damage == Damage::missing) return;
    if (damage == Damage::text) {  // the other way round: numbers where texts should be
      return group.write<float>(name, {texts.size()}, std::vector<float>(texts.size()));
    }
    if (damage == Damage::shorter) texts.clear();
    if (damage == Damage::wrong_value) texts.back().clear();
    group.write_text_dataset(name, std::span<const std::string>(texts));
  }

  void put_number(Hdf5Group& group, const std::string& prefix, const std::string& name, double value) {
    const Damage damage = damage_of(prefix + name);
    if (damage == Damage::missing) return;
    if (damage == Damage::text) return group.write_text(name, "words");
    group.write_number(name, damage == Damage::wrong_value ? std::nan("") : value);
  }

  void write_model(Hdf5Group& models, const std::string& model_name, const LearntModel& model) {
    Hdf5Group group = models.create_group(model_name);
    const std::string prefix = model_name + "/";
    std::vector<std::string> names;
    std::vector<std::int32_t> parents, sizes, vertices;
    for (const LearntPart& learnt : model.parts) {
      names.push_back(learnt.part.name);
      parents.push_back(learnt.part.parent);
      sizes.push_back(static_cast<std::int32_t>(learnt.part.vertices.size()));
      vertices.insert(vertices.end(), learnt.part.vertices.begin(), learnt.part.vertices.end());
    }
    const Positions& reference = model.reference;
    put<float>(group, prefix, "reference", {static_cast<std::size_t>(reference.rows()), 3},
               {reference.data(), reference.data() + reference.size()});
    put_texts(group, prefix, "part_names", names);
    put(group, prefix, "part_parents", {parents.size()}, parents);
    put(group, prefix, "part_sizes", {sizes.size()}, sizes);
    put(group, prefix, "part_vertices", {vertices.size()}, vertices);
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      const std::string name = std::to_string(p);
      if (damage_of(prefix + name) == Damage::missing) continue;
      Hdf5Group child = group.create_group(name);
      write_part(child, prefix + name + "/", model.parts[p]);
    }
  }

  void write_part(Hdf5Group& group, const std::string& prefix, const LearntPart& learnt) {
    const auto size = static_cast<std::size_t>(learnt.mean.size());
    const auto components = static_cast<std::size_t>(learnt.component_count());
    const auto column = [&](const char* name, const Eigen::VectorXd& values) {
      put<double>(group, prefix, name, {components}, {values.data(), values.data() + values.size()});
    };
    put<float>(group, prefix, "mean", {size}, {learnt.mean.data(), learnt.mean.data() + size});
    put<float>(group, prefix, "basis", {components, size},
               {learnt.basis.data(), learnt.basis.data() + learnt.basis.size()});
    column("deviations", learnt.deviations);
    column("least", learnt.least);
    column("greatest", learnt.greatest);
    put_texts(group, prefix, "examples", learnt.examples);
    put_number(group, prefix, "discarded_variance", learnt.discarded_variance);
    put_number(group, prefix, "total_variance", learnt.total_variance);
  }

  std::string victim_;
  Damage damage_;
  bool has_damaged_ = false;
};

TEST(DatabaseModel, EveryKindOfDamageToEveryObjectIsNamed) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "a.reprise";
  const PerformanceDatabase database = database_with_models();
  const auto load = [&] { (void)load_database(path); };
  ModelWriter("", Damage::none).write(path, database);
  test::expect_equal(load_database(path).models(), database.models());  // files by hand are right undamaged

  const auto expect_named = [&](const std::string& victim, Damage damage, const std::string& object) {
    ModelWriter writer(victim, damage);
    writer.write(path, database);
    ASSERT_TRUE(writer.has_damaged()) << victim;
    EXPECT_THAT(load, ThrowsMessage<FileError>(AllOf(HasSubstr("a.reprise"), HasSubstr(object))))
        << victim << ", damage " << static_cast<int>(damage);
    EXPECT_THROW((void)DatabaseReader(path).read_models(), FileError);
  };
  for (const std::string model : {"part", "whole"}) {
    const std::string whole_group = "/model/" + model;
    for (const char* name : {"reference", "part_names", "part_parents", "part_sizes", "part_vertices"}) {
      for (const Damage damage : {Damage::missing, Damage::shorter, Damage::text, Damage::wrong_value}) {
        expect_named(model + "/" + name, damage, whole_group);
      }
    }
    for (const char* name : {"reference", "part_parents", "part_sizes", "part_vertices"}) {
      expect_named(model + "/" + name, Damage::other_rank, whole_group + "/" + name);
    }
    expect_named(model + "/0", Damage::missing, whole_group + "/0");
    const std::string part = model + "/0/";
    for (const char* name : {"mean", "basis", "deviations", "least", "greatest"}) {
      for (const Damage damage : {Damage::missing, Damage::other_rank, Damage::text}) {
        expect_named(part + name, damage, "/model/" + part + name);
      }
      expect_named(part + name, Damage::shorter, "/model/" + part);
      expect_named(part + name, Damage::wrong_value, whole_group);
    }
    for (const Damage damage : {Damage::missing, Damage::text}) {
      expect_named(part + "examples", damage, "/model/" + part + "examples");
      for (const char* name : {"discarded_variance", "total_variance"}) {
        expect_named(part + name, damage, "/model/" + model + "/0: ");
      }
    }
    for (const Damage damage : {Damage::shorter, Damage::wrong_value}) {
      expect_named(part + "examples", damage, whole_group);
    }
    for (const char* name : {"discarded_variance", "total_variance"}) {
      expect_named(part + name, Damage::wrong_value, whole_group);
    }
  }
}

// Means and bases carry a checksum: they come back as they were, or not at all.
TEST(DatabaseModel, AFlippedBitNeverChangesWhatWasLearnt) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = database_with_models();
  save_database(database, folder / "a.reprise");
  const std::string bytes = read_text_file(folder / "a.reprise");
  int refused = 0;
  int tried = 0;
  for (std::size_t at = 512; at < bytes.size(); at += 53) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    std::ofstream(folder / "b.reprise", std::ios::binary) << damaged;
    ++tried;
    try {
      const LearntModels found = load_database(folder / "b.reprise").models();
      if (found.part.parts.empty() || found.whole.parts.empty()) {
        ADD_FAILURE() << "a model vanished without a word: byte " << at;
        continue;
      }
      for (std::size_t p = 0; p < found.part.parts.size(); ++p) {
        EXPECT_EQ(found.part.parts[p].mean, database.models().part.parts[p].mean) << at;
        EXPECT_EQ(found.part.parts[p].basis, database.models().part.parts[p].basis) << at;
      }
      EXPECT_EQ(found.whole.parts[0].basis, database.models().whole.parts[0].basis) << at;
    } catch (const FileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 4);
}

TEST(DatabaseModel, AFullDiskIsAnErrorAndTheOlderFileStays) {
  const test::TemporaryFolder folder;
  const PerformanceDatabase database = database_with_models();
  save_database(database, folder / "a.reprise");
  const std::string before = read_text_file(folder / "a.reprise");
  for (int step = 1; step < 20; ++step) {
    const test::FullDisk full(before.size() * static_cast<std::size_t>(step) / 20);
    EXPECT_THROW(save_database(database, folder / "a.reprise"), FileError) << step;
  }
  EXPECT_EQ(read_text_file(folder / "a.reprise"), before);
}

}  // namespace
}  // namespace reprise
