// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/outputs.h"

#include <system_error>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return true;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error) && !error;
}

}  // namespace

void check_outputs(const std::vector<Output>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const fs::path& path = outputs[i].path;
    if (path.empty()) continue;
    for (const fs::path& input : inputs) {
      if (is_same_file(path, input)) {
        throw InvalidArgument(
            fmt::format("{} is read by this command, so it is not written over", path.string()));
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (!outputs[j].path.empty() && is_same_file(path, outputs[j].path)) {
        throw InvalidArgument(fmt::format("{} is named for two outputs", path.string()));
      }
    }
    if (!outputs[i].extension.empty() && path.extension() != outputs[i].extension) {
      throw InvalidArgument(
          fmt::format("{}: expected a name that ends in {}", path.string(), outputs[i].extension));
    }
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
      throw FileError(path, fmt::format("cannot be written: there is no folder {}", folder.string()));
    }
  }
}

void prepare_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw FileError(folder, fmt::format("the folder cannot be made: {}",
                                        error ? error.message() : "there is something else of that name"));
  }
  const std::filesystem::path probe = folder / ".reprise-evaluation";
  write_text_file(probe, "");
  std::filesystem::remove(probe, error);
}

}  // namespace reprise
