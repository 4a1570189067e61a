// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/matrix_store.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/log.h"
#include "reprise/core/ranks.h"
#include "reprise/io/hdf5.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

constexpr const char* found_signature = "reprise exact entries";
constexpr std::int64_t found_version = 1;
constexpr auto first_pause = std::chrono::seconds(1);
constexpr std::chrono::duration<double> longest_pause = std::chrono::seconds(10);
constexpr double work_per_save = 19.0;
// Entries sent to the other ranks at a time.
constexpr std::size_t block_entries = std::size_t{1} << 20U;
constexpr std::size_t chunk_rows = 4096;

template <typename T>
std::span<const std::byte> bytes_of(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(values);
}

template <typename T>
std::vector<T> values_of(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

// What the first rank has, for all.
template <typename T>
std::vector<T> from_first(std::span<const T> values) {
  const auto all = Ranks::all_gather(Ranks::is_first() ? bytes_of(values) : std::span<const std::byte>());
  return values_of<T>(all.front());
}

// The first rank's matrix, for all: the others bring an empty one of the same clips.
void share(DissimilarityMatrix& matrix) {
  if (Ranks::count() == 1) return;
  const std::size_t frame_count = matrix.frame_count();
  std::vector<MatrixEntry> block;
  std::size_t first_row = 0;
  for (std::size_t a = 0, size = 0; a < frame_count; ++a) {
    size += frame_count - 1 - a;
    if (size < block_entries && a + 1 < frame_count) continue;
    block.clear();
    for (std::size_t row = first_row; row <= a && Ranks::is_first(); ++row) {
      for (std::size_t b = row + 1; b < frame_count; ++b) block.push_back(matrix.entry(row, b));
    }
    block = from_first<MatrixEntry>(block);
    auto next = block.begin();
    for (std::size_t row = first_row; row <= a; ++row) {
      for (std::size_t b = row + 1; b < frame_count; ++b) matrix.set(row, b, *next++);
    }
    first_row = a + 1;
    size = 0;
  }
}

void write_found(const fs::path& file, const std::string& key, std::span<const PairEntry> found) {
  std::vector<std::uint32_t> pairs;
  std::vector<float> values;
  for (const PairEntry& f : found) {
    pairs.insert(pairs.end(), {f.a, f.b});
    values.insert(values.end(), {f.entry.lower, f.entry.value, f.entry.yaw});
  }
  AtomicOutput output(file, AtomicOutput::Kind::file);
  Hdf5File stream = Hdf5File::create(output.path());
  stream.write_text("signature", found_signature);
  stream.write_integer("version", found_version);
  stream.write_text("key", key);
  const Hdf5DatasetOptions checked{.chunk_rows = std::min(chunk_rows, found.size()), .checksum = true};
  stream.create_dataset("pairs", Hdf5Type::uint32, {found.size(), 2}, checked)
      .write<std::uint32_t>({0, 0}, {found.size(), 2}, pairs);
  stream.create_dataset("entries", Hdf5Type::float32, {found.size(), 3}, checked)
      .write<float>({0, 0}, {found.size(), 3}, values);
  stream.finish();
  output.commit();
}

void read_found(const fs::path& file, const std::string& key, std::size_t frame_count,
                std::vector<PairEntry>& found) {
  const Hdf5File stream = Hdf5File::open(file);
  if (!stream.has_attribute("signature") || stream.read_text("signature") != found_signature) {
    throw FileError(file, "does not hold exact entries of Reprise: expected an HDF5 file with its signature");
  }
  if (const std::int64_t version = stream.read_integer("version"); version != found_version) {
    throw FileError(file, fmt::format("has version {}, expected {}", version, found_version));
  }
  if (stream.read_text("key") != key) return;
  const Hdf5Dataset pairs = stream.dataset("pairs");
  const std::size_t count = pairs.shape().empty() ? 0 : pairs.shape()[0];
  pairs.check_shape({count, 2});
  const Hdf5Dataset entries = stream.dataset("entries");
  entries.check_shape({count, 3});
  const std::vector<std::uint32_t> indices = pairs.read<std::uint32_t>();
  const std::vector<float> values = entries.read<float>();
  std::vector<PairEntry> read;
  for (std::size_t i = 0; i < count; ++i) {
    const PairEntry f{
        .a = indices[2 * i],
        .b = indices[2 * i + 1],
        .entry = {.lower = values[3 * i], .value = values[3 * i + 1], .yaw = values[3 * i + 2]}};
    const bool is_good = f.a < f.b && f.b < frame_count && f.entry.is_exact() && f.entry.value >= 0.0F &&
                         std::abs(f.entry.yaw) < 4.0F;
    if (!is_good) {
      throw FileError(
          file, fmt::format("entry {}", i),
          fmt::format("expected an exact dissimilarity of two of {} frames, found {} to {} m at yaw {} "
                      "of frames {} and {}",
                      frame_count, f.entry.lower, f.entry.value, f.entry.yaw, f.a, f.b));
    }
    read.push_back(f);
  }
  found.insert(found.end(), read.begin(), read.end());
}

}  // namespace

MatrixStore::MatrixStore(fs::path file, std::string key)
    : file_(std::move(file)),
      key_(std::move(key)),
      last_save_(std::chrono::steady_clock::now()),
      pause_(first_pause) {}

bool MatrixStore::load(DissimilarityMatrix& matrix) const {
  std::uint8_t is_there = 0;
  std::error_code ignored;
  if (Ranks::is_first() && !file_.empty() && fs::exists(file_, ignored)) {
    // A large one is not held twice.
    const std::string metric = matrix.metric();
    const std::string key = matrix.key();
    const std::vector<std::string> names = matrix.clip_names();
    const std::vector<std::size_t> counts = matrix.clip_frame_counts();
    matrix = DissimilarityMatrix();
    try {
      matrix = DissimilarityMatrix::load(file_);
      if (matrix.key() == key_ && matrix.metric() == metric && matrix.clip_frame_counts() == counts) {
        is_there = 1;
      }
    } catch (const FileError& error) {
      spdlog::warn("{}; the matrix is computed anew", error.what());
    }
    if (is_there == 0) matrix = DissimilarityMatrix(metric, key, names, counts);
  }
  is_there = from_first<std::uint8_t>({&is_there, 1}).front();
  if (is_there != 0) share(matrix);
  return is_there != 0;
}

std::vector<fs::path> MatrixStore::found_files() const {
  std::vector<fs::path> files;
  if (file_.empty()) return files;
  const std::string prefix = file_.filename().string() + ".found-";
  std::error_code error;
  for (fs::directory_iterator entry(file_.parent_path(), error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename().string().starts_with(prefix)) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

std::vector<PairEntry> MatrixStore::load_found(std::size_t frame_count) const {
  std::vector<PairEntry> found;
  if (Ranks::is_first()) {
    for (const fs::path& file : found_files()) {
      try {
        read_found(file, key_, frame_count, found);
      } catch (const FileError& error) {
        spdlog::warn("{}; its entries are computed anew", error.what());
      }
    }
  }
  return from_first<PairEntry>(found);
}

template <typename Write>
void MatrixStore::keep(const Write& write) {
  if (file_.empty() || is_broken_) return;
  const auto start = std::chrono::steady_clock::now();
  try {
    fs::create_directories(file_.parent_path());
    write();
  } catch (const std::exception& error) {  // a read-only folder or a full disk
    is_broken_ = true;
    spdlog::warn("the matrix is not kept: {}", error.what());
  }
  last_save_ = std::chrono::steady_clock::now();
  const std::chrono::duration<double> cost = last_save_ - start;
  pause_ = std::max(std::min(2.0 * pause_, longest_pause), work_per_save * cost);
}

void MatrixStore::save(const DissimilarityMatrix& matrix) {
  if (!Ranks::is_first()) return;
  keep([&] {
    matrix.save(file_);
    for (const fs::path& file : found_files()) fs::remove(file);
  });
}

void MatrixStore::save_found(std::span<const PairEntry> found) {
  if (found.empty()) return;
  keep([&] {
    fs::path file = file_;
    file += fmt::format(".found-{}", Ranks::index());
    write_found(file, key_, found);
  });
}

bool MatrixStore::is_due() const {
  return std::chrono::steady_clock::now() - last_save_ >= pause_;
}

}  // namespace reprise
