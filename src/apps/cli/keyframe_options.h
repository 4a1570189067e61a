// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Options that ask for an animation by key-frames.

#pragma once

#include <functional>

#include "command.h"
#include "reprise/pipeline/keyframes.h"

namespace reprise::cli {

// Declares the options of a query. Call the result once the command line was parsed, before `options` is
// used: it puts in what is given in other units or by several options, and throws `InvalidArgument`.
std::function<void()> add_keyframe_options(CLI::App& command, KeyframesOptions& options);

// --max-retiming and --max-stretch.
void add_correction_limits(CLI::App& command, CorrectionOptions& options);

}  // namespace reprise::cli
