// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Exceptions of the library. A bad argument, file or index throws one of these, with the values found and
// expected in the message. A poor or impossible result ("no path satisfies these key-frames") is not an
// exception: it is a value with a reason.

#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace reprise {

// Base of everything the library throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// An argument breaks a stated precondition; the message names the argument, what was expected and what was
// found.
class InvalidArgument : public Error {
 public:
  using Error::Error;
};

// A file cannot be read or written as asked. The message reads "PATH[:PLACE]: WHAT", where PLACE is a line,
// byte or frame and WHAT says what was expected and what was found.
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& path, const std::string& what);
  FileError(const std::filesystem::path& path, const std::string& place, const std::string& what);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The user asked to stop (Ctrl-C). Nothing half-written is left behind.
class Cancelled : public Error {
 public:
  Cancelled();
};

}  // namespace reprise
