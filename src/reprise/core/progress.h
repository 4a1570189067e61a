// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A progress line on the terminal: silent when standard error is not one. Of
// several ranks the first draws.

#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace reprise {

// Counts finished items of one long piece of work and draws "label  37% 120/325  3 s left" at most ten times
// a second. Thread-safe. The line is erased at destruction.
class Progress {
 public:
  // `total`: number of items, at least 0.
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Marks `count` more items as done. Throws `Cancelled` if the user has asked to stop.
  void advance(std::size_t count = 1);

 private:
  void draw(std::size_t done);

  std::string label_;
  std::size_t total_;
  bool visible_;
  std::atomic<std::size_t> done_{0};
  std::mutex mutex_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace reprise
