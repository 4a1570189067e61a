// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/database_file.h"
#include "reprise/io/database_header.h"
#include "reprise/io/database_markup.h"
#include "reprise/io/database_model.h"
#include "reprise/io/hdf5.h"

namespace reprise {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

namespace {

// What earlier programs know: markup, texture and truth, but no models.
constexpr int version_without_models = 2;

void check_name(const std::string& name) {
  // "." is how HDF5 calls the group itself.
  if (name.empty() || name == "." || name.find_first_of(":/\0"sv) != std::string::npos) {
    throw InvalidArgument(fmt::format("'{}' cannot name a clip: expected a name without ':' and '/'", name));
  }
}

}  // namespace

struct DatabaseWriter::Impl {
  Impl(fs::path target, TopologyPtr shared)
      : topology(std::move(shared)),
        output((check_target(target), std::move(target)), AtomicOutput::Kind::file),
        file(Hdf5File::create(output.path(), database_header_bytes, output.target())),
        clips_group((write_topology(), file.create_group("clips"))) {}

  static void check_target(const fs::path& target) {
    if (fs::is_regular_file(target) && !is_database(target)) {
      throw FileError(
          target, "is not a Reprise database and is left as it is: expected a new file or one to replace");
    }
  }

  void write_topology() {
    file.write_text("format", database_format_name);
    if (!topology) throw InvalidArgument("a database needs a topology");
    validate(*topology);
    if (topology->vertex_count < 1) throw InvalidArgument("a database needs a topology with vertices");
    Hdf5Group group = file.create_group("topology");
    group.write_integer("vertex_count", topology->vertex_count);
    const auto write_rows = [&]<typename T, std::size_t columns>(
                                const char* name, const std::vector<std::array<T, columns>>& rows) {
      const T* first = rows.empty() ? nullptr : rows.front().data();
      group.write<T>(name, {rows.size(), columns}, std::span(first, rows.size() * columns));
    };
    write_rows("triangles", topology->triangles);
    if (topology->has_uvs()) {
      write_rows("uvs", topology->uvs);
      write_rows("triangle_uvs", topology->triangle_uvs);
    }
    if (topology->texture) write_texture(group, *topology->texture);
  }

  struct Clip {
    Hdf5Group group;
    std::string name;
    std::size_t frame_count = 0;
    std::optional<Hdf5Dataset> positions;
    std::optional<Hdf5Dataset> normals;
    std::optional<Hdf5Dataset> colors;  // once the colours of a frame differ from those of the first
    std::vector<Color> first_colors;
    std::vector<FrameOrigin> origins;
    std::size_t frames_of_truth = 0;  // 0: none
  };

  void begin_clip(const std::string& name, double frames_per_second) {
    check_open();
    check_name(name);
    if (std::ranges::count(names, name) > 0) {
      throw InvalidArgument(fmt::format("there is a clip named '{}' already", name));
    }
    if (!(frames_per_second > 0.0) || !std::isfinite(frames_per_second)) {
      throw InvalidArgument(
          fmt::format("clip '{}': {} frames per second; expected a positive rate", name, frames_per_second));
    }
    end_clip();
    Hdf5Group group = clips_group.create_group(name);
    group.write_integer("index", static_cast<std::int64_t>(names.size()));
    group.write_number("frames_per_second", frames_per_second);
    names.push_back(name);
    clip.emplace(Clip{.group = std::move(group), .name = name});
  }

  Hdf5Dataset frame_dataset(const char* name, Hdf5Type type) {
    const auto n = static_cast<std::size_t>(topology->vertex_count);
    return clip->group.create_dataset(name, type, {0, n, 3}, {.chunk_rows = 1, .growable = true});
  }

  template <typename T>
  void write_frame(Hdf5Dataset& dataset, std::size_t frame_idx, const T* values) {
    const auto n = static_cast<std::size_t>(topology->vertex_count);
    dataset.resize_rows(frame_idx + 1);
    dataset.write<T>({frame_idx, 0, 0}, {1, n, 3}, std::span(values, n * 3));
  }

  // `normals`: null or N x 3; `colors`: empty or N.
  void append(const float* positions, const float* normals, std::span<const Color> colors) {
    const std::size_t f = clip->frame_count;
    if (f > 0 && (normals != nullptr) != clip->normals.has_value()) {
      throw InvalidArgument(fmt::format("clip '{}': frame {} has {} normals, unlike the frames before it",
                                        clip->name, f, normals == nullptr ? "no" : "its"));
    }
    if (f > 0 && colors.empty() != clip->first_colors.empty()) {
      throw InvalidArgument(fmt::format("clip '{}': frame {} has {} colours, unlike the frames before it",
                                        clip->name, f, colors.empty() ? "no" : "its"));
    }
    if (f == 0) {
      clip->positions = frame_dataset("positions", Hdf5Type::float32);
      if (normals != nullptr) clip->normals = frame_dataset("normals", Hdf5Type::float32);
      clip->first_colors.assign(colors.begin(), colors.end());
    }
    write_frame(*clip->positions, f, positions);
    if (normals != nullptr) write_frame(*clip->normals, f, normals);
    if (!clip->colors && !std::ranges::equal(colors, clip->first_colors)) {
      clip->colors = frame_dataset("colors", Hdf5Type::uint8);
      for (std::size_t before = 0; before < f; ++before) {
        write_frame(*clip->colors, before, clip->first_colors.data()->data());
      }
    }
    if (clip->colors) write_frame(*clip->colors, f, colors.data()->data());
    ++clip->frame_count;
    file.check_writes();
  }

  void end_clip() {
    if (!clip) return;
    if (clip->frame_count == 0) throw InvalidArgument(fmt::format("clip '{}' has no frames", clip->name));
    if (!clip->origins.empty() && clip->origins.size() != clip->frame_count) {
      throw InvalidArgument(fmt::format("clip '{}': {} origins for {} frames", clip->name,
                                        clip->origins.size(), clip->frame_count));
    }
    if (clip->frames_of_truth > 0 && clip->frames_of_truth != clip->frame_count) {
      throw InvalidArgument(fmt::format("clip '{}': a truth of {} frames for {} frames", clip->name,
                                        clip->frames_of_truth, clip->frame_count));
    }
    clip->group.write_integer("frame_count", static_cast<std::int64_t>(clip->frame_count));
    if (!clip->colors && !clip->first_colors.empty()) {
      clip->colors = frame_dataset("colors", Hdf5Type::uint8);
      write_frame(*clip->colors, 0, clip->first_colors.data()->data());
    }
    if (!clip->origins.empty()) write_origins();
    clip.reset();
    file.check_writes();
  }

  void write_origins() {
    std::map<std::string, std::int32_t> ids;
    std::vector<std::string> clip_names;
    const auto id_of = [&](const std::string& name) {
      if (name.empty()) return std::int32_t{-1};
      const auto [entry, is_new] = ids.try_emplace(name, static_cast<std::int32_t>(clip_names.size()));
      if (is_new) clip_names.push_back(name);
      return entry->second;
    };
    std::vector<std::int32_t> clips;
    std::vector<std::int32_t> frames;
    std::vector<std::int32_t> partner_clips;
    std::vector<std::int32_t> partner_frames;
    std::vector<double> partner_weights;
    for (const FrameOrigin& origin : clip->origins) {
      clips.push_back(id_of(origin.clip));
      frames.push_back(origin.frame_idx);
      partner_clips.push_back(id_of(origin.partner_clip));
      partner_frames.push_back(origin.partner_frame_idx);
      partner_weights.push_back(origin.partner_weight);
    }
    Hdf5Group group = clip->group.create_group("origins");
    const Hdf5Shape shape = {clip->frame_count};
    group.write_text_dataset("clip_names", std::span<const std::string>(clip_names));
    group.write<std::int32_t>("clip", shape, clips);
    group.write<std::int32_t>("frame", shape, frames);
    group.write<std::int32_t>("partner_clip", shape, partner_clips);
    group.write<std::int32_t>("partner_frame", shape, partner_frames);
    group.write<double>("partner_weight", shape, partner_weights);
  }

  void commit() {
    check_open();
    end_clip();
    if (!note.empty()) file.write_text_dataset("note", note);
    const int version = has_models ? database_format_version : version_without_models;
    file.write_integer("version", version);
    file.write_integer("clip_count", static_cast<std::int64_t>(names.size()));
    is_committed = true;
    file.finish();
    write_database_header(output.path(), version, output.target());
    output.commit();
  }

  void set_markup(const Markup& markup) {
    check_open();
    if (skeleton) throw InvalidArgument("the markup of a database is set once");
    validate(markup, topology->vertex_count);
    Hdf5Group group = file.create_group("markup");
    write_markup(group, markup);
    skeleton = markup.skeleton;
    file.check_writes();
  }

  void set_models(const LearntModels& models) {
    check_open();
    if (has_models) throw InvalidArgument("the learnt models of a database are set once");
    if (models.empty()) return;
    validate(models, topology->vertex_count);
    Hdf5Group group = file.create_group("model");
    write_models(group, models);
    has_models = true;
    file.check_writes();
  }

  void set_truth(const ClipTruth& truth) {
    Clip& current = current_clip();
    if (!skeleton) {
      throw InvalidArgument(fmt::format(
          "clip '{}': a truth needs a markup, whose skeleton its poses are poses of", current.name));
    }
    if (current.frames_of_truth > 0)
      throw InvalidArgument(fmt::format("clip '{}' has a truth already", current.name));
    try {
      validate(truth, *skeleton, current.frame_count);
    } catch (const InvalidArgument& error) {
      throw InvalidArgument(fmt::format("clip '{}': {}", current.name, error.what()));
    }
    Hdf5Group group = current.group.create_group("truth");
    write_truth(group, truth);
    current.frames_of_truth = truth.poses.size();
    file.check_writes();
  }

  void check_open() const {
    if (is_committed) throw InvalidArgument(fmt::format("{} is committed already", output.target().string()));
  }

  Clip& current_clip() {
    check_open();
    if (!clip) throw InvalidArgument("begin_clip comes before the frames of a clip");
    return *clip;
  }

  TopologyPtr topology;
  TopologyPtr equal_topology;  // the last other object that was found equal
  AtomicOutput output;         // before the file: a file that is closed can be removed
  Hdf5File file;
  Hdf5Group clips_group;
  std::optional<Clip> clip;
  std::optional<Skeleton> skeleton;  // of the markup that was written
  std::vector<std::string> names;
  std::string note;
  bool has_models = false;
  bool is_committed = false;
};

DatabaseWriter::DatabaseWriter(fs::path target, TopologyPtr topology)
    : impl_(std::make_unique<Impl>(std::move(target), std::move(topology))) {}
DatabaseWriter::~DatabaseWriter() = default;

void DatabaseWriter::begin_clip(const std::string& name, double frames_per_second) {
  impl_->begin_clip(name, frames_per_second);
}

void DatabaseWriter::append(const Mesh& mesh) {
  const Impl::Clip& clip = impl_->current_clip();
  const auto n = static_cast<Eigen::Index>(impl_->topology->vertex_count);
  const auto check = [&](const char* what, Eigen::Index found, bool may_be_missing) {
    if (found == n || (found == 0 && may_be_missing)) return;
    throw InvalidArgument(fmt::format("clip '{}': frame {} has {} {}; expected {}", clip.name,
                                      clip.frame_count, found, what, n));
  };
  if (mesh.topology != impl_->topology && mesh.topology != impl_->equal_topology) {
    const std::string difference =
        mesh.topology ? first_difference(*impl_->topology, *mesh.topology, "the database",
                                         fmt::format("frame {} of clip '{}'", clip.frame_count, clip.name))
                      : fmt::format("frame {} of clip '{}' has none", clip.frame_count, clip.name);
    if (!difference.empty())
      throw InvalidArgument("all frames of a database share one topology, but " + difference);
    impl_->equal_topology = mesh.topology;
  }
  check("positions", mesh.positions.rows(), false);
  check("normals", mesh.normals.rows(), true);
  check("colours", static_cast<Eigen::Index>(mesh.colors.size()), true);
  impl_->append(mesh.positions.data(), mesh.normals.rows() > 0 ? mesh.normals.data() : nullptr, mesh.colors);
}

void DatabaseWriter::set_origins(std::span<const FrameOrigin> origins) {
  impl_->current_clip().origins.assign(origins.begin(), origins.end());
}

void DatabaseWriter::set_markup(const Markup& markup) {
  impl_->set_markup(markup);
}

void DatabaseWriter::set_models(const LearntModels& models) {
  impl_->set_models(models);
}

void DatabaseWriter::set_truth(const ClipTruth& truth) {
  impl_->set_truth(truth);
}

void DatabaseWriter::set_note(const std::string& text) {
  impl_->check_open();
  impl_->note = text;
}

void DatabaseWriter::write_clip(const MeshSequence& clip) {
  const std::string difference = !clip.topology() ? "it has none"
                                 : clip.topology() == impl_->topology
                                     ? ""
                                     : first_difference(*impl_->topology, *clip.topology(), "the database",
                                                        fmt::format("clip '{}'", clip.name()));
  if (!difference.empty())
    throw InvalidArgument("all clips of a database share one topology, but " + difference);
  impl_->begin_clip(clip.name(), clip.frames_per_second());
  for (std::size_t f = 0; f < clip.frame_count(); ++f) {
    impl_->append(clip.frame(f).data(), clip.has_normals() ? clip.normals(f).data() : nullptr,
                  clip.has_colors() ? clip.colors(f) : std::span<const Color>());
  }
  set_origins(clip.origins());
}

void DatabaseWriter::commit() {
  impl_->commit();
}

void save_database(const PerformanceDatabase& database, const fs::path& target, const std::string& note) {
  DatabaseWriter writer(target, database.topology());
  if (database.markup()) writer.set_markup(*database.markup());
  writer.set_models(database.models());
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    writer.write_clip(database.clip(c));
    if (const ClipTruth* truth = database.truth(c)) writer.set_truth(*truth);
  }
  writer.set_note(note);
  writer.commit();
}

}  // namespace reprise
