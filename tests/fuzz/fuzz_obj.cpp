// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "invariants.h"
#include "reprise/core/error.h"
#include "reprise/io/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    ObjFaces faces;
    const ParsedMesh mesh = parse_obj(text, "fuzz.obj", &faces);
    fuzz::check(mesh);
    // The short way of later frames gives the same vertices.
    if (faces.text.empty()) return 0;
    const std::optional<ParsedMesh> again = parse_obj_frame(text, "fuzz.obj", faces);
    fuzz::require(again.has_value());
    const auto same = [](const Positions& a, const Positions& b) {
      const auto bytes = sizeof(float) * static_cast<std::size_t>(a.size());
      return a.size() == b.size() && (bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0);
    };
    fuzz::require(same(mesh.positions, again->positions));
    fuzz::require(same(mesh.normals, again->normals));
    fuzz::require(mesh.colors == again->colors);
  } catch (const FileError&) {
  }
  return 0;
}
