// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/frame_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"
#include "reprise/core/text.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

// A file name without extension, cut into text, digits, text, digits, ..., text.
struct NumberedName {
  fs::path path;
  std::vector<std::string> texts, digits;
};

NumberedName parse_name(const fs::path& path) {
  NumberedName name{path, {std::string()}, {}};
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  bool in_digits = false;
  for (const char c : path.stem().string()) {
    if (is_digit(c) && !in_digits) name.digits.emplace_back();
    if (!is_digit(c) && in_digits) name.texts.emplace_back();
    in_digits = is_digit(c);
    (in_digits ? name.digits : name.texts).back() += c;
  }
  if (in_digits) name.texts.emplace_back();
  return name;
}

std::string without_leading_zeros(const std::string& digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
}

std::string file_name(const NumberedName& name) {
  return name.path.filename().string();
}

// Which of the numbers in the names counts the frames; nothing if a single name has none.
std::optional<std::size_t> frame_number_position(const std::vector<NumberedName>& names,
                                                 const fs::path& folder) {
  const NumberedName& first = names.front();
  std::optional<std::size_t> position;
  for (const NumberedName& name : names) {
    if (name.texts != first.texts) {
      throw FileError(
          folder, fmt::format("holds files of several names: expected frames of one sequence, found {} and "
                              "{}",
                              file_name(first), file_name(name)));
    }
    for (std::size_t k = 0; k < first.digits.size(); ++k) {
      if (without_leading_zeros(name.digits[k]) == without_leading_zeros(first.digits[k])) continue;
      if (position.value_or(k) != k) {
        throw FileError(folder, fmt::format("holds files whose names differ in several numbers: {} and {}",
                                            file_name(first), file_name(name)));
      }
      position = k;
    }
  }
  if (!position && !first.digits.empty()) position = first.digits.size() - 1;
  return position;
}

}  // namespace

FileKind file_kind(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".obj") return FileKind::obj;
  if (extension == ".ply") return FileKind::ply;
  if (extension == ".pc2") return FileKind::pc2;
  if (extension == ".mdd") return FileKind::mdd;
  if (extension == ".h5" || extension == ".hdf5") return FileKind::hdf5;
  return FileKind::other;
}

FrameFiles find_frame_files(const fs::path& folder) {
  std::map<FileKind, std::vector<fs::path>> by_kind;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& path = entries->path();
    const FileKind kind = file_kind(path);
    // Hidden files are not frames: file managers of some systems put a "._name.obj" beside every "name.obj".
    if (kind != FileKind::other && !path.filename().string().starts_with('.')) by_kind[kind].push_back(path);
  }
  if (error) throw FileError(folder, fmt::format("cannot be read: {}", error.message()));

  for (auto& [kind, paths] : by_kind) {
    std::sort(paths.begin(), paths.end(),
              [](const fs::path& a, const fs::path& b) { return natural_less(a.string(), b.string()); });
  }
  if (by_kind.size() > 1) {
    throw FileError(folder,
                    fmt::format("holds files of several kinds, such as {} and {}: expected frames of one",
                                by_kind.begin()->second.front().filename().string(),
                                std::next(by_kind.begin())->second.front().filename().string()));
  }
  if (by_kind.empty()) throw FileError(folder, "holds no frames: expected numbered OBJ or PLY files");
  const auto& [kind, paths] = *by_kind.begin();
  if (kind != FileKind::obj && kind != FileKind::ply) {
    throw FileError(
        folder, fmt::format("holds no frames: expected numbered OBJ or PLY files; {} is a sequence itself",
                            paths.front().filename().string()));
  }

  std::vector<NumberedName> names;
  for (const fs::path& path : paths) names.push_back(parse_name(path));
  FrameFiles files{kind == FileKind::obj, {}};
  const std::optional<std::size_t> position = frame_number_position(names, folder);
  if (!position) {
    if (names.size() > 1) {
      throw FileError(folder, fmt::format("holds frames without number: {} and {}", file_name(names[0]),
                                          file_name(names[1])));
    }
    files.paths = paths;
    return files;
  }

  std::vector<std::pair<std::uint64_t, const NumberedName*>> numbered;
  for (const NumberedName& name : names) {
    const std::string digits = without_leading_zeros(name.digits[*position]);
    if (digits.size() > 18) throw FileError(name.path, "has a frame number of more than 18 digits");
    numbered.emplace_back(std::stoull(digits), &name);
  }
  std::stable_sort(numbered.begin(), numbered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < numbered.size(); ++i) {
    const NumberedName& name = *numbered[i].second;
    if (i > 0 && numbered[i].first == numbered[i - 1].first) {
      throw FileError(folder, fmt::format("holds frame {} twice: {} and {}", numbered[i].first,
                                          file_name(*numbered[i - 1].second), file_name(name)));
    }
    if (i > 0 && numbered[i].first != numbered[i - 1].first + 1) {
      const NumberedName& before = *numbered[i - 1].second;
      std::string missing;
      for (std::size_t k = 0; k < before.texts.size(); ++k) {
        missing += before.texts[k];
        if (k == *position) {
          missing += fmt::format("{:0{}}", numbered[i - 1].first + 1, before.digits[k].size());
        } else if (k < before.digits.size()) {
          missing += before.digits[k];
        }
      }
      throw FileError(folder,
                      fmt::format("frame {}{} is missing between {} and {}", missing,
                                  before.path.extension().string(), file_name(before), file_name(name)));
    }
    files.paths.push_back(name.path);
  }
  return files;
}

}  // namespace reprise
