// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// The files of costumes/, which the build puts into the library.

#pragma once

#include <string_view>
#include <vector>

namespace reprise::costume {

struct BuiltinText {
  std::string_view name;
  std::string_view json;
};

const std::vector<BuiltinText>& builtin_texts();

}  // namespace reprise::costume
