// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/editing/edit_model.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

constexpr std::array<std::pair<EditModel, const char*>, edit_model_count> names = {
    {{EditModel::part, "part"},
     {EditModel::whole, "whole"},
     {EditModel::laplacian, "laplacian"},
     {EditModel::lbs, "lbs"},
     {EditModel::dqs, "dqs"}}};

}  // namespace

EditModel parse_edit_model(const std::string& text) {
  for (const auto& [model, name] : names) {
    if (text == name) return model;
  }
  throw InvalidArgument(
      fmt::format("there is no model '{}'; expected part, whole, laplacian, lbs or dqs", text));
}

std::string to_string(EditModel model) {
  for (const auto& [known, name] : names) {
    if (model == known) return name;
  }
  throw InvalidArgument(fmt::format("there is no model number {}", static_cast<int>(model)));
}

}  // namespace reprise
