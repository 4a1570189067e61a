// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/database_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/core/progress.h"
#include "reprise/io/database_markup.h"
#include "reprise/io/hdf5.h"

namespace reprise {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

namespace {

// A plain text in the user block, before the HDF5 data: tells what the file is, whether it is whole, and what
// version it has, before HDF5 looks at a single byte.
//   REPRISE DATABASE\nversion 2\nbytes 1234567\n, then zeros
constexpr std::string_view signature = "REPRISE DATABASE\n";
constexpr std::size_t user_block = 512;
constexpr const char* format_name = "Reprise performance database";

struct Header {
  std::int64_t version = 0;
  std::uint64_t bytes = 0;
};

std::string header_text(const Header& header) {
  return fmt::format("{}version {}\nbytes {}\n", signature, header.version, header.bytes);
}

std::string first_bytes(const fs::path& path) {
  std::string bytes(user_block, '\0');
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

bool is_database(const fs::path& path) {
  return first_bytes(path).starts_with(signature);
}

template <typename T>
bool parse_line(std::string_view& text, std::string_view key, T& value) {
  if (!text.starts_with(key)) return false;
  text.remove_prefix(key.size());
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end == text.data() + text.size() || *end != '\n') return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
  return true;
}

// Throws `FileError` unless the file is a whole database of a version this program knows, which is returned.
int check_header(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw FileError(path, "there is no such file");
  if (!fs::is_regular_file(path, error)) throw FileError(path, "is not a file; expected a Reprise database");
  const std::string bytes = first_bytes(path);
  if (!bytes.starts_with(signature)) {
    const bool is_cut = !bytes.empty() && signature.starts_with(bytes);
    throw FileError(path, bytes.empty() ? "is empty; expected a Reprise database"
                          : is_cut      ? "is truncated in its header"
                          : bytes.starts_with("\x89HDF\r\n\x1a")
                              ? "is an HDF5 file but not a Reprise database"
                              : "is not a Reprise database");
  }
  std::string_view text = std::string_view(bytes).substr(signature.size());
  Header header;
  const bool has_version = parse_line(text, "version ", header.version);
  if (has_version && header.version > database_format_version) {
    throw FileError(path, fmt::format("has database format version {}; this program reads versions up to {}",
                                      header.version, database_format_version));
  }
  if (bytes.size() < user_block) throw FileError(path, "is truncated in its header");
  if (!has_version || header.version < 1 || !parse_line(text, "bytes ", header.bytes)) {
    throw FileError(path, "has a damaged header: expected its version and its size");
  }
  if (header.bytes == 0) throw FileError(path, "was never finished");
  const std::uint64_t found = fs::file_size(path);
  if (found < header.bytes) {
    throw FileError(path, fmt::format("is truncated: expected {} bytes, found {}", header.bytes, found));
  }
  return static_cast<int>(header.version);
}

void check_name(const std::string& name) {
  // "." is how HDF5 calls the group itself.
  if (name.empty() || name == "." || name.find_first_of(":/\0"sv) != std::string::npos) {
    throw InvalidArgument(fmt::format("'{}' cannot name a clip: expected a name without ':' and '/'", name));
  }
}

std::size_t read_count(const Hdf5Object& object, const std::string& attribute, std::size_t limit) {
  const std::int64_t value = object.read_integer(attribute);
  if (value < 0 || static_cast<std::uint64_t>(value) > limit) {
    throw FileError(object.file_path(), object.name(), fmt::format("attribute '{}' is {}", attribute, value));
  }
  return static_cast<std::size_t>(value);
}

constexpr std::size_t max_frames = std::size_t{1} << 31;

}  // namespace

// ---- Reading
// --------------------------------------------------------------------------------------------------

struct DatabaseReader::Impl {
  struct Clip {
    Hdf5Group group;
    Hdf5Dataset positions;
    std::optional<Hdf5Dataset> normals;
    std::optional<Hdf5Dataset> colors;
  };

  explicit Impl(const fs::path& path) : version(check_header(path)), file(Hdf5File::open(path)) {
    if (!file.has_attribute("format") || file.read_text("format") != format_name) {
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
    try {
      validate(read);
    } catch (const InvalidArgument& error) {
      throw FileError(file.file_path(), group.name(), error.what());
    }
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
    const auto column = [&]<typename T>(const char* name, T /*type*/) {
      const Hdf5Dataset dataset = group.dataset(name);
      dataset.check_shape({frame_count});
      return dataset.read<T>();
    };
    const auto clip = column("clip", std::int32_t{});
    const auto frame = column("frame", std::int32_t{});
    const auto partner_clip = column("partner_clip", std::int32_t{});
    const auto partner_frame = column("partner_frame", std::int32_t{});
    const auto partner_weight = column("partner_weight", double{});
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

// ---- Writing
// --------------------------------------------------------------------------------------------------

struct DatabaseWriter::Impl {
  Impl(fs::path target, TopologyPtr shared)
      : topology(std::move(shared)),
        output((check_target(target), std::move(target)), AtomicOutput::Kind::file),
        file(Hdf5File::create(output.path(), user_block, output.target())),
        clips_group((write_topology(), file.create_group("clips"))) {}

  static void check_target(const fs::path& target) {
    if (fs::is_regular_file(target) && !is_database(target)) {
      throw FileError(
          target, "is not a Reprise database and is left as it is: expected a new file or one to replace");
    }
  }

  void write_topology() {
    file.write_text("format", format_name);
    file.write_integer("version", database_format_version);
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
    file.write_integer("clip_count", static_cast<std::int64_t>(names.size()));
    is_committed = true;
    file.finish();
    // Only now, with everything in the file, does it say that it is whole.
    std::fstream stream(output.path(), std::ios::binary | std::ios::in | std::ios::out);
    const std::string header =
        header_text({.version = database_format_version, .bytes = fs::file_size(output.path())});
    stream.write(header.data(), static_cast<std::streamsize>(header.size()));
    stream.close();
    if (!stream) throw FileError(output.target(), "cannot be written");
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
    for (std::size_t c = 0; c < reader.clips().size(); ++c) {
      if (std::optional<ClipTruth> truth = reader.read_truth(c)) database.set_truth(c, std::move(*truth));
    }
  }
  return database;
}

void save_database(const PerformanceDatabase& database, const fs::path& target) {
  DatabaseWriter writer(target, database.topology());
  if (database.markup()) writer.set_markup(*database.markup());
  for (std::size_t c = 0; c < database.clips().size(); ++c) {
    writer.write_clip(database.clip(c));
    if (const ClipTruth* truth = database.truth(c)) writer.set_truth(*truth);
  }
  writer.commit();
}

}  // namespace reprise
