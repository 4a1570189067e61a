// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_file.h"
#include "reprise/io/database_header.h"
#include "reprise/io/database_markup.h"
#include "reprise/io/database_model.h"
#include "reprise/io/hdf5.h"
#include "reprise/io/hdf5_contents.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

std::size_t read_count(const Hdf5Object& object, const std::string& attribute, std::size_t limit) {
  const std::int64_t value = object.read_integer(attribute);
  if (value < 0 || static_cast<std::uint64_t>(value) > limit) {
    throw FileError(object.file_path(), object.name(), fmt::format("attribute '{}' is {}", attribute, value));
  }
  return static_cast<std::size_t>(value);
}

constexpr std::size_t max_frames = std::size_t{1} << 31;

}  // namespace

struct DatabaseReader::Impl {
  struct Clip {
    Hdf5Group group;
    Hdf5Dataset positions;
    std::optional<Hdf5Dataset> normals;
    std::optional<Hdf5Dataset> colors;
  };

  explicit Impl(const fs::path& path) : version(check_database_header(path)), file(Hdf5File::open(path)) {
    if (!file.has_attribute("format") || file.read_text("format") != database_format_name) {
      throw FileError(path, "is not a Reprise database");
    }
    read_topology();
    if (file.has("markup")) markup = read_markup(file.group("markup"), topology->vertex_count);
    read_clips();
  }

  void read_topology() {
    const Hdf5Group group = file.group("topology");
    Topology read;
    read.vertex_count = static_cast<std::int32_t>(read_count(group, "vertex_count", 1U << 30));
    read.triangles = read_rows<Triangle, std::int32_t>(group, "triangles");
    if (group.has("uvs")) {
      read.uvs = read_rows<std::array<float, 2>, float>(group, "uvs");
      read.triangle_uvs = read_rows<Triangle, std::int32_t>(group, "triangle_uvs");
    }
    if (group.has("texture")) read.texture = std::make_shared<const Image>(read_texture(group));
    check_contents(group, [&] { validate(read); });
    topology = std::make_shared<const Topology>(std::move(read));
  }

  // Rows of `Row`, an array of numbers `T`.
  template <typename Row, typename T>
  static std::vector<Row> read_rows(const Hdf5Group& group, const std::string& name) {
    const Hdf5Dataset dataset = group.dataset(name);
    const std::size_t row_count = dataset.shape().empty() ? 0 : dataset.shape().front();
    constexpr std::size_t columns = std::tuple_size_v<Row>;
    dataset.check_shape({row_count, columns});
    std::vector<Row> rows(row_count);
    if (row_count > 0)
      dataset.read<T>({0, 0}, {row_count, columns}, std::span(rows.data()->data(), row_count * columns));
    return rows;
  }

  void read_clips() {
    const Hdf5Group group = file.group("clips");
    const std::vector<std::string> names = group.children();
    if (const std::size_t expected = read_count(file, "clip_count", names.size() + 1);
        expected != names.size()) {
      throw FileError(file.file_path(), fmt::format("expected {} clips, found {}", expected, names.size()));
    }
    std::vector<const std::string*> in_order(names.size(), nullptr);
    for (const std::string& name : names) {
      const std::size_t idx = read_count(group.group(name), "index", names.size() - 1);
      if (in_order[idx] != nullptr) {
        throw FileError(file.file_path(), group.name(), fmt::format("two clips have the index {}", idx));
      }
      in_order[idx] = &name;
    }
    const auto vertex_count = static_cast<std::size_t>(topology->vertex_count);
    for (const std::string* name : in_order) {
      Hdf5Group clip = group.group(*name);
      ClipInfo info{.name = *name,
                    .frame_count = read_count(clip, "frame_count", max_frames),
                    .frames_per_second = clip.read_number("frames_per_second"),
                    .has_normals = clip.has("normals"),
                    .has_colors = clip.has("colors"),
                    .has_origins = clip.has("origins"),
                    .has_truth = clip.has("truth")};
      if (info.has_truth && !markup) {
        throw FileError(file.file_path(), clip.name(),
                        "has a truth, but the database has no skeleton for it");
      }
      if (!(info.frames_per_second > 0.0) || !std::isfinite(info.frames_per_second)) {
        throw FileError(file.file_path(), clip.name(),
                        fmt::format("has {} frames per second", info.frames_per_second));
      }
      // No chunk cache: a frame is one chunk and is read straight to its place.
      Hdf5Dataset positions = clip.dataset("positions", 0);
      positions.check_shape({info.frame_count, vertex_count, 3});
      std::optional<Hdf5Dataset> normals;
      if (info.has_normals) {
        normals = clip.dataset("normals", 0);
        normals->check_shape({info.frame_count, vertex_count, 3});
      }
      std::optional<Hdf5Dataset> colors;
      if (info.has_colors) {
        colors = clip.dataset("colors", 0);
        const bool is_constant = !colors->shape().empty() && colors->shape().front() == 1;
        colors->check_shape({is_constant ? 1 : info.frame_count, vertex_count, 3});
      }
      infos.push_back(std::move(info));
      clips.push_back({std::move(clip), std::move(positions), std::move(normals), std::move(colors)});
    }
  }

  std::vector<FrameOrigin> read_origins(std::size_t clip_idx) const {
    if (!infos[clip_idx].has_origins) return {};
    const Hdf5Group group = clips[clip_idx].group.group("origins");
    const std::size_t frame_count = infos[clip_idx].frame_count;
    const std::vector<std::string> names = group.dataset("clip_names").read_texts();
    const auto clip = read_column<std::int32_t>(group, "clip", frame_count);
    const auto frame = read_column<std::int32_t>(group, "frame", frame_count);
    const auto partner_clip = read_column<std::int32_t>(group, "partner_clip", frame_count);
    const auto partner_frame = read_column<std::int32_t>(group, "partner_frame", frame_count);
    const auto partner_weight = read_column<double>(group, "partner_weight", frame_count);
    const auto name_of = [&](std::int32_t idx) {
      if (idx < -1 || idx >= static_cast<std::int32_t>(names.size())) {
        throw FileError(file.file_path(), group.name(),
                        fmt::format("names clip {} of {}", idx, names.size()));
      }
      return idx < 0 ? std::string() : names[static_cast<std::size_t>(idx)];
    };
    std::vector<FrameOrigin> origins(frame_count);
    for (std::size_t f = 0; f < frame_count; ++f) {
      origins[f] = {.clip = name_of(clip[f]),
                    .frame_idx = frame[f],
                    .partner_clip = name_of(partner_clip[f]),
                    .partner_frame_idx = partner_frame[f],
                    .partner_weight = partner_weight[f]};
    }
    return origins;
  }

  template <typename OnFrames>
  MeshSequence read_clip(std::size_t clip_idx, const OnFrames& on_frames) const {
    const ClipInfo& info = infos[clip_idx];
    const Clip& clip = clips[clip_idx];
    MeshSequence sequence(info.name, topology, info.frame_count, info.frames_per_second);
    const std::size_t n = sequence.vertex_count();
    constexpr std::size_t block = 16;
    for (std::size_t first = 0; first < info.frame_count; first += block) {
      const std::size_t count = std::min(block, info.frame_count - first);
      clip.positions.read<float>({first, 0, 0}, {count, n, 3},
                                 std::span(sequence.frame(first).data(), count * n * 3));
      if (clip.normals) {
        clip.normals->read<float>({first, 0, 0}, {count, n, 3},
                                  std::span(sequence.mutable_normals(first).data(), count * n * 3));
      }
      check_usable(sequence, first, count);
      on_frames(count);
    }
    if (clip.colors && info.frame_count > 0) {
      const std::size_t count = clip.colors->shape().front();
      std::vector<Color> colors(count * n);
      clip.colors->read<std::uint8_t>({0, 0, 0}, {count, n, 3},
                                      std::span(colors.data()->data(), count * n * 3));
      sequence.set_colors(std::move(colors));
    }
    sequence.set_origins(read_origins(clip_idx));
    return sequence;
  }

  // Motion that is worked on must be finite: one NaN would spread into every figure computed from it.
  void check_usable(const MeshSequence& sequence, std::size_t first, std::size_t count) const {
    std::vector<std::string> faults(count);
    parallel_for(0, count,
                 [&](std::size_t i) { faults[i] = degeneracy(*topology, sequence.frame(first + i)); });
    for (std::size_t i = 0; i < count; ++i) {
      if (faults[i].empty()) continue;
      throw FileError(file.file_path(), fmt::format("clip '{}', frame {}", sequence.name(), first + i),
                      faults[i]);
    }
  }

  void check_clip(std::size_t clip_idx) const {
    if (clip_idx >= infos.size()) {
      throw InvalidArgument(fmt::format("{} holds {} clips, asked for clip {}", file.file_path().string(),
                                        infos.size(), clip_idx));
    }
  }

  int version;
  Hdf5File file;
  TopologyPtr topology;
  std::optional<Markup> markup;
  std::vector<ClipInfo> infos;
  std::vector<Clip> clips;
};

DatabaseReader::DatabaseReader(const fs::path& path) : impl_(std::make_unique<Impl>(path)) {}
DatabaseReader::~DatabaseReader() = default;
DatabaseReader::DatabaseReader(DatabaseReader&&) noexcept = default;

const TopologyPtr& DatabaseReader::topology() const {
  return impl_->topology;
}

const std::vector<ClipInfo>& DatabaseReader::clips() const {
  return impl_->infos;
}

int DatabaseReader::format_version() const {
  return impl_->version;
}

const std::optional<Markup>& DatabaseReader::markup() const {
  return impl_->markup;
}

LearntModels DatabaseReader::read_models() const {
  if (!impl_->file.has("model")) return {};
  return reprise::read_models(impl_->file.group("model"), impl_->topology->vertex_count);
}

std::string DatabaseReader::note() const {
  if (!impl_->file.has("note")) return {};
  std::vector<std::string> texts = impl_->file.dataset("note").read_texts();
  return texts.empty() ? std::string() : std::move(texts.front());
}

Mesh DatabaseReader::read_frame(std::size_t clip_idx, std::size_t frame_idx) const {
  impl_->check_clip(clip_idx);
  const ClipInfo& info = impl_->infos[clip_idx];
  if (frame_idx >= info.frame_count) {
    throw InvalidArgument(
        fmt::format("clip '{}' has {} frames, asked for frame {}", info.name, info.frame_count, frame_idx));
  }
  const Impl::Clip& clip = impl_->clips[clip_idx];
  const auto n = static_cast<std::size_t>(impl_->topology->vertex_count);
  Mesh mesh{.topology = impl_->topology};
  mesh.positions.resize(static_cast<Eigen::Index>(n), 3);
  clip.positions.read<float>({frame_idx, 0, 0}, {1, n, 3}, std::span(mesh.positions.data(), n * 3));
  if (clip.normals) {
    mesh.normals.resize(static_cast<Eigen::Index>(n), 3);
    clip.normals->read<float>({frame_idx, 0, 0}, {1, n, 3}, std::span(mesh.normals.data(), n * 3));
  }
  if (clip.colors) {
    mesh.colors.resize(n);
    const std::size_t row = clip.colors->shape().front() == 1 ? 0 : frame_idx;
    clip.colors->read<std::uint8_t>({row, 0, 0}, {1, n, 3}, std::span(mesh.colors.data()->data(), n * 3));
  }
  return mesh;
}

MeshSequence DatabaseReader::read_clip(std::size_t clip_idx) const {
  impl_->check_clip(clip_idx);
  return impl_->read_clip(clip_idx, [](std::size_t) {});
}

std::optional<ClipTruth> DatabaseReader::read_truth(std::size_t clip_idx) const {
  impl_->check_clip(clip_idx);
  const ClipInfo& info = impl_->infos[clip_idx];
  if (!info.has_truth) return std::nullopt;
  return reprise::read_truth(impl_->clips[clip_idx].group.group("truth"), impl_->markup->skeleton,
                             info.frame_count);
}

PerformanceDatabase load_database(const fs::path& path) {
  const DatabaseReader reader(path);
  std::size_t frame_count = 0;
  for (const ClipInfo& info : reader.clips()) frame_count += info.frame_count;
  PerformanceDatabase database;
  {
    Progress progress("loading", frame_count);
    for (std::size_t c = 0; c < reader.clips().size(); ++c) {
      MeshSequence clip = reader.impl_->read_clip(c, [&](std::size_t frames) { progress.advance(frames); });
      try {
        database.add(std::move(clip));
      } catch (const InvalidArgument& error) {
        throw FileError(path, error.what());
      }
    }
  }
  if (!database.empty()) {
    database.set_markup(reader.markup());
    database.set_models(reader.read_models());
    for (std::size_t c = 0; c < reader.clips().size(); ++c) {
      if (std::optional<ClipTruth> truth = reader.read_truth(c)) database.set_truth(c, std::move(*truth));
    }
  }
  return database;
}

}  // namespace reprise
