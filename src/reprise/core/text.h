// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Small text helpers shared by readers and error messages.

#pragma once

#include <span>
#include <string>
#include <string_view>

namespace reprise {

// The candidate nearest to `word` in edit distance, or an empty string if none is near enough to be a likely
// typo (more than a third of the word wrong, but at least two letters may differ).
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

// Orders "frame_2" before "frame_10": runs of digits compare as numbers.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace reprise
