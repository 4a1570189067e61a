// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Options of motion-capture queries, of the commands that ask them.

#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "reprise/pipeline/mocap.h"

namespace reprise::cli {

// Declares them; what is returned fills in what the command line gives in another form, after it was parsed.
std::function<void()> add_mocap_options(CLI::App& command, MocapStageOptions& options);

}  // namespace reprise::cli
