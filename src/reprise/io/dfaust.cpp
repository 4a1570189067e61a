// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/dfaust.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {
namespace {

constexpr std::size_t block_bytes = std::size_t{32} << 20;

bool is_integer(Hdf5Type type) {
  return type != Hdf5Type::float32 && type != Hdf5Type::float64 && type != Hdf5Type::text &&
         type != Hdf5Type::other;
}

bool is_sequence(const Hdf5Dataset& dataset) {
  return dataset.shape().size() == 3 &&
         (dataset.type() == Hdf5Type::float32 || dataset.type() == Hdf5Type::float64);
}

// Triangles of the dataset `faces`: rows of three or four vertex indices from 0.
std::vector<Triangle> read_faces(const Hdf5File& file) {
  const Hdf5Dataset dataset = file.dataset("faces");
  const Hdf5Shape& shape = dataset.shape();
  if (shape.size() != 2 || (shape[1] != 3 && shape[1] != 4) || !is_integer(dataset.type())) {
    throw FileError(file.file_path(), "faces",
                    fmt::format("expected whole numbers of shape (faces, 3) or (faces, 4), found shape ({})",
                                fmt::join(shape, ", ")));
  }
  const std::vector<std::int64_t> corners = dataset.read<std::int64_t>();
  std::vector<Triangle> triangles;
  triangles.reserve(shape[0] * (shape[1] - 2));
  for (std::size_t face = 0; face < shape[0]; ++face) {
    Triangle triangle{};
    for (std::size_t k = 0; k < shape[1]; ++k) {
      const std::int64_t corner = corners[face * shape[1] + k];
      if (corner < 0 || corner >= std::numeric_limits<std::int32_t>::max()) {
        throw FileError(file.file_path(), "faces", fmt::format("face {} has vertex index {}", face, corner));
      }
      if (k == 3) {
        triangles.push_back(triangle);
        triangle[1] = triangle[2];
      }
      triangle[std::min<std::size_t>(k, 2)] = static_cast<std::int32_t>(corner);
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace

std::vector<DfaustLayout> dfaust_layouts(const std::array<std::size_t, 3>& shape, std::size_t min_vertices) {
  std::vector<DfaustLayout> possible, exact;
  for (const DfaustLayout& layout : {DfaustLayout{0, 1, 2}, DfaustLayout{2, 0, 1}, DfaustLayout{0, 2, 1}}) {
    if (shape[layout.coordinate] != 3 || shape[layout.vertex] < min_vertices) continue;
    possible.push_back(layout);
    if (shape[layout.vertex] == min_vertices) exact.push_back(layout);
  }
  return exact.empty() ? possible : exact;
}

DfaustFile::DfaustFile(const std::filesystem::path& path, const std::string& sequence_id,
                       TopologyPtr topology) {
  const Hdf5File file = Hdf5File::open(path);
  std::vector<std::string> ids;
  std::vector<std::array<std::size_t, 3>> shapes;
  for (const std::string& child : file.children()) {
    if (child == "faces" || !file.is_dataset(child)) continue;
    const Hdf5Dataset dataset = file.dataset(child);
    if (!is_sequence(dataset)) continue;
    ids.push_back(child);
    shapes.push_back({dataset.shape()[0], dataset.shape()[1], dataset.shape()[2]});
  }
  if (ids.empty())
    throw FileError(path, "holds no sequence: expected datasets of three dimensions beside 'faces'");
  auto found = std::find(ids.begin(), ids.end(), sequence_id);
  if (sequence_id.empty() && ids.size() == 1) found = ids.begin();
  if (found == ids.end()) {
    const std::string near = nearest_word(sequence_id, ids);
    throw FileError(
        path,
        fmt::format("{}; it holds {}{}",
                    sequence_id.empty() ? "holds several sequences: name one of them"
                                        : fmt::format("holds no sequence '{}'", sequence_id),
                    fmt::join(ids, ", "),
                    sequence_id.empty() || near.empty() ? "" : fmt::format(" (did you mean {}?)", near)));
  }
  sequence_id_ = *found;
  shape_ = shapes[static_cast<std::size_t>(found - ids.begin())];

  std::vector<Triangle> triangles;
  std::size_t min_vertices = 1;
  if (file.has("faces")) {
    triangles = read_faces(file);
    for (const Triangle& triangle : triangles) {
      for (const std::int32_t v : triangle)
        min_vertices = std::max(min_vertices, static_cast<std::size_t>(v) + 1);
    }
  } else if (topology != nullptr) {
    min_vertices = static_cast<std::size_t>(topology->vertex_count);
  } else {
    throw FileError(path,
                    "holds no faces: expected a dataset 'faces', or an OBJ or PLY file as the topology");
  }

  // Faces may leave the last vertices unused, so that several layouts fit: all sequences of a file have the
  // same number of vertices.
  std::vector<DfaustLayout> layouts = dfaust_layouts(shape_, min_vertices);
  if (layouts.size() > 1) {
    std::erase_if(layouts, [&](const DfaustLayout& layout) {
      return !std::all_of(shapes.begin(), shapes.end(), [&](const std::array<std::size_t, 3>& other) {
        const std::vector<DfaustLayout> of_other = dfaust_layouts(other, min_vertices);
        return std::any_of(of_other.begin(), of_other.end(), [&](const DfaustLayout& candidate) {
          return other[candidate.vertex] == shape_[layout.vertex];
        });
      });
    });
  }
  if (layouts.size() != 1) {
    const std::string shape = fmt::format("({})", fmt::join(shape_, ", "));
    throw FileError(path, sequence_id_,
                    layouts.empty()
                        ? fmt::format("expected shape (frames, vertices, 3) or (vertices, 3, frames) with "
                                      "at least {} vertices, as the faces ask for; found {}",
                                      min_vertices, shape)
                        : fmt::format("shape {} is ambiguous: the faces use {} vertices, and several of its "
                                      "dimensions may count the vertices",
                                      shape, min_vertices));
  }
  layout_ = layouts.front();
  if (frame_count() == 0) throw FileError(path, sequence_id_, "expected at least 1 frame, found 0");
  const std::size_t vertex_count = shape_[layout_.vertex];
  if (vertex_count > std::numeric_limits<std::int32_t>::max() ||
      (topology != nullptr && vertex_count != static_cast<std::size_t>(topology->vertex_count))) {
    throw FileError(
        path, sequence_id_,
        fmt::format("has {} vertices, but the topology has {}", vertex_count,
                    topology != nullptr ? topology->vertex_count : std::numeric_limits<std::int32_t>::max()));
  }
  if (topology == nullptr) {
    Topology own;
    own.vertex_count = static_cast<std::int32_t>(vertex_count);
    own.triangles = std::move(triangles);
    std::erase_if(own.triangles,
                  [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    if (own.triangles.empty()) throw FileError(path, "faces", "expected at least 1 face, found 0");
    topology = std::make_shared<const Topology>(std::move(own));
  }
  topology_ = std::move(topology);
  // Contiguous frames are read one by one.
  const std::size_t frame_bytes = 3 * sizeof(float) * vertex_count;
  frames_per_block_ =
      layout_.frame == 0 ? 1 : std::clamp<std::size_t>(block_bytes / frame_bytes, 1, frame_count());
  dataset_ = std::make_unique<const Hdf5Dataset>(file.dataset(sequence_id_));
}

std::shared_ptr<const DfaustFile::Block> DfaustFile::block_of(std::size_t frame_idx) const {
  const std::lock_guard lock(mutex_);
  for (std::shared_ptr<const Block>& block : recent_) {
    if (block != nullptr && frame_idx - block->first_frame < block->frame_count) return block;
  }
  auto block = std::make_shared<Block>();
  block->first_frame = frame_idx / frames_per_block_ * frames_per_block_;
  block->frame_count = std::min(frames_per_block_, frame_count() - block->first_frame);
  Hdf5Shape offset(3, 0);
  Hdf5Shape count(shape_.begin(), shape_.end());
  offset[layout_.frame] = block->first_frame;
  count[layout_.frame] = block->frame_count;
  block->values.resize(count[0] * count[1] * count[2]);
  dataset_->read<float>(offset, count, block->values);
  recent_[1] = std::exchange(recent_[0], block);
  return block;
}

Positions DfaustFile::read(std::size_t frame_idx) const {
  const std::shared_ptr<const Block> block = block_of(frame_idx);
  std::array<std::size_t, 3> sizes = shape_;
  sizes[layout_.frame] = block->frame_count;
  const std::array<std::size_t, 3> strides = {sizes[1] * sizes[2], sizes[2], 1};
  const float* const first = block->values.data() + (frame_idx - block->first_frame) * strides[layout_.frame];
  Positions positions(static_cast<Eigen::Index>(shape_[layout_.vertex]), 3);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      positions(v, k) = first[static_cast<std::size_t>(v) * strides[layout_.vertex] +
                              static_cast<std::size_t>(k) * strides[layout_.coordinate]];
    }
  }
  return positions;
}

}  // namespace reprise
