// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/json_file.h"

#include <cstdint>

#include <spdlog/spdlog.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {
namespace {

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto newline = before.rfind('\n');
  return fmt::format("line {}, column {}", 1 + std::ranges::count(before, '\n'),
                     newline == std::string_view::npos ? before.size() + 1 : before.size() - newline);
}

}  // namespace

Json read_json_file(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    // After its own place, the parser says what it met and what it expected.
    std::string what = error.what();
    if (const auto dash = what.find(" - "); dash != std::string::npos) what = what.substr(dash + 3);
    throw FileError(path, line_and_column(text, error.byte), "is not JSON: " + what);
  } catch (const Json::exception& error) {
    throw FileError(path, fmt::format("is not JSON: {}", error.what()));
  }
}

void JsonField::fail(const std::string& what) const {
  throw FileError(*file_, path_.empty() ? "top level" : path_, what);
}

JsonField JsonField::operator[](const char* name) const {
  const auto found = as_object().find(name);
  const std::string path = path_.empty() ? name : fmt::format("{}.{}", path_, name);
  if (found == value_->end()) throw FileError(*file_, path, "expected this field, found none");
  return {*file_, *found, path};
}

std::vector<JsonField> JsonField::items() const {
  if (!value_->is_array()) fail(fmt::format("expected a list, found {}", found_type()));
  std::vector<JsonField> fields;
  for (std::size_t i = 0; i < value_->size(); ++i) {
    fields.emplace_back(*file_, (*value_)[i], fmt::format("{}[{}]", path_, i));
  }
  return fields;
}

std::vector<std::pair<std::string, JsonField>> JsonField::entries() const {
  std::vector<std::pair<std::string, JsonField>> fields;
  for (const auto& [name, value] : as_object().items()) {
    fields.emplace_back(name,
                        JsonField(*file_, value, path_.empty() ? name : fmt::format("{}.{}", path_, name)));
  }
  return fields;
}

std::string JsonField::text() const {
  if (!value_->is_string()) fail(fmt::format("expected a text, found {}", found_type()));
  return value_->get<std::string>();
}

double JsonField::number() const {
  if (!value_->is_number()) fail(fmt::format("expected a number, found {}", found_type()));
  return value_->get<double>();
}

double JsonField::number_from(double least) const {
  const double value = number();
  if (!(value >= least)) fail(fmt::format("expected a number from {}, found {}", least, value));
  return value;
}

int JsonField::integer(int least, int greatest) const {
  if (!value_->is_number_integer()) fail(fmt::format("expected an integer, found {}", found_type()));
  // Unsigned values beyond int64 wrap to negative ones, which no field takes.
  const auto value = value_->get<std::int64_t>();
  const bool is_wrapped = value_->is_number_unsigned() && value < 0;
  if (is_wrapped || value < least || value > greatest) {
    fail(greatest == std::numeric_limits<int>::max()
             ? fmt::format("expected an integer from {}, found {}", least, value_->dump())
             : fmt::format("expected an integer from {} to {}, found {}", least, greatest, value_->dump()));
  }
  return static_cast<int>(value);
}

void JsonField::warn_of_others(const std::vector<std::string>& known) const {
  for (const auto& [name, value] : as_object().items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const std::string nearest = nearest_word(name, known);
    spdlog::warn("{}: {}: unknown field '{}' is passed over{}", file_->string(),
                 path_.empty() ? "top level" : path_, name,
                 nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
  }
}

const Json& JsonField::as_object() const {
  if (!value_->is_object()) fail(fmt::format("expected an object, found {}", found_type()));
  return *value_;
}

std::string JsonField::found_type() const {
  const std::string text = value_->dump(-1, ' ', false, Json::error_handler_t::replace);
  return fmt::format("{} {}", value_->type_name(), text.size() <= 40 ? text : text.substr(0, 40) + "...");
}

}  // namespace reprise
