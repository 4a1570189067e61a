// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/log.h"

#include <memory>

#include <spdlog/sinks/stdout_color_sinks.h>

namespace reprise {

void initialize_log(bool verbose) {
  auto logger =
      std::make_shared<spdlog::logger>("reprise", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%^%l%$: %v");
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace reprise
