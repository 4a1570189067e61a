// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/error.h"

#include <fmt/format.h>

namespace reprise {

FileError::FileError(const std::filesystem::path& path, const std::string& what)
    : Error(fmt::format("{}: {}", path.string(), what)), path_(path) {}

FileError::FileError(const std::filesystem::path& path, const std::string& place, const std::string& what)
    : Error(fmt::format("{}:{}: {}", path.string(), place, what)), path_(path) {}

Cancelled::Cancelled() : Error("stopped on request; nothing was written") {}

}  // namespace reprise
