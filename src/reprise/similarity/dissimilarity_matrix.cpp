// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/similarity/dissimilarity_matrix.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/io/hdf5.h"

namespace reprise {
namespace {

constexpr const char* file_signature = "reprise dissimilarity matrix";
constexpr std::int64_t file_version = 2;  // 1 had no lower bounds
// Far beyond any capture, and small enough that products of two sizes do not overflow.
constexpr std::uint64_t max_frame_count = 10'000'000;

std::size_t pairs_of(std::size_t frame_count) {
  return frame_count < 2 ? 0 : frame_count * (frame_count - 1) / 2;
}

std::vector<std::size_t> frame_counts_of(const PerformanceDatabase& database) {
  std::vector<std::size_t> counts;
  for (const MeshSequence& clip : database.clips()) counts.push_back(clip.frame_count());
  return counts;
}

std::vector<float> read_pairs(const Hdf5File& file, const std::string& name, std::size_t size) {
  const Hdf5Dataset dataset = file.dataset(name);
  dataset.check_shape({size});
  return dataset.read<float>();
}

// Values that a metric gives, or that say that it has not been asked yet.
void check_bounds(const std::filesystem::path& path, const std::vector<float>& lower_bounds,
                  const std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0.0F)) {
      throw FileError(path, fmt::format("values, entry {}", i),
                      fmt::format("expected a dissimilarity of at least 0 m, found {}", values[i]));
    }
    if (!(lower_bounds[i] >= 0.0F && lower_bounds[i] <= values[i]) || std::isinf(lower_bounds[i])) {
      throw FileError(path, fmt::format("lower_bounds, entry {}", i),
                      fmt::format("expected a finite lower bound from 0 m to the value, {} m, found {}",
                                  values[i], lower_bounds[i]));
    }
  }
}

}  // namespace

DissimilarityMatrix::DissimilarityMatrix(std::string metric, std::string key,
                                         std::vector<std::string> clip_names,
                                         std::vector<std::size_t> clip_frame_counts)
    : metric_(std::move(metric)),
      key_(std::move(key)),
      clip_names_(std::move(clip_names)),
      clip_frame_counts_(std::move(clip_frame_counts)) {
  if (clip_names_.size() != clip_frame_counts_.size()) {
    throw InvalidArgument(
        fmt::format("a dissimilarity matrix of {} clip names and {} frame counts: expected one each",
                    clip_names_.size(), clip_frame_counts_.size()));
  }
  for (const std::size_t count : clip_frame_counts_) {
    first_frames_.push_back(frame_count_);
    frame_count_ += count;
  }
  const MatrixEntry unknown;
  lower_bounds_.resize(pairs_of(frame_count_), unknown.lower);
  values_.resize(pairs_of(frame_count_), unknown.value);
  yaws_.resize(pairs_of(frame_count_), unknown.yaw);
}

DissimilarityMatrix::DissimilarityMatrix(std::string metric, const PerformanceDatabase& database)
    : DissimilarityMatrix(std::move(metric), database.content_hash(), database.clip_names(),
                          frame_counts_of(database)) {}

std::size_t DissimilarityMatrix::index(std::size_t a, std::size_t b) const {
  return a * (2 * frame_count_ - a - 1) / 2 + (b - a - 1);
}

float DissimilarityMatrix::value(std::size_t a, std::size_t b) const {
  if (a == b) return 0.0F;
  return values_[a < b ? index(a, b) : index(b, a)];
}

float DissimilarityMatrix::lower_bound(std::size_t a, std::size_t b) const {
  if (a == b) return 0.0F;
  return lower_bounds_[a < b ? index(a, b) : index(b, a)];
}

float DissimilarityMatrix::yaw(std::size_t a, std::size_t b) const {
  if (a == b) return 0.0F;
  return a < b ? yaws_[index(a, b)] : -yaws_[index(b, a)];
}

void DissimilarityMatrix::set(std::size_t a, std::size_t b, float value, float yaw_a_from_b) {
  set(a, b, MatrixEntry{.lower = value, .value = value, .yaw = yaw_a_from_b});
}

void DissimilarityMatrix::set(std::size_t a, std::size_t b, const MatrixEntry& entry) {
  const std::size_t i = index(a, b);
  lower_bounds_[i] = entry.lower;
  values_[i] = entry.value;
  yaws_[i] = entry.yaw;
}

MatrixEntry DissimilarityMatrix::entry(std::size_t a, std::size_t b) const {
  return {.lower = lower_bound(a, b), .value = value(a, b), .yaw = yaw(a, b)};
}

std::size_t DissimilarityMatrix::exact_count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) count += lower_bounds_[i] == values_[i] ? 1 : 0;
  return count;
}

std::size_t DissimilarityMatrix::unknown_count() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(values_, [](float value) { return std::isinf(value); }));
}

void DissimilarityMatrix::save(const std::filesystem::path& path) const {
  AtomicOutput output(path, AtomicOutput::Kind::file);
  Hdf5File file = Hdf5File::create(output.path());
  file.write_text("signature", file_signature);
  file.write_integer("version", file_version);
  file.write_text("metric", metric_);
  file.write_text("key", key_);
  const std::vector<std::uint64_t> frame_counts(clip_frame_counts_.begin(), clip_frame_counts_.end());
  file.write_integer("clip_count", static_cast<std::int64_t>(clip_names_.size()));
  // HDF5 has no use for empty arrays, and neither has a reader.
  if (!clip_names_.empty()) {
    file.write_text_dataset("clip_names", clip_names_);
    file.write<std::uint64_t>("clip_frame_counts", {frame_counts.size()}, frame_counts);
  }
  if (!values_.empty()) {
    file.write<float>("lower_bounds", {lower_bounds_.size()}, lower_bounds_);
    file.write<float>("values", {values_.size()}, values_);
    file.write<float>("yaws", {yaws_.size()}, yaws_);
  }
  file.finish();
  output.commit();
}

DissimilarityMatrix DissimilarityMatrix::load(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  if (!file.has_attribute("signature") || file.read_text("signature") != file_signature) {
    throw FileError(path,
                    "is not a dissimilarity matrix of Reprise: expected an HDF5 file with its signature");
  }
  const std::int64_t version = file.read_integer("version");
  if (version != file_version) {
    throw FileError(
        path, fmt::format("has version {}, expected {}: compute the matrix anew", version, file_version));
  }
  const std::int64_t clip_count = file.read_integer("clip_count");
  std::vector<std::string> names;
  std::vector<std::size_t> frame_counts;
  if (clip_count != 0) {
    names = file.dataset("clip_names").read_texts();
    const std::vector<std::uint64_t> counts = file.dataset("clip_frame_counts").read<std::uint64_t>();
    if (clip_count < 0 || names.size() != static_cast<std::size_t>(clip_count) ||
        counts.size() != names.size()) {
      throw FileError(path, "clip_frame_counts",
                      fmt::format("expected {} clips, found {} names and {} frame counts", clip_count,
                                  names.size(), counts.size()));
    }
    std::uint64_t total = 0;
    for (const std::uint64_t count : counts) {
      total += std::min(count, max_frame_count + 1);
      if (total > max_frame_count) {
        throw FileError(path, "clip_frame_counts",
                        fmt::format("expected at most {} frames in all, found more", max_frame_count));
      }
      frame_counts.push_back(count);
    }
    // Before memory is taken for them: the arrays must be as long as the frame counts say.
    if (const std::size_t pairs = pairs_of(total); pairs > 0) {
      file.dataset("lower_bounds").check_shape({pairs});
      file.dataset("values").check_shape({pairs});
      file.dataset("yaws").check_shape({pairs});
    }
  }
  DissimilarityMatrix matrix(file.read_text("metric"), file.read_text("key"), std::move(names),
                             std::move(frame_counts));
  if (!matrix.values_.empty()) {
    matrix.lower_bounds_ = read_pairs(file, "lower_bounds", matrix.lower_bounds_.size());
    matrix.values_ = read_pairs(file, "values", matrix.values_.size());
    matrix.yaws_ = read_pairs(file, "yaws", matrix.yaws_.size());
  }
  check_bounds(path, matrix.lower_bounds_, matrix.values_);
  const auto bad_yaw = std::ranges::find_if(matrix.yaws_, [](float v) { return !(std::abs(v) < 4.0F); });
  if (bad_yaw != matrix.yaws_.end()) {
    throw FileError(path, fmt::format("yaws, entry {}", bad_yaw - matrix.yaws_.begin()),
                    fmt::format("expected an angle from -pi to pi, found {}", *bad_yaw));
  }
  return matrix;
}

}  // namespace reprise
