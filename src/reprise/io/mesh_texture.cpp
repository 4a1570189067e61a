// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/io/mesh_texture.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "reprise/io/input_file.h"

namespace reprise {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view spaces = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(spaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(spaces) - first + 1);
}

// The first word, and what follows it.
std::pair<std::string_view, std::string_view> split_word(std::string_view text) {
  const std::string_view line = trimmed(text);
  const std::size_t end = line.find_first_of(spaces);
  if (end == std::string_view::npos) return {line, {}};
  return {line.substr(0, end), trimmed(line.substr(end))};
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789+-.eE") == std::string_view::npos;
}

// A file name may hold spaces, so it is what is left behind the options.
std::string texture_name(std::string_view arguments) {
  struct Option {
    std::string_view name;
    int most;  // arguments; beyond the first only numbers count
  };
  constexpr std::array<Option, 12> options = {{{"-blendu", 1},
                                               {"-blendv", 1},
                                               {"-boost", 1},
                                               {"-bm", 1},
                                               {"-cc", 1},
                                               {"-clamp", 1},
                                               {"-imfchan", 1},
                                               {"-mm", 2},
                                               {"-o", 3},
                                               {"-s", 3},
                                               {"-t", 3},
                                               {"-texres", 1}}};
  while (true) {
    const auto [word, rest] = split_word(arguments);
    const auto option = std::ranges::find(options, word, &Option::name);
    if (option == options.end()) break;
    arguments = split_word(rest).second;
    for (int i = 1; i < option->most; ++i) {
      const auto [argument, after] = split_word(arguments);
      if (!is_number(argument) || after.empty()) break;
      arguments = after;
    }
  }
  std::string name(trimmed(arguments));
  std::ranges::replace(name, '\\', '/');
  return name;
}

// Pictures of the materials in use, each once, with their folders.
std::vector<fs::path> textures_of_materials(const ParsedMesh& mesh, const fs::path& folder,
                                            const fs::path& path) {
  std::vector<fs::path> textures;
  for (const std::string& file : mesh.material_files) {
    std::string name = file;
    std::ranges::replace(name, '\\', '/');
    const fs::path mtl = folder / name;
    std::error_code error;
    if (!fs::is_regular_file(mtl, error)) {
      spdlog::warn("{}: its material file '{}' is missing", path.string(), file);
      continue;
    }
    for (const ObjMaterial& material : parse_mtl(InputFile(mtl).read_all().view())) {
      const bool is_used =
          mesh.materials.empty() || std::ranges::find(mesh.materials, material.name) != mesh.materials.end();
      if (!is_used || material.texture_file.empty()) continue;
      const fs::path texture = mtl.parent_path() / material.texture_file;
      if (std::ranges::find(textures, texture) == textures.end()) textures.push_back(texture);
    }
  }
  return textures;
}

}  // namespace

std::vector<ObjMaterial> parse_mtl(std::string_view text) {
  std::vector<ObjMaterial> materials;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const auto [word, rest] = split_word(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (word == "newmtl") {
      materials.push_back({.name = std::string(rest), .texture_file = {}});
    } else if (word == "map_Kd" && !materials.empty()) {
      materials.back().texture_file = texture_name(rest);
    }
  }
  return materials;
}

void load_texture(ParsedMesh& mesh, const fs::path& path) {
  if (!mesh.topology.has_uvs()) return;
  const fs::path folder = path.parent_path();
  try {
    std::vector<fs::path> textures = textures_of_materials(mesh, folder, path);
    for (const std::string& file : mesh.texture_files) textures.push_back(folder / file);
    if (textures.size() > 1) {
      spdlog::warn("{}: has {} textures, such as '{}' and '{}'; only one a surface can be kept, so none is",
                   path.string(), textures.size(), textures[0].filename().string(),
                   textures[1].filename().string());
    } else if (!textures.empty()) {
      mesh.topology.texture = std::make_shared<const Image>(read_image(textures.front()));
    }
  } catch (const FileError& error) {
    spdlog::warn("{}: goes without its texture: {}", path.string(), error.what());
  }
}

}  // namespace reprise
