// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/costume.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/input_file.h"
#include "reprise/synthetic/body/costume_texts.h"

namespace reprise {
namespace {

using nlohmann::json;

std::string offer(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = nearest_word(name, names);
  if (!nearest.empty()) return fmt::format("did you mean '{}'?", nearest);
  return fmt::format("there are {}", fmt::join(names, ", "));
}

// A JSON value, and where it stands in which file.
class Field {
 public:
  Field(const json& value, const std::filesystem::path& path, std::string place)
      : value_(value), path_(path), place_(std::move(place)) {}

  [[noreturn]] void fail(const std::string& expected) const {
    std::string found = value_.dump();
    if (found.size() > 60) found = fmt::format("{}...", found.substr(0, 57));
    throw FileError(path_, place_, fmt::format("expected {}, found {}", expected, found));
  }

  std::string text() const {
    if (!value_.is_string() || value_.get<std::string>().empty()) fail("a text");
    return value_.get<std::string>();
  }
  double number(double low, double high) const {
    if (!value_.is_number()) fail(fmt::format("a number from {} to {}", low, high));
    const double x = value_.get<double>();
    if (!(x >= low && x <= high)) fail(fmt::format("a number from {} to {}", low, high));
    return x;
  }
  std::string one_of(const std::vector<std::string>& names) const {
    const std::string name = text();
    for (const std::string& candidate : names) {
      if (candidate == name) return name;
    }
    throw FileError(
        path_, place_,
        fmt::format("expected one of {}, found '{}'; {}", fmt::join(names, ", "), name, offer(name, names)));
  }
  Color color() const {
    const char* expected = "a colour such as \"#c8452f\"";
    if (!value_.is_string()) fail(expected);
    const auto text = value_.get<std::string>();
    if (text.size() != 7 || text[0] != '#' ||
        text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos) {
      fail(expected);
    }
    Color color;
    for (std::size_t c = 0; c < 3; ++c) {
      color[c] = static_cast<std::uint8_t>(std::stoi(text.substr(1 + 2 * c, 2), nullptr, 16));
    }
    return color;
  }
  std::vector<Field> list() const {
    if (!value_.is_array()) fail("a list");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      fields.emplace_back(value_[i], path_, fmt::format("{}[{}]", place_, i));
    }
    return fields;
  }

  // Calls `read(name, field)` for every member; it returns false for a name it does not know.
  template <typename Read>
  void members(const std::vector<std::string>& known, const Read& read) const {
    if (!value_.is_object()) fail("an object");
    for (const auto& [name, value] : value_.items()) {
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw FileError(path_, place_.empty() ? "the costume" : place_,
                        fmt::format("unknown field '{}'; {}", name, offer(name, known)));
      }
      read(name, Field(value, path_, place_.empty() ? name : place_ + "." + name));
    }
  }
  bool is_text() const { return value_.is_string(); }
  const json& value() const { return value_; }

 private:
  const json& value_;
  const std::filesystem::path& path_;
  std::string place_;
};

constexpr double tallest = 3.0;  // metres

CostumePieces read_pieces(const Field& field) {
  const std::string name = field.one_of({"all", "upper", "lower"});
  return name == "all" ? CostumePieces::all : name == "upper" ? CostumePieces::upper : CostumePieces::lower;
}

CostumePattern read_pattern(const Field& field) {
  static const std::vector<std::string> kinds = {"plain", "stripes", "bands", "checks", "dots"};
  CostumePattern pattern;
  field.members({"type", "colors", "scale"}, [&](const std::string& name, const Field& member) {
    if (name == "type") {
      const std::string kind = member.one_of(kinds);
      pattern.kind =
          static_cast<CostumePattern::Kind>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
    } else if (name == "colors") {
      for (const Field& color : member.list()) pattern.colors.push_back(color.color());
    } else {
      pattern.scale = member.number(0.002, 1.0);
    }
  });
  if (pattern.kind != CostumePattern::Kind::plain && pattern.colors.size() < 2) {
    field.fail("a pattern with two or more \"colors\"");
  }
  return pattern;
}

CostumeFreedom read_freedom(const Field& field) {
  CostumeFreedom freedom{.most = 1.0};
  bool has_from = false, has_to = false;
  field.members({"from", "to", "most"}, [&](const std::string& name, const Field& member) {
    if (name == "from") {
      freedom.from = member.number(0.0, tallest);
      has_from = true;
    } else if (name == "to") {
      freedom.to = member.number(0.0, tallest);
      has_to = true;
    } else {
      freedom.most = member.number(0.0, 1.0);
    }
  });
  if (!has_from || !has_to || freedom.to >= freedom.from) {
    field.fail("\"from\" and, below it, \"to\", in metres above the ground");
  }
  return freedom;
}

CostumeGarment read_garment(const Field& field) {
  CostumeGarment garment;
  field.members({"proxy", "pieces", "color", "pattern", "contrast", "freedom", "waist", "hem", "flare",
                 "fullness", "edge_length"},
                [&](const std::string& name, const Field& member) {
                  if (name == "proxy") garment.proxy = member.text();
                  if (name == "pieces") garment.pieces = read_pieces(member);
                  if (name == "color") garment.color = member.color();
                  if (name == "contrast") garment.contrast = member.number(0.0, 2.0);
                  if (name == "pattern") garment.pattern = read_pattern(member);
                  if (name == "freedom") garment.freedom = read_freedom(member);
                  if (name == "waist") garment.waist = member.number(0.0, tallest);
                  if (name == "hem") garment.hem = member.number(0.02, tallest);
                  if (name == "flare") garment.flare = member.number(0.5, 5.0);
                  if (name == "fullness") garment.fullness = member.number(1.0, 5.0);
                  if (name == "edge_length") garment.edge_length = member.number(0.005, 1.0);
                });
  if (garment.proxy.empty()) field.fail("a garment with a \"proxy\"");
  if (garment.hem.has_value() != garment.waist.has_value() ||
      (garment.hem.has_value() && *garment.hem >= *garment.waist)) {
    field.fail("\"waist\" and, below it, \"hem\", or neither");
  }
  return garment;
}

void read_costume(const Field& field, Costume& costume) {
  const std::vector<std::string> known = {"based_on", "name",      "motions", "body",     "skin", "eyes",
                                          "eyebrows", "eyelashes", "hair",    "garments", "shoes"};
  field.members(known, [&](const std::string& name, const Field& member) {
    if (name == "name") costume.name = member.text();
    if (name == "motions") costume.motions = member.one_of({"character", "fashion1", "fashion2"});
    if (name == "body") {
      costume.body.clear();
      member.members(
          [&] {
            std::vector<std::string> all;
            if (member.value().is_object()) {
              for (const auto& item : member.value().items()) all.push_back(item.key());
            }
            return all;
          }(),
          [&](const std::string& target, const Field& weight) {
            costume.body[target] = weight.number(-2.0, 2.0);
          });
    }
    if (name == "skin") costume.skin = member.text();
    if (name == "eyes") {
      member.members({"proxy", "color"}, [&](const std::string& part, const Field& value) {
        (part == "proxy" ? costume.eyes : costume.eye_color) = value.text();
      });
    }
    if (name == "eyebrows") costume.eyebrows = member.text();
    if (name == "eyelashes") costume.eyelashes = member.text();
    if (name == "hair") {
      costume.hair = {};
      member.members({"proxy", "color", "contrast", "freedom"},
                     [&](const std::string& part, const Field& value) {
                       if (part == "proxy") costume.hair.proxy = value.text();
                       if (part == "color") costume.hair.color = value.color();
                       if (part == "contrast") costume.hair.contrast = value.number(0.0, 2.0);
                       if (part == "freedom") costume.hair.freedom = read_freedom(value);
                     });
      if (costume.hair.proxy.empty()) member.fail("hair with a \"proxy\"");
    }
    if (name == "garments") {
      costume.garments.clear();
      for (const Field& garment : member.list()) costume.garments.push_back(read_garment(garment));
    }
    if (name == "shoes") {
      costume.shoes = {};
      member.members({"proxy", "pieces", "color"}, [&](const std::string& part, const Field& value) {
        if (part == "proxy") costume.shoes.proxy = value.text();
        if (part == "pieces") costume.shoes.pieces = read_pieces(value);
        if (part == "color") costume.shoes.color = value.color();
      });
      if (costume.shoes.proxy.empty()) member.fail("shoes with a \"proxy\"");
    }
  });
}

Costume load_based(const std::string& name_or_file, std::vector<std::string>& chain);

Costume parse_based(std::string_view text, const std::filesystem::path& path,
                    std::vector<std::string>& chain) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::parse_error& error) {
    throw FileError(path, fmt::format("byte {}", error.byte), "expected JSON, found a damaged text");
  } catch (const json::exception& error) {  // a number that is too large
    throw FileError(path, fmt::format("expected JSON, found what is none: {}", error.what()));
  }
  const Field field(root, path, "");
  if (!root.is_object()) field.fail("a JSON object");
  Costume costume;
  if (const auto base = root.find("based_on"); base != root.end()) {
    const Field base_field(*base, path, "based_on");
    std::string name = base_field.text();
    if (name.ends_with(".json")) name = (path.parent_path() / name).lexically_normal().string();
    if (std::find(chain.begin(), chain.end(), name) != chain.end()) {
      base_field.fail("a costume that is not based on this one");
    }
    chain.push_back(name);
    try {
      costume = load_based(name, chain);
    } catch (const InvalidArgument& error) {
      throw FileError(path, "based_on", error.what());
    }
  }
  read_costume(field, costume);
  const std::vector<std::pair<std::string, bool>> needed = {
      {"name", !costume.name.empty()},
      {"motions", !costume.motions.empty()},
      {"body", !costume.body.empty()},
      {"skin", !costume.skin.empty()},
      {"eyes", !costume.eyes.empty() && !costume.eye_color.empty()},
      {"eyebrows", !costume.eyebrows.empty()},
      {"eyelashes", !costume.eyelashes.empty()},
      {"hair", !costume.hair.proxy.empty()},
      {"garments", !costume.garments.empty()},
      {"shoes", !costume.shoes.proxy.empty()}};
  for (const auto& [name, there] : needed) {
    if (!there)
      throw FileError(path, fmt::format("expected a field '{}' or \"based_on\", found neither", name));
  }
  return costume;
}

Costume load_based(const std::string& name_or_file, std::vector<std::string>& chain) {
  if (name_or_file.ends_with(".json")) {
    const FileBytes bytes = InputFile(name_or_file).read_all();
    return parse_based(bytes.view(), name_or_file, chain);
  }
  for (const costume::BuiltinText& text : costume::builtin_texts()) {
    if (text.name == name_or_file) {
      return parse_based(text.json, fmt::format("built-in {}.json", text.name), chain);
    }
  }
  throw InvalidArgument(fmt::format("expected a costume's name or a .json file, found '{}'; {}", name_or_file,
                                    offer(name_or_file, builtin_costume_names())));
}

}  // namespace

std::vector<std::string> builtin_costume_names() {
  std::vector<std::string> names;
  for (const costume::BuiltinText& text : costume::builtin_texts()) names.emplace_back(text.name);
  return names;
}

Costume load_costume(const std::string& name_or_file) {
  std::vector<std::string> chain = {name_or_file};
  return load_based(name_or_file, chain);
}

Costume parse_costume(std::string_view text, const std::filesystem::path& path) {
  std::vector<std::string> chain = {path.string()};
  return parse_based(text, path, chain);
}

}  // namespace reprise
