// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/hdf5.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <mutex>
#include <numeric>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include "reprise/core/error.h"

namespace reprise {

namespace fs = std::filesystem;

struct Hdf5Context {
  fs::path path;
  std::uint64_t file_bytes = 0;  // of a file opened for reading
  hid_t file = -1;
  int write_error = 0;  // errno of the first write that failed

  herr_t close() {
    const hid_t closing = std::exchange(file, -1);
    return closing < 0 ? 0 : H5Fclose(closing);
  }
  ~Hdf5Context();
};

namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

// ---- File access
// ---------------------------------------------------------------------------------------------- HDF5 1.10
// cannot close a file whose last writes fail: H5Fclose gives up half way, keeps the descriptor and tries
// again when the process ends. So this driver lets no write fail: it remembers the first error, drops what
// follows, and `Hdf5File::finish` asks for the error. It takes no file locks: files are put in place by
// renaming, and locks fail on some network file systems.

struct DriverFile {
  H5FD_t base;  // must come first: HDF5 knows the file by this part alone
  int descriptor;
  haddr_t eoa;
  haddr_t eof;
  dev_t device;
  ino_t inode;
  int* write_error;
};

DriverFile* driver_file(H5FD_t* file) {
  return reinterpret_cast<DriverFile*>(file);
}
const DriverFile* driver_file(const H5FD_t* file) {
  return reinterpret_cast<const DriverFile*>(file);
}

H5FD_t* driver_open(const char* name, unsigned flags, hid_t access, haddr_t /*maxaddr*/) {
  const auto* info = static_cast<int* const*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  int mode = O_CLOEXEC | ((flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY);
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  const int descriptor = ::open(name, mode, 0666);
  if (descriptor < 0) return nullptr;
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) {
    ::close(descriptor);
    return nullptr;
  }
  return &(new DriverFile{.base = {},
                          .descriptor = descriptor,
                          .eoa = 0,
                          .eof = static_cast<haddr_t>(status.st_size),
                          .device = status.st_dev,
                          .inode = status.st_ino,
                          .write_error = *info})
              ->base;
}

herr_t driver_close(H5FD_t* file) {
  const DriverFile* f = driver_file(file);
  // Some file systems report a full disk only here.
  if (::close(f->descriptor) != 0 && *f->write_error == 0) *f->write_error = errno;
  delete f;
  return 0;
}

int driver_compare(const H5FD_t* file1, const H5FD_t* file2) {
  const DriverFile* a = driver_file(file1);
  const DriverFile* b = driver_file(file2);
  const auto key = [](const DriverFile* f) { return std::pair(f->device, f->inode); };
  return key(a) < key(b) ? -1 : key(a) > key(b) ? 1 : 0;
}

herr_t driver_query(const H5FD_t* /*file*/, unsigned long* flags) {
  if (flags != nullptr) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  }
  return 0;
}

haddr_t driver_eoa(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return driver_file(file)->eoa;
}
haddr_t driver_eof(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return driver_file(file)->eof;
}

herr_t driver_set_eoa(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
  driver_file(file)->eoa = address;
  return 0;
}

herr_t driver_read(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, size_t size,
                   void* buffer) {
  auto* out = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got = ::pread(driver_file(file)->descriptor, out, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) {  // behind the end of the file, where space is allocated but not yet written
      std::memset(out, 0, size);
      return 0;
    }
    out += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  return 0;
}

herr_t driver_write(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, size_t size,
                    const void* buffer) {
  DriverFile* f = driver_file(file);
  const auto* in = static_cast<const char*>(buffer);
  f->eof = std::max(f->eof, address + size);
  while (size > 0 && *f->write_error == 0) {
    const ssize_t put = ::pwrite(f->descriptor, in, size, static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      *f->write_error = put < 0 ? errno : ENOSPC;
      break;
    }
    in += put;
    address += static_cast<haddr_t>(put);
    size -= static_cast<size_t>(put);
  }
  return 0;
}

herr_t driver_truncate(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  DriverFile* f = driver_file(file);
  if (f->eoa == f->eof) return 0;
  if (*f->write_error == 0 && ::ftruncate(f->descriptor, static_cast<off_t>(f->eoa)) != 0)
    *f->write_error = errno;
  f->eof = f->eoa;
  return 0;
}

hid_t driver_id() {
  static const H5FD_class_t driver = [] {
    H5FD_class_t d{};
    d.name = "reprise";
    d.maxaddr = (haddr_t{1} << 62) - 1;
    d.fc_degree = H5F_CLOSE_STRONG;
    d.fapl_size = sizeof(int*);
    d.open = driver_open;
    d.close = driver_close;
    d.cmp = driver_compare;
    d.query = driver_query;
    d.get_eoa = driver_eoa;
    d.set_eoa = driver_set_eoa;
    d.get_eof = driver_eof;
    d.read = driver_read;
    d.write = driver_write;
    d.truncate = driver_truncate;
    const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), d.fl_map);
    return d;
  }();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

// ---- Errors and identifiers
// -----------------------------------------------------------------------------------

herr_t keep_first_description(unsigned /*n*/, const H5E_error2_t* error, void* text) {
  auto& description = *static_cast<std::string*>(text);
  if (description.empty() && error->desc != nullptr) description = error->desc;
  return 0;
}

// The innermost entry of HDF5's error stack: "can't open object (...)".
std::string library_message() {
  std::string message;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first_description, &message);
  H5Eclear2(H5E_DEFAULT);
  return message;
}

[[noreturn]] void fail(const Hdf5Context& context, const std::string& place, const std::string& what) {
  const std::string message = library_message();
  const std::string text = message.empty() ? what : fmt::format("{} (HDF5: {})", what, message);
  if (place.empty() || place == "/") throw FileError(context.path, text);
  throw FileError(context.path, place, text);
}

// An identifier that is released at the end of its scope.
class Id {
 public:
  using Closer = herr_t (*)(hid_t);
  Id(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Id() {
    if (id_ >= 0) closer_(id_);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Id& operator=(Id&&) = delete;
  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }

 private:
  hid_t id_;
  Closer closer_;
};

Id checked(const Hdf5Context& context, const std::string& place, const char* what, hid_t id,
           Id::Closer closer) {
  if (id < 0) fail(context, place, what);
  return {id, closer};
}

void initialize_library() {
  static const bool done = [] {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors become exceptions, not text on standard error
    return true;
  }();
  static_cast<void>(done);
}

hid_t memory_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::float32:
      return H5T_NATIVE_FLOAT;
    case Hdf5Type::float64:
      return H5T_NATIVE_DOUBLE;
    case Hdf5Type::int8:
      return H5T_NATIVE_INT8;
    case Hdf5Type::uint8:
      return H5T_NATIVE_UINT8;
    case Hdf5Type::int16:
      return H5T_NATIVE_INT16;
    case Hdf5Type::uint16:
      return H5T_NATIVE_UINT16;
    case Hdf5Type::int32:
      return H5T_NATIVE_INT32;
    case Hdf5Type::uint32:
      return H5T_NATIVE_UINT32;
    case Hdf5Type::int64:
      return H5T_NATIVE_INT64;
    case Hdf5Type::uint64:
      return H5T_NATIVE_UINT64;
    default:
      return -1;
  }
}

hid_t file_type(Hdf5Type type) {
  switch (type) {
    case Hdf5Type::float32:
      return H5T_IEEE_F32LE;
    case Hdf5Type::float64:
      return H5T_IEEE_F64LE;
    case Hdf5Type::int8:
      return H5T_STD_I8LE;
    case Hdf5Type::uint8:
      return H5T_STD_U8LE;
    case Hdf5Type::int16:
      return H5T_STD_I16LE;
    case Hdf5Type::uint16:
      return H5T_STD_U16LE;
    case Hdf5Type::int32:
      return H5T_STD_I32LE;
    case Hdf5Type::uint32:
      return H5T_STD_U32LE;
    case Hdf5Type::int64:
      return H5T_STD_I64LE;
    case Hdf5Type::uint64:
      return H5T_STD_U64LE;
    default:
      return -1;
  }
}

Hdf5Type type_of(hid_t type) {
  const std::size_t size = H5Tget_size(type);
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      return size == 8 ? Hdf5Type::float64 : size == 4 ? Hdf5Type::float32 : Hdf5Type::other;
    case H5T_INTEGER: {
      const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
      switch (size) {
        case 1:
          return is_signed ? Hdf5Type::int8 : Hdf5Type::uint8;
        case 2:
          return is_signed ? Hdf5Type::int16 : Hdf5Type::uint16;
        case 4:
          return is_signed ? Hdf5Type::int32 : Hdf5Type::uint32;
        case 8:
          return is_signed ? Hdf5Type::int64 : Hdf5Type::uint64;
        default:
          return Hdf5Type::other;
      }
    }
    case H5T_STRING:
      return Hdf5Type::text;
    default:
      return Hdf5Type::other;
  }
}

std::vector<hsize_t> to_hsize(const Hdf5Shape& shape) {
  return {shape.begin(), shape.end()};
}

Id fixed_text_type(std::size_t size) {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(size, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

// Reads `count` texts of either kind, fixed or variable length, through `read(memory type, buffer)`.
std::vector<std::string> texts_from(hid_t type, hid_t space, std::size_t count,
                                    const std::function<herr_t(hid_t, void*)>& read, herr_t& status) {
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type) > 0) {
    Id memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.get(), H5T_VARIABLE);
    H5Tset_cset(memory.get(), H5Tget_cset(type));
    std::vector<char*> pointers(count, nullptr);
    status = read(memory.get(), pointers.data());
    if (status < 0) return texts;
    for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
    H5Dvlen_reclaim(memory.get(), space, H5P_DEFAULT, pointers.data());
    return texts;
  }
  const std::size_t size = H5Tget_size(type);
  std::vector<char> buffer(size * count);
  status = read(type, buffer.data());
  if (status < 0) return texts;
  for (std::size_t i = 0; i < count; ++i) {
    const char* first = buffer.data() + i * size;
    texts.emplace_back(first, std::find(first, first + size, '\0'));
  }
  return texts;
}

}  // namespace

Hdf5Context::~Hdf5Context() {
  const Lock lock(library_mutex());
  close();
  H5Eclear2(H5E_DEFAULT);
}

// ---- Objects and attributes
// -----------------------------------------------------------------------------------

Hdf5Object::Hdf5Object(std::shared_ptr<Hdf5Context> context, std::int64_t id, std::string name)
    : context_(std::move(context)), id_(id), name_(std::move(name)) {}

Hdf5Object::~Hdf5Object() {
  close();
}

void Hdf5Object::close() noexcept {
  const std::int64_t closing = std::exchange(id_, -1);
  if (closing < 0) return;
  const Lock lock(library_mutex());
  if (H5Iis_valid(closing) > 0) H5Oclose(closing);  // not valid: the file was finished before
  H5Eclear2(H5E_DEFAULT);
}

Hdf5Object::Hdf5Object(Hdf5Object&& other) noexcept
    : context_(std::move(other.context_)), id_(std::exchange(other.id_, -1)), name_(std::move(other.name_)) {}

Hdf5Object& Hdf5Object::operator=(Hdf5Object&& other) noexcept {
  if (this != &other) {
    close();
    context_ = std::move(other.context_);
    id_ = std::exchange(other.id_, -1);
    name_ = std::move(other.name_);
  }
  return *this;
}

const fs::path& Hdf5Object::file_path() const {
  return context_->path;
}

bool Hdf5Object::has_attribute(const std::string& attribute) const {
  const Lock lock(library_mutex());
  const htri_t found = H5Aexists(id_, attribute.c_str());
  if (found < 0) H5Eclear2(H5E_DEFAULT);
  return found > 0;
}

namespace {

// A scalar attribute of one of the given classes.
Id open_scalar(const Hdf5Context& context, hid_t object, const std::string& name,
               const std::string& attribute, std::initializer_list<H5T_class_t> classes,
               const char* expected) {
  const std::string what = fmt::format("has no attribute '{}', or it cannot be read", attribute);
  Id opened = checked(context, name, what.c_str(), H5Aopen(object, attribute.c_str(), H5P_DEFAULT), H5Aclose);
  const Id type = checked(context, name, what.c_str(), H5Aget_type(opened.get()), H5Tclose);
  const Id space = checked(context, name, what.c_str(), H5Aget_space(opened.get()), H5Sclose);
  const bool fits = std::ranges::count(classes, H5Tget_class(type.get())) > 0;
  if (!fits || H5Sget_simple_extent_npoints(space.get()) != 1) {
    fail(context, name, fmt::format("attribute '{}' is not {}", attribute, expected));
  }
  return opened;
}

void write_scalar(const Hdf5Context& context, hid_t object, const std::string& name,
                  const std::string& attribute, hid_t stored, hid_t memory, const void* value) {
  const std::string what = fmt::format("attribute '{}' cannot be written", attribute);
  if (H5Aexists(object, attribute.c_str()) > 0) H5Adelete(object, attribute.c_str());
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id created =
      checked(context, name, what.c_str(),
              H5Acreate2(object, attribute.c_str(), stored, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (H5Awrite(created.get(), memory, value) < 0) fail(context, name, what);
}

}  // namespace

std::int64_t Hdf5Object::read_integer(const std::string& attribute) const {
  const Lock lock(library_mutex());
  const Id opened = open_scalar(*context_, id_, name_, attribute, {H5T_INTEGER}, "one integer");
  std::int64_t value = 0;
  if (H5Aread(opened.get(), H5T_NATIVE_INT64, &value) < 0) fail(*context_, name_, "attribute cannot be read");
  return value;
}

double Hdf5Object::read_number(const std::string& attribute) const {
  const Lock lock(library_mutex());
  const Id opened = open_scalar(*context_, id_, name_, attribute, {H5T_INTEGER, H5T_FLOAT}, "one number");
  double value = 0.0;
  if (H5Aread(opened.get(), H5T_NATIVE_DOUBLE, &value) < 0)
    fail(*context_, name_, "attribute cannot be read");
  return value;
}

std::string Hdf5Object::read_text(const std::string& attribute) const {
  const Lock lock(library_mutex());
  const Id opened = open_scalar(*context_, id_, name_, attribute, {H5T_STRING}, "one text");
  const Id type = checked(*context_, name_, "attribute without type", H5Aget_type(opened.get()), H5Tclose);
  const Id space = checked(*context_, name_, "attribute without shape", H5Aget_space(opened.get()), H5Sclose);
  herr_t status = 0;
  auto texts = texts_from(
      type.get(), space.get(), 1,
      [&](hid_t memory, void* buffer) { return H5Aread(opened.get(), memory, buffer); }, status);
  if (status < 0) fail(*context_, name_, fmt::format("attribute '{}' cannot be read", attribute));
  return std::move(texts.front());
}

void Hdf5Object::write_integer(const std::string& attribute, std::int64_t value) {
  const Lock lock(library_mutex());
  write_scalar(*context_, id_, name_, attribute, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void Hdf5Object::write_number(const std::string& attribute, double value) {
  const Lock lock(library_mutex());
  write_scalar(*context_, id_, name_, attribute, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5Object::write_text(const std::string& attribute, const std::string& value) {
  const Lock lock(library_mutex());
  const Id type = fixed_text_type(value.size());
  write_scalar(*context_, id_, name_, attribute, type.get(), type.get(), value.c_str());
}

// ---- Datasets
// -------------------------------------------------------------------------------------------------

Hdf5Dataset::Hdf5Dataset(std::shared_ptr<Hdf5Context> context, std::int64_t id, std::string name)
    : Hdf5Object(std::move(context), id, std::move(name)) {
  const Id space = checked(*context_, name_, "dataset without shape", H5Dget_space(id_), H5Sclose);
  const Id type = checked(*context_, name_, "dataset without type", H5Dget_type(id_), H5Tclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> dimensions(rank < 0 ? 0 : static_cast<std::size_t>(rank));
  if (rank < 0 || (rank > 0 && H5Sget_simple_extent_dims(space.get(), dimensions.data(), nullptr) < 0)) {
    fail(*context_, name_, "dataset without shape");
  }
  shape_.assign(dimensions.begin(), dimensions.end());
  type_ = type_of(type.get());
}

std::size_t Hdf5Dataset::size() const {
  return std::accumulate(shape_.begin(), shape_.end(), std::size_t{1}, std::multiplies<>());
}

void Hdf5Dataset::check_shape(const Hdf5Shape& expected) const {
  if (shape_ == expected) return;
  throw FileError(context_->path, name_,
                  fmt::format("expected an array of shape ({}), found ({})", fmt::join(expected, ", "),
                              fmt::join(shape_, ", ")));
}

// A damaged or hostile file may claim an array far beyond memory.
void Hdf5Dataset::check_claim() const {
  const Id type = checked(*context_, name_, "dataset without type", H5Dget_type(id_), H5Tclose);
  const Id creation =
      checked(*context_, name_, "dataset without properties", H5Dget_create_plist(id_), H5Pclose);
  // Deflate makes at most 1032 bytes of one.
  const double expansion = H5Pget_nfilters(creation.get()) > 0 ? 1032.0 : 1.0;
  double claim = static_cast<double>(H5Tget_size(type.get()));
  for (const std::size_t n : shape_) claim *= static_cast<double>(n);
  if (claim > expansion * static_cast<double>(context_->file_bytes)) {
    throw FileError(context_->path, name_,
                    fmt::format("claims an array of shape ({}), more than a file of {} bytes can hold",
                                fmt::join(shape_, ", "), context_->file_bytes));
  }
}

void Hdf5Dataset::read_all(void* values, Hdf5Type type) const {
  const Lock lock(library_mutex());
  if (type_ == Hdf5Type::text || type_ == Hdf5Type::other) {
    throw FileError(context_->path, name_, "expected an array of numbers");
  }
  if (H5Dread(id_, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    fail(*context_, name_, "cannot be read");
  }
}

namespace {

std::size_t block_size(const Hdf5Context& context, const std::string& name, const Hdf5Shape& shape,
                       const Hdf5Shape& offset, const Hdf5Shape& count) {
  bool inside = offset.size() == shape.size() && count.size() == shape.size() && !shape.empty();
  std::size_t size = 1;
  for (std::size_t d = 0; inside && d < shape.size(); ++d) {
    inside = offset[d] <= shape[d] && count[d] <= shape[d] - offset[d];
    size *= count[d];
  }
  if (!inside) {
    throw FileError(context.path, name,
                    fmt::format("has the shape ({}), which does not hold ({}) elements from ({})",
                                fmt::join(shape, ", "), fmt::join(count, ", "), fmt::join(offset, ", ")));
  }
  return size;
}

}  // namespace

void Hdf5Dataset::read_block(const Hdf5Shape& offset, const Hdf5Shape& count, void* out, std::size_t size,
                             Hdf5Type type) const {
  const Lock lock(library_mutex());
  if (type_ == Hdf5Type::text || type_ == Hdf5Type::other) {
    throw FileError(context_->path, name_, "expected an array of numbers");
  }
  const std::size_t needed = block_size(*context_, name_, shape_, offset, count);
  if (needed != size) throw InvalidArgument(fmt::format("{} elements for a block of {}", size, needed));
  if (needed == 0) return;
  const auto file_offset = to_hsize(offset);
  const auto file_count = to_hsize(count);
  const Id space = checked(*context_, name_, "dataset without shape", H5Dget_space(id_), H5Sclose);
  // Of the same rank as the file's: for another one HDF5 walks element by element, thirty times slower.
  const Id memory =
      checked(*context_, name_, "block too large",
              H5Screate_simple(static_cast<int>(count.size()), file_count.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, file_offset.data(), nullptr, file_count.data(),
                          nullptr) < 0 ||
      H5Dread(id_, memory_type(type), memory.get(), space.get(), H5P_DEFAULT, out) < 0) {
    fail(*context_, name_, fmt::format("elements from ({}) cannot be read", fmt::join(offset, ", ")));
  }
}

void Hdf5Dataset::write_block(const Hdf5Shape& offset, const Hdf5Shape& count, const void* values,
                              std::size_t size, Hdf5Type type) {
  const Lock lock(library_mutex());
  const std::size_t needed = block_size(*context_, name_, shape_, offset, count);
  if (needed != size) throw InvalidArgument(fmt::format("{} elements for a block of {}", size, needed));
  if (needed == 0) return;
  const auto file_offset = to_hsize(offset);
  const auto file_count = to_hsize(count);
  const Id space = checked(*context_, name_, "dataset without shape", H5Dget_space(id_), H5Sclose);
  // Of the same rank as the file's: for another one HDF5 walks element by element, thirty times slower.
  const Id memory =
      checked(*context_, name_, "block too large",
              H5Screate_simple(static_cast<int>(count.size()), file_count.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, file_offset.data(), nullptr, file_count.data(),
                          nullptr) < 0 ||
      H5Dwrite(id_, memory_type(type), memory.get(), space.get(), H5P_DEFAULT, values) < 0) {
    fail(*context_, name_, fmt::format("elements from ({}) cannot be written", fmt::join(offset, ", ")));
  }
}

std::vector<std::string> Hdf5Dataset::read_texts() const {
  const Lock lock(library_mutex());
  if (type_ != Hdf5Type::text) throw FileError(context_->path, name_, "expected text");
  const Id type = checked(*context_, name_, "dataset without type", H5Dget_type(id_), H5Tclose);
  const Id space = checked(*context_, name_, "dataset without shape", H5Dget_space(id_), H5Sclose);
  herr_t status = 0;
  auto texts = texts_from(
      type.get(), space.get(), size(),
      [&](hid_t memory, void* buffer) { return H5Dread(id_, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer); },
      status);
  if (status < 0) fail(*context_, name_, "cannot be read");
  return texts;
}

void Hdf5Dataset::resize_rows(std::size_t rows) {
  const Lock lock(library_mutex());
  Hdf5Shape shape = shape_;
  shape.at(0) = rows;
  if (H5Dset_extent(id_, to_hsize(shape).data()) < 0) fail(*context_, name_, "cannot be resized");
  shape_ = std::move(shape);
}

// ---- Groups
// ---------------------------------------------------------------------------------------------------

namespace {

std::string child_path(const std::string& parent, const std::string& child) {
  return parent == "/" ? "/" + child : parent + "/" + child;
}

}  // namespace

bool Hdf5Group::has(const std::string& child) const {
  const Lock lock(library_mutex());
  const bool found = H5Lexists(id_, child.c_str(), H5P_DEFAULT) > 0 &&
                     H5Oexists_by_name(id_, child.c_str(), H5P_DEFAULT) > 0;
  H5Eclear2(H5E_DEFAULT);
  return found;
}

std::vector<std::string> Hdf5Group::children() const {
  const Lock lock(library_mutex());
  H5G_info_t info{};
  if (H5Gget_info(id_, &info) < 0) fail(*context_, name_, "cannot be listed");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t size = H5Lget_name_by_idx(id_, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (size < 0) fail(*context_, name_, "cannot be listed");
    std::string name(static_cast<std::size_t>(size) + 1, '\0');
    if (H5Lget_name_by_idx(id_, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT) <
        0) {
      fail(*context_, name_, "cannot be listed");
    }
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

bool Hdf5Group::is_dataset(const std::string& child) const {
  const Lock lock(library_mutex());
  const Id object(H5Oopen(id_, child.c_str(), H5P_DEFAULT), H5Oclose);
  H5Eclear2(H5E_DEFAULT);
  return object.valid() && H5Iget_type(object.get()) == H5I_DATASET;
}

Hdf5Group Hdf5Group::group(const std::string& child) const {
  const Lock lock(library_mutex());
  const hid_t id = H5Gopen2(id_, child.c_str(), H5P_DEFAULT);
  if (id < 0) fail(*context_, child_path(name_, child), "there is no such group");
  return {context_, id, child_path(name_, child)};
}

Hdf5Group Hdf5Group::create_group(const std::string& child) {
  const Lock lock(library_mutex());
  const Id creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);  // the same content gives the same file
  const hid_t id = H5Gcreate2(id_, child.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT);
  if (id < 0) fail(*context_, child_path(name_, child), "group cannot be created");
  return {context_, id, child_path(name_, child)};
}

namespace {

Id dataset_access(std::size_t cache_bytes) {
  Id access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 521, cache_bytes, H5D_CHUNK_CACHE_W0_DEFAULT);
  return access;
}

}  // namespace

Hdf5Dataset Hdf5Group::dataset(const std::string& child, std::size_t cache_bytes) const {
  const Lock lock(library_mutex());
  const Id access = dataset_access(cache_bytes);
  const hid_t id = H5Dopen2(id_, child.c_str(), access.get());
  if (id < 0) fail(*context_, child_path(name_, child), "there is no such dataset");
  Hdf5Dataset dataset(context_, id, child_path(name_, child));
  if (context_->file_bytes > 0) dataset.check_claim();
  return dataset;
}

Hdf5Dataset Hdf5Group::create_dataset(const std::string& child, Hdf5Type type, const Hdf5Shape& shape,
                                      const Hdf5DatasetOptions& options) {
  const Lock lock(library_mutex());
  const std::string path = child_path(name_, child);
  const auto dimensions = to_hsize(shape);
  auto limits = dimensions;
  if (options.growable) limits.at(0) = H5S_UNLIMITED;
  const Id space =
      checked(*context_, path, "has an impossible shape",
              H5Screate_simple(static_cast<int>(shape.size()), dimensions.data(), limits.data()), H5Sclose);
  const Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER);
  if (options.chunk_rows > 0) {
    auto chunk = dimensions;
    chunk.at(0) = options.chunk_rows;
    if (H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data()) < 0) {
      fail(*context_, path, "cannot be divided into chunks");
    }
    if (options.deflate > 0) {
      H5Pset_shuffle(creation.get());
      H5Pset_deflate(creation.get(), static_cast<unsigned>(options.deflate));
    }
    if (options.checksum) H5Pset_fletcher32(creation.get());
  }
  const Id access = dataset_access(0);
  const hid_t id =
      H5Dcreate2(id_, child.c_str(), file_type(type), space.get(), H5P_DEFAULT, creation.get(), access.get());
  if (id < 0) fail(*context_, path, "dataset cannot be created");
  return {context_, id, path};
}

namespace {

void write_texts(const Hdf5Context& context, hid_t group, const std::string& path, const std::string& child,
                 hid_t space, std::span<const std::string> texts) {
  std::size_t size = 1;
  for (const std::string& text : texts) size = std::max(size, text.size());
  std::vector<char> buffer(size * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i)
    std::ranges::copy(texts[i], buffer.begin() + static_cast<long>(i * size));
  const Id type = fixed_text_type(size);
  const Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  const Id dataset =
      checked(context, path, "text cannot be created",
              H5Dcreate2(group, child.c_str(), type.get(), space, H5P_DEFAULT, creation.get(), H5P_DEFAULT),
              H5Dclose);
  if (!texts.empty() &&
      H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()) < 0) {
    fail(context, path, "text cannot be written");
  }
}

}  // namespace

void Hdf5Group::write_text_dataset(const std::string& child, const std::string& text) {
  const Lock lock(library_mutex());
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  write_texts(*context_, id_, child_path(name_, child), child, space.get(), std::span(&text, 1));
}

void Hdf5Group::write_text_dataset(const std::string& child, std::span<const std::string> texts) {
  const Lock lock(library_mutex());
  const hsize_t count = texts.size();
  const Id space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  write_texts(*context_, id_, child_path(name_, child), child, space.get(), texts);
}

// ---- Files
// ----------------------------------------------------------------------------------------------------

Hdf5File Hdf5File::open(const fs::path& path) {
  const Lock lock(library_mutex());
  initialize_library();
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw FileError(path, fs::exists(path, error) ? "is not a file" : "there is no such file");
  }
  auto context = std::make_shared<Hdf5Context>();
  context->path = path;
  context->file_bytes = fs::file_size(path, error);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw FileError(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  ::close(descriptor);
  int* info = &context->write_error;
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_driver(access.get(), driver_id(), &info);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  context->file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get());
  if (context->file < 0) fail(*context, "", "cannot be opened as an HDF5 file");
  const hid_t root = H5Gopen2(context->file, "/", H5P_DEFAULT);
  if (root < 0) fail(*context, "", "cannot be opened as an HDF5 file");
  return {std::move(context), root, "/"};
}

Hdf5File Hdf5File::create(const fs::path& path, std::size_t user_block, const fs::path& reported_path) {
  const Lock lock(library_mutex());
  initialize_library();
  auto context = std::make_shared<Hdf5Context>();
  context->path = reported_path.empty() ? path : reported_path;
  int* info = &context->write_error;
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_driver(access.get(), driver_id(), &info);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  // The 1.10 layout keeps a checksum with all its metadata: damage is an error message, not a wild read.
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  const Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.get(), false);
  H5Pset_userblock(creation.get(), user_block);
  errno = 0;
  context->file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get());
  if (context->file < 0) fail(*context, "", "cannot be created");
  const hid_t root = H5Gopen2(context->file, "/", H5P_DEFAULT);
  if (root < 0) fail(*context, "", "cannot be created");
  return {std::move(context), root, "/"};
}

void Hdf5File::check_writes() const {
  if (context_->write_error != 0) {
    throw FileError(context_->path,
                    fmt::format("cannot be written: {}", std::strerror(context_->write_error)));
  }
}

void Hdf5File::finish() {
  const Lock lock(library_mutex());
  Hdf5Object::close();
  const bool closed = context_->close() >= 0;
  check_writes();
  if (!closed) fail(*context_, "", "cannot be finished");
}

}  // namespace reprise
