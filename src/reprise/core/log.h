// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Messages to the user on standard error. Standard output belongs to results.

#pragma once

#include <spdlog/spdlog.h>

namespace reprise {

// Sends messages to standard error as "warning: text" without time stamps. Call once at program start.
void initialize_log(bool verbose);

}  // namespace reprise
