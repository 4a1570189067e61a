// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/mocap/drive_model.h"

#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

struct NamedModel {
  std::string_view name;
  DriveModel model;
};
constexpr std::array<NamedModel, 7> models = {{{"none", DriveModel::none},
                                               {"part", DriveModel::part},
                                               {"whole", DriveModel::whole},
                                               {"laplacian", DriveModel::laplacian},
                                               {"lbs", DriveModel::lbs},
                                               {"dqs", DriveModel::dqs},
                                               {"rest-lbs", DriveModel::rest_lbs}}};

}  // namespace

DriveModel parse_drive_model(const std::string& text) {
  std::vector<std::string_view> names;
  for (const NamedModel& known : models) {
    if (known.name == text) return known.model;
    names.push_back(known.name);
  }
  throw InvalidArgument(
      fmt::format("there is no drive model '{}'; expected one of {}", text, fmt::join(names, ", ")));
}

std::string to_string(DriveModel model) {
  for (const NamedModel& known : models) {
    if (known.model == model) return std::string(known.name);
  }
  throw InvalidArgument(fmt::format("there is no drive model number {}", static_cast<int>(model)));
}

}  // namespace reprise
