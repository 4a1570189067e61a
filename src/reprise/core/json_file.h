// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// JSON files that people edit: every error names the file and the field, or the line and column.

#pragma once

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace reprise {

using Json = nlohmann::ordered_json;  // keeps fields in the order a person reads them

// Throws `FileError` if the file cannot be read or is not JSON (says where).
Json read_json_file(const std::filesystem::path& path);

// One field of a file with its path in it ("clips[2].name"). All members throw `FileError` that names both
// and says what was expected and found. The file's path and the JSON must outlive it.
class JsonField {
 public:
  JsonField(const std::filesystem::path& file, const Json& value, std::string path = {})
      : file_(&file), value_(&value), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& what) const;

  bool has(const char* name) const { return as_object().contains(name); }
  bool is_null() const { return value_->is_null(); }
  bool is_text() const { return value_->is_string(); }
  JsonField operator[](const char* name) const;
  std::vector<JsonField> items() const;
  // Names and values of an object.
  std::vector<std::pair<std::string, JsonField>> entries() const;

  std::string text() const;
  double number() const;
  double number_from(double least) const;
  int integer(int least, int greatest = std::numeric_limits<int>::max()) const;
  template <typename Enum, std::size_t count>
  Enum choice(const std::pair<Enum, const char*> (&names)[count]) const {
    const std::string name = text();
    std::vector<std::string_view> known;
    for (const auto& [value, known_name] : names) {
      if (name == known_name) return value;
      known.emplace_back(known_name);
    }
    fail(fmt::format("expected one of {}, found '{}'", fmt::join(known, ", "), name));
  }

  // Warns of fields that are not `known`: a misspelt one must not be passed over in silence.
  void warn_of_others(const std::vector<std::string>& known) const;

 private:
  const Json& as_object() const;
  std::string found_type() const;

  const std::filesystem::path* file_;
  const Json* value_;
  std::string path_;
};

}  // namespace reprise
