// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Clean stop on Ctrl-C: the handler raises a flag, long work looks at it and throws `Cancelled`, destructors
// remove temporary files.

#pragma once

namespace reprise {

// Installs the handler for SIGINT and SIGTERM. A second signal ends the process at once.
void install_interrupt_handler();

// True once the user has asked to stop.
bool interrupted();

// Raises the flag as a signal would, or lowers it; for tests and embedding programs.
void set_interrupted(bool value);

// Throws `Cancelled` if the user has asked to stop. Cheap enough for every frame of a loop.
void throw_if_interrupted();

}  // namespace reprise
