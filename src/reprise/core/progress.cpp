// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/core/progress.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "reprise/core/interrupt.h"
#include "reprise/core/ranks.h"

namespace reprise {
namespace {

constexpr auto redraw_interval = std::chrono::milliseconds(100);
constexpr const char* erase_line = "\r\x1b[K";

}  // namespace

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(total),
      visible_(isatty(STDERR_FILENO) != 0 && Ranks::is_first()),
      start_(std::chrono::steady_clock::now()),
      last_drawn_(start_) {}

Progress::~Progress() {
  if (visible_) std::fputs(erase_line, stderr);
}

void Progress::advance(std::size_t count) {
  throw_if_interrupted();
  const std::size_t done = done_ += count;
  if (visible_) draw(done);
}

void Progress::draw(std::size_t done) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;  // somebody else is drawing right now
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ < redraw_interval || done == 0) return;
  last_drawn_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  // More may be done than was announced.
  const std::size_t total = std::max(total_, done);
  const double left = elapsed * static_cast<double>(total - done) / static_cast<double>(done);
  const auto line =
      fmt::format("{}{}  {:3.0f}% {}/{}  {:.0f} s left", erase_line, label_,
                  100.0 * static_cast<double>(done) / static_cast<double>(total), done, total, left);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace reprise
