// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What holds of every mesh a parser returns, however odd its input.

#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "reprise/io/parsed_mesh.h"

namespace reprise::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline void check(const ParsedMesh& mesh) {
  const Topology& topology = mesh.topology;
  const auto vertices = static_cast<std::size_t>(topology.vertex_count);
  validate(topology);  // an exception of this kind is none of the parsers'
  require(static_cast<std::size_t>(mesh.positions.rows()) == vertices);
  require(mesh.normals.size() == 0 || static_cast<std::size_t>(mesh.normals.rows()) == vertices);
  require(mesh.colors.empty() || mesh.colors.size() == vertices);
}

}  // namespace reprise::fuzz
