// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "reprise/core/error.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

const char* describe(fs::file_type type) {
  if (type == fs::file_type::directory) return "a folder";
  if (type == fs::file_type::regular) return "a file";
  return "neither a file nor a folder";
}

}  // namespace

AtomicOutput::AtomicOutput(fs::path target, Kind kind) : target_(std::move(target)), kind_(kind) {
  std::error_code error;
  if (target_.filename().empty()) target_ = target_.parent_path();  // "out/" means "out"
  if (fs::is_symlink(target_, error)) {
    if (fs::path place = fs::canonical(target_, error); !error) target_ = std::move(place);
  }
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    throw FileError(target_, fmt::format("cannot be written: there is no folder {}", folder.string()));
  }
  const fs::file_type wanted = kind_ == Kind::directory ? fs::file_type::directory : fs::file_type::regular;
  const fs::file_type standing = fs::status(target_, error).type();
  if (standing != wanted && standing != fs::file_type::not_found) {
    // Not only a matter of kind: a rename would put an ordinary file in the place of, say, /dev/null.
    throw FileError(target_,
                    fmt::format("is {} where {} is to be written", describe(standing), describe(wanted)));
  }
  // Two outputs to one target, even of one process, each have a temporary place of their own.
  static std::atomic<unsigned> output_count{0};
  temporary_ = folder / fmt::format(".{}.partial-{}-{}{}", target_.stem().string(), getpid(), output_count++,
                                    target_.extension().string());
  fs::remove_all(temporary_, error);
  if (kind_ == Kind::directory) {
    fs::create_directory(temporary_, error);
    if (error) throw FileError(target_, fmt::format("cannot be written: {}", error.message()));
  }
}

AtomicOutput::~AtomicOutput() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void AtomicOutput::commit() {
  std::error_code error;
  if (kind_ == Kind::directory && fs::exists(target_, error)) {
    // A directory cannot be replaced in one step: set the old one aside so that a failure can bring it back.
    fs::path aside = temporary_;
    aside += ".old";
    fs::rename(target_, aside, error);
    if (!error) {
      fs::rename(temporary_, target_, error);
      std::error_code ignored;
      if (error) {
        fs::rename(aside, target_, ignored);
      } else {
        fs::remove_all(aside, ignored);
      }
    }
  } else {
    fs::rename(temporary_, target_, error);
  }
  if (error) throw FileError(target_, fmt::format("cannot be put in place: {}", error.message()));
  committed_ = true;
}

void write_text_file(const fs::path& target, std::string_view text) {
  AtomicOutput output(target, AtomicOutput::Kind::file);
  std::ofstream stream(output.path(), std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) throw FileError(target, fmt::format("cannot be written: {}", std::strerror(errno)));
  output.commit();
}

std::string read_text_file(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw FileError(path, "cannot be read: it is a folder");
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  std::vector<char> block(std::size_t{1} << 16U);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  // A read that fails sets the bad bit, a file that cannot be opened never reaches its end.
  if (stream.bad() || !stream.eof()) {
    throw FileError(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  return text;
}

}  // namespace reprise
