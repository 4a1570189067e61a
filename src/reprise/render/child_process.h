// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A program run beside this one, without a shell.

#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace reprise {

struct ChildOptions {
  bool input = false;                       // the caller feeds standard input with `write`
  std::filesystem::path output;             // standard output goes to this file; empty: nowhere
  std::filesystem::path working_directory;  // empty: that of the caller
};

// What the program says on standard error is kept for `errors`. A child that still runs at destruction is
// killed.
class ChildProcess {
 public:
  // `arguments[0]` is looked up in PATH. Throws `Error` if there is no such program (names it and says that
  // it `is_needed_for` something), `FileError` if the output cannot be opened.
  ChildProcess(const std::vector<std::string>& arguments, const ChildOptions& options,
               const std::string& is_needed_for);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // False if the child no longer reads. Never raises SIGPIPE.
  bool write(std::span<const std::uint8_t> bytes);

  // Closes the child's input and waits for its end. True if it ended with status 0.
  bool finish();

  // After `finish`: how it ended and what it said, such as "ended with status 1: disk full".
  std::string report() const;

 private:
  std::string program_;
  pid_t pid_ = -1;
  int input_ = -1;
  int errors_ = -1;
  int status_ = 0;
};

}  // namespace reprise
