// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// HDF5 files: groups, datasets and attributes whose handles close themselves and whose errors are
// `FileError`s with HDF5's own words. Safe from several threads: one lock around the library, which by itself
// is not.

#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace reprise {

enum class Hdf5Type {
  float32,
  float64,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  text,
  other
};

template <typename T>
constexpr Hdf5Type hdf5_type() {
  static_assert(std::is_floating_point_v<T> || std::is_integral_v<T>);
  if constexpr (std::is_floating_point_v<T>) return sizeof(T) == 4 ? Hdf5Type::float32 : Hdf5Type::float64;
  constexpr bool is_signed = std::is_signed_v<T>;
  if constexpr (sizeof(T) == 1) return is_signed ? Hdf5Type::int8 : Hdf5Type::uint8;
  if constexpr (sizeof(T) == 2) return is_signed ? Hdf5Type::int16 : Hdf5Type::uint16;
  if constexpr (sizeof(T) == 4) return is_signed ? Hdf5Type::int32 : Hdf5Type::uint32;
  return is_signed ? Hdf5Type::int64 : Hdf5Type::uint64;
}

using Hdf5Shape = std::vector<std::size_t>;

struct Hdf5DatasetOptions {
  std::size_t chunk_rows = 0;  // rows of the first dimension a chunk; 0: contiguous, fixed size
  bool growable = false;       // the first dimension may grow by `resize_rows`; needs chunks
  int deflate = 0;             // 1 (fast) to 9 (small), after a byte shuffle; 0: none; needs chunks
  bool checksum = false;       // Fletcher-32 a chunk, checked on reading; needs chunks
};

// State shared by everything opened from one file.
struct Hdf5Context;

// What groups and datasets have in common. Movable; closes itself. All members throw `FileError` on failure.
class Hdf5Object {
 public:
  ~Hdf5Object();
  Hdf5Object(Hdf5Object&& other) noexcept;
  Hdf5Object& operator=(Hdf5Object&& other) noexcept;

  const std::filesystem::path& file_path() const;
  const std::string& name() const { return name_; }  // path inside the file: "/clips/0/positions"

  bool has_attribute(const std::string& attribute) const;
  std::int64_t read_integer(const std::string& attribute) const;
  double read_number(const std::string& attribute) const;
  std::string read_text(const std::string& attribute) const;
  void write_integer(const std::string& attribute, std::int64_t value);
  void write_number(const std::string& attribute, double value);
  void write_text(const std::string& attribute, const std::string& value);

 protected:
  Hdf5Object(std::shared_ptr<Hdf5Context> context, std::int64_t id, std::string name);
  void close() noexcept;

  std::shared_ptr<Hdf5Context> context_;
  std::int64_t id_ = -1;
  std::string name_;
};

// An array of numbers (or texts). Values are converted between the file's number type and T.
class Hdf5Dataset : public Hdf5Object {
 public:
  const Hdf5Shape& shape() const { return shape_; }
  std::size_t size() const;  // number of elements
  Hdf5Type type() const { return type_; }

  // Throws `FileError` naming the found shape unless it is `expected`.
  void check_shape(const Hdf5Shape& expected) const;

  // The whole array.
  template <typename T>
  std::vector<T> read() const {
    std::vector<T> values(size());
    read_all(values.data(), hdf5_type<T>());
    return values;
  }
  // The block of `count` elements from `offset`, one entry a dimension each; `out` has as many elements as
  // the block.
  template <typename T>
  void read(const Hdf5Shape& offset, const Hdf5Shape& count, std::span<T> out) const {
    read_block(offset, count, out.data(), out.size(), hdf5_type<T>());
  }
  template <typename T>
  void write(const Hdf5Shape& offset, const Hdf5Shape& count, std::span<const T> values) {
    write_block(offset, count, values.data(), values.size(), hdf5_type<T>());
  }
  // Texts of a one-dimensional (or scalar) array.
  std::vector<std::string> read_texts() const;

  // New length of the first dimension of a growable array.
  void resize_rows(std::size_t rows);

 private:
  friend class Hdf5Group;
  Hdf5Dataset(std::shared_ptr<Hdf5Context> context, std::int64_t id, std::string name);
  void check_claim() const;
  void read_all(void* values, Hdf5Type type) const;
  void read_block(const Hdf5Shape& offset, const Hdf5Shape& count, void* out, std::size_t size,
                  Hdf5Type type) const;
  void write_block(const Hdf5Shape& offset, const Hdf5Shape& count, const void* values, std::size_t size,
                   Hdf5Type type);

  Hdf5Shape shape_;
  Hdf5Type type_ = Hdf5Type::other;
};

class Hdf5Group : public Hdf5Object {
 public:
  bool has(const std::string& child) const;
  // Names of the groups and datasets directly inside, in ascending order.
  std::vector<std::string> children() const;
  bool is_dataset(const std::string& child) const;

  Hdf5Group group(const std::string& child) const;
  Hdf5Group create_group(const std::string& child);

  // `cache_bytes`: chunks kept in memory; 0 reads and writes whole chunks without a copy.
  // Throws `FileError` also if the array claims more than its file can hold.
  Hdf5Dataset dataset(const std::string& child, std::size_t cache_bytes = 1 << 20) const;
  Hdf5Dataset create_dataset(const std::string& child, Hdf5Type type, const Hdf5Shape& shape,
                             const Hdf5DatasetOptions& options = {});
  // Creates and fills a dataset of fixed size.
  template <typename T>
  void write(const std::string& child, const Hdf5Shape& shape, std::span<const T> values) {
    create_dataset(child, hdf5_type<T>(), shape).write(Hdf5Shape(shape.size(), 0), shape, values);
  }
  // One text, or an array of texts (UTF-8).
  void write_text_dataset(const std::string& child, const std::string& text);
  void write_text_dataset(const std::string& child, std::span<const std::string> texts);

 protected:
  using Hdf5Object::Hdf5Object;
};

// The file, which is also its root group.
class Hdf5File : public Hdf5Group {
 public:
  // Throws `FileError` if the file is missing or HDF5 cannot open it.
  static Hdf5File open(const std::filesystem::path& path);
  // Creates or replaces a file. `user_block`: bytes before the HDF5 data that belong to the caller: 0, 512,
  // 1024, ...
  // `reported_path`: what errors call the file, if it is a temporary one.
  static Hdf5File create(const std::filesystem::path& path, std::size_t user_block = 0,
                         const std::filesystem::path& reported_path = {});

  // Writes what is buffered and closes the file. Datasets and groups opened from it must be gone. Throws
  // `FileError` if this or any earlier write failed, for example on a full disk; the destructor closes
  // silently.
  void finish();
  // Throws `FileError` if a write has failed so far.
  void check_writes() const;

 private:
  using Hdf5Group::Hdf5Group;
};

}  // namespace reprise
