// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What a performer wears: body shape, garments, hair, colours and patterns, motions. Built in, or a JSON
// file.

#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reprise/mesh/topology.h"

namespace reprise {

// Drawn on the cloth in metres of cloth, so that it is as large on a sleeve as on a skirt.
struct CostumePattern {
  enum class Kind { plain, stripes, bands, checks, dots };  // stripes run up, bands run around

  Kind kind = Kind::plain;
  std::vector<Color> colors;  // plain: none; others: two or more, the first is the ground
  double scale = 0.06;        // metres from one repetition to the next
};

// Where cloth or hair moves on its own: not at all above `from`, then more and more, `most` below `to`.
// Metres above the ground, standing in the costume's shoes.
struct CostumeFreedom {
  double from = 0.0;
  double to = 0.0;
  double most = 0.0;  // 0 to 1; 0: all of it follows the skin
};

// Some of the package's meshes are several things in one: shirt and trousers, shoes and socks.
enum class CostumePieces { all, upper, lower };

struct CostumeGarment {
  std::string proxy;  // of the package's clothes, or `long_skirt`: the body's own helper skirt
  CostumePieces pieces = CostumePieces::all;
  std::optional<Color> color;  // of the cloth; its texture's light and dark stay. None: the texture as it is
  CostumePattern pattern;
  double contrast = 1.0;  // how much of the texture's light and dark stays under colour and pattern
  CostumeFreedom freedom;
  // Shape below `waist` (metres above the ground): stretched so that it ends at `hem`, and widened by `flare`
  // there. None: as it is.
  std::optional<double> waist, hem;
  double flare = 1.0;
  // Cut wider around the body by this factor at the hem than it lies at rest: folds when it hangs, width when
  // it swings.
  double fullness = 1.0;
  // Largest edge length in metres where the cloth is free; longer ones are split. 0: as it is.
  double edge_length = 0.0;

  static constexpr std::string_view long_skirt = "long_skirt";
};

struct CostumeHair {
  std::string proxy;
  std::optional<Color> color;
  double contrast = 0.5;  // as of garments
  CostumeFreedom freedom;
};

struct CostumeShoes {
  std::string proxy;
  CostumePieces pieces = CostumePieces::all;
  std::optional<Color> color;
};

struct Costume {
  std::string name;
  // Which clips it performs: "character" (stand, walk, jog, ...), "fashion1" or "fashion2" (pose, walk,
  // twirl, ...).
  std::string motions;
  std::map<std::string, double> body;  // morph target -> weight
  std::string skin;
  std::string eyes, eye_color;
  std::string eyebrows;
  std::string eyelashes;
  CostumeHair hair;
  std::vector<CostumeGarment> garments;  // from the inside out
  CostumeShoes shoes;
};

// "character1", "fashion1", "fashion2".
std::vector<std::string> builtin_costume_names();

// A built-in costume by name, or a costume file if `name_or_file` ends in .json. A file may name a costume it
// is "based_on" and change only some fields. Throws `InvalidArgument` for an unknown name (offers the
// nearest), `FileError` naming file, field, what was expected and found.
Costume load_costume(const std::string& name_or_file);

// The same for a costume's JSON text; `path` is for the messages and the place of relative names.
Costume parse_costume(std::string_view text, const std::filesystem::path& path);

}  // namespace reprise
