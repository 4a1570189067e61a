// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/interrupt.h"

#include <atomic>
#include <csignal>

#include "reprise/core/error.h"

namespace reprise {
namespace {

std::atomic<bool> interrupted_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void handle_interrupt(int signal_number) {
  interrupted_flag = true;
  std::signal(signal_number, SIG_DFL);  // the next one ends the process
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, handle_interrupt);
  std::signal(SIGTERM, handle_interrupt);
  // A closed pipe must be an error of the write, not a silent death that leaves temporary files.
  std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() {
  return interrupted_flag;
}

void set_interrupted(bool value) {
  interrupted_flag = value;
}

void throw_if_interrupted() {
  if (interrupted()) throw Cancelled();
}

}  // namespace reprise
