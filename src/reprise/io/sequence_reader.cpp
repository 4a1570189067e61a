// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/sequence_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/io/byte_order.h"
#include "reprise/io/dfaust.h"
#include "reprise/io/frame_files.h"
#include "reprise/io/input_file.h"
#include "reprise/io/mdd.h"
#include "reprise/io/mesh_texture.h"
#include "reprise/io/obj.h"
#include "reprise/io/pc2.h"
#include "reprise/io/ply.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

void apply_scale(Positions& positions, double scale) {
  if (scale != 1.0) positions = (positions.cast<double>() * scale).cast<float>();
}

void warn_of_dropped(const ParsedMesh& mesh, const fs::path& path) {
  if (mesh.dropped_triangles > 0) {
    spdlog::warn("{}: {} triangles with two equal corners are left out", path.string(),
                 mesh.dropped_triangles);
  }
}

void check_frame_idx(std::size_t frame_idx, std::size_t frame_count) {
  if (frame_idx >= frame_count) {
    throw InvalidArgument(
        fmt::format("frame {} is out of range: the sequence has {} frames", frame_idx, frame_count));
  }
}

// A folder of numbered OBJ or PLY files.
class FolderReader : public SequenceReader {
 public:
  explicit FolderReader(const SequenceSource& source) : scale_(source.scale) {
    const FrameFiles files = find_frame_files(source.path);
    is_obj_ = files.is_obj;
    paths_ = files.paths;
    const FileBytes bytes = InputFile(paths_.front()).read_all();
    ParsedMesh first = is_obj_ ? parse_obj(bytes.view(), paths_.front(), &obj_faces_)
                               : parse_ply(bytes.view(), paths_.front());
    warn_of_dropped(first, paths_.front());
    load_texture(first, paths_.front());
    if (first.topology.texture) warn_of_changing_texture(first);
    has_normals_ = first.normals.size() > 0;
    has_colors_ = !first.colors.empty();
    topology_ = std::make_shared<const Topology>(std::move(first.topology));
    frame_count_ = paths_.size();
  }

  std::string frame_name(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    return paths_[frame_idx].string();
  }

  std::size_t frame_bytes(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    std::error_code error;
    const std::uintmax_t size = fs::file_size(paths_[frame_idx], error);
    if (error) throw FileError(paths_[frame_idx], fmt::format("cannot be read: {}", error.message()));
    return size;
  }

  Mesh read(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    const fs::path& path = paths_[frame_idx];
    const FileBytes bytes = InputFile(path).read_all();
    std::optional<ParsedMesh> parsed;
    if (is_obj_) parsed = parse_obj_frame(bytes.view(), path, obj_faces_);
    if (!parsed) {
      parsed = is_obj_ ? parse_obj(bytes.view(), path) : parse_ply(bytes.view(), path);
      const std::string difference = first_difference(
          *topology_, parsed->topology, paths_.front().filename().string(), path.filename().string());
      if (!difference.empty())
        throw FileError(path, fmt::format("does not match the first frame: {}", difference));
    }
    check_same_extras(parsed->normals.size() > 0, has_normals_, "normals", path);
    check_same_extras(!parsed->colors.empty(), has_colors_, "vertex colours", path);
    apply_scale(parsed->positions, scale_);
    const std::string reason =
        degeneracy(*topology_, PositionsView(parsed->positions.data(), parsed->positions.rows(), 3));
    if (!reason.empty()) throw FileError(path, reason);
    return {topology_, std::move(parsed->positions), std::move(parsed->normals), std::move(parsed->colors)};
  }

 private:
  void check_same_extras(bool here, bool first, const char* what, const fs::path& path) const {
    if (here == first) return;
    throw FileError(path, fmt::format("does not match the first frame: {} has {}, {} has none",
                                      (here ? path : paths_.front()).filename().string(), what,
                                      (here ? paths_.front() : path).filename().string()));
  }

  // The last frame speaks for all between.
  void warn_of_changing_texture(const ParsedMesh& first) const {
    const fs::path& path = paths_.back();
    const FileBytes bytes = InputFile(path).read_all();
    std::optional<ParsedMesh> last;
    if (is_obj_) last = parse_obj_frame(bytes.view(), path, obj_faces_);
    if (!last) last = is_obj_ ? parse_obj(bytes.view(), path) : parse_ply(bytes.view(), path);
    if (last->material_files != first.material_files || last->texture_files != first.texture_files) {
      spdlog::warn("{}: names another texture than {}; that of the first frame is kept for all",
                   path.string(), paths_.front().filename().string());
    }
  }

  double scale_;
  bool is_obj_ = true;
  std::vector<fs::path> paths_;
  ObjFaces obj_faces_;
  bool has_normals_ = false, has_colors_ = false;
};

// A file that holds positions of all frames, with faces and colours from elsewhere.
class PositionsReader : public SequenceReader {
 public:
  std::string frame_name(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    return fmt::format("{}, frame {}", path_.string(), frame_idx);
  }

  Mesh read(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    Positions positions = read_positions(frame_idx);
    apply_scale(positions, scale_);
    const std::string reason = degeneracy(*topology_, PositionsView(positions.data(), positions.rows(), 3));
    if (!reason.empty()) throw FileError(path_, fmt::format("frame {}", frame_idx), reason);
    return {topology_, std::move(positions), {}, colors_};
  }

 protected:
  explicit PositionsReader(const SequenceSource& source) : path_(source.path), scale_(source.scale) {}

  void take_topology(const SequenceSource& source, const char* format) {
    if (!source.topology) {
      throw FileError(
          path_, fmt::format("{} holds positions alone: name an OBJ or PLY file of the same vertices as its "
                             "topology",
                             format));
    }
    Mesh mesh = read_mesh(*source.topology);
    topology_ = std::move(mesh.topology);
    colors_ = std::move(mesh.colors);
  }

  void check_vertex_count(std::size_t vertex_count, const SequenceSource& source) const {
    if (vertex_count != static_cast<std::size_t>(topology_->vertex_count)) {
      throw FileError(path_, fmt::format("has {} vertices, but its topology {} has {}", vertex_count,
                                         source.topology->string(), topology_->vertex_count));
    }
  }

  virtual Positions read_positions(std::size_t frame_idx) const = 0;

  fs::path path_;
  double scale_;
  std::vector<Color> colors_;
};

// A PC2 or MDD file: `Header` knows where frames are, `Order` how floats are stored.
template <typename Header, std::endian Order>
class PointCacheReader : public PositionsReader {
 public:
  explicit PointCacheReader(const SequenceSource& source) : PositionsReader(source), file_(source.path) {
    constexpr bool is_mdd = Order == std::endian::big;
    std::array<char, 32> start;
    const std::size_t available = std::min<std::size_t>(start.size(), file_.size());
    file_.read_at(0, start.data(), available);
    const std::string_view bytes(start.data(), available);
    if constexpr (is_mdd) {
      header_ = parse_mdd_header(bytes, file_.size(), path_);
      FileBytes times(4 * header_.frame_count);
      file_.read_at(header_.times_offset(), times.data(), times.view().size());
      frames_per_second_ = frames_per_second_from_mdd_times(times.view());
    } else {
      header_ = parse_pc2_header(bytes, file_.size(), path_);
    }
    take_topology(source, is_mdd ? "an MDD file" : "a PC2 file");
    check_vertex_count(header_.vertex_count, source);
    frame_count_ = header_.frame_count;
  }

  std::size_t frame_bytes(std::size_t) const override { return header_.frame_bytes(); }

 private:
  Positions read_positions(std::size_t frame_idx) const override {
    Positions positions(static_cast<Eigen::Index>(header_.vertex_count), 3);
    file_.read_at(header_.frame_offset(frame_idx), positions.data(), header_.frame_bytes());
    if constexpr (Order != std::endian::native) {
      for (Eigen::Index i = 0; i < positions.size(); ++i) {
        float& value = positions.data()[i];
        std::array<char, sizeof value> raw;
        std::memcpy(raw.data(), &value, sizeof value);
        value = load<float, Order>(raw.data());
      }
    }
    return positions;
  }

  InputFile file_;
  Header header_;
};

using Pc2Reader = PointCacheReader<Pc2Header, std::endian::little>;
using MddReader = PointCacheReader<MddHeader, std::endian::big>;

class DfaustReader : public PositionsReader {
 public:
  explicit DfaustReader(const SequenceSource& source) : PositionsReader(source) {
    // A folder or a missing file is reported as for the other kinds.
    { const InputFile probe(source.path); }
    if (source.topology) take_topology(source, "an HDF5 file");
    file_.emplace(source.path, source.sequence_id, topology_);
    topology_ = file_->topology();
    frame_count_ = file_->frame_count();
  }

  std::string frame_name(std::size_t frame_idx) const override {
    check_frame_idx(frame_idx, frame_count_);
    return fmt::format("{}, {}, frame {}", path_.string(), file_->sequence_id(), frame_idx);
  }
  std::size_t frame_bytes(std::size_t) const override {
    return 3 * sizeof(float) * static_cast<std::size_t>(topology_->vertex_count);
  }

 private:
  Positions read_positions(std::size_t frame_idx) const override { return file_->read(frame_idx); }

  std::optional<DfaustFile> file_;
};

}  // namespace

std::unique_ptr<SequenceReader> open_sequence(const SequenceSource& source) {
  if (!(source.scale > 0.0) || !std::isfinite(source.scale)) {
    throw InvalidArgument(fmt::format("scale: expected a positive number, found {}", source.scale));
  }
  std::error_code error;
  const fs::file_status status = fs::status(source.path, error);
  if (!fs::exists(status)) throw FileError(source.path, "does not exist");
  if (fs::is_directory(status)) {
    if (source.topology) {
      spdlog::warn("{}: the topology {} is not used: every frame of a folder has its own faces",
                   source.path.string(), source.topology->string());
    }
    return std::make_unique<FolderReader>(source);
  }
  switch (file_kind(source.path)) {
    case FileKind::pc2:
      return std::make_unique<Pc2Reader>(source);
    case FileKind::mdd:
      return std::make_unique<MddReader>(source);
    case FileKind::hdf5:
      return std::make_unique<DfaustReader>(source);
    case FileKind::obj:
    case FileKind::ply:
      throw FileError(source.path, "is a single mesh: expected a folder of numbered OBJ or PLY files");
    case FileKind::other:
      break;
  }
  throw FileError(
      source.path,
      "is not a sequence: expected a folder of numbered OBJ or PLY files, or a file .pc2, .mdd, .h5 or "
      ".hdf5");
}

Mesh read_mesh(const fs::path& path) {
  const FileKind kind = file_kind(path);
  if (kind != FileKind::obj && kind != FileKind::ply && fs::exists(path)) {
    throw FileError(path, "is not a mesh: expected a file .obj or .ply");
  }
  const FileBytes bytes = InputFile(path).read_all();
  ParsedMesh parsed = kind == FileKind::obj ? parse_obj(bytes.view(), path) : parse_ply(bytes.view(), path);
  warn_of_dropped(parsed, path);
  load_texture(parsed, path);
  return {std::make_shared<const Topology>(std::move(parsed.topology)), std::move(parsed.positions),
          std::move(parsed.normals), std::move(parsed.colors)};
}

}  // namespace reprise
