// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/child_process.h"

#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "reprise/core/error.h"

extern char** environ;

namespace reprise {
namespace {

struct SpawnActions {
  SpawnActions() { posix_spawn_file_actions_init(&value); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&value); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  posix_spawn_file_actions_t value;
};

struct Descriptor {
  explicit Descriptor(int descriptor) : value(descriptor) {}
  ~Descriptor() {
    if (value >= 0) close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int release() { return std::exchange(value, -1); }
  int value;
};

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const ChildOptions& options,
                           const std::string& is_needed_for)
    : program_(arguments.at(0)) {
  const auto fail = [&](const char* what) {
    return Error(fmt::format("{} cannot be started: {}: {}", program_, what, std::strerror(errno)));
  };
  // A file in memory rather than a pipe: a talkative child never blocks, and nobody has to listen.
  Descriptor errors(memfd_create("reprise-child-errors", MFD_CLOEXEC));
  if (errors.value < 0) throw fail("no memory file for its messages");
  Descriptor output(options.output.empty()
                        ? open("/dev/null", O_WRONLY | O_CLOEXEC)
                        : open(options.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (output.value < 0)
    throw FileError(options.output, fmt::format("cannot be written: {}", std::strerror(errno)));

  // A socket rather than a pipe: a write to a dead child is then an error of that write (MSG_NOSIGNAL), while
  // SIGPIPE would end the whole program or need a process-wide handler.
  int ends[2] = {-1, -1};
  if (options.input && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw fail("no socket");
  Descriptor ours(ends[0]);
  Descriptor theirs(options.input ? ends[1] : open("/dev/null", O_RDONLY | O_CLOEXEC));

  SpawnActions actions;
  posix_spawn_file_actions_adddup2(&actions.value, theirs.value, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions.value, output.value, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions.value, errors.value, STDERR_FILENO);
  if (!options.working_directory.empty()) {
    posix_spawn_file_actions_addchdir_np(&actions.value, options.working_directory.c_str());
  }
  std::vector<std::string> copies = arguments;
  std::vector<char*> pointers;
  for (std::string& copy : copies) pointers.push_back(copy.data());
  pointers.push_back(nullptr);
  const int error = posix_spawnp(&pid_, pointers[0], &actions.value, nullptr, pointers.data(), environ);
  if (error == ENOENT) {
    throw Error(fmt::format("the program `{}` is not installed (not in PATH); it is needed {}", program_,
                            is_needed_for));
  }
  if (error != 0) {
    errno = error;
    throw fail("spawn");
  }
  input_ = ours.release();
  errors_ = errors.release();
}

ChildProcess::~ChildProcess() {
  if (input_ >= 0) close(input_);
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (errors_ >= 0) close(errors_);
}

bool ChildProcess::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool ChildProcess::finish() {
  if (input_ >= 0) close(std::exchange(input_, -1));
  if (pid_ > 0) {
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  return WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
}

std::string ChildProcess::report() const {
  std::string said(4096, '\0');  // the first messages name the cause, the rest are its consequences
  const ssize_t count = pread(errors_, said.data(), said.size(), 0);
  said.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  while (!said.empty() && std::isspace(static_cast<unsigned char>(said.back())) != 0) said.pop_back();
  const std::string end = WIFSIGNALED(status_) ? fmt::format("was ended by signal {}", WTERMSIG(status_))
                                               : fmt::format("ended with status {}", WEXITSTATUS(status_));
  return said.empty() ? fmt::format("{} {}", program_, end) : fmt::format("{} {}: {}", program_, end, said);
}

}  // namespace reprise
